"""The numbered equations of papers A and B, the listing of A and the equations of C's links: a row an entry.

A row holds the verdict, what the entry's text refers to, and the numbers that it shows. The proof is the same
for all (`formulas.everywhere`): the form as the ledger has it, evaluated at random designs with the values of
its names by the raw loop and the free bodies, and by the package. A wrong form has a hand-written twin in
`letters`, which it must equal there.
"""

import itertools
import math

import pytest
from mpmath import mp, mpf

from tests.papers import curves_b as curves
from tests.papers import free_bodies, loop
from tests.papers import paper_a as A
from tests.papers import paper_b as B
from tests.papers.designs import (
    CASE,
    DESIGNS,
    EXACT,
    SPEED,
    close,
    exact_point,
    float_point,
    package,
    three_digits,
)
from tests.papers.designs_b import STEADY, case
from tests.papers.proofs import proves_each

WRONG = {
    "A-eq19": "sign",
    "A-listing-V_C": "sign",
    "A-listing-a_C": "sign",
    "B-eq2b": "typo",
    "B-eq10": "sign",
    "B-eq17": "sign",
    "B-eq18": "sign and exponent",
    "B-eq20": "sign and exponent",
    "B-eq29": "sign",
    "B-eq30": "sign",
    "B-eq38": "wrong claim",
    "B-eq39": "wrong claim",
    "B-eq40": "wrong claim",
    "B-eq41": "wrong claim",
    "B-eq42b": "sign and missing factor",
    "B-eq45": "wrong claim",
    "B-eq48": "wrong claim",
}
RIGHT = """
A-eq1 A-eq2 A-eq3 A-eq4 A-eq5 A-eq6 A-eq7 A-eq8 A-eq9 A-eq10 A-eq11 A-eq12 A-eq13 A-eq14 A-eq15 A-eq16 A-eq17
A-eq18 A-eq20 A-eq21 A-eq22 A-eq23 A-eq24 A-eq25 A-listing-omega A-listing-delta A-listing-phi A-listing-Y
A-listing-V_B A-listing-a_B A-listing-omega_BC A-listing-alpha_BC A-listing-alpha_BC1 A-listing-alpha_BC2
A-listing-alpha_BC3 A-listing-alpha_BC4 A-listing-a_C1 A-listing-a_C2 A-listing-a_C3 A-listing-a_C4
B-eq1 B-eq2a B-eq3 B-eq4 B-eq5a B-eq5b B-eq6 B-eq7 B-eq8 B-eq9 B-eq11 B-eq12 B-eq13 B-eq14 B-eq15 B-eq16
B-eq19 B-eq21 B-eq22 B-eq23 B-eq24 B-eq25 B-eq26 B-eq27 B-eq28 B-eq31 B-eq32 B-eq33 B-eq34 B-eq35 B-eq36
B-eq37a B-eq37b B-eq42a B-eq43 B-eq44 B-eq46a B-eq46b
C-link2-x C-link2-y C-link2-moment C-link3-x C-link3-y C-link3-moment C-link4-x C-link4-y C-link4-moment
"""
VERDICTS = dict.fromkeys(RIGHT.split(), "correct") | WRONG
CITES = {
    **{"A-eq4": "2", "A-eq9": "2", "A-eq12": "2", "A-eq13": "19", "A-eq19": "22 23 13 2 19 22 23"},
    **{"A-eq22": "13 19", "A-eq23": "13 19", "A-eq24": "A-claim-sensitivity-functions"},
    **{"A-eq25": "24 A-claim-sensitivity-functions", "A-listing-delta": "5", "A-listing-phi": "6"},
    **{"A-listing-Y": "7", "A-listing-V_B": "2", "A-listing-a_B": "4", "A-listing-omega_BC": "10"},
    **{"A-listing-alpha_BC": "14", "A-listing-alpha_BC1": "15", "A-listing-alpha_BC2": "16"},
    **{"A-listing-alpha_BC3": "17", "A-listing-alpha_BC4": "18", "A-listing-a_C1": "20"},
    **{"A-listing-a_C2": "21", "A-listing-a_C3": "22", "A-listing-a_C4": "23"},
    **{"A-listing-V_C": "11 1", "A-listing-a_C": "19 2"},
    **{"B-eq2a": "1", "B-eq6": "5a 5b", "B-eq9": "1", "B-eq10": "9 12", "B-eq12": "9 10", "B-eq15": "13"},
    **{"B-eq16": "15", "B-eq20": "17 19 9 14 1", "B-eq21": "6", "B-eq24": "6", "B-eq25": "24"},
    **{"B-eq29": "27", "B-eq30": "29", "B-eq31": "32 33", "B-eq32": "3", "B-eq33": "2 3 32", "B-eq38": "46b"},
    **{"B-eq37a": "37b B-text-inertia-direction", "B-eq37b": "B-text-inertia-direction"},
    **{"B-eq42a": "9 14 37 46", "B-eq42b": "42a 20", "B-eq43": "41"},
    **{"B-eq46a": "20 B-text-inertia-direction", "B-eq46b": "46a B-text-inertia-direction"},
}


