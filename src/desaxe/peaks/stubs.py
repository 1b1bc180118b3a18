"""Stubs of the functions that `search` calls, for the cosine; each compiled module has its own instead."""

from math import cos, sin
from typing import Any

WORK = 1  # rows of what `sweep` keeps of each design


def sweep(count: Any, nodes: Any, block: Any, work: Any, value: Any, slope: Any) -> None:
    """The quantity and its derivative by theta at every node, for `count` designs."""
    for j in range(nodes.size):
        for i in range(count):
            value[j, i], slope[j, i] = cos(nodes[j]), -sin(nodes[j])


def points(rows: Any, count: Any, theta: Any, block: Any, value: Any, slope: Any) -> None:
    """The quantity and its derivative by theta, each at its own angle."""
    for j in range(rows):
        for i in range(count):
            value[j, i], slope[j, i] = cos(theta[j, i]), -sin(theta[j, i])


def finish(count: Any, theta: Any, block: Any, out: Any) -> None:
    """The quantity, its derivative by theta and its gradient."""
    for i in range(count):
        out[0, i], out[1, i] = cos(theta[i]), -sin(theta[i])
