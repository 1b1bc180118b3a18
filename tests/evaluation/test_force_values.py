"""Every force, torque and energy and its sensitivities at generic points, against the truth.

Errors are at most 1e-13 of the value, or 8 ulp x (1 + sum of the condition numbers) with respect to all
inputs: a force is a sum of what masses, loads and motion cause, which may nearly balance.
"""

import math
import random
from functools import partial
from itertools import product

import numpy as np
import pytest

import desaxe as dx
from desaxe.oracle.force_truth import (
    OTHERS,
    PARAMETERS,
    SHAKING,
    STATE_PARAMETERS,
    conditions,
    force_balances,
    force_names,
    truth_all,
)
from tests.effort import cases, first
from tests.evaluation import test_values as values_of
from tests.points import draw

misses = partial(values_of.misses, truth_all=truth_all, conditions=partial(conditions, others=OTHERS))
CENTRES = ("r_crank", "r_rod")
WORDS = {0: 5, 1: 0, 2: 6}  # how many balances of forces there are -> status


def bodies(rng, kind, AB, BC):
    """Masses, centres of mass anywhere along the links, loads and friction."""
    result = {name: rng.uniform(0.1, 3.0) for name in ("m_crank", "m_rod", "m_slider")}
    result |= {"I_crank": 3e-2 * rng.random(), "I_rod": 3e-2 * rng.random()}
    result |= {"r_crank": AB * rng.uniform(-0.8, 1.2), "r_rod": BC * rng.uniform(-0.2, 1.2)}
    result |= {name: rng.uniform(-200.0, 200.0) for name in ("F_X", "F_Y")}
    result |= {name: rng.uniform(-10.0, 10.0) for name in ("g_X", "g_Y")}
    result["mu"] = rng.uniform(0.02, 0.3) if kind == "friction" else 0.0
    if kind == "default_centres":
        for name in CENTRES:
            del result[name]
    if kind == "loads alone":
        result = {name: result[name] for name in ("F_X", "F_Y", "mu")}
    return result


def points(geometry, kind, count):
    """Points of one kind of mechanism or motion, with bodies of one kind."""
    rng = random.Random(f"forces: {geometry} {kind}")
    for point in draw(geometry, count):
        yield point | bodies(rng, kind, point["AB"], point["BC"])


def names_for(point):
    return force_names(STATE_PARAMETERS if "omega" in point else PARAMETERS)


KINDS = ("smooth", "friction", "default_centres", "loads alone")
GEOMETRIES = ("generic", "branch -1", "long crank", "concentric", "backwards", "slowing down")
STATES = ("state", "state at rest", "state that starts", "at rest", "from rest")


PAIRS = {(name, KINDS[k % 4]): None for k, name in enumerate((*GEOMETRIES, *STATES))}  # then all others
PAIRS |= dict.fromkeys(product((*GEOMETRIES, *STATES), KINDS))


@pytest.mark.sampled
@pytest.mark.parametrize(("geometry", "kind"), first(len(GEOMETRIES) + len(STATES), PAIRS))
def test_values_and_all_first_sensitivities(geometry, kind):
    for point in points(geometry, kind, cases(1, 5)):
        assert not misses(dx.evaluate(names_for(point), **point), point), point


@pytest.mark.parametrize("parameter", ["AB", "BC"])
def test_a_derivative_that_moves_a_centre_alone(parameter):
    """Asked for by itself, it may need how the centre of mass moves, though not where that is."""
    for point in points("slowing down", "default_centres", 2):
        for name in (name for name in force_names() if name.endswith(f"_wrt_{parameter}")):
            assert not misses({name: dx.evaluate(name, **point)}, point), (name, point)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["smooth", "friction", "default_centres"])
def test_a_kernel_is_as_right_as_a_point(kind):
    """The same through the compiled loop; the sensitivities of the torque stand for all."""
    rows = list(points("generic", kind, 12))
    names = [name for name in names_for(rows[0]) if "_wrt_" not in name or name.startswith("T_in")]
    columns = {name: np.tile([row[name] for row in rows], 200) for name in rows[0] if name != "branch"}
    answers = dx.evaluate(names, **columns)
    for index, row in enumerate(rows):
        assert not misses({name: float(column[index]) for name, column in answers.items()}, row), row


def rough(count):
    """Points with so much friction that forces may not balance, or balance in two ways."""
    for number, point in enumerate(points("long crank", "friction", count)):
        yield point | {"mu": 2.0 ** (number % 9 - 4)}


def test_how_many_balances_of_forces_there_are():
    result = {0: 0, 1: 0, 2: 0}
    for point in rough(150):
        balances = force_balances(**point)
        forces = ["N_C", "T_in", *SHAKING, *(f"{name}_wrt_{p}" for name in SHAKING for p in ("ec", "F_X"))]
        answer = dx.evaluate([*forces, "status"], **point)
        assert answer["status"] == WORDS[balances], point
        assert {math.isnan(answer[name]) for name in forces} == {balances != 1}
        result[balances] += 1
    assert min(result.values()) > 10


