"""Comparisons of answers of arrays."""

import math

import numpy as np

import desaxe as dx

SIZES = {"AB": 0.125, "BC": 0.35, "omega0": 157.0}
POINT = {"theta": 1.1, "ec": 0.01, **SIZES}
EPSILON = 2.0**-52


def columns(*shape):
    """Angles and eccentricities of a shape."""
    count = math.prod(shape)
    theta = np.linspace(-4, 7, count).reshape(shape)
    return theta, np.linspace(-0.05, 0.1, count).reshape(shape)


def one_by_one(name, theta, ec):
    """The values of a quantity, one number at a time, in the broadcast shape."""
    theta, ec = np.broadcast_arrays(theta, ec)
    out = np.empty(theta.shape)
    for index in np.ndindex(theta.shape):
        out[index] = dx.evaluate(name, theta=float(theta[index]), ec=float(ec[index]), **SIZES)
    return out


def close(result, expected):
    """To 4 ulp of the largest value: a kernel's sine may differ from the C library's by one."""
    scale = np.nanmax(np.abs(expected), initial=0.0)
    return np.allclose(result, expected, rtol=0, atol=4 * EPSILON * scale, equal_nan=True)


def bits(dataset):
    """The bytes of all values; a NaN has no digits, and processors choose its sign."""
    return {n: np.where(np.isnan(a.values), np.nan, a.values).tobytes() for n, a in dataset.variables.items()}
