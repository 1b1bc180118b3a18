"""Titles: the inputs that matter for what is drawn, loads among them."""

import re
import textwrap
from collections.abc import Collection, Iterator, Sequence
from typing import TYPE_CHECKING

from ..loads.words import span, without_points
from ..mechanism.catalogue import has, law_name
from ..mechanism.inputs import INPUTS
from ..mechanism.names import CENTRES, LOADS
from ..mechanism.program import Variant, program_of
from .shared import raised, shown

if TYPE_CHECKING:
    import xarray as xr

WIDTH = 80  # letters in a line
ACTING = ("alpha", *(name for name in LOADS if name not in CENTRES))  # nothing where they are 0
_TABLE = re.compile(r"over (.*): [0-9]+ points, \w+, (.*)")
_NUMBER = re.compile(r"(?<![\w.^])[-+]?[0-9][0-9.]*(?:e[-+]?[0-9]+)?(?![\w.^])")
_VARYING = re.compile(r"(\w+): <load (.*?)>(?=; \w+: <|$)")


def title_of(dataset: "xr.Dataset", names: Sequence[str], width: int = WIDTH) -> str:
    """The inputs of these quantities that have one value, and the loads that vary with the motion."""
    needs = _needs(names, "omega" in dataset.coords)
    told = [*_numbers(dataset, needs), *_loads(dataset, needs)]
    if dataset.attrs.get("branch") == -1:
        told.append("branch = -1")
    whole = (one.replace(" ", "\u00a0") if len(one) < width else one for one in told)
    return textwrap.fill(", ".join(whole), width)


def _numbers(dataset: "xr.Dataset", needs: Collection[str]) -> Iterator[str]:
    for name, value in dataset.coords.items():
        if value.ndim or "units" not in value.attrs or (name in LOADS and name not in needs):
            continue
        if float(value) == 0.0 and name in ACTING:
            continue
        unit = "[deg]" if value.attrs["units"] == "rad" else raised(str(value.attrs["units"]))
        yield f"{name} = {float(shown(value)):.6g} {unit[1:-1]}".rstrip()


def _loads(dataset: "xr.Dataset", needs: Collection[str]) -> Iterator[str]:
    """The loads that vary with the motion, each with what it is over and its range, both ways together."""
    for name, words in _VARYING.findall(str(dataset.attrs.get("loads", ""))):
        if name not in needs:
            continue
        table = _TABLE.fullmatch(without_points(words))
        if table is None:
            yield f"{name} {words}"
            continue
        over, ranges = table.groups()
        ends = [float(number) for number in _NUMBER.findall(ranges)]
        unit = _NUMBER.sub("", ranges.rpartition(" to ")[2]).strip() or INPUTS[name].unit
        yield f"{name} over {over}, {span(ends)} {unit}"


def _needs(names: Sequence[str], state: bool) -> Collection[str]:
    """The inputs that these quantities depend on; all of them where one is no quantity of the catalogue."""
    if not all(has(name, state) for name in names):
        return INPUTS
    return program_of(tuple(law_name(n) if state else n for n in names), Variant(state)).inputs
