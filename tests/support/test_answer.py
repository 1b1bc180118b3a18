"""Answers: dicts to every caller, readable on a screen."""

import pickle

import numpy as np
import pytest

import desaxe as dx
from desaxe.support.answer import Answer

SIZES = {"ec": 0.1, "AB": 0.125, "BC": 0.35}
CALLS = {
    "events": lambda: dx.events(**SIZES),
    "feasibility": lambda: dx.feasibility(**SIZES),
    "peak": lambda: dx.peak("a_C", omega0=157.0, **SIZES),
    "evaluate": lambda: dx.evaluate(["V_C", "a_C"], theta=1.0, omega0=157.0, **SIZES),
}


@pytest.mark.parametrize("name", CALLS)
def test_an_answer_is_a_dict(name):
    found = CALLS[name]()
    assert isinstance(found, dict)
    assert pickle.loads(pickle.dumps(found)) == found == dict(found)
    lines = repr(found).splitlines()
    assert [line.split()[0] for line in lines if not line.startswith(" ")] == list(found)
    assert max(map(len, lines)) < 120


def test_numbers_have_six_digits():
    assert repr(Answer(stroke=0.26279794681770396, status=0)) == "stroke  0.262798\nstatus  0"
    assert repr(Answer(gradient={"ec": -2.1535312, "AB": 1 / 3})) == "gradient  {ec: -2.15353, AB: 0.333333}"
    assert repr(Answer()) == "{}"


def test_arrays_are_shown_by_their_range():
    many = np.append(np.arange(9.0), np.nan)
    assert repr(Answer(a=many, few=many[:2])) == "a    10 float64 0 .. 8, 1 nan\nfew  [0, 1]"


def test_an_answer_of_evaluate_knows_what_it_was_asked_for():
    theta = np.linspace(0.0, 1.0, 5)
    found = dx.evaluate(["V_C"], theta=theta, omega0=1.0, **SIZES)
    assert found.inputs["theta"] is theta
    assert pickle.loads(pickle.dumps(found)).inputs["ec"] == 0.1