def test_values_with_much_friction():
    for point in rough(24):
        names = [name for name in names_for(point) if "_wrt_" not in name or "_wrt_mu" in name]
        assert not misses(dx.evaluate(names, **point), point), point


def test_friction_in_arrays_tells_its_status_and_disturbs_nothing_else():
    rows = list(rough(150))
    columns = {name: np.array([row[name] for row in rows]) for name in rows[0] if name != "branch"}
    for branch in (1, -1):
        answers = dx.evaluate(["T_in", "status"], **columns, branch=branch)
        singles = [dx.evaluate(["T_in", "status"], **row | {"branch": branch}) for row in rows]
        assert answers["status"].tolist() == [single["status"] for single in singles]
        np.testing.assert_allclose(answers["T_in"], [single["T_in"] for single in singles], rtol=1e-11)


def test_status_knows_of_friction_only_where_it_is_asked_about():
    point = {"theta": 0.2, "ec": 0.3, "AB": 0.125, "BC": 0.35, "omega0": 1.0, "F_X": 1.0}
    rough = point | {"mu": 4.0}
    assert force_balances(**rough) == 0
    assert dx.evaluate("status", **point) == 0
    assert dx.evaluate(["status", "V_C"], **point)["status"] == 0
    assert dx.evaluate("status", **rough) == 5
    assert dx.evaluate(["status", "N_C"], **rough)["status"] == 5
    assert dx.evaluate(["status", "N_C"], **point) == {"status": 0, "N_C": -1.0}


MACHINE = {"ec": 0.02, "AB": 0.125, "BC": 0.35, "m_rod": 0.7, "m_slider": 0.9, "g_Y": -9.81, "F_Y": -50.0}
LAW_OF_MOTION = {"theta": 1.0, "omega0": 10.0, "alpha": 3.0}
FORCES = [name for name in names_for({}) if "_wrt_" not in name]
OF_LINKS = ("m_rotating", "m_reciprocating", "I_lumping")


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("change", "status"), [({"ec": 0.3, "theta": math.pi / 2}, 1), ({"alpha": -60.0}, 3)]
)
@pytest.mark.parametrize("bodies", [MACHINE, {n: MACHINE[n] for n in ("ec", "AB", "BC", "F_Y")}])
def test_there_are_no_forces_without_a_mechanism_in_motion(change, status, bodies):
    """Nor where masses that are 0 leave nothing of the formula that would know."""
    point = bodies | LAW_OF_MOTION | change
    finite = OF_LINKS if status == 1 else (*OF_LINKS, "M_eff", "potential_energy")
    assert dx.evaluate(["T_in", "status"], **point)["status"] == status
    for name in names_for(point):
        if name.partition("_wrt_")[0] not in finite:
            assert math.isnan(dx.evaluate(name, **point)), name
            array = dx.evaluate(name, **point | {"theta": np.array([point["theta"], 0.1])})
            assert np.isnan(array).tolist() == [True, status == 3 and point["alpha"] * 0.1 < -50], name


@pytest.mark.parametrize(
    ("name", "value", "limit"),
    [
        ("m_rod", -0.1, "a finite mass >= 0"),
        ("I_crank", -1e-9, "a finite moment of inertia >= 0"),
        ("mu", -0.2, "a finite number >= 0"),
        ("r_rod", math.inf, "a finite number"),
        ("F_Y", math.nan, "a finite number"),
    ],
)
def test_a_bad_load_is_refused(name, value, limit):
    with pytest.raises(ValueError, match=f"{name} = {value}: it must be {limit}"):
        dx.evaluate("T_in", **LAW_OF_MOTION | MACHINE | {name: value})
    column = np.array([value, 0.01])
    result = dx.evaluate(["T_in", "status"], **LAW_OF_MOTION | MACHINE | {name: column})
    assert (result["status"].tolist(), np.isnan(result["T_in"]).tolist()) == ([4, 0], [True, False])


def test_a_centre_of_mass_that_is_not_given_is_halfway_and_moves_with_its_link():
    given = LAW_OF_MOTION | MACHINE
    names = ["T_in", "T_in_wrt_BC", "T_in_wrt_r_rod"]
    free, held = dx.evaluate(names, **given), dx.evaluate(names, **given, r_rod=0.175, r_crank=0.0625)
    assert free["T_in"] == pytest.approx(held["T_in"], rel=1e-14)
    assert free["T_in_wrt_r_rod"] == pytest.approx(held["T_in_wrt_r_rod"], rel=1e-13)
    moved = held["T_in_wrt_BC"] + held["T_in_wrt_r_rod"] / 2
    assert free["T_in_wrt_BC"] == pytest.approx(moved, rel=1e-13)
    assert free["T_in_wrt_BC"] != pytest.approx(held["T_in_wrt_BC"], rel=1e-3)


def test_an_input_that_there_is_not():
    with pytest.raises(TypeError, match=r"peak\(\) has no input 'm_piston'"):
        dx.peak("T_in", **MACHINE, omega0=1.0, m_piston=2.0)
