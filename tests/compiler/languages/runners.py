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
        return lambda given, tables: module.evaluate(*given.values(), *flat(tables))
    return lambda given, tables: {
        name: [getattr(module, name)(*point) for point in zip(*given.values(), strict=True)]
        for name in outputs
    }


def by_c(place, outputs):
    """`name_array`, as gcc compiles it without fused products."""
    loaded = library(place, "gcc", ("-O2", "-ffp-contract=off"))

    def call(given, tables):
        size = next(iter(given.values())).size
        found = [np.full(size, 7.0) for _ in outputs]
        columns = [(POINTER * len(group))(*map(pointer, group)) for group in (given.values(), found)]
        getattr(loaded, f"{place.stem}_array")(ctypes.c_size_t(size), *columns, *in_c(tables))
        return dict(zip(outputs, found, strict=True))

    return call


def by_octave(place, outputs):
    """The function, called once."""

    def call(given, tables):
        found = octave(place, [*given.values(), *flat(tables)], len(outputs))
        return dict(zip(outputs, found, strict=True))

    return call


def by_jax(place, outputs):
    """`evaluate` in doubles."""

    def call(given, tables):
        with jax_in_doubles():
            found = imported(place).evaluate(**given)
            return {name: np.asarray(value) for name, value in found.items()}

    return call


def by_javascript(place, outputs):
    """`evaluate` of arrays, by node."""

    def call(given, tables):
        named = {f"{n}_{end}": each for n in tables for end, each in zip("xc", tables[n], strict=True)}
        lists = {name: np.asarray(column).tolist() for name, column in (given | named).items()}
        return es_module(place, [["evaluate", lists]])[0]

    return call


RUNNERS = {"numba": by_numba, "c": by_c, "octave": by_octave, "jax": by_jax, "javascript": by_javascript}
SLOW = ("numba", "jax")  # some seconds of compiling each


def flat(tables):
    """The arrays of tables in order, as most languages take them."""
    return [np.array(column, float) for table in tables.values() for column in table]


def in_c(tables):
    """Pointers to the knots and coefficients of tables, and how many knots there are."""
    found = []
    for table in tables.values():
        for array in (np.array(column, float) for column in table):
            found.append(pointer(array))
            found[-1].kept = array  # a pointer alone keeps no array
        found.append(ctypes.c_int64(len(table[0])))
    return found


def caller(language, place, inputs, outputs):
    """A file that a language wrote, as a function of columns, and of tables that are arguments.

    tables  name -> knots and coefficients
    """
    run = RUNNERS[language](place, list(outputs))

    def call(columns, tables=None):
        found = run(dict(zip(inputs, columns, strict=True)), tables or {})
        return {name: np.asarray(found[name], float) for name in outputs}

    return call


def compiled(language, folder, scene, inputs, name="press", **options):
    """The module of a scene, as such a function."""
    place = folder / f"{name}_{language}{language_of(language).suffix}"
    dx.compile(scene, place, to=language, **options)
    return caller(language, place, inputs, scene["outputs"])
