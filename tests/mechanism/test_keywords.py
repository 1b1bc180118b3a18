"""A misspelt keyword of any public call is answered with the one that is meant."""

import inspect

import pytest

import desaxe as dx

CALLS = [name for name in dx.__all__ if inspect.isroutine(getattr(dx, name)) and name not in ("define",)]
OTHERS = {"between", "plus_minus", "quantities", "scene", "undefine", "equation", "to_excel", "explain"}


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


@pytest.mark.parametrize("name", sorted({*CALLS} - OTHERS))
def test_an_option_or_an_input_of_a_call(name):
    function = getattr(dx, name)
    every = [p for p in inspect.signature(function).parameters.values() if p.name != "sliders"]
    needed = {p.name: "Y" for p in every if p.default is p.empty and p.kind is not p.VAR_KEYWORD}
    option = ["AB", *(p.name for p in every if p.kind is not p.VAR_KEYWORD and p.name not in needed)][-1]
    with pytest.raises(TypeError, match=rf"has no input '{option}z'; did you mean {option}[, ?]"):
        function(**{**needed, f"{option}z": 1.0})
