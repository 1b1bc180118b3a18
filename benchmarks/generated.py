"""`python -m benchmarks --only generated`: the modules of `desaxe.generated` beside the library.

One core, one process, each call with memory for its answer. A module computes all of its results, so the
library is asked for all of them.
"""

from collections.abc import Iterator
from importlib import import_module
from typing import Any

import numpy as np

import desaxe as dx

from .rig import in_turns
from .work import BY_KEY, OMEGA0

GROUPS = ("motion", "sensitivities", "forces")
MASSES = {"m_crank": 1.0, "m_rod": 1.0, "m_slider": 2.0, "I_crank": 0.01, "I_rod": 0.01, "mu": 0.1}
ROUNDS = 60
WORKS = {
    "10,000 points": ("point", 10_000),
    "100,000 points": ("point", 100_000),
    "mixed designs": ("fifths", 100_000),
}


def table() -> str:
    """The time of each module as a multiple of the library's."""
    lines = [f"| module | {' | '.join([*WORKS, 'grid'])} |", "|---" * (len(WORKS) + 2) + "|"]
    for group in GROUPS:
        module = import_module(f"desaxe.generated.{group}")
        more = MASSES if group == "forces" else {}
        lines.append(f"| {group} | {' | '.join(f'{ratio:.2f}' for ratio in _ratios(module, more))} |")
    return "\n".join(lines)


def _ratios(module: Any, more: dict[str, float]) -> Iterator[float]:
    for key, count in WORKS.values():
        inputs = BY_KEY[key].inputs(count)
        yield _ratio(
            module.evaluate, dx.evaluate, module, {**inputs.broadcast(), **inputs.scalars, **more}, (count,)
        )
    angles, offsets = np.linspace(0.0, 2.0 * np.pi, 721), np.linspace(0.0, 0.05, 400)
    axes = {"theta": angles, "ec": offsets, "AB": 0.125, "BC": 0.35, "omega0": OMEGA0}
    yield _ratio(module.grid, dx.grid, module, {**axes, **more}, (angles.size, offsets.size))


def _ratio(theirs: Any, ours: Any, module: Any, inputs: dict[str, Any], shape: tuple[int, ...]) -> float:
    names = list(module.OUTPUTS)
    out = {name: np.empty(shape, kind) for name, kind in module.OUTPUTS.items()}
    best = in_turns(
        {
            "module": lambda: theirs(**inputs, out=out),
            "library": lambda: ours(names, **inputs, threads=1, out=out),
        },
        ROUNDS,
    )
    return best["module"] / best["library"]
