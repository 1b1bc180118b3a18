"""The results of a run as the page docs/benchmarks.md and the table of docs/measured.md; times are ratios."""

from collections.abc import Mapping
from math import nan
from typing import Any

from .accuracy.errors import TOP, ULPS
from .accuracy.report import number, table
from .contenders import LIMITS, STANDARD
from .load import DOUBLE
from .measure import Data
from .work import BY_KEY, DEGREE, MEMORY, TURNS

PICTURE, GROWTH_PICTURE = "benchmarks.png", "benchmarks-points.png"
COMMAND = "python -m benchmarks --write"
BEGIN = f"<!-- written by `{COMMAND}`: begin -->"
END = "<!-- end -->"
SHOWN = {  # in the short table: the work and its column
    "point": "`V_C, a_C`",
    "first": "+ 8 sensitivities",
    "grid": "grid, labelled",
    "grid_out": "grid into `out=`",
    "peak": "8,192 peaks",
}
QUIET = "The clock counts what else a machine does: these two tables mean something where that was nothing."
READING = f"""\
All times are multiples of what `accuracy="standard"` takes at the same work in the same run: 5 means five
times as long as desaxe. Every contender has a process of its own on the same core (affinity set); they take
turns, one at a time, and each time is the best round: the processor's time on one core, the clock's on all.
Compilation is not in these times: it has a table of its own.

Everyone but desaxe computes the textbook's closed form (`desaxe.equation`) at constant speed, as an
experienced user would run it: numbers are folded in before compiling, inputs have the layout that it prefers,
and results go into allocated memory where it supports that.

* heyoka derives its own sensitivities (`diff_tensors`), faster ones than SymPy's; on grids, sweeps and peaks
  it and CasADi get blocks of 131,072 points.
* C is a nest of loops from SymPy's printer with each shared subexpression in the outermost loop that knows
  its inputs, one call of `sincos`, no call of `pow`, by `gcc -O3 -march=native`. With `-ffast-math` its sines
  have loops of their own over strips, which gcc vectorises (`libmvec`).
* On the labelled grid the others return plain arrays, desaxe an xarray.Dataset with status and margin.
* For a peak the others take the best of 720 angles; desaxe refines it, with its gradient.
* `{LIMITS}` fills the memory of the result and computes nothing.
"""


def page(data: Data) -> str:
    """The whole page."""
    parts = ["# Time against error, beside everyone else", _made(data), READING.rstrip()]
    parts += ["## One core", by_contender(data, data["one core"]), _refusals(data["one core"])]
    parts += ["## Error", f"![Worst error over time, for every contender]({PICTURE})", _errors(data)]
    if "all cores" in data:
        parts += ["## All cores", _all_cores(data)]
    parts += ["## What a scene does not need", _operations(data)]
    if "growth" in data:
        parts += [
            "## Number of points",
            f"![Time per point over their number]({GROWTH_PICTURE})",
            _growth(data),
        ]
    parts += ["## Compilation, cold start, memory", _starts(data)]
    if "calls" in data:
        parts += ["## First calls and second processes", _calls(data)]
    parts += ["## The limits of the machine", _limits(data), _bounds(data)]
    return "\n\n".join(part for part in parts if part) + "\n"


def short_table(data: Data) -> str:
    """The table between the markers of docs/measured.md."""
    head = ["time as a multiple of `standard`'s", *SHOWN.values(), "error: generic", "next to a change point"]
    rows = []
    for name in [*data["who"], LIMITS]:
        cells = [_ratio(data["one core"][key], name) for key in SHOWN]
        result = data["errors"].get(name)
        rows.append(
            [name, *cells, *(_share(result[f][0]) if result else "" for f in ("generic", "change_point"))]
        )
    return table(head, rows)


def with_table(text: str, data: Data) -> str:
    """The page with the table of this data."""
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"the page has no {BEGIN} ... {END}")
    return f"{before}{BEGIN}\n\n{short_table(data)}\n\n{END}{after}"


def terminal(data: Data) -> str:
    """The tables of a run as text for the terminal."""
    if "one core" not in data:
        return f"{data['machine']}\n\n{_calls(data)}\n"
    parts = [
        data["machine"],
        by_contender(data, data["one core"]),
        _refusals(data["one core"]),
        _errors(data),
    ]
    if "all cores" in data:
        parts.append(_all_cores(data))
    if "growth" in data:
        parts.append(_growth(data))
    if "calls" in data:
        parts.append(_calls(data))
    parts += [_starts(data), _operations(data), _limits(data), _bounds(data)]
    return "\n\n".join(part for part in parts if part) + "\n"


