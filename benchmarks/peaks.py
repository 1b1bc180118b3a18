"""`python -m benchmarks.peaks`: refined peaks of a_C beside a dense grid of the textbook formula.

8,192 designs, in one process and in turns. NumPy evaluates the textbook formula (SymPy's
`lambdify` with common subexpressions) at 720 angles a design, in the blocks of designs that serve it
best, and takes the largest magnitude: no angle in between, no gradient. `dx.peak` has the refined value, its
angle, its exact gradient and status.
"""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

import desaxe as dx

from .formulas import lambdified
from .rig import in_turns
from .work import Inputs

DESIGNS, ANGLES, SPEED = 8_192, 720, 157.08
BLOCKS = (16, 32, 64, DESIGNS)  # designs at a time: what fits in the caches is best, all at once is plain


def main() -> None:
    """Print times per design and their ratios."""
    designs = random_designs(DESIGNS)
    contenders: dict[str, Callable[[], Any]] = {
        f"NumPy, {block} designs at a time": grid_of(designs, block) for block in BLOCKS
    }
    for threads in (1, 2):
        contenders[f"dx.peak, threads={threads}"] = partial(
            dx.peak, "a_C", **designs, omega0=SPEED, threads=threads
        )
    best = in_turns(contenders, rounds=7)
    ours = best["dx.peak, threads=1"]
    print(f"largest |a_C| of {DESIGNS} designs, in turns\n\n| | ns a design | ratio |\n|---|---|---|")
    for name, seconds in best.items():
        print(f"| {name} | {seconds / DESIGNS * 1e9:.0f} | {seconds / ours:.1f} |")
    one = {name: float(column[0]) for name, column in designs.items()}
    alone = in_turns({"one": lambda: dx.peak("a_C", **one, omega0=SPEED)}, rounds=200)["one"]
    print(f"\none design in a call: {alone * 1e6:.0f} us")


def random_designs(count: int) -> dict[str, Any]:
    """Designs that turn fully."""
    rng = np.random.default_rng(0)
    ranges = {"ec": (0.0, 0.1), "AB": (0.1, 0.13), "BC": (0.3, 0.4)}
    return {name: rng.uniform(*ends, count) for name, ends in ranges.items()}


def grid_of(designs: Mapping[str, Any], block: int) -> Callable[[], Any]:
    """The dense grid, some designs at a time."""
    theta = np.linspace(0.0, 2.0 * np.pi, ANGLES)
    columns = {"theta": theta, **designs}
    function = lambdified(("a_C",), Inputs(columns, dict.fromkeys(columns, 0), {"omega0": SPEED}), "numpy")

    def run() -> Any:
        found = np.empty(DESIGNS)
        for start in range(0, DESIGNS, block):
            part = [column[start : start + block, None] for column in designs.values()]
            (values,) = function(theta, *part)
            found[start : start + block] = np.abs(values).max(axis=1)
        return found

    return run


if __name__ == "__main__":
    main()
