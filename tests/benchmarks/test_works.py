"""The works: their shapes, and what the blocks of a broadcast make of them."""

import numpy as np
import pytest

from benchmarks.blocks import POINTS, block_size, filled, peaks
from benchmarks.rows import table
from benchmarks.work import BY_KEY, GRID, WORKS, swept


def test_the_grid_is_the_one_that_is_stated():
    assert BY_KEY["grid"].inputs(GRID).shape == (720, 32, 16, 16)


@pytest.mark.parametrize("work", WORKS, ids=lambda work: work.key)
def test_inputs_broadcast_to_the_shape(work):
    inputs = work.inputs(work.quick)
    assert np.broadcast_shapes(*(column.shape for column in inputs.broadcast().values())) == inputs.shape
    assert {*inputs.columns, *inputs.scalars} >= {"theta", "AB", "BC"} - (
        {"theta"} if work.kind == "peak" else set()
    )


@pytest.mark.thorough
@pytest.mark.parametrize("key", ["point", "sweeps", "grid", "peak"])
def test_blocks_see_every_point_once(key):
    inputs = BY_KEY[key].inputs(30_000)
    inputs = swept(inputs, theta_first=False) if key == "peak" else inputs

    def added(rows, result):
        result[0] = rows.sum(axis=0)

    (total,) = filled(inputs, added, [np.zeros(inputs.shape)])
    expected = sum(np.broadcast_to(column, inputs.shape) for column in inputs.broadcast().values())
    np.testing.assert_allclose(total, expected, rtol=1e-14)
    assert block_size(inputs) <= POINTS


def test_peaks_of_blocks_are_those_of_the_whole():
    inputs = swept(BY_KEY["peak"].inputs(100), theta_first=False)
    columns = inputs.broadcast()

    def wave(rows, result):
        ec, AB, _, theta = rows
        result[0] = AB * np.cos(theta) + ec

    values, angles = peaks(inputs, wave)
    dense = columns["AB"] * np.cos(columns["theta"]) + columns["ec"]
    np.testing.assert_array_equal(values, np.abs(dense).max(axis=1))
    np.testing.assert_array_equal(angles, columns["theta"][np.abs(dense).argmax(axis=1)])


@pytest.mark.parametrize(
    ("name", "bound"),
    [
        pytest.param("peaks", 1e-4, marks=pytest.mark.thorough),  # the best of 720 angles
        pytest.param("derivatives", 1e-12, marks=pytest.mark.thorough),
        ("motors", 1e-12),
        ("rubbing", 1e-12),
        ("generated-forces-points", 1e-12),
        pytest.param("motions", 1e-7, marks=pytest.mark.thorough),
        pytest.param("steady", 1e-9, marks=pytest.mark.thorough),
    ],
)
def test_all_ways_of_a_row_have_the_same_values(name, bound):
    first, *rest = (line.split(" | ") for line in table(name, 1).splitlines()[4:])
    assert first[2:] == ["1", "0.0e+00 |"]
    assert rest
    for cells in rest:
        assert float(cells[3].rstrip(" |")) <= bound, cells
