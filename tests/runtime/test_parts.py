"""Our target of numba: numbers of arrays, variables of two types, types of calls."""

import numpy as np
from numba import types

from desaxe.runtime.native.compiled_text import compile_text
from desaxe.runtime.native.modules import Native, _ready

TEXT = """
from math import floor
from numba import njit, types
from numpy import empty, int64, uint64

@njit(error_model="numpy")
def fill(a, i, b, c):
    row, made = a[1], empty((2, 3))
    made[1, -1] = row[-1, 0]
    x = 2
    x = x + 0.5  # of another type now
    k = uint64(1)
    b[0], b[i], b[k] = x, row[i, 2], made[k, 2] + a[0, k, 1] + c[-1, 2]
    b[(3,)] = a[-1, i][(0,)] + floor(x) + made.shape[1]
    return int64(x > 2.0)

def function(a, i, b, c):
    return fill(a, i, b, c)

signature = types.int64(
    types.float64[:, :, :], types.int64, types.int8[:], types.Array(types.int64, 2, "F")
)
"""


def test_numbers_of_arrays_are_those_of_numpy():
    """From the end, by whole numbers without a sign, by one in a tuple, in any layout, of any type."""
    before = types.BaseFunction.get_call_type
    function = Native(_ready(compile_text(TEXT, "a test", {})))
    assert types.BaseFunction.get_call_type is before
    a = np.arange(120.0).reshape(4, 5, 6)[::-1, ::2, ::2]
    b, c = np.zeros(8, np.int8)[::2], np.arange(6).reshape(2, 3, order="F")
    assert function(a, -2, b, c) == 1
    expected = [2, a[1, -1, 0] + a[0, 1, 1] + c[-1, 2], a[1, -2, 2], a[-1, -2, 0] + 2 + 3]
    assert b.tolist() == np.array(expected).astype(np.int8).tolist()
