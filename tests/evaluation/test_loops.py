"""A broadcast as a nest of loops: the same numbers as one loop over all points, and which nest it is."""

import math

import numpy as np
import pytest

import desaxe as dx
from desaxe.evaluation import arrays as _axes
from desaxe.evaluation.arrays import INNERMOST, loops_over

NAMES = ["V_C", "a_C", "a_C_wrt_ec", "status"]


def values(name, *shape):
    low, high = {"theta": (-7, 7), "ec": (-0.3, 0.3), "AB": (0.1, 0.2), "BC": (0.2, 0.5), "omega0": (1, 9)}[
        name
    ]
    return np.random.default_rng(len(shape) + ord(name[0])).uniform(low, high, shape)


PATTERNS = {  # shapes of the inputs, and the sizes of the loops
    "designs by angles": ({"ec": (9, 1), "AB": (9, 1), "BC": (9, 1), "theta": (70,)}, (9, 70)),
    "angles by designs": ({"theta": (9, 1), "ec": (70,), "AB": (70,)}, (9, 70)),
    "three axes": ({"ec": (4, 1, 1), "BC": (5, 1), "theta": (70,)}, (4, 5, 70)),
    "designs in a table": ({"ec": (4, 5, 1), "AB": (4, 5, 1), "theta": (70,)}, (20, 70)),
    "axes of length one": ({"ec": (1, 9, 1, 1), "theta": (1, 1, 1, 70), "BC": (1, 1)}, (9, 70)),
}


@pytest.mark.thorough
@pytest.mark.parametrize("pattern", PATTERNS)
def test_a_nest_has_the_values_of_one_loop(pattern, monkeypatch):
    shapes, nest = PATTERNS[pattern]
    inputs = {"ec": 0.01, "AB": 0.15, "BC": 0.4, "omega0": 3.0}
    inputs |= {name: values(name, *shape) for name, shape in shapes.items()}
    flat = dx.evaluate(NAMES, **inputs)
    monkeypatch.setattr(_axes, "NESTED", 0)
    arrays = {name: value for name, value in inputs.items() if np.size(value) > 1}
    shape = np.broadcast_shapes(*(value.shape for value in arrays.values()))
    assert loops_over(arrays, shape)[0] == nest
    nested = dx.evaluate(NAMES, **inputs)
    for name in NAMES:
        assert nested[name].shape == shape
        assert np.array_equal(nested[name], flat[name], equal_nan=True)
    assert len(set(flat["status"].reshape(-1).tolist())) > 1 or pattern != "designs by angles"


def test_a_nest_fills_memory_of_the_caller_and_knows_undecided_points(monkeypatch):
    """Angles next to the last one that each mechanism reaches, on both sides of it."""
    ec = np.linspace(0.21, 0.25, 5)
    last = np.arcsin((0.35 - ec) / 0.15)
    theta = np.sort(
        np.concatenate([[a, math.nextafter(a, 0), math.nextafter(a, 9)] for a in last for _ in range(5)])
    )
    inputs = {"ec": ec[:, None], "theta": theta, "AB": 0.15, "BC": 0.35}
    flat = dx.evaluate("status", **inputs)
    monkeypatch.setattr(_axes, "NESTED", 0)
    out = np.full((5, theta.size), 9, np.int8)
    assert dx.evaluate("status", **inputs, out=out) is out
    assert np.array_equal(out, flat)
    assert {0, 1} <= set(out.reshape(-1).tolist())


@pytest.mark.parametrize(
    "shapes",
    [
        {"theta": (9, 70), "ec": (70,)},  # theta varies along both
        {"theta": (9, 1), "ec": (INNERMOST - 1,)},  # too short to be a loop of its own
        {"theta": (630,), "ec": (630,)},
    ],
)
def test_what_is_no_nest_is_one_loop(shapes, monkeypatch):
    monkeypatch.setattr(_axes, "NESTED", 0)
    arrays = {name: values(name, *shape) for name, shape in shapes.items()}
    shape = np.broadcast_shapes(*shapes.values())
    sizes, columns, _ = loops_over(arrays, shape)
    assert sizes == (math.prod(shape),)
    for name, column in columns.items():
        assert np.array_equal(column.reshape(shape), np.broadcast_to(arrays[name], shape))


def test_few_points_are_one_loop():
    arrays = {"theta": values("theta", 70), "ec": values("ec", 9, 1)}
    assert loops_over(arrays, (9, 70))[0] == (630,)
