"""Freezing: SymPy's expressions as lines of one operation, in an order that depends on nothing else."""

import math

import pytest
import sympy as sp

from desaxe.compiler.interpret import run_in_doubles
from desaxe.compiler.program import validate
from desaxe.compiler.text import with_short_temporaries, write_lines
from desaxe.derive.freeze import freeze
from desaxe.derive.sheet import Sheet, symbol
from desaxe.derive.stable import le, lt, select
from desaxe.units.dimensions import LENGTH

x, y, z = map(symbol, "xyz")
INPUTS = ("x", "y", "z")
GOLDEN = [
    (x + y, "x + y"),
    (x - y, "x - y"),
    (-x - y, "-x - y"),
    (y - x * z, "y - x * z"),
    (-x * y, "-(x * y)"),
    (-2 * x, "-(2.0 * x)"),
    (x * y / z, "x * y / z"),
    (x / (y * z), "x / (y * z)"),
    (1 / x, "1.0 / x"),
    (x**2, "x * x"),
    (x**3, "x * x * x"),
    (x**-2, "1.0 / (x * x)"),
    (x / 2, "x / 2.0"),
    (sp.Rational(1, 3) * x, "x / 3.0"),
    (sp.sqrt(x + y), "sqrt(x + y)"),
    (sp.sin(x) * sp.cos(y), "sin(x) * cos(y)"),
    (sp.Float(0.5) * x, "0.5 * x"),
    (sp.Integer(3), "3.0"),
    (symbol("nan"), "nan"),
    (select(lt(x, y), x, symbol("nan")), "x if x < y else nan"),
    (select(le(0, x), 1, 0), "1 if 0.0 <= x else 0"),
    (select(lt(x, y), 1, -1), "1.0 if x < y else -1.0"),
    (select(lt(x, y), select(lt(y, z), 3, 2), 0), "(3 if y < z else 2) if x < y else 0"),
]


def frozen(expression):
    sheet = Sheet(())
    sheet.define("out", expression)
    program = freeze(sheet, INPUTS, ("out",))
    validate(program)
    return program


@pytest.mark.parametrize(("expression", "text"), GOLDEN)
def test_golden(expression, text):
    lines = write_lines(with_short_temporaries(frozen(expression)))
    assert lines[-1] == f"out = {text}"


@pytest.mark.parametrize("power", [4, 5, 7, -3])
def test_a_power_is_products(power):
    value = run_in_doubles(frozen(x**power), {"x": 1.5, "y": 0.0, "z": 0.0})["out"]
    assert math.isclose(value, 1.5**power, rel_tol=1e-15)
    assert len(frozen(x**power).lines) <= 5


def test_a_power_that_is_no_product_is_refused():
    with pytest.raises(ValueError, match="cannot freeze the power"):
        frozen(x ** sp.Rational(1, 3))


def toy():
    sheet = Sheet(())
    sheet.define("u", x + y * z, unit=LENGTH, meaning="a length", source="A (6)")
    sheet.define("v", symbol("u") ** 2 - sp.sin(symbol("u")))
    sheet.define("w", y * z + symbol("v"))
    return freeze(sheet, INPUTS, ("w", "v"))


def test_a_toy_sheet():
    assert write_lines(with_short_temporaries(validate(toy()))) == [
        "t0 = y * z",
        "u = x + t0  # m | a length | A (6)",
        "v = u * u - sin(u)",
        "w = v + t0",
    ]


def test_a_toy_sheet_in_numbers():
    result = run_in_doubles(toy(), {"x": 1.0, "y": 2.0, "z": 3.0})
    assert (result["v"], result["w"]) == (49 - math.sin(7), 6 + (49 - math.sin(7)))


def test_equal_equations_freeze_alike():
    left, right = frozen((x + y) * z - x), frozen(-x + z * (y + x))
    assert left == right


def test_a_name_that_is_another_is_its_copy():
    sheet = Sheet(())
    sheet.define("u", x + y)
    sheet.define("v", symbol("u"))
    (_, line) = freeze(sheet, INPUTS[:2], ("u", "v")).lines
    assert (line.name, line.op, line.args) == ("v", "copy", ("u",))
