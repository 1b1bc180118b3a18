"""Numbers and short formulas inside the sentences of the ledgers, each recomputed and compared as printed."""

import math
import re

import pytest
from mpmath import mp, mpf

from desaxe.errata.formula import parse
from desaxe.errata.ledger import entries
from tests.papers import formulas, loop
from tests.papers import newton_euler_c as ne
from tests.papers import paper_b as B
from tests.papers import paper_c as C
from tests.papers.designs import CASE, CRANK, ROD
from tests.papers.designs_b import TABLE_1, TABLE_2, peaks_by_stroke
from tests.papers.states_c import report, symbols
from tests.papers.test_paper_c_listing import BARS, ROUND, RUN, bar

LEDGER = {entry.id: entry for entry in entries()}
NUMBER = re.compile(r"(?<![\w.)])[-+]?\d+(?:\.\d+)?")
K, C_ROD, SPEED = TABLE_1["k"], TABLE_1["c"], TABLE_1["omega"]
OUTER, INNER = B.dead_centres(0.020, K, C_ROD)
BACK = math.degrees(INNER - OUTER)
AWAY = 360 - BACK


def torque_peaks(e):
    """Greatest torque in the return and the advance stroke, N m."""
    return peaks_by_stroke(lambda th: B.drive_torque(B.Case(th, e, K, C_ROD, SPEED), 1.05), e, K, C_ROD)


def in_case(name):
    """A quantity of paper A's test cases from the raw loop."""
    return float(loop.truth(name, CASE))


def released(name):
    """A symbol of paper C at the start from rest with the listing's alpha2."""
    return float(symbols(report(alpha=C.CRANK_ACCELERATION))[name])


def held(name, degrees=0):
    """An unknown of paper C held against 50 N."""
    return float(ne.solve(report(theta=math.radians(degrees)))[name])


def of_listing(name):
    """The value that paper C's listing computes for an unknown."""
    return float(RUN["x"][C.UNKNOWNS.index(name)])


def inertia(which):
    """IG about z with faceted ends, with round ends, and as a thin rod, each as a factor, 10 and -6."""
    length, mass = BARS[which], C.scalars()["m" + which]
    faceted, round_ends, thin = bar(length)[2], bar(length, ROUND)[2], mass * length**2 / 12
    return [1e6 * faceted, 10, -6, 20, 1e6 * round_ends, 10, -6, 2, 12, 1e6 * thin, 10, -6]


CALL = [60, 0, CRANK, ROD]
STROKE = 1000 * B.corrected_eq49(0.020, K, C_ROD)
FAST = TABLE_2["omega"] ** 2 * TABLE_2["k"]
RATIO = TABLE_2["k"] / TABLE_2["c"]
PRINTED = {
    "A-case1-omega0": lambda: [1500, 1500 * 2 * math.pi / 60],
    "A-case1-omega_BC": lambda: [*CALL, in_case("omega_BC")],
    "A-case1-V_C": lambda: [*CALL, in_case("V_C")],
    "A-case2-alpha_BC": lambda: [*CALL, in_case("alpha_BC")],
    "A-case2-a_C": lambda: [*CALL, in_case("a_C")],
    "C-weights": lambda: [C.CRANK_MASS, C.ROD_MASS, C.SLIDER_MASS, 50],
    "B-table3-max-existing": lambda: [FAST * (1 - RATIO)],
    "B-table3-min-existing": lambda: [-FAST * (1 + RATIO)],
}
CORRECTED = {
    "B-claim-stroke": lambda: [STROKE, 20],
    "B-table1-S": lambda: [STROKE],
    "B-claim-time-ratio": lambda: [AWAY / BACK],
    "B-claim-return-time": lambda: [math.radians(BACK) / SPEED],
    "B-claim-return-angle": lambda: [BACK],
    "B-claim-advance-time": lambda: [math.radians(AWAY) / SPEED],
    "B-claim-advance-angle": lambda: [AWAY],
    "B-claim-advance-range": lambda: [math.degrees(INNER), 360 + math.degrees(OUTER)],
    "B-claim-return-range": lambda: [math.degrees(OUTER), math.degrees(INNER)],
    "B-claim-torque-e20-advance": lambda: [torque_peaks(0.020)[1]],
    "B-claim-torque-e10-return": lambda: [torque_peaks(0.010)[0]],
    "B-claim-torque-e10-advance": lambda: [torque_peaks(0.010)[1]],
    "B-table2-omega": lambda: [200 * math.pi / 30],
    "C-static-0": lambda: [1000 * held("T12"), 50, C.CRANK, C.ROD, C.ECCENTRICITY],
    "C-static-90": lambda: [1000 * held("T12", 90), 50, C.CRANK, C.ROD, C.ECCENTRICITY],
    "C-static-180": lambda: [1000 * held("T12", 180), 50, C.CRANK, C.ROD, C.ECCENTRICITY],
    "C-static-270": lambda: [1000 * held("T12", 270), 50, C.CRANK, C.ROD, C.ECCENTRICITY],
    "C-listing-IG2": lambda: inertia("2"),
    "C-listing-IG3": lambda: inertia("3"),
    "C-listing-alpha2": lambda: [0, C.CRANK_ACCELERATION],
    "C-listing-aG2y": lambda: [0, released("aG2y")],
    "C-listing-aG3y": lambda: [0, released("aG3y")],
    "C-listing-aG4x": lambda: [released("aG4x"), 2, 0],
    "C-value-F12x": lambda: [held("F12x"), 50],
    "C-value-F12y": lambda: [held("F12y"), 50],
    "C-value-F32x": lambda: [of_listing("F32x"), -50, 50],
    "C-value-F32y": lambda: [held("F32y"), 50],
    "C-value-F43x": lambda: [held("F43x"), 50],
    "C-value-F43y": lambda: [held("F43y"), 50],
    "C-value-F14x": lambda: [of_listing("F14y"), held("F14y"), 50],
    "C-value-T12": lambda: [of_listing("T12"), held("T12"), 50],
    "C-claim-equilibrium": lambda: [-1000 * held("T12"), held("T12")],
}


