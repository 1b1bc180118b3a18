"""A rate per time that does not say of what is refused with the reason: in calls, machines, scenes."""

import pytest

import desaxe as dx

SIZES = {"ec": 0.0, "AB": 0.1, "BC": 0.3}


@pytest.mark.parametrize("text", ["120 1/min", "120/min", "2 / s"])
@pytest.mark.parametrize("kind", ["call", "machine", "scene"])
def test_a_rate_says_of_what(text, kind):
    calls = {
        "call": lambda: dx.evaluate("V_C", theta=1.0, omega0=text, **SIZES),
        "machine": lambda: dx.Machine(omega0=text, units="mm", **SIZES),
        "scene": lambda: dx.scene(
            {"outputs": ["V_C"], "mechanism": SIZES, "motion": {"theta": 1.0, "omega0": text}}
        ),
    }
    with pytest.raises(ValueError, match=r"omega0 = .*does not say of what: write turns .*120 turn/min"):
        calls[kind]()


@pytest.mark.parametrize("text", ["120 mm/1", "1/2 s", "120 rev//min"])
def test_other_texts_are_refused_as_before(text):
    with pytest.raises(ValueError, match="it must be a number, or a number with a unit"):
        dx.evaluate("V_C", theta=1.0, omega0=text, **SIZES)
