"""The oracle of forces: friction found by trial, rest, and points without an answer."""

import itertools

import mpmath
import pytest

from desaxe.oracle.force_truth import (
    FORCES,
    MAGNITUDES,
    MASSES,
    OTHERS,
    SHAKING,
    TOUCHED,
    conditions,
    force_balances,
    force_names,
    truth,
    truth_all,
)
from desaxe.oracle.truth import LAW
from desaxe.oracle.truth import truth as kinematic_truth
from tests.oracle.force_points import AT_REST, PLAIN, POINTS, agree


def balances_by_trial(point):
    """The normal forces N at which a slider without friction, loaded with the friction of N, is pushed by N.

    What is left over is linear in N on either side of zero: its signs there and far away tell every root.
    """
    slides = mpmath.sign(truth("V_C", **point))

    def left_over(N):
        with mpmath.workdps(60):
            load = point["F_Y"] - mpmath.mpf(point["mu"]) * abs(N) * slides
            plain = truth_all(("N_C", "N_C_wrt_F_Y"), **point | {"mu": 0.0})
            return plain["N_C"] + plain["N_C_wrt_F_Y"] * (load - mpmath.mpf(point["F_Y"])) - N

    far, roots = mpmath.mpf(10) ** 9, []
    for end in (far, -far):
        low, high = left_over(mpmath.mpf(0)), left_over(end)
        if low * high < 0:
            roots.append(end * low / (low - high))
    return roots


STEEP = {"theta": 0.5, "ec": 3.5, "AB": 1.0, "BC": 5.0, "m_slider": 1.0, "m_rod": 0.5, "I_rod": 0.25}
SLIDING = [
    (1.0, 0.5, 20.0, 0.0, "one"),
    (1.0, 0.5, -20.0, 0.0, "one"),
    (-1.0, 0.5, 0.0, 20.0, "one"),
    (-1.0, 0.5, 0.0, -20.0, "one"),
    (1.0, 3.0, 20.0, 0.0, "none or two"),
    (1.0, 3.0, -20.0, 0.0, "none or two"),
    (-1.0, 3.0, 20.0, 0.0, "none or two"),
    (-1.0, 3.0, -20.0, 0.0, "none or two"),
]


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize(("omega", "mu", "F_X", "F_Y", "kind"), SLIDING)
def test_friction(omega, mu, F_X, F_Y, kind, branch):
    point = STEEP | {"omega": omega, "mu": mu, "F_X": F_X, "F_Y": F_Y, "branch": branch}
    roots = balances_by_trial(point)
    assert force_balances(**point) == len(roots)
    assert (len(roots) == 1) == (kind == "one")
    if len(roots) == 1:
        assert agree(truth("N_C", **point), roots[0], digits=40)
        friction = -mpmath.mpf(mu) * abs(roots[0]) * mpmath.sign(truth("V_C", **point))
        assert agree(truth("F_friction", **point), friction, digits=40)
    else:
        names = [*TOUCHED, *(f"{name}_wrt_mu" for name in TOUCHED)]
        assert all(map(mpmath.isnan, truth_all(names, **point).values()))


def test_every_kind_of_friction_is_among_these():
    points = [
        STEEP | {"omega": omega, "mu": mu, "F_X": F_X, "F_Y": F_Y, "branch": branch}
        for (omega, mu, F_X, F_Y, _), branch in itertools.product(SLIDING, (1, -1))
    ]
    counts = [force_balances(**point) for point in points]
    assert set(counts) == {0, 1, 2}
    pushes = {mpmath.sign(truth("N_C", **p)) for p, count in zip(points, counts, strict=True) if count == 1}
    assert pushes == {1, -1}


