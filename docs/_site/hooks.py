"""What the pages say about the package comes from the package, when the site is built.

A line `<!-- desaxe: WHAT ARGUMENTS -->` is replaced by what the function of that name below returns.
"""

import inspect
import io
import re
from html import escape

import matplotlib
from matplotlib.font_manager import FontProperties
from matplotlib.mathtext import math_to_image
from sympy import latex

import desaxe as dx
from desaxe._scene import schema
from desaxe._scene.read import SECTIONS
from desaxe.catalogue import quantities as catalogue
from desaxe.inputs import INPUTS
from desaxe.names import parts

MARK = re.compile(r"^<!-- desaxe: (\w+) ?(.*?) -->$", re.M)


def on_page_markdown(markdown, **_):
    """The event of MkDocs."""
    return MARK.sub(lambda found: WRITERS[found[1]](*found[2].split()), markdown)


def equation(*names):
    """Quantities as `desaxe.equation` derives them."""
    rows = [dx.equation(name) for name in names]
    return "\n\n".join(f"{_math(row.latex)}\n\n`{row.name}`: {_about(row)}." for row in rows)


def _about(row):
    source = f", paper {row.source}" if row.source else ""
    return f"{row.meaning}{f' [{row.unit}]' if row.unit != '1' else ''}{source}"


def closure():
    """The vector loop along X and along Y, from the file that the derivation starts from."""
    from desaxe.derive import loop
    from desaxe.derive.equation import LATEX_NAMES

    names = {symbol: LATEX_NAMES[symbol.name] for symbol in (loop.theta, loop.ec, loop.phi, loop.branch)}
    sides = zip(loop.CRANK + loop.ROD, loop.SLIDER, strict=True)
    rows = [" = ".join(latex(side, symbol_names=names) for side in pair) for pair in sides]
    return "\n\n".join(map(_math, rows))


def steps(name):
    """The lines that are computed for a quantity."""
    return "```text\n" + "\n".join(dx.equation(name).steps) + "\n```"


def _math(text):
    """LaTeX as a drawing, which needs neither a script nor a font, and its source to copy."""
    file = io.BytesIO()
    with matplotlib.rc_context({"mathtext.fontset": "cm", "svg.fonttype": "path"}):
        math_to_image(f"${_spaced(text)}$", file, prop=FontProperties(size=16), format="svg")
    drawing = file.getvalue().decode().partition("-//W3C//DTD")[2].partition(">")[2]
    drawing = re.sub(
        r"<metadata>.*?</metadata>|<!--.*?-->|<g id=\"patch_1\">.*?</g>", "", drawing, flags=re.S
    )
    drawing = re.sub(r"\s*\n\s*", " ", drawing).replace("<svg", '<svg role="img" fill="currentColor"', 1)
    source = f"<details><summary>LaTeX</summary><pre><code>{escape(text)}</code></pre></details>"
    return f'<div class="equation" aria-label="{escape(text)}">{drawing}</div>{source}'


def _spaced(text):
    """The same as it is best drawn: plain parentheses about a letter, room in front of a function."""
    text = re.sub(r"\\left\((\\?\w+) *\\right\)", r"(\1)", text)
    return re.sub(r"(?<=\S) (\\(?:sin|cos)\b)", r" \\,\1", text)


def api():
    """Every public function: how it is called, and its docstring as it stands."""
    found = [(name, getattr(dx, name)) for name in dx.__all__]
    return "\n\n".join(_entry(f"desaxe.{name}", value) for name, value in found)


def _entry(name, value):
    if inspect.ismodule(value):
        inside = [(own, getattr(value, own)) for own in value.__all__]
        doc = inspect.getdoc(value)
        return "\n\n".join([f"## {name}", _verbatim(doc), *(_entry(f"{name}.{n}", v) for n, v in inside)])
    return f"## {name}\n\n{_verbatim(_call(name, value))}\n\n{_verbatim(inspect.getdoc(value))}"


def _call(name, value):
    """The signature, a parameter a line where it is long."""
    given = inspect.signature(value)
    rows = [str(p).replace("typing.", "").replace("collections.abc.", "") for p in given.parameters.values()]
    kinds = [p.kind for p in given.parameters.values()]
    keyword = inspect.Parameter.KEYWORD_ONLY
    if keyword in kinds:
        rows.insert(kinds.index(keyword), "*")
    whole = f"{name}({', '.join(rows)})"
    return whole if len(whole) < 90 else f"{name}(\n" + "".join(f"    {row},\n" for row in rows) + ")"


def _verbatim(text):
    """Docstrings are laid out by hand, in columns."""
    return f'<pre class="docstring"><code>{escape(text)}</code></pre>'


def scene():
    """The keys of a scene file, from the types that check it."""
    top = _keys(schema.SceneFile, leave=(*SECTIONS, "check", "peak", "picture", "results"))
    tables = [
        *((f"[{name}]", table) for name, table in SECTIONS.items()),
        ("[[check]]", schema.CheckTable), ("[[peak]]", schema.PeakTable),
        ("[[peak.claim]]", schema.ClaimTable), ("[[picture]]", schema.PictureTable),
        ("[results]", schema.Results),
    ]  # fmt: skip
    return "\n\n".join(
        ["## At the top", top, *(f"## {head}\n\n{_doc(t)}\n\n{_keys(t)}" for head, t in tables)]
    )


def _doc(table):
    """What a table is for, without its own name in front."""
    return inspect.getdoc(table).partition(": ")[2].capitalize()


def _keys(table, leave=()):
    fields = [field for field in schema.msgspec.structs.fields(table) if field.name not in leave]
    rows = [f"| `{f.name}` | {_key(f.name, f.type)} | {'needed' if f.required else ''} |" for f in fields]
    return "\n".join(["| key | what it is | |", "|---|---|---|", *rows])


def _key(name, kind):
    known = INPUTS.get(name)
    words = schema._allowed(kind).replace("|", "\\|")
    return f"{known.meaning} [{known.unit}]" if known else words


def quantities():
    """Every quantity; its sensitivities have a name each, too."""
    rows = [row for row in catalogue() if not parts(row.name)[1]]
    return "\n".join(
        ["| name | unit | meaning | paper |", "|---|---|---|---|"]
        + [f"| `{r.name}` | {r.unit} | {r.meaning.replace('|', chr(92) + '|')} | {r.source} |" for r in rows]
    )


def inputs():
    """Every input."""
    rows = [f"| `{r.name}` | {r.unit} | {r.meaning} | {r.limit} |" for r in INPUTS.values()]
    return "\n".join(["| name | unit | meaning | limit |", "|---|---|---|---|", *rows])


WRITERS = {f.__name__: f for f in (equation, closure, steps, api, scene, quantities, inputs)}
