"""`python -m derive --report`: what each pass saved, per quantity."""

from desaxe.compiler.cost import cost_of
from desaxe.compiler.passes.pipeline import optimise
from desaxe.compiler.passes.slicing import keep_outputs

from .build import Derivation
from .quantities import QUANTITIES


def report(derivation: Derivation) -> str:
    """Operations of each quantity: in the whole program, sliced, after each pass, then specialised."""
    whole = cost_of(derivation.program)
    head = f"the whole program: {whole.operations} operations, depth {whole.depth}\n"
    rows = []
    for name in QUANTITIES:
        sliced = keep_outputs(derivation.program, (name,))
        general, steps = optimise(sliced)
        with_all = tuple(n for n in derivation.names if n == name or n.startswith(f"{name}_wrt_"))
        family, _ = optimise(keep_outputs(derivation.program, with_all))
        concentric, _ = optimise(sliced, {"ec": 0.0, "alpha": 0.0, "branch": 1.0})
        counts = [step.cost.operations for step in steps]
        rows.append([name, *counts, cost_of(general).depth, len(family.lines), len(concentric.lines)])
    passes = [step.name for step in steps]
    titles = ["quantity", *passes, "depth", "with all its sensitivities", "ec=0, alpha=0, branch=1"]
    return head + _table(titles, rows)


def _table(titles: list[str], rows: list[list[object]]) -> str:
    widths = [max(len(str(row[i])) for row in (titles, *rows)) for i in range(len(titles))]
    lines = ["  ".join(str(cell).ljust(width) for cell, width in zip(row, widths, strict=True)) for row in rows]
    return "\n".join(["  ".join(t.ljust(w) for t, w in zip(titles, widths, strict=True)), *lines])