def ratio(works: Mapping[str, Any], name: str, by: str = STANDARD) -> float:
    """Time as a multiple of another contender's; NaN if one of them has none."""
    mine, base = works.get(name, {}).get("seconds"), works.get(by, {}).get("seconds")
    return mine / base if mine and base else float("nan")


def digits(x: float) -> str:
    """A ratio with two digits, three from 100."""
    return "" if x != x else f"{x:.2f}" if x < 0.95 else f"{x:.1f}" if x < 9.95 else f"{x:,.0f}"


def by_contender(data: Data, works: Mapping[str, Any]) -> str:
    """A row for each contender, a column for each work, and what the columns are."""
    rows = [[name, *(_ratio(result, name) for result in works.values())] for name in [*data["who"], LIMITS]]
    titles = "\n".join(f"* **{key}**: {BY_KEY[key].title}{_many(data, key)}" for key in works)
    return f"{table(['', *works], rows)}\n\n{titles}"


def _many(data: Data, key: str) -> str:
    return f" ({data['points'][key]:,} points)" if BY_KEY[key].is_of_points else ""


def _ratio(works: Mapping[str, Any], name: str) -> str:
    return digits(ratio(works, name))


def _share(x: float) -> str:
    return number(x, TOP / ULPS)


def _made(data: Data) -> str:
    return f"Made by `{COMMAND}`, {data['rounds']} rounds, on\n{data['machine']}{_absent(data)}."


def _absent(data: Data) -> str:
    """A line on the contenders that are not installed."""
    return f"\nnot installed, and left out: {', '.join(data['absent'])}" if data["absent"] else ""


def _refusals(works: Mapping[str, Any]) -> str:
    message = [
        f"* {name} did not do `{key}`: {result['refused']}"
        for key, raced in works.items()
        for name, result in raced.items()
        if "refused" in result
    ]
    return "\n".join(message)


def _errors(data: Data) -> str:
    families = list(next(iter(data["errors"].values())))
    head = ["worst error (median)", *(name.replace("_", " ") for name in families)]
    rows = [
        [name, *(f"{_share(result[f][0])} ({_share(result[f][1])})" for f in families)]
        for name, result in data["errors"].items()
    ]
    return (
        f"{table(head, rows)}\n\n"
        "Of V_C, a_C and a_C_wrt_ec, as a multiple of what the inputs' last digits excuse, 8 ulp x (1 + the\n"
        "sum of the condition numbers), against the loop closure in ball arithmetic. `none`: somewhere no\n"
        "digit is right."
    )


def _all_cores(data: Data) -> str:
    many = data["all cores"]

    def gain(key: str, name: str) -> str:
        both = {"one": data["one core"][key].get(name, {}), "all": many[key].get(name, {})}
        return digits(ratio(both, "one", "all"))

    names = [*data["who"], LIMITS]
    speed = table(
        ["one core's time over all cores'", *many], [[n, *(gain(k, n) for k in many)] for n in names]
    )
    shares = table(["", *many], [[n, *(_ratio(many[k], n) for k in many)] for n in names])
    return f"{shares}\n\n{speed}\n\n{QUIET}"


def _operations(data: Data) -> str:
    """desaxe's time at works of different size, beside their operations."""
    works = {key: data["one core"][key].get(STANDARD, {}).get("seconds") for key in data["operations"]}
    known = {key: seconds / data["points"][key] for key, seconds in works.items() if seconds}
    if "concentric" not in known:
        return ""
    base, least = known["concentric"], data["operations"]["concentric"]
    rows = [
        [
            BY_KEY[k].title,
            str(data["operations"][k]),
            digits(data["operations"][k] / least),
            digits(known[k] / base),
        ]
        for k in known
        if BY_KEY[k].is_of_points
    ]
    head = ["desaxe standard", "operations at a point", "as a multiple", "time at a point, as a multiple"]
    return (
        f"{table(head, rows)}\n\nOperations as the frozen program has them, a sine or a root counted as one."
    )


def _growth(data: Data) -> str:
    sizes = [size for size, result in data["growth"].items() if STANDARD in result]
    rows = [
        [
            name,
            *(digits(data["growth"][s].get(name, float("nan")) / data["growth"][s][STANDARD]) for s in sizes),
        ]
        for name in data["who"]
    ]
    return table(["V_C, a_C: number of points", *(f"{int(size):,}" for size in sizes)], rows)


