"""The polynomials level their error far below a double's last bit, and the parts of pi/2 add up."""

import math

import mpmath
import pytest

from desaxe._constants import constants
from desaxe.derive.polynomials import BITS, trigonometry

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


def test_the_parts_of_a_quarter_add_up(made):
    with mpmath.workdps(60):
        assert abs(sum(map(mpmath.mpf, made.pi_half)) - mpmath.pi / 2) < mpmath.mpf(2) ** -150


def test_whole_quarters_times_a_part_are_exact(made):
    """All parts but the last are so short that a product with a whole number up to the limit is exact."""
    quarters = math.ceil(made.limit * made.two_over_pi)
    for part in made.pi_half[:-1]:
        mantissa = int(math.ldexp(math.frexp(part)[0], BITS))
        assert math.ldexp(mantissa, -BITS) == math.frexp(part)[0]
        assert (mantissa * quarters).bit_length() <= 53
