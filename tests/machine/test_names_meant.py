"""A machine names the input or the method that was meant."""

import pickle

import pytest

import desaxe as dx

PRESS = dx.Machine(ec=0.01, AB=0.05, BC=0.2, m_slider=4.0)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("mslider", "did you mean m_slider?"),
        ("eccentricity", "did you mean ec?"),
        ("mcrank", "did you mean m_crank, which is not given?"),
        ("stroke", "it is a quantity, which machine.evaluate('stroke') gives"),
        ("omega", "did you mean omega, which is not given?"),
        ("zzz", "it has ec, AB, BC, m_slider"),
    ],
)
def test_an_input(name, words):
    with pytest.raises(KeyError) as caught:
        PRESS[name]
    assert str(caught.value) == f"a machine has no input {name!r}; {words}"
    assert name not in PRESS
    assert PRESS.get(name, 3.0) == 3.0


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("evalute", "; did you mean evaluate?"),
        ("AB", "; its inputs are machine['AB'] and so on"),
        ("stroke", "; it is a quantity, which machine.evaluate('stroke') gives"),
        ("T_in", "; it is a quantity, which machine.evaluate('T_in', theta=...) gives"),
        ("qqqq", ""),
    ],
)
def test_a_method(name, words):
    with pytest.raises(AttributeError) as caught:
        getattr(PRESS, name)
    assert str(caught.value) == f"a machine has no method {name!r}{words}"
    assert not hasattr(PRESS, name)
    assert pickle.loads(pickle.dumps(PRESS)) == PRESS
