"""Steady states and gradients against turns at 60 digits: presses, pumps, friction, unstable motions."""

import numpy as np
import pytest
from flint import arb

import desaxe as dx
from tests.design.steady.true_turns import Curve, Kloss, Machine, Table, truth
from tests.effort import cases

NUMBERS = ("ec", "AB", "BC", "m_rod", "m_slider", "I_crank", "I_rod", "r_rod", "g_Y", "F_Y", "mu")
KINDS = ("press", "pump", "cam", "table", "near", "unstable")


def machine(rng):
    """Inputs of a machine with a mean torque near 1 N m for its size; half of them with friction."""
    AB = rng.uniform(0.03, 0.08)
    BC = AB * rng.uniform(2.6, 5.0)
    return {
        "ec": rng.uniform(-0.25, 0.25) * AB, "AB": AB, "BC": BC, "m_rod": rng.uniform(0.2, 3.0),
        "m_slider": rng.uniform(0.5, 8.0), "I_crank": rng.uniform(0.05, 1.0), "I_rod": rng.uniform(0.0, 0.02),
        "r_rod": rng.uniform(0.2, 0.8) * BC, "g_Y": -9.81 * rng.integers(0, 2), "F_Y": 0.0,
        "mu": rng.uniform(0.01, 0.15) * rng.integers(0, 2),
    }  # fmt: skip


def load(rng, kind, inputs, branch, torque):
    """A table against the motion, with a share of the motor's torque in its mean."""
    AB, stroke = inputs["AB"], 2.0 * inputs["AB"]
    size = np.pi * torque / stroke * rng.uniform(0.2, 0.6)
    if kind == "unstable":
        size = np.pi * torque / (2.0 * stroke) * rng.uniform(0.55, 0.8)
    if kind in ("pump", "unstable", "near"):  # the same force against both strokes, or one of them
        back = size if kind == "unstable" else size * rng.integers(0, 2)
        return Table("outer", (0.0, stroke), (-size, -size), (back, back))
    if kind == "cam":
        x = tuple(np.sort(rng.uniform(0.2, 6.0, 5)).tolist())
        y = size * rng.uniform(-0.4, 0.4, 5)
        y = (*y[:4].tolist(), float(y[0]))
        return Table("theta", x, y, y)
    d = np.sort(rng.uniform(0.05, 0.95, 3)) * stroke
    against = tuple((size * np.array([0.3, 1.0, 0.6])).tolist())
    if rng.integers(0, 2):
        outer = bool(rng.integers(0, 2))
        out, back = ((0.0, 0.0, 0.0), against) if not outer else (tuple(-y for y in against), (0.0, 0.0, 0.0))
        return Table("outer" if outer else "inner", tuple(d.tolist()), out, back)
    middle = branch * np.sqrt(inputs["BC"] ** 2 - inputs["ec"] ** 2)
    return Table("Y", tuple((middle - AB + d).tolist()), tuple(-y for y in against), (0.0, 0.0, 0.0))


def drawn(seed):
    """A random machine: its kind, the inputs of both, and what makes the true one of its numbers."""
    rng = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    inputs, branch, way = machine(rng), int(rng.choice([1, -1])), int(rng.choice([1, -1]))
    if kind == "cam":
        way = 1
    top, torque = rng.uniform(8.0, 30.0), rng.uniform(20.0, 80.0)
    J = torque / top**2 * 10 ** rng.uniform(0.5, 2.0)
    slip, gear = rng.uniform(0.1, 0.35), rng.uniform(1.0, 12.0)
    if kind == "near":
        J = 4 * np.pi * torque / (slip * top**2 * 10 ** rng.uniform(-3.0, -1.5))
    own = load(rng, kind, inputs, branch, torque)
    numbers = {**inputs, "J": J}
    if kind == "table":
        speeds = sorted((way * top * np.array([0.0, 0.5, 0.8, 1.1])).tolist())
        torques = (way * torque * np.array([1.0, 1.3, 1.1, 0.0]))[::way].tolist()
        motor, true = dx.over_omega(speeds, torques), lambda values: Curve(speeds, torques)
    else:
        of_motor = {
            "breakdown_torque": torque / gear, "breakdown_slip": slip, "synchronous_speed": way * top * gear,
            "gear": gear,
        }  # fmt: skip
        motor, true = dx.kloss(**of_motor), Kloss
        numbers |= of_motor
    return kind, numbers, own, motor, lambda values: Machine(values, own, true(values), branch, way)


def called(numbers, own, motor, made):
    """The steady states of `desaxe`."""
    table = (own.places, own.outward, own.inward)
    if own.over == "Y":
        force = dx.over_Y(*table)
    elif own.over == "theta":
        force = dx.over_theta(own.places, own.outward, "linear")
    else:
        force = dx.over_stroke(*table, dead_centre=own.over)
    inputs = {name: numbers[name] for name in NUMBERS if name != "F_Y"}
    return dx.steady(torque=motor, flywheel_inertia=numbers["J"], F_Y=force, branch=made.branch, **inputs)


def check(seed):
    """Compare all motions of a machine; returns the largest errors of values and derivatives."""
    kind, numbers, own, motor, make = drawn(seed)
    made = make({name: arb(value) for name, value in numbers.items()})
    found = called(numbers, own, motor, made)
    worst, motions = [0.0, 0.0], [one for one in (found, *found["others"]) if one["status"] == 0]
    changing = [name for name, value in numbers.items() if value and name != "g_Y"]
    names = np.random.default_rng(seed).permutation(changing)[:2].tolist()
    for one in motions:
        multiplier, values, by = truth(make, numbers, one["omega"][0], one["multiplier"], names)
        assert abs(one["multiplier"] - multiplier) < 1e-9 * max(1.0, multiplier), seed
        power = abs(values["omega_mean"]) * np.abs(one["T_motor"]).max()
        for key, value in values.items():
            size = power if key == "power_mean" else abs(value)
            worst[0] = max(worst[0], abs(one[key] - value) / size)
            for name in names:
                slope = by[name][key]
                gap = abs(one["gradient"][key]["flywheel_inertia" if name == "J" else name] - slope)
                worst[1] = max(worst[1], gap / (abs(slope) + 1e-2 * size / abs(numbers[name])))
    return kind, motions, worst


@pytest.mark.sampled
def test_values_and_gradients_against_turns_at_sixty_digits():
    seen = set()
    for seed in range(cases(2, 6, 300)):
        kind, motions, worst = check(seed)
        assert worst[0] < 1e-9, (seed, kind, worst)
        assert worst[1] < 1e-8, (seed, kind, worst)
        seen |= {kind for _ in motions}
    assert seen
