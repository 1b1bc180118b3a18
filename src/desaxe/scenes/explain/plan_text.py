"""A plan as text for a terminal, at most 100 columns wide."""

from collections.abc import Mapping
from textwrap import wrap
from typing import Any

from ...support.shown import printed, with_unit
from ..report import number, table

WIDTH = 96


def plan_text(plan: Mapping[str, Any]) -> str:
    """The whole plan."""
    parts = [plan["title"] or "Scene", _asked(plan)]
    if plan["loops"] is not None:
        parts += [_skipped(plan), _passes(plan), _loops(plan), _how(plan)]
    parts += [_also(plan)] if plan["also"] else []
    parts += [_sweep(plan)] if plan["sweep"] is not None else []
    return "\n\n".join(part for part in parts if part)


def _asked(plan: Mapping[str, Any]) -> str:
    """The requested names and the axes of the grid."""
    lines = ["Asked for"]
    if plan["outputs"]:
        rows = [[out["name"], printed(out["unit"]), out["meaning"]] for out in plan["outputs"]]
        lines += [_cut(line) for line in table(rows, "l")]
        taken = plan["reduction"]
        if taken:
            how = "block by block" if taken["stored"] else "the grid is not stored"
            lines.append(f"  of each over {taken['axis']}: {', '.join(taken['kinds'])}; {how}")
        else:
            lines.append("  and at every point its status; the margin once per design")
    lines += _wrapped("accuracy", [f"{plan['accuracy']}: {plan['promise']}"])
    lines += _wrapped("motion", [plan["motion"]])
    axes = [one for one in plan["inputs"] if "values" in one]
    fixed = [one for one in plan["inputs"] if "value" in one]
    if axes:
        told = [
            f"{a['name']} ({a['values']}: {number(a['from'])} to {number(a['to'])} {a['unit']})" for a in axes
        ]
        lines += _wrapped("axes", told)
    if any("load" in one for one in plan["inputs"]):
        lines += _wrapped("loads", [f"{a['name']}: {a['load']}" for a in plan["inputs"] if "load" in a])
    if fixed:
        lines += _wrapped(
            "fixed", [with_unit(f"{a['name']} = {number(a['value'])}", a["unit"]) for a in fixed]
        )
    return "\n".join(lines)


def _cut(line: str) -> str:
    if len(line) <= WIDTH + 2:
        return line
    return line[: line.rindex(" ", 0, WIDTH - 2)].rstrip(" ,;") + ", ..."


def _wrapped(word: str, parts: list[str]) -> list[str]:
    """Wrapped lines of a label and its parts; only a single part may be broken inside."""
    whole = [part.replace(" ", "\xa0") for part in parts] if len(parts) > 1 else parts
    rows = wrap(", ".join(whole), WIDTH - 11, break_long_words=False)
    return [f"  {word if not index else '':8} {row}".replace("\xa0", " ") for index, row in enumerate(rows)]


def _skipped(plan: Mapping[str, Any]) -> str:
    """The part of the plan on what is skipped."""
    lines = ["Skipped"]
    for one in plan["skipped"]:
        count = one["saved"]
        saved = f" ({count} operation{'s' if count > 1 else ''} a point)" if count > 0 else ""
        rows = wrap(f"{one['what']}: {one['why']}{saved}", WIDTH - 2, subsequent_indent="  ")
        lines += ["  " + row for row in rows]
    return "\n".join(lines) if len(lines) > 1 else ""


def _passes(plan: Mapping[str, Any]) -> str:
    """Operations at each point after each pass, then what hoisting leaves."""
    rows = [["pass", "operations", "saved", ""]]
    for step in plan["steps"]:
        saved = f"{step['saved']:+d}".replace("+", "") if step["saved"] else ""
        rows.append([step["name"], str(step["operations"]), saved, step["what"]])
    counts = plan["operations"]
    before = plan["steps"][-1]["operations"]
    per = counts["per_point"]
    if _is_compiled(plan) and per < 0.995 * before:
        what = "what does not depend on an axis leaves its loop"
        rows.append(["hoist", _few(per), _few(before - per), what])
    return "\n".join(["Operations at each point after each pass", *table(rows, "lrrl")])


def _is_compiled(plan: Mapping[str, Any]) -> bool:
    """True if the plan runs a kernel."""
    compiled: bool = plan["run"]["way"] == "compiled"
    return compiled