@proves_each({key: key for key in VERDICTS}, VERDICTS, cites=CITES)
def test_equation(key):
    return NUMBERS[key]() if key in NUMBERS else {}


# --- the numbers that entries show ----------------------------------------------------------------

RESULTS = [-20.2, -7740.0, -994.0]  # V_C, alpha_BC and a_C of the test cases, as printed


def turn_of_the_rod():
    """The rod's own turning in the package's frame, rad/s."""
    motion = DESIGNS[0]
    turn = loop.rate(lambda t: free_bodies.turn_of_rod(motion, t), 1)
    return {"turn": turn, "names": {"omega_BC": loop.truth("omega_BC", motion)}}


def signs_that_were_run():
    """Signs of the terms present without alpha that print the three results, and the number tried."""
    theta, ec, AB, BC, omega = float_point(CASE)[:5]
    phi = A.printed_eq6(theta, ec, AB, BC)
    centripetal = BC * A.printed_eq10(theta, ec, AB, BC, omega) ** 2 * math.cos(phi)
    choices = list(itertools.product(*(itertools.product((1, -1), repeat=n) for n in (2, 2, 3))))
    run = []
    for v, b, c in choices:
        V_C = A.V_C_of_signs(v, theta, ec, AB, BC, omega)
        alpha_BC = A.alpha_BC_of_signs((b[0], 1, b[1]), theta, ec, AB, BC, omega, 0.0)
        parts = -AB * omega**2 * math.cos(theta), -BC * alpha_BC * math.sin(phi), -centripetal
        a_C = sum(sign * part for sign, part in zip(c, parts, strict=True))
        if [three_digits(x) for x in (V_C, alpha_BC, a_C)] == RESULTS:
            run.append((v, b, c))
    return run, len(choices)


def case_2_as_printed():
    """a_C of test case 2 by Eq. 19, and so by the listing, as printed, m/s2."""
    return {"as_printed": EXACT.a_C(*CASE[:4])}


def signs_of_eq19():
    """Test case 2 by Eq. 19, and the only choice of signs that prints the results."""
    p = exact_point(CASE)
    run, tried = signs_that_were_run()
    assert run == [((-1, -1), (1, -1), (1, 1, 1))]
    right = A.corrected_eq19(*p.design, p.omega, 0, mp)
    values = {"choices": mpf(tried), "three": list(map(mpf, RESULTS)), "plain": mpf(RESULTS[2])}
    return case_2_as_printed() | values | {"all_plus": right}


