"""Every formula that the ledgers show is evaluated as it is written there; a changed one is noticed."""

import re

import pytest
from mpmath import mp, mpf

from desaxe.errata.formula import latex, parse
from desaxe.errata.ledger import FINE, entries
from tests.papers import newton_euler_c as ne
from tests.papers import paper_c as C
from tests.papers.formulas import FORMULA, misses
from tests.papers.states_c import report, symbols

FORMULAS = [entry for entry in entries() if FORMULA.fullmatch(entry.id)]
SHOWN = [
    pytest.param(entry.id, text, field == "printed", id=f"{entry.id}-{field}")
    for entry in FORMULAS
    for field, text in (("printed", entry.printed), ("corrected", entry.corrected))
    if text
]
SWAPS = {"sin": "cos", "cos": "sin", "+": "-", "-": "+"}


def mutations(text):
    """The formula with one sign reversed, a sine and a cosine exchanged, or one digit changed, in turn."""
    for found in re.finditer(r"sin|cos|[+-]|\d", text):
        old = found.group()
        new = SWAPS.get(old) or str((int(old) + 1) % 10)
        yield text[: found.start()] + new + text[found.end() :]


def test_every_equation_is_here():
    equations = [entry.id for entry in FORMULAS if re.match(r"[AB]-eq", entry.id)]
    assert len(equations) == 25 + 58
    assert len(FORMULAS) == 25 + 58 + 18 + 9


@pytest.mark.parametrize(("key", "text", "printed"), SHOWN)
def test_formula(key, text, printed):
    assert misses(key, text, printed) == ""


@pytest.mark.parametrize("entry", [e for e in FORMULAS if e.verdict not in FINE], ids=lambda e: e.id)
def test_wrong_form_is_wrong(entry):
    assert misses(entry.id, entry.printed, printed=False)


@pytest.mark.parametrize(("key", "text", "printed"), SHOWN)
def test_mutation_is_caught(key, text, printed):
    for changed in mutations(text):
        assert misses(key, changed, printed), changed


# --- what is no equation: rows and numbers of paper C ---------------------------------------------

LEDGER = {entry.id: entry for entry in entries("C")}
STATE = report(omega=3.0, alpha=40.0, theta=0.4)


def row(text):
    """The entries of a row in brackets, or of one of the listing, by the values of some state."""
    v = symbols(STATE) | {"mu": mpf("0.3")}
    pieces = text.split(" with ")[0].strip("[]; ").split()
    signs = {"+-mu": v["mu"]}
    return [signs[p] if p in signs else mpf(p) if p.lstrip("-").isdigit() else signed(p, v) for p in pieces]


def signed(name, v):
    """A name, perhaps with a minus."""
    return -v[name[1:]] if name.startswith("-") else v[name]


@pytest.mark.parametrize("number", range(1, 9))
def test_row_of_the_matrix(number):
    with mp.workdps(2 * ne.DIGITS):
        wanted = C.printed_matrix(symbols(STATE), mpf("0.3"))[number - 1]
        assert row(LEDGER[f"C-matrix-row{number}"].printed) == wanted
        for changed in mutations(LEDGER[f"C-matrix-row{number}"].printed.replace("+-mu", "-mu")):
            try:
                assert row(changed) != wanted
            except KeyError:
                continue
        if number == 3:
            assert row(LEDGER["C-listing-A-row3"].corrected.split(";")[0]) == wanted


def test_right_hand_side_as_written():
    v = symbols(STATE)
    pieces = LEDGER["C-right-hand-side"].printed.strip("[]").split(",")
    with mp.workdps(2 * ne.DIGITS):
        got = [eval_product(piece, v) for piece in pieces]
        assert got == C.printed_right_hand_side(v)


def eval_product(text, v):
    """A sum of products of names with blanks between them, such as m4 aG4x - FPx."""
    total, sign = mpf(0), 1
    for term in re.split(r"\s*([+-])\s*", text.strip()):
        if term in ("+", "-"):
            sign = 1 if term == "+" else -1
        elif term:
            product = mpf(sign)
            for name in term.split():
                product *= v[name]
            total += product
    return total


HELD = {"F12x", "F12y", "F32y", "F43x", "F43y"}
ARMS = ("R12x", "R12y", "R23x", "R43x", "R43y")


@pytest.mark.parametrize("name", ARMS)
def test_corrected_arm(name):
    text = LEDGER[f"C-listing-{name}"].corrected
    lines = C.scalars(C.corrected_listing())
    expression = text.split("=")[1].strip().rstrip(";")
    assert text.startswith(name + "=")
    assert C.number(expression, lines) == pytest.approx(float(symbols(report())[name]), abs=1e-9)
    if name != "R12y":  # zero at theta = 0; the crank angle enters below
        return
    turned = C.scalars(C.corrected_listing(theta="50"))
    true = float(symbols(report(theta=mp.radians(50)))[name])
    assert C.number(expression, turned) == pytest.approx(true, abs=1e-9)


@pytest.mark.parametrize("name", ["alpha3", "aG3x", "aG4x", "Fpx"])
def test_corrected_number(name):
    released = symbols(report(alpha=C.CRANK_ACCELERATION))
    number = float(re.match(rf"{name} ?= (\S+);", LEDGER[f"C-listing-{name}"].corrected).group(1))
    assert number == pytest.approx(float(released["FPx" if name == "Fpx" else name]), rel=2e-4)


@pytest.mark.parametrize("name", sorted(HELD))
def test_corrected_value(name):
    number = float(re.match(rf"{name} = (\S+) N", LEDGER[f"C-value-{name}"].corrected).group(1))
    assert number == pytest.approx(float(ne.solve(report())[name]), abs=5e-5)


# --- the form itself ------------------------------------------------------------------------------


def test_latex():
    assert latex("v_2 = [c^2 - e^2]^(1/2)/(2*k)") == r"v_2 = \frac{\sqrt{c^{2} - e^{2}}}{2 \, k}"
    assert latex("dv_1/dtheta = -omega*k*cos(theta)") == (
        r"\frac{d v_1}{d \theta} = -\omega \, k \, \cos(\theta)"
    )
    assert all(latex(text) for _, text, _ in (shown.values for shown in SHOWN))


@pytest.mark.parametrize("text", ["a word or two", "x = __import__('os')", "x = [k for k in c]", "x = a.b"])
def test_no_formula(text):
    with pytest.raises(ValueError, match="no formula"):
        parse(text)
