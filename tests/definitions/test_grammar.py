"""Invalid expressions are refused at once, with a mark below the error."""

import math
import random
import time

import pytest

import desaxe as dx
from desaxe.mechanism.own import definitions
from tests.definitions.expressions import defined

REFUSED = {
    "": "empty", "V_C +": "too early", "(V_C": "too early", "V_C)": "unexpected", "a.b": "attributes",
    "V_C.__class__": "attributes", "__import__('os')": "text", "V_C; V_C": "';'",
    "x" * 1_000_000: "at most", "(" * 1_000_000: "at most", "-" * 3_000 + "V_C": "more than 400",
    "(" * 60 + "V_C" + ")" * 60: "more than 40", "V_C**1000000000": "at most 64",
    "9**9**9**9*V_C": "at most 64", "1e999*V_C": "too large", "2**V_C": "a power is a plain number",
    "V_C**phi": "is a constant", "\u03a9*2": "no meaning", "V_C\u200b": "no meaning", "V_C\x00": "no meaning",
    "vc": "did you mean V_C", "nobody": "unknown name 'nobody'", "lambda: 1": "':'",
    "V_C if V_C else 1": "unexpected 'if'", "[V_C]": "lists", "V_C = 2": "==", "0 < V_C < 1": "two sides",
    "where(V_C, 1, 2)": "comparison", "(V_C > 0) * 2": "where", "sin(V_C)": "'V_C' is m/s",
    "V_C + a_C": r"'V_C' is m/s, 'a_C' is m/s\^2", "V_C + 1": "'1' is a plain number",
    "hypot(V_C, Y)": "'V_C' is m/s, 'Y' is m", "sqrt()": "unexpected",
    "atan2(V_C)": "takes 2 arguments, got 1", "eval(V_C)": "unknown function 'eval'",
    "status + 1": "not a real number", "2 * pi": "constant", "own * 2": "defined by itself",
    "own_wrt_ec": "defined by itself", "V_C^2": r"a power is \*\*", "V_C // 2": "unexpected",
    "1_0 * V_C": "unexpected", "sqrt(V_C)": "not an integer", "V_C(2)": "unknown function 'V_C'",
    "max(*V_C)": "unexpected", "max(V_C, )": "unexpected", "(V_C, V_C)": "unexpected ','",
    "2(V_C)": "unexpected",
    "not V_C": "unexpected 'V_C'", "lambda": "unknown name 'lambda'", "V_C Y": "unexpected 'Y'",
    "sqrt(Y, Y)": "takes 1 argument, got 2", "hypot(Y, Y, Y)": "takes 2 arguments, got 3",
    "min(Y)": "takes 2 to 8 arguments, got 1", "where(Y > 0, Y, Y, Y)": "takes 3 arguments, got 4",
    "2 * Y" + " + Y" * 199: "more than 400", "-" * 397 + "V_C * a_C" + " " * 4_000: "4406 characters",
}  # fmt: skip


@pytest.mark.parametrize("text", REFUSED, ids=lambda text: text[:20])
def test_refused(text):
    start = time.perf_counter()
    with pytest.raises(ValueError, match=REFUSED[text]) as caught:
        dx.define("own", text)
    assert time.perf_counter() - start < 1.0
    first, shown, mark = str(caught.value).split("\n")
    assert first.startswith("own: ")
    assert set(mark) == {" ", "^"}
    assert max(map(len, (first, shown, mark))) < 200
    assert "own" not in definitions()


@pytest.mark.parametrize(
    ("text", "marked"),
    [
        ("0.08 * abs(N_D * V_C)", "N_D"),
        ("V_C + (a_C + V_C) * AB", "(a_C + V_C)"),
        ("AB\n + BC.x", "."),
        ("2 * 3 $ 4", "$"),
        ("2 * (AB", "B"),
        ("min(Y, (V_C ) ) + 1", "min(Y, (V_C ) )"),
        ("AB + 0 * (0 < AB)", "(0 < AB)"),
        ("sin( ( AB ) )", "sin( ( AB ) )"),
    ],
)
def test_the_mark_is_below_the_place(text, marked):
    with pytest.raises(ValueError, match=r"^own: ") as caught:
        dx.define("own", text)
    _, shown, mark = str(caught.value).split("\n")
    at = mark.index("^")
    assert shown[at : mark.rindex("^") + 1] == marked


