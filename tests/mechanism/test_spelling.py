"""Wrong names: the intended one is suggested or none, never another one, by every public call."""

import inspect
import re

import pytest

import desaxe as dx
from desaxe.mechanism.inputs import INPUTS
from desaxe.mechanism.spelling import WORDS, did_you_mean, meant

SIZES = {"AB": 0.125, "BC": 0.35}
RUN = {"torque": 1.0, "t_end": 1.0, "ec": 0.0, **SIZES}
CALLS = {name for name in dx.__all__ if inspect.isroutine(getattr(dx, name))}
CALLS -= {
    "between",
    "plus_minus",
    "quantities",
    "scene",
    "define",
    "undefine",
    "equation",
    "to_excel",
    "explain",
}


def arguments_of(call):
    """The parameters of a call, and values for those that it needs."""
    every = inspect.signature(getattr(dx, call)).parameters.values()
    named = [p for p in every if p.kind is not p.VAR_KEYWORD and p.name != "sliders"]
    return named, {p.name: "Y" for p in named if p.default is p.empty}


@pytest.mark.parametrize("call", sorted(CALLS))
def test_an_option_or_an_input_of_a_call(call):
    named, needed = arguments_of(call)
    option = ["AB", *(p.name for p in named if p.name not in needed)][-1]
    with pytest.raises(TypeError, match=rf"has no input '{option}z'; did you mean {option}[, ?]"):
        getattr(dx, call)(**{**needed, f"{option}z": 1.0})


@pytest.mark.parametrize(
    ("call", "wrong", "name"),
    [
        ("evaluate", "eccentricity", "ec"), ("evaluate", "ab", "AB"), ("evaluate", "speed", "omega0"),
        ("evaluate", "n", "omega0"), ("evaluate", "m", "m_slider"), ("evaluate", "Theta", "theta"),
        ("evaluate", "acuracy", "accuracy"), ("grid", "crank", "AB"), ("peak", "rod", "BC"),
        ("tolerance", "offset", "ec"), ("design_map", "bc", "BC"), ("simulate", "omega0", "omega_start"),
        ("simulate", "theta", "theta0"), ("simulate", "m_piston", "m_slider"), ("events", "omega", "omega0"),
        ("feasibility", "e", "ec"), ("inverse", "position", "Y"), ("synthesize", "ratio", "time_ratio"),
        ("harmonics", "friction", "mu"),
    ],
)  # fmt: skip
def test_the_name_that_was_meant(call, wrong, name):
    with pytest.raises(TypeError) as complaint:
        getattr(dx, call)(**arguments_of(call)[1], **{wrong: 0.1})
    text = str(complaint.value)
    assert re.match(rf"{call}\(\) has no input '{wrong}'; did you mean {name}(, \w+)?( or \w+)?\?$", text)
    assert (complaint.value.__cause__, complaint.value.__context__) == (None, None)


@pytest.mark.parametrize(
    ("make", "meant"),
    [
        (lambda: dx.over_Y([0, 1], [1, 2], inwards=[1, 2]), "inward"),
        (lambda: dx.Machine(units="mm").over_stroke([0, 1], [1, 2], inwards=[1, 2]), "inward"),
        (lambda: dx.kloss(1, 0.1, 157, geer=2), "gear"),
        (lambda: dx.over_omega([0, 1], [1, 0], kynd="linear"), "kind"),
        (lambda: dx.over_theta([0, 1], [1, 1], periode=3), "period"),
        (lambda: dx.over_theta.read("x.csv", tetha="deg"), "theta"),
        (lambda: dx.Machine(AB=1, brnach=1), "branch"),
    ],
)
def test_makers_of_loads_and_motors(make, meant):
    with pytest.raises(TypeError, match=rf"did you mean {meant}\?"):
        make()


@pytest.mark.parametrize(("call", "wrong"), [("events", "theta"), ("grid", "foo"), ("evaluate", "x")])
def test_no_guess_is_better_than_a_wrong_one(call, wrong):
    with pytest.raises(TypeError, match=rf"{call}\(\) has no input '{wrong}'; there are .*ec, AB, BC"):
        getattr(dx, call)(**arguments_of(call)[1], **{wrong: 0.1})


def test_other_errors_are_told_as_they_are():
    with pytest.raises(TypeError, match="missing 1 required keyword-only argument: 'BC'"):
        dx.events(ec=0.0, AB=0.1)
    by_name = "takes {} positional argument.*; inputs are given by name, such as theta=1.0$"
    with pytest.raises(TypeError, match=by_name.format(0)):
        dx.events(0.1)
    with pytest.raises(TypeError, match=by_name.format(1)):
        dx.evaluate("a_C", 1.0, ec=0.0, **SIZES)
    with pytest.raises(ValueError, match=r"names = \(\): name at least one quantity, such as 'a_C'"):
        dx.evaluate([], theta=1.0, ec=0.0, **SIZES)


def test_a_checked_function_looks_like_itself():
    assert list(inspect.signature(dx.feasibility).parameters) == ["ec", "AB", "BC"]
    assert dx.simulate.__name__ == "simulate"
    assert "The motion of the crank" in dx.simulate.__doc__


def test_the_table_leads_to_names_that_there_are():
    there = {*INPUTS, *inspect.signature(dx.simulate).parameters, *dx.quantities()}
    assert {name for names in WORDS.values() for name in names} <= there
    assert all(word == word.lower() for word in WORDS)


def test_case_spelling_and_words():
    assert meant("a_c", ("V_C", "a_C", "N_C"), 3)[0] == "a_C"
    assert meant("crank_length", ("BC", "AB")) == ["AB"]
    assert meant("crank_length", ("theta",)) == []
    assert meant("omega", ("omega", "omega0")) == ["omega"]
    assert did_you_mean("omega_1", ("omega", "omega0", "BC"), 3) == "did you mean omega or omega0? "


@pytest.mark.parametrize(
    ("word", "name"),
    [
        ("A_C", "a_C"), ("acceleration", "a_C"), ("a", "a_C"), ("velocity", "V_C"), ("v", "V_C"),
        ("jerk", "j_C"), ("position", "Y"), ("x", "Y"), ("torque", "T_in"), ("side_force", "N_C"),
    ],
)  # fmt: skip
def test_a_quantity_that_was_meant(word, name):
    with pytest.raises(ValueError, match=rf"unknown quantity '{word}'; did you mean {name}[,?]"):
        dx.evaluate(word, theta=1.0, ec=0.0, omega0=1.0, **SIZES)


@pytest.mark.parametrize("names", [3, None, [["a_C"]]])
def test_what_is_no_name_is_told(names):
    point = {"theta": 1.0, "ec": 0.0, "omega0": 1.0, **SIZES}
    expected = r"expected the name of a quantity or a list of names"
    for call, inputs in (
        (dx.evaluate, point), (dx.evaluate, {**point, "quality": True}), (dx.simulate, RUN | {"m_slider": 1})
    ):  # fmt: skip
        with pytest.raises(TypeError, match=expected):
            call(names=names, **inputs)
    with pytest.raises(TypeError, match=r"peak: expected one name, such as 'a_C', got \['a_C'\]"):
        dx.peak(["a_C"], ec=0.0, omega0=1.0, **SIZES)
