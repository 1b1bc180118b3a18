"""Functions, scene files, quantities and inputs, from their docstrings, types and tables.

`python docs/_site/reference.py` writes what WRITTEN makes into the pages, between `<!-- table: NAME ... -->`
and `<!-- end -->`; a test holds them fresh. The docstrings stand on the site alone.
"""

import inspect
import re
from html import escape
from pathlib import Path

import formulas
import loads

import desaxe as dx
from desaxe.derive.equation import EquationText
from desaxe.evaluation.quality import Quality
from desaxe.mechanism.catalogue import Quantity
from desaxe.mechanism.catalogue import quantities as catalogue
from desaxe.mechanism.inputs import INPUTS
from desaxe.mechanism.names import parts
from desaxe.mechanism.status import TABLES
from desaxe.scenes import schema
from desaxe.scenes.explain.explain import RunPlan
from desaxe.scenes.scene import Scene, SceneResult
from desaxe.simulation.result import Event, Simulation

# What the functions give, where it is not a float, an array, a plain dict or a Dataset.
RETURNED = (Quality, Quantity, EquationText, Simulation, Event, Scene, SceneResult, RunPlan)


def summary():
    """Every public name and the first line of what it says about itself."""
    rows = [f"| `{name}` | {_first(value)} |" for name, value in _public().items()]
    return "\n".join(["| name | what it is for |", "|---|---|", *rows])


def api():
    """Every public function: how it is called, and its docstring as it stands."""
    return "\n\n".join(f"## {name}\n\n{_entry(name, value)}" for name, value in _public().items())


def _public():
    """Each public name, those of a public module after it."""
    found = {}
    for name in dx.__all__:
        value = found[f"desaxe.{name}"] = getattr(dx, name)
        if inspect.ismodule(value):
            found |= {f"desaxe.{name}.{own}": getattr(value, own) for own in value.__all__}
    return found


def _first(value):
    return inspect.getdoc(value).partition("\n")[0].replace("|", "\\|")


def _entry(name, value):
    called = (
        "" if inspect.ismodule(value) or inspect.isclass(value) else _verbatim(_call(name, value)) + "\n\n"
    )
    return called + _verbatim(inspect.getdoc(value))


def _call(name, value):
    """The signature without the names of modules, a parameter a line where it is long."""
    given = inspect.signature(value)
    rows = [_short(p) for p in given.parameters.values()]
    kinds = [p.kind for p in given.parameters.values()]
    keyword = inspect.Parameter.KEYWORD_ONLY
    if keyword in kinds:
        rows.insert(kinds.index(keyword), "*")
    back = _short(inspect.formatannotation(given.return_annotation).strip("'"))
    whole = f"{name}({', '.join(rows)}) -> {back}"
    return (
        whole
        if len(whole) < 100
        else f"{name}(\n" + "".join(f"    {row},\n" for row in rows) + f") -> {back}"
    )


def _short(text):
    return re.sub(r"\b(?:[a-z_]\w*\.)+(?=[A-Z])", "", str(text))


def returned():
    """The classes of what comes back, with their own methods and properties."""
    return "\n\n".join(f"### {c.__name__}\n\n{_verbatim(_class_text(c))}" for c in RETURNED)


def _class_text(found):
    own = {
        name: value
        for name, value in vars(found).items()
        if not name.startswith("_") and (callable(value) or isinstance(value, property))
    }
    rows = [
        f".{name}{'()' * callable(value)}  {_first(value)}" for name, value in own.items() if _is_told(value)
    ]
    fields = getattr(found, "_fields", ())
    if fields and not any(field in inspect.getdoc(found).split() for field in fields):
        rows.append(f"A named tuple: {', '.join(fields)}")
    return "\n".join([inspect.getdoc(found), *([""] * bool(rows)), *rows])


def _is_told(value):
    return bool(inspect.getdoc(value)) and not isinstance(value, type(Event.t))


def _verbatim(text):
    """Docstrings are laid out by hand, in columns."""
    return f'<pre class="docstring"><code>{escape(text)}</code></pre>'


def scene():
    """The keys of a scene file, from the rules that check it."""
    tables = [*((f"[{name}]", table) for name, table in schema.SECTIONS.items())]
    tables += [(f"[[{name}]]", table) for name, table in schema.LISTED.items()]
    tables.insert(-1, ("[[peak.claim]]", schema.CLAIM))
    tables += [("[results]", schema.RESULTS), ("[quantities.NAME]", schema.QUANTITY)]
    apart = (*schema.SECTIONS, *schema.LISTED, "results", "quantities")
    sections = [f"## {head}\n\n{_about(table)}\n\n{_keys(table)}" for head, table in tables]
    return "\n\n".join(["## At the top", _keys(schema.SCENE, leave=apart), *sections])


def _about(table):
    """What a table is for, without its own name in front."""
    text = table["description"].rpartition("]: ")[2]
    return f"{text[:1].upper()}{text[1:]}."


def _keys(table, leave=()):
    rows = [
        f"| `{name}` | {_key(name, rule)} | {'needed' if name in table['required'] else ''} |"
        for name, rule in table["properties"].items()
        if name not in leave
    ]
    return "\n".join(["| key | what it is | |", "|---|---|---|", *rows])


def _key(name, rule):
    words = rule["description"].replace("|", "\\|").replace("{", "&#123;")  # no list of attributes
    return rule.get("title", words)


def quantities():
    """Every quantity; its sensitivities have a name each, too."""
    rows = [row for name, row in catalogue().items() if not parts(name)[1]]
    return "\n".join(
        ["| name | unit | meaning | paper |", "|---|---|---|---|"]
        + [f"| `{r.name}` | {r.unit} | {r.meaning.replace('|', chr(92) + '|')} | {r.source} |" for r in rows]
    )


def statuses():
    """A table of the codes of every call."""
    rows = []
    for table in TABLES:
        of, _, calls = inspect.getdoc(table).splitlines()[0].rstrip(".").partition(": ")
        name = f'<code style="white-space: nowrap">{table.__name__}</code>'
        codes = "<br>".join(f"{status:d} {status.words}" for status in table)
        rows.append(f"| {calls} | {of.removeprefix('The status of ')} | {name} | {codes} |")
    return "\n".join(["| call | status of | in `desaxe.status` | codes |", "|---|---|---|---|", *rows])


def inputs():
    """Every input."""
    rows = [f"| `{r.name}` | {r.unit} | {r.meaning} | {r.limit} |" for r in INPUTS.values()]
    return "\n".join(["| name | unit | meaning | limit |", "|---|---|---|---|", *rows])


WRITERS = (api, returned, loads.load_picture)
WRITTEN = {
    writer.__name__: writer
    for writer in (summary, quantities, inputs, statuses, scene, *loads.WRITERS, *formulas.WRITERS)
}
TABLE = re.compile(r"(?<=^<!-- table: )(\w+)( [\w ]+)?( -->\n).*?(?=^<!-- end -->$)", re.S | re.M)


def with_tables(page):
    """The text of a page with its tables as they are now."""

    def fresh(mark):
        arguments = mark[2] or ""
        return f"{mark[1]}{arguments}{mark[3]}\n{WRITTEN[mark[1]](*arguments.split())}\n\n"

    return TABLE.sub(fresh, page)


if __name__ == "__main__":
    for path in Path(__file__).resolve().parents[1].glob("*.md"):
        path.write_text(with_tables(path.read_text(encoding="utf-8")), encoding="utf-8")
