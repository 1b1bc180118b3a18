"""Closed forms against the raw triangle at 60 digits, in numbers and arrays, at borders too."""

import math
import random
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest

from desaxe.mechanism.closed.dead_centres import DEAD_CENTRES, SENSITIVITIES
from desaxe.mechanism.closed.functions import closed_form
from desaxe.mechanism.closed.inverse import INVERSE
from desaxe.mechanism.closed.limits import ANGLES, LIMITS, in_intervals, theta_intervals
from desaxe.mechanism.names import WHOLE
from desaxe.oracle.truth import ulp_error
from tests.effort import cases
from tests.mechanism.closed.truth import design, truths

PARTS = 8
BOUND = 4.0  # ulp times 1 + the condition numbers; the promise is 8
KINKED = ("max_pressure_angle", "min_transmission_angle", "time_ratio")  # at ec = 0


def dead_centres(branch):
    return closed_form(DEAD_CENTRES, branch=float(branch), turning=1.0)


@pytest.mark.sampled
@pytest.mark.parametrize("part", range(PARTS))
def test_dead_centres_and_their_derivatives(part):
    rng = random.Random(f"dead centres {part}")
    for _ in range(cases(40, 500, 12_500)):
        *lengths, branch = design(rng)
        form = dead_centres(branch)
        result = dict(zip(form.program.outputs, form.point(*lengths), strict=True))
        known = truths(*lengths, branch)
        for name in (*WHOLE, *SENSITIVITIES):
            check(name, result[name], known, lengths)


def check(name, value, known, lengths):
    base = name.partition("_wrt_")[0]
    if lengths[0] == 0.0 and base in KINKED and name.endswith("_wrt_ec"):
        assert value == 0.0 or math.isnan(value), name  # the mean of both sides
    elif name in known:
        exact, condition = known[name]
        error = abs(value) if exact is None else ulp_error(value, exact) / (1.0 + condition)  # None: it is 0
        assert error <= BOUND, (name, lengths, value, exact)
    elif base not in known and exact_margin(*lengths) < 0 and base[:2] not in ("Y_", "th"):
        assert math.isnan(value), (name, lengths)


def exact_margin(ec, AB, BC):
    return Fraction(BC) - Fraction(AB) - abs(Fraction(ec))


@pytest.mark.parametrize("branch", [1, -1])
def test_at_a_change_point_values_are_limits_and_derivatives_infinite(branch):
    form = dead_centres(branch)
    result = dict(zip(form.program.outputs, form.point(0.5, 1.0, 1.5), strict=True))
    with mp.workdps(60):
        assert ulp_error(result["stroke"], mp.sqrt(6)) <= 1
        assert ulp_error(result["max_pressure_angle"], mp.pi / 2) <= 1
        assert ulp_error(result["theta_inner"], mp.pi / 2) <= 1
    assert result["Y_inner"] == 0.0
    assert math.isinf(result["stroke_wrt_AB"])
    assert result["turn_status"] == 2


@pytest.mark.sampled
@pytest.mark.parametrize("branch", [1, -1])
def test_arrays_have_the_digits_of_numbers(branch):
    rng = random.Random("arrays")
    rows = np.array([design(rng)[:3] for _ in range(cases(300, 2_000, 20_000))])
    form = dead_centres(branch)
    arrays = np.array(np.broadcast_arrays(*form.arrays(*rows.T)))
    numbers = np.array([form.point(*row) for row in rows.tolist()]).T
    assert np.array_equal(np.isnan(arrays), np.isnan(numbers))
    finite = np.isfinite(numbers)
    near = np.abs(arrays[finite] - numbers[finite]) <= 8 * np.spacing(np.abs(numbers[finite]))
    assert near.all()  # the functions of two libraries may differ in the last bit
    assert np.array_equal(arrays[~finite], numbers[~finite], equal_nan=True)


@pytest.mark.sampled
@pytest.mark.parametrize("part", range(PARTS))
def test_limit_angles_and_margins(part):
    rng = random.Random(f"limits {part}")
    form = closed_form(LIMITS)
    for _ in range(cases(50, 500, 12_500)):
        lengths = design(rng)[:3]
        result = dict(zip(form.program.outputs, form.point(*lengths), strict=True))
        margin = exact_margin(*lengths)
        assert result["status"] == (2 if margin == 0 else 0 if margin > 0 else 1)
        assert theta_intervals(*lengths) == in_intervals([result[name] for name in ANGLES])
        check_limits(result, *lengths)


