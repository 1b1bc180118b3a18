"""The polynomials level their error far below an ulp, and the parts of pi/2 add up."""

import math

import mpmath
import pytest

from desaxe.derive.polynomials import double_trigonometry, trigonometry
from desaxe.mechanism.constants import constants, double_constants

HALF_BIT = 2.0**-53
ANGLES = [math.pi / 4 * k / 200 for k in range(1, 201)]


@pytest.fixture(scope="module")
def made():
    return trigonometry()


def test_they_are_those_committed(made):
    assert made == constants()


def worst(exact, form):
    with mpmath.workdps(40):
        return max(abs(form(mpmath.mpf(a)) / exact(mpmath.mpf(a)) - 1) for a in ANGLES)


def test_the_sine(made):
    assert worst(mpmath.sin, lambda y: y + y**3 * mpmath.polyval(made.sine[::-1], y * y)) < HALF_BIT / 4


def test_the_cosine(made):
    def form(y):
        return 1 - y * y / 2 + y**4 * mpmath.polyval(made.cosine[::-1], y * y)

    assert worst(mpmath.cos, form) < HALF_BIT / 4


# Constants, digits of the numbers that they reduce, bits of pi/2 in all.
REDUCTIONS = {
    "double": (trigonometry, 53, 150),
    "twice": (double_trigonometry, 53, 143),
}


@pytest.mark.parametrize("kind", REDUCTIONS)
def test_the_parts_of_a_quarter_add_up(kind):
    make, _, bits = REDUCTIONS[kind]
    with mpmath.workdps(60):
        assert abs(sum(map(mpmath.mpf, make().pi_half)) - mpmath.pi / 2) < mpmath.mpf(2) ** -bits


@pytest.mark.parametrize("kind", REDUCTIONS)
def test_whole_quarters_times_a_part_are_exact(kind):
    """All parts but the last are so short that a product with a whole number up to the limit is exact."""
    make, digits, _ = REDUCTIONS[kind]
    made = make()
    quarters = math.ceil(made.limit * made.two_over_pi)
    for part in made.pi_half[:-1]:
        mantissa, _ = math.frexp(part)[0].as_integer_ratio()
        assert (mantissa * quarters).bit_length() <= digits


def test_those_of_twice_the_digits_are_taylors():
    made = double_trigonometry()
    assert made == double_constants()
    with mpmath.workdps(80):
        rows = [(k, words, (-1) ** k / mpmath.factorial(2 * k + 1)) for k, words in enumerate(made.sine)]
        rows += [
            (k, words, (-1) ** (k + 1) / mpmath.factorial(2 * k + 2)) for k, words in enumerate(made.cosine)
        ]
        for k, words, exact in rows:
            error = abs(sum(map(mpmath.mpf, words)) - exact)
            assert error * (mpmath.pi / 4) ** (2 * k) < 2.0**-132
        after = 1 / mpmath.factorial(2 * len(made.sine) + 1)
        assert after * (mpmath.pi / 4) ** (2 * len(made.sine)) < 2.0**-135
