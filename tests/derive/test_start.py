"""The forms next to theta = 0 are those of the chain rule, or refused; a given state has none."""

import pytest

from desaxe.compiler.program import Line
from desaxe.derive import start
from desaxe.derive.loop import theta
from tests.derive.derived import derivation


def test_both_derivatives_choose():
    lines = {line.name: line for line in derivation().program.lines}
    assert lines["near_start"].op == "extended_only"
    choices = [line for line in lines.values() if line.op == "select" and line.args[0] == "near_start"]
    assert {line.args[1] for line in choices} == {"rod_start", "slider_start"}


@pytest.mark.thorough
def test_a_state_is_never_near_its_start():
    lines = derivation().state.lines
    assert Line("near_start", "lt", (1.0, 0.0), "bool") in lines


@pytest.mark.parametrize("name", ["ROD_START", "SLIDER_START"])
def test_a_wrong_form_is_refused(monkeypatch, name):
    monkeypatch.setattr(start, name, getattr(start, name) * (1 + theta))
    with pytest.raises(ArithmeticError, match="is not the chain rule's"):
        start.prove_start()


def test_a_wrong_series_is_refused(monkeypatch):
    monkeypatch.setattr(start, "SINE_EXCESS", theta**3 / 3)
    with pytest.raises(ArithmeticError, match="is not sin"):
        start.prove_start()