def check_limits(result, ec, AB, BC):
    """The margins, rounded once, and the limit angles."""
    margin = exact_margin(ec, AB, BC)
    with mp.workdps(400):
        exact = mp.mpf(margin.numerator) / margin.denominator
        # half an ulp may be a tie that ec alone decides
        assert ulp_error(result["margin"], exact) <= 0.5 + 1e-9, (ec, AB, BC)
    assert (result["link_margin"] >= 0.0) == (abs(Fraction(BC) - Fraction(AB)) >= abs(Fraction(ec)))
    intervals = in_intervals([result[name] for name in ANGLES])
    if margin >= 0:
        assert intervals == [(0.0, 2 * math.pi)]
        return
    reaches = AB != 0.0 and abs(Fraction(ec)) <= Fraction(AB) + Fraction(BC)
    assert bool(intervals) == reaches, (ec, AB, BC)
    with mp.workdps(100):
        for angle in (angle for interval in intervals for angle in interval):
            check_limit(angle, *map(mp.mpf, (ec, AB, BC)))


def check_limit(angle, ec, AB, BC):
    """The nearest root of ec + AB sin(theta) = BC or -BC."""
    sines = [(side * BC - ec) / AB for side in (1, -1)]
    arcs = [mp.asin(sine) for sine in sines if abs(sine) <= 1]
    roots = [root + 2 * mp.pi * k for arc in arcs for root in (arc, mp.pi - arc) for k in range(-1, 3)]
    root = min(roots, key=lambda r: abs(r - angle))
    assert abs(root - angle) <= mp.mpf(2) ** -51 * (1 + abs(root)), (angle, ec, AB, BC)


@pytest.mark.sampled
@pytest.mark.parametrize("part", range(PARTS))
def test_the_inverse_finds_the_angles(part):
    rng = random.Random(f"inverse {part}")
    for _ in range(cases(50, 500, 12_500)):
        ec, AB, BC, branch = design(rng)
        theta = rng.uniform(-math.pi, math.pi)
        with mp.workdps(60):
            room = mp.mpf(BC) ** 2 - (mp.mpf(ec) + mp.mpf(AB) * mp.sin(theta)) ** 2
            if not room > 0 or AB == 0.0:
                continue
            Y = float(AB * mp.cos(theta) + branch * mp.sqrt(room))
            *angles, _ = closed_form(INVERSE, branch=float(branch)).point(Y, ec, AB, BC)
            check_inverse(angles, Y, *map(mp.mpf, (ec, AB, BC)), branch)


def check_inverse(angles, Y, ec, AB, BC, branch):
    """Both angles of the triangle with the sides AB, BC and |AC|; those of this branch alone."""
    side = mp.hypot(ec, Y)
    cosine = (side**2 + AB**2 - BC**2) / (2 * side * AB) if side else 1
    if abs(cosine) >= 1:
        return  # rounding of Y has put it beyond a dead centre
    middle, half = mp.atan2(-ec, Y), mp.acos(cosine)
    # What a last bit of each side of the triangle moves, by the cosine theorem.
    loss = mp.mpf(2) ** -50 * ((side + AB + BC) ** 2 / (side * AB) / mp.sin(half) + 4)
    for exact in (middle - half, middle + half):
        rise = branch * (Y - AB * mp.cos(exact))
        if abs(rise) <= 4 * loss * AB:
            continue  # at a limit angle: either branch
        turned = [abs(mp.mpf(a) - exact + 2 * mp.pi * k) for a in angles if a == a for k in (-1, 0, 1)]
        assert (min(turned, default=mp.inf) <= loss) == (rise > 0), (angles, exact, Y, ec, AB, BC, branch)


@pytest.mark.sampled
@pytest.mark.parametrize("long", [False, True])
def test_the_inverse_keeps_its_digits_next_to_a_dead_centre(long):
    """Down to the last double before it, where the angle between the two is a root of a few last bits."""
    rng = random.Random(f"flat {long}")
    for _ in range(cases(60, 600, 12_500)):
        AB, BC = rng.uniform(0.1, 1.0), rng.uniform(1.0, 3.0)
        AB, BC = (BC, AB) if long else (AB, BC)
        ec, scale = rng.uniform(-0.99, 0.99) * abs(BC - AB), 2.0 ** rng.randint(-900, 900)
        reach = rng.choice([AB + BC, abs(BC - AB)])
        Y = math.sqrt((reach - ec) * (reach + ec)) + rng.randint(-3, 3) * 2.0 ** -rng.randint(20, 52)
        lengths = [v * scale for v in (Y, ec, AB, BC)]
        with mp.workdps(60):
            y, e, a, b = map(mp.mpf, (Y, ec, AB, BC))
            side = mp.hypot(e, y)
            cosine = (side**2 + a**2 - b**2) / (2 * side * a)
            result = [closed_form(INVERSE, branch=branch).point(*lengths) for branch in (1.0, -1.0)]
            angles = [angle for *some, _ in result for angle in some if angle == angle]
            assert bool(angles) == (abs(cosine) <= 1), (Y, ec, AB, BC)
            exact = [mp.atan2(-e, y) + side * mp.acos(cosine) for side in (1, -1)] if angles else []
            for angle in angles:
                apart = [abs(angle - one + 2 * mp.pi * k) for one in exact for k in (-1, 0, 1)]
                assert min(apart) <= 2.0**-49, (Y, ec, AB, BC)  # a few last bits of pi
