"""Wrong input to the design questions: one table of calls, the errors and their words."""

import math
import subprocess
import sys

import numpy as np
import pytest

import desaxe as dx

ROD = {"ec": 0.0, "AB": 0.1, "BC": 0.3}
PRESS = {"ec": 0.01, "AB": 0.05, "BC": 0.2, "omega0": 40.0, "m_slider": 2.0, "m_rod": 1.0, "F_Y": -500.0}
BODIES = {**PRESS, "F_Y": 0.0}
MACHINE = {"ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 150.0}
SPREAD = {**MACHINE, "theta": 1.0, "ec": dx.plus_minus(0.1, 1e-3)}
MOTOR = {**PRESS, "torque": dx.kloss(40.0, 0.15, 157.08, gear=12)}
del MOTOR["omega0"]
BEST = {"maximize": "stroke", "over": {"ec": (0, 0.1)}, "AB": 0.125, "BC": 0.35, "omega0": 157.08}
WISH = {"stroke": 0.1, "time_ratio": 1.2, "BC": 0.1}
THETA, SOME = np.linspace(0.0, 6.0, 90), np.ones(90)
DATA = {"theta": THETA, "a_C": SOME}
FIT = {"over": {"AB": 0.12, "ec": 0.0, "m_rod": 1.0}, "sigma": {"a_C": 5.0}, "BC": 0.35, "omega0": 150.0}
WHEEL = {**BODIES, "fluctuation": 0.02}
TWO, NAN = [0.1, 0.2], math.nan

TABLE = [  # a call and what is good for it; what is changed, the error and its words
    ((dx.events,), ROD, [
        ({"BC": 0.0}, ValueError, r"BC = 0\.0: it must be a finite length > 0"),
        ({"AB": -1.0}, ValueError, r"AB = -1\.0: it must be a finite length >= 0"),
        ({"ec": None}, TypeError, "events: ec is missing"),
        ({"branch": 2}, ValueError, "branch = 2"),
        ({"ec": "10 kg"}, ValueError, "ec = '10 kg': it must be a quantity in m"),
    ]),
    ((dx.feasibility,), ROD, [
        ({"BC": 0.0}, ValueError, r"BC = 0\.0: it must be a finite length > 0"),
        ({"ec": TWO, "AB": [0.1] * 3}, ValueError, "the shapes do not broadcast"),
    ]),
    ((dx.inverse,), {"Y": 0.3, "ec": 0.05, "AB": 0.125, "BC": 0.35}, [
        ({"Y": math.inf}, ValueError, "Y = inf: it must be a finite number"),
        ({"BC": 0.0}, ValueError, "BC = 0.0"),
        ({"branch": 2}, ValueError, "branch = 2"),
        ({"a_C": 1.0}, TypeError, "V_C is missing"),
    ]),
    ((dx.drive,), PRESS, [
        ({"fluctuation": 0}, ValueError, "fluctuation = 0"),
        ({"fluctuation": 2.5}, ValueError, "fluctuation = 2.5"),
        ({"fluctuation": "250 %"}, ValueError, "fluctuation = '250 %': it must be a number of at least 1e-9"),
        ({"fluctuation": "2 mm"}, ValueError, "fluctuation = '2 mm'"),
        ({"fluctuation": [0.1]}, ValueError, "fluctuation = "),
        ({"omega0": 0.0}, ValueError, "omega0 = 0"),
        ({"omega0": None}, TypeError, "omega0 is missing"),
        ({"AB": TWO}, TypeError, r"AB = \[0.1, 0.2\]: drive expects one number"),
        ({"omega": 3.0}, TypeError, "no input 'omega'"),
        ({"m_slidr": 3.0}, TypeError, "m_slider"),
        ({"m_slider": -1.0}, ValueError, "m_slider = -1.0"),
        ({"F_Y": lambda theta: np.zeros(3)}, ValueError, "F_Y"),
    ]),
    ((dx.harmonics, "Y"), ROD, [
        ({"ec": 0.23, "AB": 0.125, "BC": 0.35}, ValueError, r"harmonics: .* turn fully, margin = -0\.005"),
        ({"BC": None}, TypeError, "harmonics: BC is missing"),
    ]),
    ((dx.harmonics, "T_in"), BODIES, [
        ({"F_Y": [1.0, 2.0]}, TypeError, r"F_Y = \[1.0, 2.0\]: harmonics expects one number or a function"),
        ({"mu": 9.0}, ValueError, r"no value at theta = .* \(status 5\)"),
    ]),
    ((dx.harmonics, "a_C"), {**ROD, "omega0": 1.0}, [
        ({"alpha": 1.0}, TypeError, "no input 'alpha'"),
        ({"orders": 2.5}, ValueError, r"orders = 2\.5: a whole number"),
    ]),
    ((dx.harmonics, "status"), {**ROD, "omega0": 1.0}, [({}, ValueError, "status is not a real number")]),
    ((dx.counterweight,), BODIES, [
        ({"along": "Z"}, ValueError, "along = 'Z'"),
        ({"omega0": None}, ValueError, "omega0 is missing or 0"),
    ]),
    ((dx.drive,), WHEEL, [
        ({"F_Y": lambda theta: {}[theta]}, ValueError, r"function failed at theta = -?\d+[.]\d+: KeyError"),
        ({"F_Y": lambda theta: np.ones(3)}, ValueError, r"F_Y: a function of \d+ angles gave the shape"),
        ({"F_Y": lambda theta: np.nan}, ValueError, "F_Y: the function gave nan"),
        ({"fluctuation": 3}, ValueError, "fluctuation = 3"),
    ]),
    ((dx.synthesize,), WISH, [
        ({"AB": 0.1}, TypeError, "expected just one of BC, AB, max_pressure_angle, got BC and AB"),
        ({"BC": None}, TypeError, "got none"),
        ({"time_ratio": 0.9}, ValueError, "time_ratio = 0.9: the longer over the shorter"),
        ({"stroke": -1}, ValueError, "stroke = -1: it must be finite and more than 0"),
        ({"BC": None, "max_pressure_angle": "100 deg"}, ValueError, "at most pi/2"),
        ({"slow_stroke": 0}, ValueError, "slow_stroke = 0"),
        ({"stroke": "1 kg"}, ValueError, "stroke = '1 kg'"),
    ]),
    ((dx.optimize,), BEST, [
        ({"maximize": None}, TypeError, "say what to maximize"),
        ({"maximize": "strok"}, ValueError, "'strok' is not a quantity of a design; did you mean 'stroke'"),
        ({"maximize": ("absmax", "a_D")}, ValueError, "unknown quantity 'a_D'"),
        ({"maximize": "a_C"}, ValueError, r"did you mean \('absmax', 'a_C'\)\?"),
        ({"maximize": ("abs", "a_C")}, ValueError, r"did you mean \('absmax', 'a_C'\)\?"),
        ({"maximize": ("at", "60 mm", "Y")}, ValueError, "60 mm"),
        ({"maximize": ("rms", "Q")}, ValueError, "unknown quantity"),
        ({"maximize": lambda design: 3.0}, TypeError, "must give"),
        ({"over": {"ecc": (0, 1)}}, TypeError, "no input 'ecc'; did you mean ec"),
        ({"over": {"ec": (1, 0)}}, ValueError, r"over: ec = \(1, 0\): the lower bound first"),
        ({"over": {}}, ValueError, "over= is empty"),
        ({"over": {"ec": (0, math.inf)}}, ValueError, "expected two finite bounds"),
        ({"over": {"ec": 0}}, TypeError, "over: ec = 0: expected two finite bounds, the lower one first$"),
        ({"over": "ec"}, TypeError, "over = 'ec': expected a dict"),
        ({"keep": {"ec": (0, 1)}}, ValueError, "keep: ec is a parameter"),
        ({"keep": {"margin": (2, 1)}}, ValueError, r"keep: margin = \(2, 1\): the lower bound first"),
        (
            {"keep": {"margin": 0.005}},
            ValueError,
            r"""keep: margin = 0.005: a limit is \(0.005, None\), \(None, 0.005\) or \("==", 0.005\)""",
        ),
        ({"keep": ("margin", 0.005)}, TypeError, r"keep = \('margin', 0.005\): expected a dict"),
        ({"AB": None}, TypeError, "optimize: AB is missing"),
        ({"ec": 0.1}, ValueError, "ec is in over= and fixed"),
        ({"starts": 0}, ValueError, "starts = 0: a whole number, at least 1"),
        ({"points": 1}, ValueError, "points = 1: a whole number, at least 2"),
    ]),
    ((dx.design_map, "stroke"), ROD, [
        ({"BC": None}, TypeError, "design_map: BC is missing"),
        ({"ec": np.zeros((2, 2))}, ValueError, "ec: a grid takes numbers and 1-d arrays"),
        ({"theta": 0.0}, TypeError, "no input 'theta'"),
    ]),
    ((dx.design_map, "strokes"), ROD, [({}, ValueError, "did you mean 'stroke'")]),
    ((dx.tolerance, "a_C"), SPREAD, [
        ({"ec": 0.1}, ValueError, "every input is exact"),
        ({"ec": dx.plus_minus(0.1, -1e-3)}, ValueError, "ec: a tolerance of -0.001 is below 0"),
        ({"ec": dx.plus_minus(0.1, math.inf)}, ValueError, "ec = .*inf.*: expected two finite numbers"),
        ({"ec": dx.plus_minus(0.1, [1])}, ValueError, "ec = .*expected two finite numbers"),
        ({"ec": "0.1 m +- x %"}, ValueError, "ec = 'x '"),
        ({"ec": (0.1, 1e-3, 0)}, ValueError, r"expected a pair \(value, tolerance\)"),
        ({"ec": [0.1, 0.2, 0.3]}, ValueError, "a pair"),
        ({"AB": np.array(TWO)}, TypeError, "AB = .*tolerance expects a number, a value and tol"),
        ({"AC": 1.0}, TypeError, "no input 'AC'"),
        ({"distribution": "flat"}, ValueError, "distribution = 'flat'"),
        ({"samples": 1}, ValueError, "samples = 1"),
        ({"samples": "many"}, ValueError, "samples = 'many': a whole number"),
        ({"sigmas": NAN}, ValueError, "sigmas = nan"),
    ]),
    ((dx.tolerance, "T_in_wrt_ec"), {**SPREAD, "m_slider": 1.0}, [
        ({}, ValueError, "T_in_wrt_ec: its derivative with respect to ec is not derived"),
    ]),
    ((dx.tolerance, "stroke"), SPREAD, [({"omega0": None}, ValueError, "theta: stroke is of a whole turn")]),
    ((dx.tolerance, "a_D"), SPREAD, [({}, ValueError, "unknown quantity 'a_D'")]),
    ((dx.steady,), MOTOR, [
        ({"torque": None}, TypeError, "torque"),
        ({"torque": "many"}, (TypeError, ValueError), "torque"),
        ({"torque": lambda speed: 1.0}, TypeError, "omega, Y, s, V_C, but <lambda> has speed"),
        ({"torque": lambda t, theta, omega: t}, ValueError, "changes with t"),
        ({"torque": lambda omega: NAN}, ValueError, "finite"),
        ({"flywheel_inertia": -1.0}, ValueError, "flywheel_inertia = -1.0"),
        ({"fluctuation": 2.0}, ValueError, "fluctuation = 2.0"),
        ({"fluctuation": 0.1, "flywheel_inertia": 7.0}, ValueError, "give one of them"),
        ({"fluctation": 0.1}, TypeError, "did you mean fluctuation"),
        ({"alpha": 1.0}, ValueError, "alpha"),
        ({"AB": None}, TypeError, "AB"),
        ({"m_slidr": 1.0}, TypeError, "m_slider"),
        ({"F_Y": dx.over_theta([0, 1, 2], [1, 2, 1], period=5.0)}, ValueError, "turns"),
    ]),
    ((dx.over_omega, [0, 1], [1]), {}, [({}, ValueError, "2 speeds and 1 values")]),
    ((dx.over_omega, [1, 0], [1, 2]), {}, [({}, ValueError, "must ascend")]),
    ((dx.over_omega, [0, 1], [1, 2], "cubic"), {}, [({}, ValueError, "kind")]),
    ((dx.over_omega, [1], [1]), {}, [({}, ValueError, "at least two")]),
    ((dx.kloss,), {"breakdown_torque": 10, "breakdown_slip": 0.1, "synchronous_speed": 100}, [
        ({"breakdown_torque": 0}, ValueError, "breakdown_torque = 0"),
        ({"synchronous_speed": 0}, ValueError, "synchronous_speed = 0"),
        ({"breakdown_slip": -0.1}, ValueError, "breakdown_slip"),
        ({"gear": NAN}, ValueError, "gear"),
    ]),
    ((dx.fit, {"theta": [1.0, 2.0], "a_C": [NAN] * 2}), FIT, [({}, ValueError, "a_C has no finite sample")]),
    ((dx.fit, {"theta": [], "a_C": []}), FIT, [({}, ValueError, "a_C has no finite sample")]),
    ((dx.fit, {"theta": [1.0], "a_C": [1.0]}), FIT, [({}, ValueError, "1 samples for 3 unknowns")]),
    ((dx.fit, {"theta": [1.0, 2.0], "a_C": [1.0]}), FIT, [
        ({}, ValueError, "a_C has 1 samples, theta has 2"),
    ]),
    ((dx.fit, {"a_C": [1.0]}), FIT, [({}, TypeError, "one of theta and t")]),
    ((dx.fit, {"theta": THETA}), FIT, [({}, TypeError, "no measured quantity")]),
    ((dx.fit, {**DATA, "Y": SOME}), FIT, [({"sigma": None}, ValueError, "give the standard")]),
    ((dx.fit, {"theta": THETA, "b_C": SOME}), FIT, [({}, ValueError, "b_C")]),
    ((dx.fit, {"theta": THETA, "a_C": 1e200 * SOME}), FIT, [
        ({}, ValueError, "data: a_C: a sample beyond 1e[+]100"),
    ]),
    ((dx.fit, DATA), FIT, [
        ({"sigma": {"a_C": 0}}, ValueError, "a_C = 0"),
        ({"sigma": {"a_C": 1e-300}}, ValueError, "sigma: a_C = 1e-300: samples"),
        ({"sigma": {"a_C": 1e300}}, ValueError, "sigma: a_C = 1e[+]300: samples"),
        ({"loss": "square"}, ValueError, "loss = "),
        ({"nuisance": ["Y_bias"]}, ValueError, "Y_bias"),
        ({"over": {"AB": 0.5, "ec": 0.0}}, ValueError, "cannot be assembled"),
        ({"over": {"AB": (0.2, 0.1)}}, ValueError, "low must be below high"),
        ({"over": {"ec": (-1e300, 1e300)}}, ValueError, "^ec = .*at most 1e[+]60"),
        ({"over": {"ec": 1e300}}, ValueError, "^ec = .*at most 1e[+]60"),
        ({"over": {"AB": (1e-300, 1e-299)}}, ValueError, "over: AB = .*1e-100"),
    ]),
]  # fmt: skip


def rows():
    for (call, *given), good, changes in TABLE:
        for number, (change, error, words) in enumerate(changes):
            name = f"{type(call).__name__ if not hasattr(call, '__name__') else call.__name__}-{number}"
            yield pytest.param(call, given, {**good, **change}, error, words, id=name)


@pytest.mark.parametrize(("call", "given", "inputs", "error", "words"), [*rows()])
def test_wrong_input_is_named(call, given, inputs, error, words):
    with pytest.raises(error, match=words):
        call(*given, **inputs)


@pytest.mark.parametrize("seed", ["x", -1, 2**32, 1.5, None, True, [1]])
@pytest.mark.parametrize(
    ("call", "given", "inputs"),
    [
        (dx.fit, [DATA], {**FIT, "over": {"ec": 0.0}}),
        (dx.tolerance, ["a_C"], SPREAD),
        (dx.optimize, [], BEST),
    ],
    ids=["fit", "tolerance", "optimize"],
)
def test_a_seed_is_a_whole_number(call, given, inputs, seed):
    with pytest.raises(ValueError, match=r"seed = .*: a whole number, at least 0 and at most 4294967295"):
        call(*given, seed=seed, **inputs)


def test_without_a_package_one_line_says_what_to_install():
    code = "import sys; sys.modules['scipy'] = None; import desaxe as dx; dx.optimize"
    run = subprocess.run([sys.executable, "-c", code], check=False, capture_output=True, text=True)
    last = run.stderr.strip().splitlines()[-1]
    assert "optimize needs scipy" in last
    assert last.endswith("python -m pip install 'desaxe[design]'")
