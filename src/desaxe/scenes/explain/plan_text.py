"""A plan as sections of texts and tables."""

from collections.abc import Iterator, Mapping
from typing import Any

from ...support.memory import size_text
from ...support.shown import printed, with_unit
from ..document.blocks import Block, Section, Text, TextTable, cell

DEAR = ("sqrt", "div", "sin", "cos", "atan2")  # operations that are counted by name


def plan_sections(plan: Mapping[str, Any]) -> Iterator[Section]:
    """The whole plan."""
    yield Section("Asked for", _asked(plan))
    if plan["loops"] is not None:
        if plan["skipped"]:
            yield Section("Skipped", [Text(_skipped(one)) for one in plan["skipped"]])
        yield Section("Operations at each point after each pass", [_passes(plan)])
        yield Section("Loops, from outside in", [_loops(plan)])
        yield Section("Execution", [Text(line) for line in _how(plan)])
    if plan["also"]:
        rows = [(one["what"], f"{one['count']:,} {one['of']}", one["how"]) for one in plan["also"]]
        yield Section("Also", [TextTable(("", "", ""), rows, is_cut=True)])
    if plan["sweep"] is not None:
        yield Section("Store", [Text(line) for line in _sweep(plan["sweep"])])


def _asked(plan: Mapping[str, Any]) -> list[Block]:
    """The requested names and the axes of the grid."""
    blocks: list[Block] = []
    if plan["outputs"]:
        rows = [(out["name"], printed(out["unit"]), out["meaning"]) for out in plan["outputs"]]
        each, taken = "and at every point its status; the margin once per design", plan["reduction"]
        if taken:
            each = f"of each over {taken['axis']}: {', '.join(taken['kinds'])}; the grid is not stored"
        blocks += [TextTable(("", "", ""), rows, is_cut=True), Text(each)]
    facts: dict[str, list[str]] = {
        "accuracy": [f"{plan['accuracy']}: {plan['promise']}"], "motion": [plan["motion"]],
        "axes": [], "loads": [], "fixed": [],
    }  # fmt: skip
    for one in plan["inputs"]:
        name, unit = one["name"], one["unit"]
        if "values" in one:
            facts["axes"].append(f"{name} ({one['values']}: {cell(one['from'])} to {cell(one['to'])} {unit})")
        elif "load" in one:
            facts["loads"].append(f"{name}: {one['load']}")
        else:
            facts["fixed"].append(with_unit(f"{name} = {cell(one['value'])}", unit))
    return [*blocks, *(Text(f"{name:8} {', '.join(parts)}") for name, parts in facts.items() if parts)]


def _skipped(one: Mapping[str, Any]) -> str:
    count = one["saved"]
    saved = f" ({count} operation{'s' if count > 1 else ''} a point)" if count > 0 else ""
    return f"{one['what']}: {one['why']}{saved}"


def _passes(plan: Mapping[str, Any]) -> TextTable:
    """Operations at each point after each pass, then what hoisting leaves."""
    steps = plan["steps"]
    rows = [(one["name"], str(one["operations"]), str(one["saved"] or ""), one["what"]) for one in steps]
    before, left = steps[-1]["operations"], plan["operations"]["per_point"]
    if plan["run"]["way"] == "compiled" and left < 0.995 * before:
        what = "operations that do not depend on an axis leave its loop"
        few, saved = (f"{n:.1f}" if n < 100 else f"{n:.0f}" for n in (left, before - left))
        rows.append(("hoist", few, saved, what))
    return TextTable(("pass", "operations", "saved", ""), rows, is_cut=True)


def _loops(plan: Mapping[str, Any]) -> TextTable:
    """Runs, operations, operations per point of each loop; its expensive operations and named values."""
    rows = []
    for loop in plan["loops"]:
        depth, operations = len(loop["along"]), str(loop["operations"])
        if loop["close"]:
            form = "instead, the stable form, where margins are narrow"
            rows.append(("  " * depth + "or, if close", "", operations, "", form))
            continue
        if loop["table"]:
            name = f"table over {' x '.join(loop['along'])}" if depth else "for the tables, once"
        else:
            name = "  " * max(0, depth - 1) + (f"for each {loop['along'][-1]}" if depth else "once")
        dear = ", ".join(f"{count} {op}" for op, count in loop["kinds"].items() if op in DEAR)
        values = ", ".join(value for value in loop["values"] if not value[1:].isdigit())
        about = "; ".join(filter(None, (dear, values)))
        rows.append((name, f"{loop['runs']:,}", operations, _share(loop["per_point"]), about))
    counts = plan["operations"]
    rows.append(("in all", "", str(counts["straight"]), _share(counts["per_point"]), ""))
    return TextTable(("", "runs", "operations", "per point", ""), rows, is_cut=True)


def _share(value: float) -> str:
    return f"{value:.3g}" if value >= 0.01 else "<0.01"


def _how(plan: Mapping[str, Any]) -> Iterator[str]:
    """Threads, what is compiled again, memory."""
    run, memory = plan["run"], plan["memory"]
    if run["way"] == "compiled":
        state = "in this process already" if run["cached"] == "memory" else "not compiled yet"
        threads = f"{run['threads']} threads" if run["threads"] > 1 else "one thread"
        yield f"kernel   compiled in float64, {threads}: {state}"
        yield f"points   {plan['points']:,}"
        numbers = ", ".join(one["name"] for one in plan["inputs"] if one.get("value"))
        limit = " while AB + |ec| < 7/8 BC" if run["wide_margins"] else ""
        yield from [f"reuse    other values of {numbers} (but 0) compile nothing new{limit}"] * bool(numbers)
    else:
        yield "kernel   none: a point is plain Python over math, nothing is compiled"
    if run["large_angles"]:
        yield "angles   some are so large that sine and cosine are those of the C library (slower)"
    for load in plan["loads"]:
        times = f"{load['lookups']:,} time{'s' if load['lookups'] > 1 else ''}"
        yield f"load     {load['name']} is looked up {times}, {load['where']}"
    grid = f"; the grid would take {size_text(memory['grid'])}" if memory["grid"] != memory["result"] else ""
    yield f"memory   {size_text(memory['result'])} of results, {size_text(memory['inputs'])} of inputs{grid}"
    yield f"results  {plan['results'] or 'returned, not written to a file'}"


def _sweep(one: Mapping[str, Any]) -> Iterator[str]:
    """The store that the results are swept into."""
    shape = " x ".join(f"{length} {name}" for name, length in one["chunk"].items()) or "one point"
    yield f"chunks   {one['chunks']:,} of {shape}, written to {one['store']}"
    yield f"memory   {size_text(one['memory'])} for the chunks in flight"
    yield f"disk     at most {size_text(one['disk'])}; {size_text(one['free'])} are free"