@pytest.mark.parametrize("mu", [0.5, 3.0])
@pytest.mark.parametrize("omega", [1.0, -1.0])
@pytest.mark.parametrize("F_X", [20.0, -20.0])
def test_what_friction_does_not_touch(mu, omega, F_X):
    """The frame feels no friction as a whole, where there is a balance of forces; energies know no forces."""
    point = STEEP | {"omega": omega, "F_X": F_X}
    balanced = force_balances(mu=mu, **point) == 1
    for name in {*FORCES} - {*TOUCHED, *MAGNITUDES}:
        if name in SHAKING and not balanced:
            assert mpmath.isnan(truth(name, mu=mu, **point))
            continue
        assert truth(name, mu=mu, **point) == truth(name, mu=0.0, **point)
        assert truth(f"{name}_wrt_mu", mu=mu, **point) == 0
        assert mpmath.isfinite(truth(f"{name}_wrt_BC", mu=mu, **point))


@pytest.mark.parametrize("omega", [1.0, -1.0])
@pytest.mark.parametrize("F_X", [1.0, -1.0])
@pytest.mark.parametrize("branch", [1, -1])
def test_at_the_border_of_jamming(F_X, omega, branch):
    """tan phi = 4/3 and mu = 3/4: the rod is parallel to what the guide can bear."""
    point = {"theta": 0.0, "ec": 4.0, "AB": 1.0, "BC": 5.0, "F_X": F_X, "omega": omega, "branch": branch}
    border, below, above = (force_balances(mu=mu, **point) for mu in (0.75, 0.75 - 2**-53, 0.75 + 2**-53))
    assert below == 1
    assert (border, above) in ((0, 0), (1, 2))
    assert border == len(balances_by_trial(point | {"mu": 0.75, "F_Y": 0.0}))
    assert {force_balances(mu=0.75, **point | {"F_X": x}) for x in (1.0, -1.0)} == {0, 1}


def test_which_way_it_slides():
    """As the motion; at rest as the motion that alpha starts; not if nothing moves, nor at a dead centre."""
    loads = {"F_X": 10.0, "mu": 0.25}

    def friction(**point):
        return truth("F_friction", **loads, **point)

    for omega, alpha in itertools.product((2.0, -2.0), (0.0, 100.0, -100.0)):
        value = friction(omega=omega, alpha=alpha, **PLAIN)
        assert mpmath.sign(value) == -mpmath.sign(truth("V_C", omega=omega, alpha=alpha, **PLAIN))
    for start in ({"omega": 0.0}, {"omega0": 0.0, **PLAIN, "theta": 0.0}):
        point = PLAIN | start
        for alpha in (100.0, -100.0):
            slope = truth("Y_wrt_theta", **point)
            assert mpmath.sign(friction(alpha=alpha, **point)) == -mpmath.sign(slope * alpha)
        assert friction(**point) == truth("F_friction_wrt_mu", **loads, **point) == 0
    dead_centre = {"theta": 0.0, "ec": 0.0, "AB": 0.125, "BC": 0.35, "omega": 2.0}
    assert friction(**dead_centre) == truth("T_in_wrt_mu", **loads, **dead_centre) == 0
    assert force_balances(**dead_centre, F_X=10.0, mu=100.0) == 1
    assert friction(**dead_centre | {"theta": 1e-300, "ec": 1e-300}) != 0


def test_the_sign_of_friction_where_nothing_pushes():
    """|N_C| at 0 from the right: a side load moves the friction as if the guide pushed along +X."""
    point = PLAIN | {"omega": 2.0, "mu": 0.25}
    assert truth("N_C", **point) == truth("F_friction", **point) == 0
    assert force_balances(**point) == 1
    right = truth("F_friction_wrt_F_X", **point)
    assert right != 0
    assert agree(right, truth("F_friction", F_X=-1.0, **point) / -1)


