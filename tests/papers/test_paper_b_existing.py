"""Paper B: the existing model, Eqs. 52 and 53, and the reference values of the torque."""

import itertools

from mpmath import mp, mpf

from tests.papers import curves_b as curves
from tests.papers import loop
from tests.papers import paper_b as B
from tests.papers.designs import close, float_point
from tests.papers.designs_b import (
    STEADY,
    case,
    off,
)
from tests.papers.extremes import greatest
from tests.papers.proofs import proves


def with_long_rod(function, ratio, theta="0.9"):
    """A function of a case for a crank of 1 and a rod of 1/ratio without an offset."""
    return function(B.Case(mpf(theta), mpf(0), mpf(1), 1 / mpf(ratio), mpf(1), mp))


@proves("B-claim-compared", "wrong claim", says="52 53 17 18", cites="52 9 14 17 20")
@proves("B-eq52", "correct", cites="9 14 B-claim-compared 1 2")
def test_eq52():
    """To first order in k/c this is d2x/dt2; the paper's a_s is d2s/dt2, its opposite."""
    for ratio in ("1e-5", "1e-7"):
        exact = with_long_rod(B.corrected_eq20, ratio)
        assert abs(with_long_rod(B.reversed_eq52, ratio) - exact) < 2 * mpf(ratio) ** 3
        assert abs(with_long_rod(B.printed_eq52, ratio) + exact) < 2 * mpf(ratio) ** 3
        assert abs(with_long_rod(B.printed_eq52, ratio) - exact) > 1
    centric = [motion._replace(ec=0.0) for motion in STEADY]
    off(lambda p: B.printed_eq52(case(p)), lambda q, p: -q("a_C"), centric)
    for motion in centric:
        q = case(float_point(motion))
        error = B.reversed_eq52(q) + float(loop.truth("a_C", motion))
        assert abs(error) < 1.5 * (q.k / q.c) ** 3 * q.k * q.omega**2
    return model_errors(B.reversed_eq52, B.corrected_eq20)


@proves("B-eq53", "correct", cites="1 2")
def test_eq53():
    """To first order in k/c this is the inertia torque: the drive's torque reversed."""
    for ratio, theta in itertools.product(("1e-5", "1e-7"), ("0.9", "2.0", "4.0")):
        exact = -with_long_rod(lambda q: B.drive_torque(q, 1), ratio, theta)
        printed = with_long_rod(lambda q: B.printed_eq53(q, 1), ratio, theta)
        assert abs(printed - exact) < 2 * mpf(ratio) ** 2
        without = mp.sin(2 * mpf(theta)) / 2
        assert abs(printed + without) > mpf(ratio) / 10  # the terms with k/c do count
        doubled = printed + mpf(ratio) * mp.sin(mpf(theta)) / 4
        assert abs(doubled - exact) > mpf(ratio) / 10  # nor would another coefficient of sin(theta) do
    return model_errors(lambda q: B.printed_eq53(q, 1), lambda q: -B.drive_torque(q, 1))


def existing_errors(case, approximate, exact):
    """The worst error of the existing model over a turn, %, of the greatest exact size, for a design."""
    size = greatest(lambda t: abs(exact(case(t))))[0]
    return 100 * greatest(lambda t: abs(approximate(case(t)) - exact(case(t))))[0] / size


def model_errors(approximate, exact):
    """The worst errors for Table 1 by offset, and for Table 2, %."""
    short = [existing_errors(lambda t, e=e: curves.case_1(t, e), approximate, exact) for e in curves.OFFSETS]
    return {
        "short": [short[0], *(x for pair in zip(short[1:], (mpf(10), mpf(20)), strict=True) for x in pair)],
        "long": existing_errors(curves.case_2, approximate, exact),
    }


def test_existing_model_has_the_dead_centres_right():
    """Without an offset Eq. 52 is exact at the dead centres, so all models share the values there."""
    with mp.workdps(loop.DIGITS):
        for theta in (mpf(0), mp.pi):
            q = B.Case(theta, mpf(0), mpf("0.0381"), mpf("0.1524"), mpf("20.994"), mp)
            assert close(B.reversed_eq52(q), B.corrected_eq20(q), 1, 30)