def _few(value: float) -> str:
    return f"{value:.1f}" if value < 100 else f"{value:.0f}"


def _loops(plan: Mapping[str, Any]) -> str:
    """The table of loops: runs, operations, operations per point."""
    rows = [["", "runs", "operations", "per point", ""]]
    for loop in plan["loops"]:
        if loop["table"]:
            place = f"table over {' x '.join(loop['along'])}" if loop["along"] else "for the tables, once"
        else:
            depth = len([axis for axis in loop["along"] if axis])
            place = "  " * max(0, depth - 1) + (f"for each {loop['along'][-1]}" if depth else "once")
        if loop["close"]:
            form = "the stable form, where margins are narrow"
            rows.append(["  " * depth + "or, if close", "", str(loop["operations"]), "instead", form])
            continue
        cells = [place, f"{loop['runs']:,}", str(loop["operations"]), _share(loop["per_point"])]
        rows.append([*cells, _values(loop)])
    counts = plan["operations"]
    rows.append(["in all", "", str(counts["straight"]), _share(counts["per_point"]), ""])
    return "\n".join(["Loops, from outside in", *map(_cut, table(rows, "lrrrl"))])


def _share(value: float) -> str:
    return f"{value:.3g}" if value >= 0.01 else "<0.01"


def _values(loop: Mapping[str, Any]) -> str:
    """The expensive operations of a loop, and its named values."""
    dear = [
        f"{count} {op}" for op, count in loop["kinds"].items() if op in ("sqrt", "div", "sin", "cos", "atan2")
    ]
    named = [name for name in loop["values"] if not name[1:].isdigit()]
    told = [", ".join(dear)] if dear else []
    return "; ".join(told + ([", ".join(named)] if named else []))


def _how(plan: Mapping[str, Any]) -> str:
    """The section on execution: threads, memory."""
    run = plan["run"]
    lines = ["Execution"]
    if run["way"] == "compiled":
        told = "in this process already" if run["cached"] == "memory" else "not compiled yet"
        threads = f"{run['threads']} threads" if run["threads"] > 1 else "one thread"
        lines.append(f"  kernel   compiled in float64, {threads}: {told}")
        lines.append(f"  points   {plan['points']:,}")
        numbers = [one["name"] for one in plan["inputs"] if one.get("value")]
        if numbers:
            while_roomy = " while AB + |ec| < 7/8 BC" if run["wide_margins"] else ""
            reused = f"other values of {', '.join(numbers)} (but 0) compile nothing new{while_roomy}"
            lines += _wrapped("reuse", [reused])
    else:
        lines.append("  kernel   none: a point is plain Python over math, nothing is compiled")
    if run["large_angles"]:
        lines.append("  angles   some are so large that sine and cosine are those of the C library (slower)")
    lines += [row for load in plan["loads"] for row in _wrapped("load", [_load(load)])]
    memory = plan["memory"]
    kept = f"  memory   {_bytes(memory['result'])} of results, {_bytes(memory['inputs'])} of inputs"
    if memory["grid"] != memory["result"]:
        kept += f"; the grid would take {_bytes(memory['grid'])}"
    lines.append(kept)
    lines.append(f"  results  {plan['results'] or 'returned, not written to a file'}")
    return "\n".join(lines)


def _load(load: Mapping[str, Any]) -> str:
    """The cost of a load."""
    times = f"{load['lookups']:,} time{'s' if load['lookups'] > 1 else ''}"
    return f"{load['name']} is looked up {times}, {load['where']}"


def _bytes(count: int) -> str:
    for unit, size in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if count >= size:
            return f"{count / size:.3g} {unit}"
    return f"{count} bytes"


def _also(plan: Mapping[str, Any]) -> str:
    rows = [[one["what"], f"{one['count']:,} {one['of']}", one["how"]] for one in plan["also"]]
    return "\n".join(["Also", *(_cut(line) for line in table(rows, "l"))])


def _sweep(plan: Mapping[str, Any]) -> str:
    """The store that the results are swept into."""
    one = plan["sweep"]
    shape = " x ".join(f"{length} {name}" for name, length in one["chunk"].items()) or "one point"
    rows = [
        f"  chunks   {one['chunks']:,} of {shape}, written to {one['store']}",
        f"  memory   {_bytes(one['memory'])} for the chunks in flight",
        f"  disk     at most {_bytes(one['disk'])}; {_bytes(one['free'])} are free",
    ]
    return "\n".join(["Store", *map(_cut, rows)])
