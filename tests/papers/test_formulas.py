"""The ledgers' formulas as syntax trees and as LaTeX."""

import re

import pytest

from tests.papers.entry_checks import raw_entries
from tests.papers.errata.equations import FINE
from tests.papers.errata.formula import latex, parse
from tests.papers.errata.ledger import entries
from tests.papers.formulas import FORMULA, everywhere, misses

FORMULAS = [entry for entry in entries() if FORMULA.fullmatch(entry.id)]


def test_every_equation_is_here():
    """The equations of A and B, the listing of A, the equations of C's links: as printed all are formulas."""
    assert len(FORMULAS) == 25 + 58 + 18 + 9
    assert all(latex(entry.printed) for entry in FORMULAS)
    corrected = [entry for entry in FORMULAS if entry.verdict not in FINE]
    assert [entry.id for entry in corrected if not is_formula(entry.corrected)] == ["B-eq50"]


def is_formula(text):
    """True if a text is a formula."""
    try:
        return bool(latex(text))
    except ValueError:
        return False


def test_wrong_formula_is_told():
    assert misses("A-eq7", "Y(theta) = AB*cos(theta) + BC*cos(phi)", printed=True) == ""
    assert "['0." in misses("A-eq7", "Y(theta) = AB*cos(theta) - BC*cos(phi)", printed=True)
    assert "KeyError" in misses("A-eq7", "Y(theta) = AB*cos(theta) + CD*cos(phi)", printed=True)
    assert "other sides" in misses("A-eq7", "AB*cos(theta) + BC*cos(phi)", printed=True)


@pytest.mark.parametrize("row", [raw_entries()[entry.id] for entry in FORMULAS], ids=lambda row: row["id"])
def test_changed_formula_is_noticed(row):
    """Each sign of what is printed and of its correction, and the verdict: `everywhere` sees any change."""
    for field in ("printed", "corrected"):
        for sign in re.finditer(r"[-+]", row[field] if is_formula(row[field]) else ""):
            other = {"-": "+", "+": "-"}[sign.group()]
            text = row[field][: sign.start()] + other + row[field][sign.end() :]
            assert any(everywhere(row | {field: text}, row["verdict"])), text
    flipped = "wrong claim" if row["verdict"] in FINE else "correct"
    whole = row | {"corrected": row["corrected"] or row["printed"]}
    assert any(everywhere(whole, flipped)) or row["id"] in ("A-eq24", "A-eq25")  # a name alone, of one side


def test_latex():
    assert latex("v_2 = [c^2 - e^2]^(1/2)/(2*k)") == r"v_2 = \frac{\sqrt{c^{2} - e^{2}}}{2 \, k}"
    assert latex("dv_1/dtheta = -omega*k*cos(theta)") == (
        r"\frac{d v_1}{d \theta} = -\omega \, k \, \cos(\theta)"
    )


@pytest.mark.parametrize("text", ["a word or two", "x = __import__('os')", "x = [k for k in c]", "x = a.b"])
def test_no_formula(text):
    with pytest.raises(ValueError, match="no formula"):
        parse(text)
