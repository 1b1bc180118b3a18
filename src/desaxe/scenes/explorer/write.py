"""Content as one HTML file: markup, style, scripts, the emitted functions and the plotting library."""

import json
import re
from html import escape
from pathlib import Path
from typing import Any

from ...compiler.languages.es_module import JavaScript
from ...definitions.tables import tables_of as definitions_of
from ...loads.along_motion import OverSpeed, members_of
from ...loads.elements import Damper, Spring
from ...loads.lines import tables_of
from ...loads.load import Load, OverY, TableOverTheta
from ...loads.stroke import OverStroke
from ...mechanism.inputs import INPUTS
from ...mechanism.names import parts
from ...mechanism.quantity_units import SI, UnitSystem
from ...mechanism.status import PointStatus
from ...support.extras import needed
from ...support.template import file_text, filled
from ...support.written import UNSEALED, sealed, write_whole
from ...units.system import DIMENSIONS
from ..written import load_table, value_text
from .content import CLOSED, PageContent, left_out_text

# In the order in which they build on each other.
SCRIPTS = ("numbers", "designs", "words", "mechanism", "charts", "controls", "files", "main")
ABOUT = ("unit", "meaning", "least", "limit", "section")  # what a page knows of an input
WORDS: dict[type, str] = {
    TableOverTheta: "over θ",
    OverY: "over Y",
    OverStroke: "over the stroke",
    OverSpeed: "over the speed",
    Spring: "by a spring",
    Damper: "by a damper",
}
# A page repeats its lines for each quantity; what they mean stands in generated/program.py.
_COMMENT = re.compile(r"^\s*(?://.*|/\*\*.*\*/)\n|(?<=;) // .*", re.MULTILINE)


def write_page(content: PageContent, path: Path, overwrite: bool = False) -> Path:
    """Write the page; its path."""
    with write_whole(path, overwrite) as staged:
        staged.write_text(page(content), encoding="utf-8")
    return path


def page(content: PageContent) -> str:
    """The text of the page."""
    with needed("desaxe explore"):
        from plotly.offline import get_plotlyjs
    page = filled(
        _asset("page.html"),
        CHECKSUM=UNSEALED,
        TITLE=escape(content.title),
        STYLE=_asset("style.css"),
        PLOTLY=get_plotlyjs(),
        CONTENT=_embedded(_data(content)),
        MODULE=_embedded(_COMMENT.sub("", JavaScript().files(content.module)["page.js"])),
        SCRIPTS=_COMMENT.sub("", "\n".join(_asset(f"{name}.js") for name in SCRIPTS)),
    )
    return sealed(page)


def _asset(name: str) -> str:
    return file_text(__package__, "page", name)


def _embedded(data: Any) -> str:
    """Data as JSON in a page."""
    return json.dumps(data, ensure_ascii=False).replace("<", "\\u003c")


def _data(content: PageContent) -> dict[str, Any]:
    """The data that the scripts of the page read."""
    groups = content.groups | CLOSED
    return {
        "title": content.title,
        "branch": content.branch,
        "theta": content.theta,
        "designs": content.designs,
        "left_out": left_out_text(content),
        "units": _units(content.units),
        "fields": _units(content.fields),
        "sizes": {**_sizes(content.fields), **_sizes(content.units)},
        "shown": content.shown,
        "inputs": {
            name: {"given": name in content.given, **{key: getattr(INPUTS[name], key) for key in ABOUT}}
            for name in content.designs[0]
        },
        "dimensions": {unit: name.replace(" ", "_") for name, unit in DIMENSIONS.items()},
        "parameters": {name: row.unit for name, row in INPUTS.items()},
        "groups": content.groups,
        "arguments": {base: content.module.taken(names[0]) for base, names in groups.items()},
        "closed": CLOSED,
        "loads": {name: _load(name, load) for name, load in content.loads.items()},
        "quantities": {row.name: _about(row.name, row.unit, row.meaning) for row in content.quantities},
        "definitions": definitions_of(content.definitions),
        "status": {str(int(status)): status.words for status in PointStatus},
    }


def _load(name: str, load: Load) -> dict[str, Any]:
    """A load in words, as text of a scene in SI units and of one in others, and where its parts jump."""
    table = load_table(name, load, SI, None, {})
    tables = [row for row in (table if isinstance(table, list) else [table]) if isinstance(row, dict)]
    plain = value_text(table)
    for row in tables:
        if not row.keys() & {"spring", "damper"}:
            row.setdefault("value", INPUTS[name].unit)
    words = ", ".join(dict.fromkeys(WORDS[type(member)] for member in members_of([load])))
    parts = [_jumps(part) for part in tables_of(name, load).values()]
    return {"words": words, "saved": [plain, value_text(table)], "parts": parts}


def _jumps(table: Load) -> dict[str, Any]:
    """The column along which a table is looked up, and where it jumps."""
    jumps = sorted({knot for way in table.tables for knot in way.jumps})
    if isinstance(table, TableOverTheta):
        return {"over": "theta", "jumps": jumps, "period": table.period}
    if isinstance(table, OverY):
        ways = {"inward": table.inward is not None, "centre": table.centre}
        return {"over": table.over, "jumps": jumps, **ways}
    return {"over": "V_C", "jumps": []}


def _units(units: UnitSystem) -> dict[str, str]:
    """SI unit, or name of a quantity -> the unit that it is shown in."""
    return {DIMENSIONS.get(name, name): unit for name, unit in units.units.items()}


def _sizes(units: UnitSystem) -> dict[str, list[str]]:
    """Unit -> what one of it is in SI units, as a fraction."""
    result = {
        name: units.of_unit(DIMENSIONS[name]) if name in DIMENSIONS else units.of(name)
        for name in units.units
    }
    return {row.unit: [str(row.si.numerator), str(row.si.denominator)] for row in result.values()}


def _about(name: str, unit: str, meaning: str) -> dict[str, Any]:
    base, by = parts(name)
    return {"base": base, "by": by, "unit": unit, "meaning": meaning}
