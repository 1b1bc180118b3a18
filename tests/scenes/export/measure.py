"""The table of docs/languages.md: `python -m tests.scenes.export.measure`.

The worst error of each language as a share of what `standard` promises, over the points of `stress`.
"""

import tempfile
from pathlib import Path

import desaxe as dx
from tests.compiler.languages.runners import compiled
from tests.compiler.languages.tools import imported, jax_in_doubles
from tests.scenes.export.stress import INPUTS, NAMES, columns, scene, shares


def arrays(language):
    """The values of a language's arrays."""

    def values(folder, branch):
        return compiled(language, folder, scene(branch), INPUTS)(columns(branch))

    return values


def numba(folder, branch):
    """The scalar functions."""
    module = imported(dx.compile(scene(branch), folder / "press_numba.py"))
    points = [*zip(*columns(branch), strict=True)]
    return {name: [getattr(module, name)(*point) for point in points] for name in NAMES}


def jax(folder, branch):
    import jax as library_of_jax

    module = imported(dx.compile(scene(branch), folder / "press_jax.py", to="jax"))
    return library_of_jax.jit(module.evaluate)(**dict(zip(INPUTS, columns(branch), strict=True)))


LANGUAGES = {
    "c": arrays("c"),
    "octave": arrays("octave"),
    "jax, under jit": jax,
    "numba, scalar functions": numba,
    "javascript": arrays("javascript"),
}


def main():
    print("| language | generic | worst | hardest family |\n|---|---|---|---|")
    for name, values in LANGUAGES.items():
        worst = {}
        for branch in (1, -1):
            with tempfile.TemporaryDirectory() as folder, jax_in_doubles():
                for family, share in shares(values(Path(folder), branch), branch):
                    worst[family] = max(share, worst.get(family, 0.0))
        hardest = max(worst, key=worst.get)
        print(f"| {name} | {worst['generic']:.2g} | {worst[hardest]:.2g} | {hardest.replace('_', ' ')} |")


if __name__ == "__main__":
    main()
