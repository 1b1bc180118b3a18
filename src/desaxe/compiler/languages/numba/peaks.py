"""The loops of a search over one input, from Programs; lines that depend on the design alone run once."""

from collections.abc import Sequence

from ...builder import function_text
from ...cost import cost_of
from ...passes.slicing import drop_unused, keep_outputs
from ...program import Line, Program, names_in
from ...text import INDENT, with_short_temporaries, write_lines
from .module import NJIT

SWEEP = "count, nodes, block, tables, work, value, slope"
COUNTED = "range(uint64(count))"
READ = 2.0  # what reading a value costs, in additions


class Rows:
    """Reads designs; `searched` is the searched input."""

    def __init__(self, inputs: Sequence[str], searched: str) -> None:
        self.inputs, self.searched = tuple(inputs), searched

    def views(self, program: Program) -> list[str]:
        """A name for the row of each input."""
        return [f"{n}_row = block[{self.inputs.index(n)}]" for n in self._own(program)]

    def loop(self, program: Program, along: str, stores: Sequence[str]) -> list[str]:
        """A loop over `count` designs, each at its own value of the searched input."""
        body = [f"{self.searched} = {along}", *self.reads(program), *lines_of(program), *stores]
        return [f"for i in {COUNTED}:", *_in(body)]

    def reads(self, program: Program) -> list[str]:
        """The inputs of design i."""
        return [f"{n} = {n}_row[i]" for n in self._own(program)]

    def function(self, name: str, parameters: str, body: Sequence[str]) -> str:
        """The text of a function."""
        return NJIT + function_text(name, [parameters], body)

    def _own(self, program: Program) -> list[str]:
        return [n for n in program.inputs if n in self.inputs]


def sweep_function(program: Program, rows: Rows) -> tuple[str, int]:
    """`sweep(count, nodes, block, tables, work, value, slope)`, and how many rows of `work` it needs.

    Precondition: two outputs. Lines that depend on no design run once a node, lines that do not depend
    on the searched input once a design where keeping them pays.
    """
    program = with_short_temporaries(program)
    kept, rest = _split(program, rows.searched)
    shared = _without(rest, set(rows.inputs) | set(kept.outputs))
    inner = drop_unused(
        rest._replace(
            inputs=(*rest.inputs, *shared.outputs),
            lines=tuple(line for line in rest.lines if line.name not in shared.outputs),
        )
    )
    numbered = list(enumerate(kept.outputs))
    body = [*rows.views(program), *(f"{n}_kept = work[{k}]" for k, n in numbered)]
    if numbered:
        body += [f"for i in {COUNTED}:"]
        body += _in([*rows.reads(kept), *lines_of(kept), *(f"{n}_kept[i] = {n}" for _, n in numbered)])
    node = [f"{rows.searched} = " + "nodes[j]", *lines_of(shared)]
    node += ["value_row = value[j]", "slope_row = slope[j]", f"for i in {COUNTED}:"]
    every = [*rows.reads(inner), *(f"{n} = {n}_kept[i]" for _, n in numbered)]
    every += lines_of(inner)
    every += [f"value_row[i] = {program.outputs[0]}", f"slope_row[i] = {program.outputs[1]}"]
    body += ["for j in range(nodes.size):", *_in([*node, *_in(every)])]
    return rows.function("sweep", SWEEP, body), len(numbered)


def points_function(program: Program, rows: Rows) -> str:
    """`points(rows, count, theta, block, tables, value, slope)`."""
    program = with_short_temporaries(program)
    names = ("value", "slope")
    stores = [f"{n}_row[i] = {o}" for n, o in zip(names, program.outputs, strict=True)]
    loop = rows.loop(program, "theta_row[i]", stores)
    body = [*rows.views(program), "for j in range(rows):"]
    body += _in(["theta_row = thetas[j]", *(f"{n}_row = {n}[j]" for n in names), *loop])
    return rows.function("points", "rows, count, thetas, block, tables, value, slope", body)


def finish_function(program: Program, rows: Rows) -> str:
    """`finish(count, theta, block, tables, out)`."""
    program = with_short_temporaries(program)
    places = list(enumerate(program.outputs))
    loop = rows.loop(program, "thetas[i]", [f"out_{k}[i] = {name}" for k, name in places])
    body = [*rows.views(program), *(f"out_{k} = out[{k}]" for k, _ in places), *loop]
    return rows.function("finish", "count, thetas, block, tables, out", body)


def _split(program: Program, fast: str) -> tuple[Program, Program]:
    """Split a program: the costly part that is independent of the input `fast`, and the rest."""
    worth = [
        line.name
        for line in _independent(program, {fast})
        if line.type == "f64" and cost_of(keep_outputs(program, (line.name,))).throughput > READ
    ]
    kept = keep_outputs(program, worth)
    lines = tuple(line for line in program.lines if line.name not in worth)
    return kept, drop_unused(program._replace(inputs=(*program.inputs, *worth), lines=lines))


def _without(program: Program, inputs: set[str]) -> Program:
    """The lines that depend on none of these inputs, as a program of what the others use of them."""
    return keep_outputs(program, tuple(line.name for line in _independent(program, inputs)))


def _independent(program: Program, inputs: set[str]) -> list[Line]:
    """The lines that depend on none of these inputs, and that the others or the result use."""
    dependent, used = set(inputs), set(program.outputs)
    for line in program.lines:
        if dependent & set(names_in(line.args)):
            dependent.add(line.name)
            used |= set(names_in(line.args))
    return [line for line in program.lines if line.name in used - dependent]


def lines_of(program: Program) -> list[str]:
    """The assignments."""
    return write_lines(program, "numba")


def _in(lines: Sequence[str]) -> list[str]:
    return [INDENT + line for line in lines]
