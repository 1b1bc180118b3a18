"""The chunks of a grid."""

import pytest

from desaxe.evaluation.chunks import blocks_of, chunk_lengths, uniform

SIZES = {"theta": 10, "ec": 4, "BC": 3}


@pytest.mark.parametrize(
    ("chunks", "theta", "ec", "BC"),
    [
        ("auto", (2, 2, 2, 2, 2), (4,), (3,)),
        (3, (3, 3, 3, 1), (3, 1), (3,)),
        (-1, (10,), (4,), (3,)),
        ({"theta": 4}, (4, 4, 2), (4,), (3,)),
        ({"theta": "auto", "ec": 1}, (8, 2), (1, 1, 1, 1), (3,)),
        ({"theta": (6, 4), "BC": None}, (6, 4), (4,), (3,)),
        ({"ec": 99}, (10,), (4,), (3,)),
    ],
)
def test_lengths(chunks, theta, ec, BC):
    assert chunk_lengths(chunks, SIZES, 24) == {"theta": theta, "ec": ec, "BC": BC}


def test_blocks_hold_every_point_once():
    chunk = uniform(chunk_lengths({"theta": 4, "ec": 3}, SIZES, 100))
    points = [
        (i, j, k)
        for _, part in blocks_of(SIZES, chunk)
        for i in range(part["theta"].start, part["theta"].stop)
        for j in range(part["ec"].start, part["ec"].stop)
        for k in range(part["BC"].start, part["BC"].stop)
    ]
    assert sorted(points) == [(i, j, k) for i in range(10) for j in range(4) for k in range(3)]


@pytest.mark.parametrize(
    ("chunks", "error", "words"),
    [
        ({"teta": 3}, ValueError, "'teta' is not a dimension of this grid; did you mean theta"),
        ({"theta": 0}, ValueError, "chunks of theta = 0: at least 1"),
        ({"theta": 2.5}, TypeError, "chunks of theta = 2.5: a whole number"),
        ({"theta": True}, TypeError, "chunks of theta = True"),
        ({"theta": (6, 5)}, ValueError, r"chunks of theta: \(6, 5\) is 11 points, it has 10"),
        ("large", TypeError, "chunks of theta = 'large'"),
    ],
)
def test_bad_chunks_are_refused(chunks, error, words):
    with pytest.raises(error, match=words):
        chunk_lengths(chunks, SIZES, 24)


def test_a_store_has_chunks_of_one_length():
    assert uniform({"theta": (4, 4, 2)}) == {"theta": 4}
    with pytest.raises(ValueError, match=r"chunks of theta: \(4, 2, 4\)"):
        uniform({"theta": (4, 2, 4)})
