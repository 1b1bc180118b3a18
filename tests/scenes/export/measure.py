"""The table of docs/languages.md: `python -m tests.scenes.export.measure`.

The worst error of each language as a share of what `standard` promises, over the points of `stress`.
"""

import math
import tempfile
from pathlib import Path

import desaxe as dx
from tests.compiler.languages.tools import array_values, es_module, imported, jax_in_doubles, library, octave
from tests.scenes.export.stress import INPUTS, NAMES, columns, scene, shares

REACH = 1.6e6  # rad, without libm


def c(folder, branch, libm):
    source = dx.compile(scene(branch), folder / "press", to="c", libm=libm) / "press.c"
    loaded = library(source, "gcc", ("-O2",), libm)
    reach = math.inf if libm else REACH
    return dict(zip(NAMES, array_values(loaded, "press", columns(branch, reach), len(NAMES)), strict=True))


def numba(folder, branch):
    """The scalar functions."""
    module = imported(dx.compile(scene(branch), folder / "press_numba.py"))
    points = [*zip(*columns(branch), strict=True)]
    return {name: [getattr(module, name)(*point) for point in points] for name in NAMES}


def of_octave(folder, branch):
    place = dx.compile(scene(branch), folder / "press.m", to="octave")
    return dict(zip(NAMES, octave(place, columns(branch), len(NAMES)), strict=True))


def jax(folder, branch):
    import jax as library_of_jax

    module = imported(dx.compile(scene(branch), folder / "press_jax.py", to="jax"))
    return library_of_jax.jit(module.evaluate)(**dict(zip(INPUTS, columns(branch), strict=True)))


def javascript(folder, branch):
    place = dx.compile(scene(branch), folder / "press.js", to="javascript")
    given = {name: column.tolist() for name, column in zip(INPUTS, columns(branch), strict=True)}
    return es_module(place, [["evaluate", given]])[0]


LANGUAGES = {
    "c": (lambda folder, branch: c(folder, branch, True), math.inf),
    "c, --no-libm": (lambda folder, branch: c(folder, branch, False), REACH),
    "octave": (of_octave, math.inf),
    "jax, under jit": (jax, math.inf),
    "numba, scalar functions": (numba, math.inf),
    "javascript": (javascript, math.inf),
}


def main():
    print("| language | generic | worst | hardest family |\n|---|---|---|---|")
    for name, (values, reach) in LANGUAGES.items():
        worst = {}
        for branch in (1, -1):
            with tempfile.TemporaryDirectory() as folder, jax_in_doubles():
                for family, share in shares(values(Path(folder), branch), branch, reach):
                    worst[family] = max(share, worst.get(family, 0.0))
        hardest = max(worst, key=worst.get)
        print(f"| {name} | {worst['generic']:.2g} | {worst[hardest]:.2g} | {hardest.replace('_', ' ')} |")


if __name__ == "__main__":
    main()
