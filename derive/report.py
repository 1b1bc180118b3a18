"""`python -m derive --report`: what each pass saved, per quantity."""

from desaxe.compiler.cost import cost_of
from desaxe.compiler.passes.pipeline import PASSES, optimise
from desaxe.compiler.passes.slicing import keep_outputs

from .build import Derivation
from .quantities import QUANTITIES


def report(derivation: Derivation) -> str:
    """Operations of each quantity: in the whole program, sliced, after each pass, then specialised."""
    whole = cost_of(derivation.program)
    head = f"the whole program: {whole.operations} operations, depth {whole.depth}\n"
    rows: list[list[object]] = []
    for name in QUANTITIES:
        sliced = keep_outputs(derivation.program, (name,))
        general, steps = optimise(sliced)
        with_all = tuple(n for n in derivation.names if n == name or n.startswith(f"{name}_wrt_"))
        family, _ = optimise(keep_outputs(derivation.program, with_all))
        concentric, _ = optimise(sliced, {"ec": 0.0, "alpha": 0.0, "branch": 1.0})
        counts = [step.cost.operations for step in steps]
        rows.append([name, *counts, cost_of(general).depth, len(family.lines), len(concentric.lines)])
    titles = [
        "quantity",
        "sliced",
        *(step.name for step in PASSES),
        "depth",
        "with all its sensitivities",
        "ec=0, alpha=0, branch=1",
    ]
    return head + _table(titles, rows)


def _table(titles: list[str], rows: list[list[object]]) -> str:
    texts = [titles, *([str(cell) for cell in row] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*texts, strict=True)]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in texts
    )
