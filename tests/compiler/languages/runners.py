"""One runner for each language: a written module as a function of columns that gives name -> array.

The table of languages of all tests: a row here, and they try a new one, too.
"""

import ctypes

import numpy as np

import desaxe as dx
from desaxe.compiler.languages import language_of
from tests.compiler.languages.tools import (
    POINTER,
    es_module,
    imported,
    jax_in_doubles,
    library,
    octave,
    pointer,
)


def by_numba(place, outputs):
    """Arrays where a scene was written, else the functions of one output each."""
    module = imported(place)
    if hasattr(module, "evaluate"):
        return lambda given: module.evaluate(*given.values())
    return lambda given: {
        name: [getattr(module, name)(*point) for point in zip(*given.values(), strict=True)]
        for name in outputs
    }


def by_c(place, outputs):
    """`name_array`, as gcc compiles it without fused products."""
    loaded = library(place, "gcc", ("-O2", "-ffp-contract=off"))

    def call(given):
        size = next(iter(given.values())).size
        result = [np.full(size, 7.0) for _ in outputs]
        columns = [(POINTER * len(group))(*map(pointer, group)) for group in (given.values(), result)]
        getattr(loaded, f"{place.stem}_array")(ctypes.c_size_t(size), *columns)
        return dict(zip(outputs, result, strict=True))

    return call


def by_octave(place, outputs):
    """The function, called once."""

    def call(given):
        result = octave(place, [*given.values()], len(outputs))
        return dict(zip(outputs, result, strict=True))

    return call


def by_jax(place, outputs):
    """`evaluate` in doubles."""

    def call(given):
        with jax_in_doubles():
            result = imported(place).evaluate(**given)
            return {name: np.asarray(value) for name, value in result.items()}

    return call


def by_javascript(place, outputs):
    """`evaluate` of arrays, by node."""

    def call(given):
        lists = {name: np.asarray(column).tolist() for name, column in given.items()}
        return es_module(place, [["evaluate", lists]])[0]

    return call


RUNNERS = {"numba": by_numba, "c": by_c, "octave": by_octave, "jax": by_jax, "javascript": by_javascript}
SLOW = ("numba", "jax")  # some seconds of compiling each


def caller(language, place, inputs, outputs):
    """A file that a language wrote, as a function of columns."""
    run = RUNNERS[language](place, list(outputs))

    def call(columns):
        result = run(dict(zip(inputs, columns, strict=True)))
        return {name: np.asarray(result[name], float) for name in outputs}

    return call


def compiled(language, folder, scene, inputs, name="press", **options):
    """The module of a scene, as such a function."""
    place = folder / f"{name}_{language}{language_of(language).suffix}"
    dx.compile(scene, place, to=language, **options)
    return caller(language, place, inputs, scene["outputs"])
