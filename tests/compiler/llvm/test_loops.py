"""Loops in Python as machine code: the bits of Python's own results, and vectors where arrays are apart."""

from __future__ import annotations

import re
from math import atan2, copysign, cos, floor, inf, isfinite, nan, sin, sqrt

import numpy as np
import pytest
from numpy import empty, int64, nextafter, zeros

from desaxe.compiler.helpers import mul_add
from desaxe.compiler.llvm import machine
from desaxe.compiler.llvm.loops import CompiledLoops, apart
from desaxe.simulation.loops import law, newton

WEIGHT, FIRST = 0.3, int64(2)


def mathematics(x, out):
    for k in range(len(x)):
        a = x[k]
        out[k] = sin(a) + cos(a) * sqrt(abs(a)) + copysign(atan2(a, 2.0), -a) ** 2.0 + nextafter(a, inf)
        out[k] += min(a, 0.5, WEIGHT) - max(a, -0.5) + floor(3.0 * a) / 7.0
        out[k] -= nan if not isfinite(a) else 0.0


def flow(x, out):
    count, total, k = 0, 0.0, 0
    while True:
        k += 1
        if k >= len(x):
            break
        if x[k] < 0.0 or (k > 3 and not x[k] > x[0]):
            continue
        count += 1
        for j in range(k, 0, -2):
            if j == 4:
                break
            total += x[j] if j > 1 else -1
    out[:] = total
    out[0], out[-1] = count, int64(total) * FIRST
    return count if total > 0.0 else -1


def pair(x, first):
    if first > 2:
        return x, x[0]
    return x, -1.0


def arrays(x, out):
    table, sums, whole = empty((2, 5)), zeros(3), x[2 : len(x) - 1]
    for k in range(5):
        table[0, k], table[1, k] = x[k], k
    for k in range(3):
        sums[k] = table[0 if k < 3 else 1, k] + table[-1, 2] if k > 1 else whole[k]
    row, first = pair(table[1], 3 if x[0] > 0.0 else 2)
    out[1:] = first
    out[0] = sums[0] + 10.0 * sums[2] + len(whole) + row.shape[0]
    return len(out[1:])


def contracted(x, out):
    apart()
    for k in range(len(x)):
        out[k] = mul_add(x[k], 2.0, 1.0) + 0.1 * x[k]


def unknown(x, out):
    out[0] = sum([2.0 * number for number in x])


def outside(x, out):
    out[0] = there(x[0])  # noqa: F821


@pytest.mark.parametrize("function", [mathematics, flow, arrays, contracted])
def test_bits_of_python(function):
    rng = np.random.default_rng(3)
    compiled = CompiledLoops(function, ("f64[1]", "f64[1]"))
    for size in (5, 17, 64):
        x = rng.normal(size=size) * 10.0 ** rng.integers(-3, 3, size)
        python, machine_code = np.zeros(size), np.zeros(size)
        assert compiled(x, machine_code) == (function(x, python) or 0)
        assert machine_code.tobytes() == python.tobytes()


@pytest.mark.parametrize(
    ("function", "message"),
    [(unknown, "unknown, line 2: sum.* cannot be compiled"), (outside, "outside: there is not known")],
)
def test_other_python_is_refused(function, message):
    with pytest.raises(TypeError, match=message):
        CompiledLoops(function, ("f64[1]", "f64[1]"))


def test_arrays_are_contiguous():
    compiled = CompiledLoops(contracted, ("f64[1]", "f64[1]"))
    with pytest.raises(ValueError, match="contiguous"):
        compiled(np.zeros((3, 2))[:, 0], np.zeros(3))


@pytest.mark.parametrize(
    ("function", "kinds", "operations"),
    [
        (newton.subtract, ("f64[1]", "f64", "f64[1]", "i64"), {"fmul", "fsub"}),
        (law.fill_rates, ("f64[1]", "f64[2]"), {"fdiv", "sqrt"}),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_short_loops_run_in_vectors(function, kinds, operations, monkeypatch):
    texts = []
    own = machine._optimise
    monkeypatch.setattr(machine, "_optimise", lambda m, t: own(m, t) or texts.append(str(m)))
    CompiledLoops(function, kinds)
    result = re.findall(r"= (f\w+) (?:[a-z]+ )*<\d+ x double>", texts[0])
    result += re.findall(r"call (?:[a-z]+ )*<\d+ x double> @llvm\.(\w+)\.v", texts[0])
    assert operations <= set(result)
