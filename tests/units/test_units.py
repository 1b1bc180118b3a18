"""Sizes of units against pint's exact registry, an independent table; what is no unit is refused."""

import random
import re
from fractions import Fraction
from functools import cache
from pathlib import Path

import pytest

from desaxe.units.dimensions import Unit
from desaxe.units.parse import LONGEST_UNIT, exact, factor_to_si, in_unit, parse_unit
from desaxe.units.table import COMMON, PI, UNITS
from desaxe.units.text import split_quantity, terms_of

ROOT = Path(__file__).resolve().parents[2]
BASES = {"meter": "m", "second": "s", "radian": "rad", "gram": "kg", "kilogram": "kg"}
FOREIGN = ("K", "furlong_of_mine", "mol", "dB", "degC")


@cache
def reference():
    """The registry of pint that computes in fractions."""
    units = pytest.importorskip("pint").UnitRegistry(non_int_type=Fraction)
    units.define("@alias revolution = rev")
    units.define("@alias revolutions_per_minute = RPM")
    return units


def by_pint(terms):
    """The size of a product of units and its exponents, by pint."""
    product = reference().Quantity(Fraction(1))
    for name, power in terms:
        product = product * reference().Quantity(Fraction(1), name) ** power
    root = product.to_root_units()
    powers = {BASES[base]: int(power) for base, power in dict(root.units._units).items()}
    return Fraction(root.magnitude) / Fraction(1000) ** powers.get("kg", 0), Unit(**powers)


@pytest.mark.parametrize("name", UNITS)
def test_a_unit_has_the_exact_size_that_pint_knows(name):
    assert parse_unit(name) == by_pint([(name, 1)])


def test_pi_has_fifty_digits():
    mpmath = pytest.importorskip("mpmath")
    with mpmath.workdps(60):
        assert abs(Fraction(mpmath.nstr(mpmath.pi, 60)) - PI) < Fraction(1, 10**49)


def products(count):
    """Products of units of the table as people write them, with the terms that they stand for."""
    draw = random.Random(45)
    for _ in range(count):
        text, terms = "", []
        for k in range(draw.randint(1, 4)):
            name = draw.choice([*UNITS])
            power = draw.choice([1, 1, 1, 2, 3, -1, -2]) if name not in "%°" else 1
            divided = k > 0 and draw.random() < 0.4
            joint = draw.choice(["/", " / "] if divided else ["*", " * ", " ", "·"]) if k else ""
            text += joint + (name if power == 1 else f"{name}{draw.choice(['', '^', '**'])}{power}")
            terms.append((name, -power if divided else power))
        yield text, terms


def test_products_have_the_sizes_of_their_terms():
    wrong = [text for text, terms in products(500) if parse_unit(text) != by_pint(terms)]
    assert not wrong


def written_units():
    """Every unit behind a number in quotes in tests, docs and examples that is one to pint."""
    files = [p for end in ("py", "md", "toml") for p in ROOT.glob(f"*/**/*.{end}") if ".venv" not in p.parts]
    result = {
        text
        for path in files
        if path.relative_to(ROOT).parts[0] in ("tests", "docs", "examples", "notebooks", "src")
        for text in re.findall(r"""["']([-+.\d][^"'\n]{1,30})["']""", path.read_text("utf-8"))
    }
    for text in result:
        try:
            unit = split_quantity(text)[1]
            by_pint(terms_of(unit) if unit else [])
        except Exception:
            continue  # what is refused on purpose
        if unit:
            yield unit


def test_every_unit_that_is_written_here_is_that_of_pint():
    units = {*written_units(), *(unit for units in COMMON.values() for unit in units)}
    assert len(units) > 60
    assert not [unit for unit in units if parse_unit(unit) != by_pint(terms_of(unit))]


@pytest.mark.parametrize("number", ["350", "12.7", "1e-3", ".1", "-7", "+3.25e2"])
@pytest.mark.parametrize("unit", ["mm", "in", "thou", "light_year"])
def test_a_text_is_rounded_once(number, unit):
    size, _ = by_pint([(unit, 1)])
    assert exact("AB", f"{number} {unit}", "m") == Fraction(number) * size
    assert in_unit("AB", f"{number}{unit}", "m") == float(Fraction(number) * size)


@pytest.mark.parametrize(
    ("unit", "si", "problem"),
    [
        ("Nm", "N*m", "did you mean N m?"),
        ("KN", "N", "did you mean kN?"),
        ("kn", "N", "did you mean kN?"),
        ("MM", "m", "did you mean mm?"),
        ("mm", "rad", "it must be a quantity in rad"),
        ("Hz", "rad/s", "it must be a quantity in rad/s"),
        ("1/min", "rad/s", 'a rate "per time" does not say of what'),
        *((unit, "m", "expected a unit of m, s, kg and rad|unknown unit") for unit in FOREIGN),
        ("m" * (LONGEST_UNIT + 1), "m", "a unit of 101 characters, at most 100"),
        *((unit, "m", "unknown unit") for unit in ("", "m2m", "m/", "m//s", "2 m", "m^0", "m^10", "m+s")),
    ],
)
def test_what_is_no_unit_of_this_kind_is_refused(unit, si, problem):
    with pytest.raises(ValueError, match=f"x: .*({re.escape(problem) if '|' not in problem else problem})"):
        factor_to_si("x", unit, si)