TAKEN = "V_C theta mu sqrt pi for x_wrt_ec 1a é stroke _x branch"


@pytest.mark.parametrize("name", [*TAKEN.split(), "", "a b", "x" * 100])
def test_a_name_that_is_taken_or_none(name):
    with pytest.raises(ValueError, match=r"is a |: a name|are parts"):
        dx.define(name, "2 * V_C")


@pytest.mark.parametrize(
    ("wrong", "problem"),
    [
        ({"k": "1 K"}, "m, s, kg and rad"), ({"k": "abc"}, "a number"), ({"k": float("inf")}, "finite"),
        ({"k": "1e99999 m/s"}, "a double holds"), ({"V_C": 1.0}, "name of a quantity"),
        ({"k": "1 m/s", "j": 1}, "j is not used"),
        ({"k": "1 m/s", "unit": "km/h"}, "product of"), ({"k": "1 m/s", "unit": "W"}, "'W' is W, but"),
        ({"k": "1 m/s", "meaning": "a\nb"}, "one line"), ({"k": 2.0}, "plain number"),
    ],
)  # fmt: skip
def test_wrong_constants_and_units(wrong, problem):
    with pytest.raises(ValueError, match=problem):
        dx.define("own", "V_C + k" if "k" in wrong else "V_C", **wrong)


@pytest.mark.parametrize("wrong", [None, 3, b"V_C", ["V_C"]])
def test_wrong_types(wrong):
    with pytest.raises(TypeError):
        dx.define("own", wrong)
    with pytest.raises(TypeError):
        dx.define("own", "V_C", unit=[wrong])
    with pytest.raises(TypeError):
        dx.define("own", "V_C + k", k=[wrong])


def test_constants_have_units_without_a_unit_library():
    for text, expected in (("1 mm", 1e-3), ("0.5 cm", 0.005), ("2 km", 2000.0)):
        with defined("own", "k + 0 * Y", k=text):
            assert dx.evaluate("own", theta=1.0, ec=0.0, AB=0.1, BC=0.3) == expected


LEAVES = ("1", "2.5", ".5", "3.", "4e-1", "phi", "theta", "pi", "k")
FORMS = (
    "{}+{}", "{} - {}", "{}*-{}", "{}\n/ (2 + abs({}))", "({} )", "-{}", "+--{}", "-sin({})**2",
    "2**-sin({})**3", "abs({})**.5", "hypot({}, {})", "min({},{}, 1)", "where({} <= {}, {}, 0)",
    "k - {} - (({}) - {})", "where({} > {}, {}, 1)", "where({} >= {}, {}, 2)", "where({} != {}, {}, 3)",
    "where({} == {}, 4, {})", "max({}, {}, -1)",
)  # fmt: skip


def expression(chance, depth):
    """A random text in which Python's own arithmetic has no pole."""
    form = chance.choice(FORMS) if depth else chance.choice(LEAVES)
    return form.format(*(expression(chance, depth - 1) for _ in range(form.count("{}"))))


@pytest.mark.parametrize("seed", range(60))
def test_arithmetic_means_what_it_means_in_python(seed):
    text = f"0*phi + k*({expression(random.Random(seed), 3)})"
    with defined("own", text, k=0.7):
        result = dx.evaluate(["own", "phi"], theta=1.1, ec=0.01, AB=0.125, BC=0.35)
    scope = {"phi": result["phi"], "theta": 1.1, "k": 0.7, "abs": abs, "min": min, "max": max}
    scope |= {"sin": math.sin, "hypot": math.hypot, "pi": math.pi}
    scope |= {"where": lambda test, yes, no: yes if test else no}
    assert result["own"] == pytest.approx(eval(text.replace("\n", ""), scope), rel=1e-13, abs=1e-13), text


def test_a_constant_may_be_a_word_of_python_and_a_number_have_zeros_before_it():
    with defined("own", "lambda * Y + 007 * is*Y", **{"lambda": 0.5, "is": 1}):
        result = dx.evaluate(["own", "Y"], theta=1.1, ec=0.01, AB=0.125, BC=0.35)
    assert result["own"] == 7.5 * result["Y"]
