"""Paper A: every line of its listing, their names and order, and Fig. 8."""

import itertools

from mpmath import mp, mpf

from tests.papers import paper_a as A
from tests.papers.designs import (
    CASE,
    SHEET,
    SPEED,
    agrees,
    differs,
    float_point,
    paper_frame,
    three_digits,
)
from tests.papers.proofs import proves, proves_each
from tests.papers.test_paper_a_equations import alpha_part, case_as_printed

LINES = {
    "omega": (lambda q, p: q("omega"), "rate"),
    "delta": (lambda q, p: q("delta"), "angle"),
    "phi": (lambda q, p: q("phi"), "angle"),
    "Y": (lambda q, p: q("Y"), "length"),
    "omega_BC": (lambda q, p: q("omega_BC"), "rate"),
    "alpha_BC": (lambda q, p: q("alpha_BC"), "rate2"),
    "alpha_BC1": (lambda q, p: q("a_B_X") - alpha_part(q, p, "X"), "acceleration"),
    "alpha_BC2": (lambda q, p: alpha_part(q, p, "X"), "acceleration"),
    "alpha_BC3": (lambda q, p: -(q("omega_BC") ** 2) * p.side, "acceleration"),
    "alpha_BC4": (lambda q, p: q("Y") - p.pin_height, "length"),
    "a_C1": (lambda q, p: q("a_B_Y") - alpha_part(q, p, "Y"), "acceleration"),
    "a_C2": (lambda q, p: alpha_part(q, p, "Y"), "acceleration"),
    "a_C3": (lambda q, p: -q("alpha_BC") * p.side, "acceleration"),
    "a_C4": (lambda q, p: -(q("omega_BC") ** 2) * (q("Y") - p.pin_height), "acceleration"),
}


CITES = dict(zip(LINES, ("", 5, 6, 7, 10, 14, 15, 16, 17, 18, 20, 21, 22, 23), strict=True))


@proves_each(
    {f"A-listing-{name}": name for name in LINES},
    "correct",
    cites={f"A-listing-{name}": f"{number}" for name, number in CITES.items()},
)
def test_listing_line(name):
    expected, kind = LINES[name]
    arguments = 1 if name == "omega" else 4
    agrees(lambda p: getattr(p.sheet, name)(*p.design[:arguments]), expected, kind)


@proves("A-listing-V_B", "correct", cites="2")
def test_listing_V_B():
    agrees(lambda p: p.sheet.V_B(p.theta, p.AB), lambda q, p: paper_frame(q, "V_B"), "velocity")


@proves("A-listing-a_B", "correct", cites="4")
def test_listing_a_B():
    agrees(lambda p: p.sheet.a_B(p.theta, p.AB), lambda q, p: paper_frame(q, "a_B"), "acceleration")


@proves("A-listing-V_C", "sign", cites="11 1")
def test_listing_V_C():
    agrees(lambda p: p.sheet.corrected_V_C(*p.design), lambda q, p: q("V_C"), "velocity")
    agrees(lambda p: p.sheet.V_C(*p.design), lambda q, p: -q("V_C"), "velocity")
    differs(lambda p: p.sheet.V_C(*p.design), "V_C")
    choices = list(itertools.product((1, -1), repeat=2))
    printing = [
        signs for signs in choices if three_digits(A.V_C_of_signs(signs, *float_point(CASE)[:5])) == -20.2
    ]
    assert printing == [(-1, -1)]
    sheet = A.Worksheet(mpf(SPEED), 0, mp)
    return {"listing": sheet.V_C(*CASE[:4]), "case": sheet.corrected_V_C(*CASE[:4])}


@proves("A-listing-a_C", "sign", cites="19 2")
def test_listing_a_C():
    agrees(lambda p: p.sheet.corrected_a_C(*p.design), lambda q, p: q("a_C"), "acceleration")
    agrees(lambda p: p.sheet.a_C(*p.design), lambda q, p: 2 * q("a_B_Y") - q("a_C"), "acceleration")
    differs(lambda p: p.sheet.a_C(*p.design), "a_C")
    return case_as_printed() | {"case": mpf(three_digits(SHEET.corrected_a_C(*CASE[:4])))}


# --- the listing's names and order, Fig. 8 --------------------------------------------------------

LISTING = {  # each line's name as printed, and the functions that it calls
    "omega": "",
    "delta": "",
    "phi": "",
    "Y": "phi",
    "V_B": "omega",
    "a_B": "omega",
    "omega_BC": "omega phi",
    "V_C": "omega omega_BC phi",
    "alpha_BC": "alpha_BC1 alpha_BC2 alpha_BC4 alpha_BC3",
    "alpha_BC1": "omega",
    "alpha_BC2": "",
    "alpha_BC3": "omega_BC phi",
    "alpha_BC4": "phi",
    "a_c": "a_c1 a_c2 a_c3 a_c4",
    "a_c1": "omega",
    "a_c2": "",
    "a_c3": "alpha_BC phi",
    "a_c4": "omega_BC phi",
}
FIG_8 = {1: ["omega"], 2: ["V_B", "a_B", "V_Bmag", "a_Bmag", "X"], 3: ["omega_BC", "V_c", "alpha_BC", "a_c"]}
NAMES = "a_c(...) and V_c(...) are defined or listed; a_C(60deg, 0.010, 0.125, 0.3) and V_C(...) are called"


@proves("A-listing-name", "typo", says=NAMES, cites="8")
def test_listing_defines_a_name_that_is_not_called():
    listed = {name for names in FIG_8.values() for name in names}
    assert {"a_C", "a_C1", "a_C2", "a_C3", "a_C4"}.isdisjoint(LISTING)
    assert {"a_c", "V_c"} <= listed
    assert "V_C" in LISTING


@proves("A-listing-order", "given")
def test_listing_is_not_in_order():
    names = list(LISTING)
    forward = [name for n, name in enumerate(names) if set(LISTING[name].split()) & set(names[n:])]
    assert forward == ["alpha_BC", "a_c"]
    assert len(names) - len(forward) == 16
    parts = [
        sorted(name for name in names if name.startswith(f"{one}") and name[-1] in "1234") for one in forward
    ]
    (first, last), (one, four) = ((names[0], names[-1]) for names in parts)
    return {"parts": f"{first} to {last} and {one} to {four}".replace("a_c", "a_C")}


@proves("A-fig8-X", "typo", cites="8")
def test_fig8_lists_functions_that_are_never_defined():
    defined, listed = set(LISTING), {name.replace("V_c", "V_C") for step in FIG_8.values() for name in step}
    assert listed - defined == {"V_Bmag", "a_Bmag", "X"}
    assert {name for name in defined - listed if name[-1] not in "1234"} == {"delta", "phi", "Y"}


@proves("A-fig8-steps", "correct", says="2 1 3", cites="1 2 3")
def test_fig8_steps_use_only_earlier_ones():
    step = {name.replace("V_c", "V_C"): number for number, names in FIG_8.items() for name in names}

    def needs(name):
        called = set(LISTING[name].split())
        return called.union(*map(needs, called))

    assert needs("V_B") == needs("a_B") == {"omega"}
    defined = [name for name in step if name in LISTING]
    assert all(step[other] <= step[name] for name in defined for other in needs(name) & set(step))
