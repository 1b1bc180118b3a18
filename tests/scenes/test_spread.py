"""The values of ranges: those of fractions, at every place, without fractions at every place."""

import random
from fractions import Fraction

import pytest

import desaxe as dx
from desaxe.scenes.reading import spread
from tests.effort import cases

SCENE = {
    "outputs": ["a_C"],
    "mechanism": {"ec": 0.01, "AB": 0.1, "BC": 0.3},
    "motion": {"omega0": 10.0},
}


def with_fractions(start, stop, steps):
    return (*(float(start + (stop - start) * k / steps) for k in range(steps)), float(stop))


def end(random):
    """A text's number: short, long, next to half way between two doubles, or far out."""
    kind = random.randrange(5)
    if kind == 0:
        return Fraction(random.randint(-1000, 1000), 10 ** random.randrange(6))
    if kind == 1:
        return Fraction(random.randint(-(10**40), 10**40), 10**40)
    if kind == 2:
        return random.randint(2**53, 2**55) + Fraction(
            random.choice([-1, 0, 1]), 2 ** random.randrange(1, 90)
        )
    if kind == 3:
        return Fraction(random.uniform(-1, 1) * 10.0 ** random.randint(-307, 307))
    return Fraction(random.randint(-5, 5)) * Fraction(2) ** random.randint(-1080, 1020)


@pytest.mark.sampled
@pytest.mark.parametrize("seed", range(cases(40, 1000)))
def test_every_value_is_the_double_next_to_it(seed):
    source = random.Random(seed)
    start, stop, steps = end(source), end(source), source.choice([1, 2, 3, 7, 64, 1000, 1 + 2**16])
    steps = min(steps, source.choice([1000, 1000, 1000, 70_000]))
    assert spread.spread(start, stop, steps) == with_fractions(start, stop, steps)


def test_half_way_between_two_doubles_goes_to_the_even_one():
    start, step = Fraction(1), Fraction(1, 2**53)
    assert spread.spread(start, start + 1000 * step, 1000) == with_fractions(start, start + 1000 * step, 1000)


@pytest.mark.parametrize("theta", [(0, 6), ("-0.3 rad", "400 deg"), ("0 deg", "360 deg"), (1e-9, -11.5)])
def test_fractions_are_taken_at_few_places(theta, monkeypatch):
    """A million values took seven seconds."""
    few, many = (
        {**SCENE, "motion": {"omega0": 10.0, "theta": {"start": theta[0], "stop": theta[1], "num": num}}}
        for num in (2, 200_001)
    )
    dx.scene(few)  # the units library takes fractions, too
    exact = []
    product = Fraction.__mul__
    monkeypatch.setattr(Fraction, "__mul__", lambda a, b: exact.append(b) or product(a, b))
    assert len(dx.scene(many).content.inputs["theta"]) == 200_001
    assert len(exact) < 1000


@pytest.mark.parametrize(
    ("steps", "count"),
    [
        ({"num": 100_000_001}, "100000001"),
        ({"num": 2**63 - 1}, "9.22e[+]18"),
        ({"step": 1e-8}, "600000001"),
        ({"step": 6e-8}, "100000001"),
        ({"step": -1e-300}, "6.00e[+]300"),
        ({"step": "1e-10 deg"}, "3437746770785"),
    ],
)
def test_too_many_values_are_counted(steps, count):
    scene = {**SCENE, "motion": {"omega0": 10.0, "theta": {"start": 0, "stop": 6, **steps}}}
    with pytest.raises(ValueError, match=rf"motion\.theta: {count} values are too many, at most 100000000"):
        dx.scene(scene)