def test_at_rest():
    rest, slow = truth_all(force_names(), **AT_REST), truth_all(FORCES, **AT_REST, omega0=2.0**-120)
    for name in FORCES:
        assert agree(rest[name], slow[name], digits=30)
    assert rest["power_in"] == rest["kinetic_energy"] == rest["F_friction"] == 0
    assert agree(rest["power_in_wrt_omega0"], rest["T_in"])
    assert rest["power_in_wrt_alpha"] == mpmath.sign(rest["T_in"]) * mpmath.inf
    assert rest["T_in_wrt_omega0"] == rest["kinetic_energy_wrt_theta"] == 0
    theta = mpmath.mpf(AT_REST["theta"])
    assert agree(rest["T_in_wrt_alpha"], rest["M_eff"] + theta * rest["M_eff_wrt_theta"])
    state = AT_REST | {"omega": 0.0}
    assert agree(truth("T_in_wrt_alpha", **state), rest["M_eff"])
    assert agree(truth("T_in_wrt_omega_omega", **state), rest["M_eff_wrt_theta"])


def test_nothing_given_is_nothing_felt():
    moving = truth_all(force_names(), omega0=3.0, **PLAIN)
    assert all(moving[name] == 0 for name in FORCES)
    assert moving["F_C_X_wrt_F_X"] == 0
    assert moving["N_C_wrt_F_X"] == -1
    assert agree(moving["T_in_wrt_F_Y"], -truth("Y_wrt_theta", **PLAIN))
    assert agree(moving["F_A_X_wrt_m_slider"], moving["F_C_X_wrt_m_slider"])


def test_no_number_where_there_is_none():
    stalled = AT_REST | {"omega0": 1.0, "alpha": -0.75}
    apart, folded = AT_REST | {"ec": 0.25, "theta": 1.0}, AT_REST | {"theta": 0.0, "ec": 0.35}
    of_shape = {"M_eff", "potential_energy", *MASSES}
    for name in FORCES:
        for tail in ("", "_wrt_theta", "_wrt_m_crank"):
            assert mpmath.isnan(truth(name + tail, **stalled)) == (name not in of_shape), name
            for point in (apart, folded):
                assert mpmath.isnan(truth(name + tail, omega0=1.0, **point)) == (name not in MASSES), name
    assert force_balances(**stalled) is force_balances(**apart, omega0=1.0) is None
    assert agree(truth("M_eff", **stalled), truth("M_eff", **AT_REST))


def test_digits_asked_for():
    quick, slow = (truth("T_in_wrt_ec_m_rod", digits=digits, **POINTS[1]) for digits in (50, 500))
    with mpmath.workdps(600):
        assert 0 < abs(quick - slow) < abs(slow) * mpmath.mpf(10) ** -50


@pytest.mark.parametrize("name", ["Y", "a_C_wrt_ec", "omega_BC_wrt_omega0_theta"])
def test_kinematic_names_too(name):
    point = POINTS[1]
    motion = {p: point[p] for p in (*LAW, "branch")}
    assert truth(name, **point) == kinematic_truth(name, **motion)


def test_conditions():
    """A load on a mechanism without mass: T_in = -F_Y dY/dtheta."""
    point = PLAIN | {"omega0": 2.0, "F_Y": 3.0}
    assert conditions("T_in", **point) + 1 == pytest.approx(conditions("V_C", **point))
    assert conditions("T_in", others=OTHERS, **point) == pytest.approx(conditions("V_C", **point))
    assert conditions("V_C", others=OTHERS, **point) == conditions("V_C", **point)
    assert conditions("power_in", **point, r_rod=None) == pytest.approx(conditions("V_C", **point))
    assert conditions("T_in_wrt_F_Y", others=OTHERS, **point) == pytest.approx(conditions("T_in", **point))
    assert conditions("m_rotating", others=OTHERS, **AT_REST) > conditions("m_rotating", **AT_REST) > 0
    crank = PLAIN | {"m_crank": 2.0, "r_crank": 0.5, "omega": 3.0}
    assert conditions("kinetic_energy", others=("m_crank",), **crank) == 3