def agree(text, wanted):
    """True if the numbers of a text are these, each to half a unit of its last digit."""
    found = NUMBER.findall(text)
    return len(found) == len(wanted) and all(
        abs(float(number) - true)
        <= max(0.51 * 10 ** -len(number.partition(".")[2]), 5e-4 * abs(true) * coarse(number))
        for number, true in zip(found, wanted, strict=True)
    )


def coarse(number):
    """A whole number of more than three digits, such as -7740, is rounded to three; others are not."""
    return number.lstrip("+-").endswith("0") and "." not in number


@pytest.mark.parametrize("field", ["printed", "corrected"])
def test_numbers(field):
    for key, wanted in (PRINTED if field == "printed" else CORRECTED).items():
        text = getattr(LEDGER[key], field)
        true = wanted()
        assert agree(text, true), (key, NUMBER.findall(text), true)
        for place in NUMBER.finditer(text):  # a changed leading digit is noticed
            old = place.group()
            leading = re.search(r"[1-9]", old)
            if leading:
                at = place.start() + leading.start()
                changed = text[:at] + str(int(text[at]) % 9 + 1) + text[at + 1 :]
                assert not agree(changed, true), (key, changed)


# --- formulas inside sentences --------------------------------------------------------------------


def formula_in(key, field, pattern):
    """The part of a sentence that is a formula."""
    return re.search(pattern, getattr(LEDGER[key], field)).group(1)


def sizes(v):
    """Sizes of paper A's vectors, as the text names them."""
    normal = v["AB"] * v["omega"] ** 2
    return {
        "V_Bmag": abs(v["V_B"]),
        "a_Bmag": abs(v["a_B"]),
        "omega_BA": v["omega"],
        "alpha_BA": v["alpha"],
    } | {
        "normal": normal,
        "tangential": mp.sqrt(abs(v["a_B"]) ** 2 - normal**2) * mp.sign(v["alpha"]),
    }


@pytest.mark.parametrize(
    ("key", "field", "pattern", "true"),
    [
        ("A-text-normal", "printed", r"\((.+)\)", "normal"),
        ("A-text-tangential", "printed", r"\((.+)\)", "normal"),
        ("A-text-tangential", "corrected", r"\((.+)\)", "tangential"),
        ("A-fig8-V_Bmag", "corrected", r"presumably (.+)", "V_Bmag"),
        ("A-fig8-a_Bmag", "corrected", r"presumably (.+)", "a_Bmag"),
    ],
)
def test_formula_of_a_sentence(key, field, pattern, true):
    with mp.workdps(formulas.loop.DIGITS):
        for number in range(3):
            v = formulas.names_a(number)
            v = v | sizes(v)
            (sides,) = parse(formula_in(key, field, pattern))
            for side in sides:
                assert abs(formulas.value(side, v) - v[true]) < mpf(10) ** -25 * abs(v["a_B"])


def test_formulas_of_paper_b_s_sentences():
    v = formulas.names_b(0)
    with mp.workdps(formulas.loop.DIGITS):
        ((distance,),) = parse(formula_in("B-text-x", "corrected", r"is (sqrt\(.+\))\."))
        assert abs(formulas.value(distance, v) - mp.hypot(v["x"], v["e"])) < mpf(10) ** -30
        ((left, right),) = parse(formula_in("B-text-eq4-for-eq6", "printed", r"as (sin.+?);"))
        assert abs(formulas.value(left, v) - formulas.value(right, v)) < mpf(10) ** -30


def test_sinusoid_as_written():
    text = formula_in("C-sinusoid-amplitude", "printed", r"^(T = .+?)\. ").replace("30t", "30*t")
    ((_, torque),) = parse(text)
    for t in ("0.013", "0.4"):
        true = C.printed_sinusoid(mpf(t), mp.cos)
        assert formulas.value(torque, {"t": mpf(t)}) == true
    assert formula_in("C-sinusoid-amplitude", "printed", r"(cos\(.+?\))") == LEDGER["C-sinusoid-unit"].printed