def listing_of_V_C():
    """V_C of test case 1 by the listing; only two minuses print what the paper has."""
    choices = itertools.product((1, -1), repeat=2)
    values = {signs: A.V_C_of_signs(signs, *float_point(CASE)[:5]) for signs in choices}
    assert [signs for signs, value in values.items() if three_digits(value) == RESULTS[0]] == [(-1, -1)]
    return {"listing": EXACT.V_C(*CASE[:4]), "case": EXACT.corrected_V_C(*CASE[:4])}


def least_s():
    """The paper's s at the outer dead centre, from which the package measures its own."""

    def at_dead_centre(e, k, c, m):
        return k + c - m.sqrt((k + c) ** 2 - e**2)

    for motion in STEADY:
        p = float_point(motion)
        difference = p.AB + p.BC - package("Y", motion) - package("s", motion)
        want = at_dead_centre(p.ec, p.AB, p.BC, math)
        assert difference == pytest.approx(want, rel=0, abs=1e-12 * (p.AB + p.BC))
    q = curves.case_1(mpf(0))
    least = q.k + q.c - loop.truth("Y", curves.motion_of(q._replace(theta=curves.dead_centres()[0])))
    assert close(least, at_dead_centre(q.e, q.k, q.c, mp), 0, 30)
    assert least > 0
    return {"least": least, "mm": 1000 * least, "names": {"k": q.k, "c": q.c, "e": q.e, "s": least}}


def peaks_of_eq20():
    """The greatest acceleration of Table 1 as printed, by unit, and in truth; it follows from Eq. 19."""
    for motion in STEADY:
        q = case(float_point(motion))
        assembled = B.printed_eq19(q, B.printed_eq17(q), B.printed_eq18(q))
        assert assembled == pytest.approx(B.printed_eq20(q), rel=1e-9, abs=1e-9 * B.a_s_terms(q, 3, 5)[2])
    in_mm = curves.places(lambda q: B.printed_eq20(curves.in_millimetres(q)) / 1000)[0]
    true, printed = (curves.places(f)[0] for f in (B.corrected_eq20, B.printed_eq20))
    return {"metres": printed, "mm": in_mm, "true": true}


NUMBERS = {
    "A-eq10": turn_of_the_rod,
    "A-eq19": signs_of_eq19,
    "A-listing-V_C": listing_of_V_C,
    "A-listing-a_C": lambda: (
        case_2_as_printed() | {"case": mpf(three_digits(EXACT.corrected_a_C(*CASE[:4])))}
    ),
    "B-eq9": least_s,
    "B-eq20": peaks_of_eq20,
}


# --- what no value of a formula shows -------------------------------------------------------------


def test_constants_of_the_worksheet():
    """Eqs. 24 and 25 are functions of four arguments: speed and acceleration are the worksheet's."""
    steady, faster, accelerating = (A.Worksheet(*constants) for constants in CONSTANTS)
    want = {steady: CASE, faster: CASE._replace(omega0=2 * SPEED), accelerating: CASE._replace(alpha=1000.0)}
    for sheet, motion in want.items():
        for name, formula in (("V_C", sheet.corrected_V_C), ("a_C", sheet.corrected_a_C)):
            assert formula(*CASE[:4]) == pytest.approx(package(name, motion), rel=1e-12)


CONSTANTS = (SPEED, 0.0), (2 * SPEED, 0.0), (SPEED, 1000.0)


@pytest.mark.parametrize(
    ("printed", "corrected"),
    [
        (B.printed_eq18, B.corrected_eq18),
        (B.printed_eq20, B.corrected_eq20),
        (lambda q: B.printed_eq42b(q, 1.0), lambda q: B.corrected_eq42b(q, 1.0)),
    ],
)
def test_dimensions(printed, corrected):
    """In millimetres the right form is 1000 times that in metres; what is printed is not."""
    for motion in STEADY:
        q = case(float_point(motion))
        large = curves.in_millimetres(q)
        assert corrected(large) == pytest.approx(1000 * corrected(q), rel=1e-9)
        assert printed(large) != pytest.approx(1000 * printed(q), rel=1e-3)
