"""Blocks for those who want every input as a column of its own: each block is written out, then computed.

A block is as large as suits heyoka best: it costs a call, and its columns should stay in the caches.
"""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from .work import Array, Inputs, largest

POINTS = 131_072
Answer = Callable[[Array, Array], None]  # rows of inputs, rows for outputs


def rows_at_once(inputs: Inputs) -> int:
    """The number of steps of the first axis in a block."""
    return max(1, min(inputs.shape[0], POINTS // max(1, int(np.prod(inputs.shape[1:])))))


def block_size(inputs: Inputs) -> int:
    """Points of a block."""
    return rows_at_once(inputs) * int(np.prod(inputs.shape[1:]))


def in_blocks(inputs: Inputs, answer: Answer, outputs: int) -> Iterator[tuple[slice, Array]]:
    """For each block its slice of the first axis, and the results in the block's shape.

    What does not depend on the first axis is written once.
    """
    step, later, broadcast = rows_at_once(inputs), inputs.shape[1:], inputs.broadcast()
    rows, result = np.empty((len(broadcast), block_size(inputs))), np.empty((outputs, block_size(inputs)))
    for start in range(0, inputs.shape[0], step):
        part = slice(start, min(start + step, inputs.shape[0]))
        for name, row in zip(broadcast, rows, strict=True):
            if inputs.axis[name] == 0:
                steps = part.stop - part.start
                row.reshape(step, *later)[:steps] = broadcast[name][part]
            elif start == 0:
                row.reshape(step, *later)[...] = broadcast[name]
        answer(rows, result)
        yield part, result.reshape(outputs, step, *later)[:, : part.stop - part.start]


def filled(inputs: Inputs, answer: Answer, out: Sequence[Array]) -> Sequence[Array]:
    """Fill `out` at all points, block by block."""
    for part, result in in_blocks(inputs, answer, len(out)):
        for place, row in zip(out, result, strict=True):
            place[part] = row
    return out


def peaks(inputs: Inputs, answer: Answer) -> Sequence[Array]:
    """The largest magnitude along the last axis, and where, block by block."""
    best, angles = np.empty(inputs.shape[0]), np.empty(inputs.shape[0])
    for part, result in in_blocks(inputs, answer, 1):
        best[part], angles[part] = largest(result[0], inputs)
    return [best, angles]
