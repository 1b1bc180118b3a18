"""Minimax polynomials for sine and cosine, and pi/2 in parts, for loops that must vectorise.

A loop that calls the C library's `sin` runs one point at a time. The compiler writes these
polynomials into the loop instead. They are made here, by Remez' exchange in high precision, and
committed with the kernels.

    sin(y) = y + y z P(z),   cos(y) = 1 - z/2 + z^2 Q(z),   z = y^2,   |y| <= pi/4
"""

from collections.abc import Callable, Iterable

from mpmath import mp, mpf

from desaxe.compiler.passes.double_angles import DoubleTrigonometry
from desaxe.compiler.passes.trigonometry import Trigonometry

TURNS = 20  # bits of the number of quarters; a part of pi/2 has the others of 53, so products are exact
PARTS = 4  # so that angles next to a multiple of pi/2 keep all their digits
TERMS = 6
EXCHANGES = 8

# For twice the digits, with a third word: a term needs as many words as it is larger than 2^-130 or so.
DOUBLE_TURNS = 30
DOUBLE_PARTS = 5
DOUBLE_TERMS = 17
DOUBLE_STEPS = (2.0**-28, 2.0**-80)  # of the first term: smaller ones need two words, one word


def trigonometry() -> Trigonometry:
    """The constants for doubles."""
    with mp.workdps(60):
        return Trigonometry(
            limit=float(mp.floor(2**TURNS * mp.pi / 2)),
            two_over_pi=float(2 / mp.pi),
            pi_half=_parts(mp.pi / 2, TURNS, PARTS),
            pi_half_words=_parts(mp.pi / 2, 0, 2),
            sine=_rounded(_minimax(_sine_rest, lambda z: mp.sin(mp.sqrt(z)) / (mp.sqrt(z) * z), TERMS)),
            cosine=_rounded(_minimax(_cosine_rest, lambda z: mp.cos(mp.sqrt(z)) / z**2, TERMS)),
        )


def double_trigonometry() -> DoubleTrigonometry:
    """The constants for twice the digits: Taylor's, which are short enough."""
    with mp.workdps(100):
        sine = [(-1) ** k / mp.factorial(2 * k + 1) for k in range(DOUBLE_TERMS)]
        cosine = [-((-1) ** k) / mp.factorial(2 * k + 2) for k in range(DOUBLE_TERMS)]
        return DoubleTrigonometry(
            limit=float(mp.floor(2**DOUBLE_TURNS * mp.pi / 2)),
            two_over_pi=float(2 / mp.pi),
            pi_half=_parts(mp.pi / 2, DOUBLE_TURNS, DOUBLE_PARTS),
            sine=_in_words(sine),
            cosine=_in_words(cosine),
            complement="eps",
            gap="less",
        )


def _in_words(coefficients: list[mpf]) -> tuple[tuple[float, ...], ...]:
    """Split each coefficient into as many doubles as its term needs."""
    largest, result = (mp.pi / 4) ** 2, []
    for k, coefficient in enumerate(coefficients):
        size = abs(coefficient / coefficients[0]) * largest**k
        words: list[float] = []
        for _ in range(1 + sum(size >= step for step in DOUBLE_STEPS)):
            words.append(float(coefficient - sum(map(mpf, words))))
        result.append(tuple(words))
    return tuple(result)


def _parts(value: mpf, turns: int, count: int, bits: int = 53) -> tuple[float, ...]:
    """Split a value into `count` numbers of `bits` bits; all but the last leave `turns` of them free."""
    parts = []
    for _ in range(count - 1):
        scale = mpf(2) ** (bits - 1 - turns - mp.floor(mp.log(value, 2)))
        part = mp.floor(value * scale) / scale
        parts.append(float(part))
        value -= part
    return (*parts, float(value))


def _sine_rest(z: mpf) -> mpf:
    """P(z), exactly."""
    y = mp.sqrt(z)
    return (mp.sin(y) - y) / (y * z)


def _cosine_rest(z: mpf) -> mpf:
    """Q(z), exactly."""
    return (mp.cos(mp.sqrt(z)) - 1 + z / 2) / z**2


def _rounded(coefficients: Iterable[mpf]) -> tuple[float, ...]:
    return tuple(float(c) for c in coefficients)


def _minimax(function: Callable[[mpf], mpf], scale: Callable[[mpf], mpf], terms: int) -> list[mpf]:
    """Coefficients that level |polynomial - function| / |scale| on (0, (pi/4)^2], lowest first."""
    low, high = mpf(10) ** -8, (mp.pi / 4) ** 2 * mpf("1.0001")
    count = terms + 1
    nodes = [(low + high) / 2 - (high - low) / 2 * mp.cos(mp.pi * k / (count - 1)) for k in range(count)]
    for _ in range(EXCHANGES):
        rows = [[z**k for k in range(terms)] + [(-1) ** i * scale(z)] for i, z in enumerate(nodes)]
        solution = mp.lu_solve(mp.matrix(rows), mp.matrix([function(z) for z in nodes]))
        coefficients = list(solution)[:terms]
        nodes = _extrema(_error(coefficients, function, scale), low, high, count)
    return coefficients


def _error(
    coefficients: list[mpf], function: Callable[[mpf], mpf], scale: Callable[[mpf], mpf]
) -> Callable[[mpf], mpf]:
    """The relative error of a polynomial."""
    return lambda z: (mp.polyval(coefficients[::-1], z) - function(z)) / scale(z)


def _extrema(error: Callable[[mpf], mpf], low: mpf, high: mpf, count: int) -> list[mpf]:
    """The points of extreme error, on a fine grid, one between each two sign changes."""
    grid = [(low + high) / 2 - (high - low) / 2 * mp.cos(mp.pi * k / 400) for k in range(401)]
    values = [error(z) for z in grid]
    best: list[int] = []
    for i, value in enumerate(values):
        if best and (value > 0) == (values[best[-1]] > 0):
            best[-1] = max(best[-1], i, key=lambda j: abs(values[j]))
        else:
            best.append(i)
    while len(best) > count:
        best.pop(0 if abs(values[best[0]]) < abs(values[best[-1]]) else -1)
    return [grid[i] for i in best]