def _starts(data: Data) -> str:
    """Compile times in seconds beyond desaxe's, memory in megabytes beyond the result's own."""
    works = {
        key: result for key, result in data["one core"].items() if key in ("point", "first", "grid", "peak")
    }
    head = ["", *(f"compile {key}" for key in works), *(f"memory {key}" for key in works)]
    began = data.get("starts", {})
    if began:
        head += ["first start", "second start"]
    rows = []
    for name in data["who"]:
        cells = [digits(_over(result, name, "first")) for result in works.values()]
        cells += [_megabytes(result.get(name, {})) for result in works.values()]
        cells += [
            digits(began[name][when] / began[STANDARD]["second"]) for when in ("first", "second") if began
        ]
        rows.append([name, *cells])
    return (
        f"{table(head, rows)}\n\n"
        "Compilation with the first call, as a multiple of desaxe standard's. Starts, from a new process to\n"
        "10,000 points, as multiples of desaxe standard's second start, which finds its kernel on disk.\n"
        "Memory: megabytes that a call needs beyond its inputs and the memory given for its answers."
    )


def _over(result: Mapping[str, Any], name: str, what: str) -> float:
    mine, base = result.get(name, {}).get(what), result.get(STANDARD, {}).get(what)
    return mine / base if mine and base else float("nan")


def _megabytes(result: Mapping[str, Any]) -> str:
    return f"{max(0.0, result['memory']):.0f}" if "memory" in result else ""


def _calls(data: Data) -> str:
    """Seconds of desaxe's calls in new processes."""
    rows = [
        [name, f"{t['first']:.2f}", f"{t.get('later', nan):.4f}", f"{t['second']:.3f}"]
        for name, t in data["calls"].items()
    ]
    head = [
        "seconds of processor time, over importing NumPy",
        "first call",
        "slowest later",
        "second process",
    ]
    return (
        f"{table(head, rows)}\n\n"
        "A first call compiles what it needs, in memory, and so does a second process: nothing is kept\n"
        "on disk but by numba, for modules that people import."
    )


def _bounds(data: Data) -> str:
    """Table of each work's share of the memory limit and of the issue limit."""
    limits, rows = data["limits"], []
    if not {"copy", "multiply_add"} <= set(limits):
        return ""
    turns = 1024 * TURNS
    for key, load in data.get("load", {}).items():
        result = data["one core"].get(key, {})
        seconds = result.get(STANDARD, {}).get("seconds")
        if not seconds:
            continue
        points = data["points"][key]
        memory = limits["copy"] / MEMORY * load["bytes"] / (2 * DOUBLE)
        filled = result.get(LIMITS, {}).get("seconds", 0.0) / points
        memory = memory if BY_KEY[key].given else filled
        issue = load["slots"] * limits["multiply_add"] / (turns * DEGREE)
        issue += load["divisions"] * limits["divide"] / turns + load["roots"] * limits["sqrt"] / turns
        least = max(memory, issue)
        cells = [str(load["bytes"]), f"{load['slots'] + load['divisions'] + load['roots']:.0f}"]
        cells += [digits(points * part / seconds) for part in (memory, issue)]
        bound = (
            "the call" if points * least < 0.1 * seconds else "memory" if memory == least else "operations"
        )
        rows.append([key, *cells, bound])
    head = ["desaxe standard", "bytes a point", "operations a point", "memory", "operations", "bound by"]
    return (
        f"{table(head, rows)}\n\n"
        "How far from the machine's limits: the time that moving its bytes takes, and the time that issuing\n"
        "its operations takes, as shares of desaxe's time; 1 is the limit. Bytes are moved as fast as a\n"
        f"loop copies {MEMORY:,} doubles (where the answer is allocated: as `{LIMITS}`\n"
        "allocates and fills it), operations are issued as fast as multiplications and additions in\n"
        "registers, with divisions and roots at their own speed. Of columns that stay in a cache the share\n"
        "can exceed 1. Where both are small, the call itself takes the time."
    )


def _limits(data: Data) -> str:
    each = {key: seconds / (1024 * TURNS) for key, seconds in data["limits"].items()}
    raced = {key: data["one core"].get(key, {}) for key in ("concentric", "point", "first")}
    known = [(key, result.get(STANDARD, {}).get("seconds")) for key, result in raced.items()]
    rows = [
        [BY_KEY[limit].title, *(digits(s / data["points"][key] / each[limit]) for key, s in known if s)]
        for limit in each
        if limit in ("sqrt", "divide", "sincos")
    ]
    head = ["desaxe standard's time at a point, in", *(key for key, s in known if s)]
    return (
        f"{table(head, rows)}\n\nEach in a loop over 1,024 doubles that stay in the first cache, vectorised."
    )
