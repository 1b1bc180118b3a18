"""The oracle against facts that it does not use: textbook formulas, symmetries, Euler's theorem, limits."""

import itertools
import math

import mpmath
import pytest

from desaxe.oracle.truth import (
    LAW,
    QUANTITIES,
    SECOND_ORDER,
    STATE,
    all_names,
    conditions,
    relative_error,
    truth,
    truth_all,
    ulp_error,
)
from tests.oracle.force_points import agree

POINTS = [
    {"theta": 1.047, "ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 157.08, "alpha": 0.0},
    {"theta": -2.5, "ec": -0.2, "AB": 0.125, "BC": 0.35, "omega0": -3.0, "alpha": -1.25, "branch": -1},
    {"theta": 0.3, "ec": 0.3, "AB": 0.5, "BC": 0.75, "omega0": 2.0, "alpha": -0.75},
    {"theta": 3.0, "ec": -0.125, "AB": 2.0, "BC": 1.0, "omega0": 0.5, "alpha": 4.0, "branch": -1},
]
STATE_POINT = {"theta": 2.0, "ec": 0.1, "AB": 0.125, "BC": 0.35, "omega": 5.0, "alpha": 4.0}
LAW_POINT = {"theta": 2.0, "ec": 0.1, "AB": 0.125, "BC": 0.35, "omega0": 3.0, "alpha": 4.0}
# Degrees in length and in 1/time.
DEGREES = {
    **dict.fromkeys(("phi", "delta", "transmission_angle", "pressure_angle"), (0, 0)),
    **dict.fromkeys(("Y", "s", "margin"), (1, 0)),
    **{"omega": (0, 1), "omega_BC": (0, 1), "alpha_BC": (0, 2)},
    **dict.fromkeys(("V_B_X", "V_B_Y", "V_B", "V_C"), (1, 1)),
    **{"a_B_X": (1, 2), "a_B_Y": (1, 2), "a_B": (1, 2), "a_C": (1, 2), "j_C": (1, 3)},
}
# What the mirror X -> -X leaves alone: theta, ec, omega0 and alpha change their signs with it.
EVEN = ("Y", "s", "V_B_Y", "V_B", "a_B_Y", "a_B", "V_C", "a_C", "j_C", "margin")
EVEN += ("transmission_angle", "pressure_angle")
MISSING = (
    "{name} has no degree: add it to DEGREES in {file} as powers of {units}, for example V_C: (1, 1); if the "
    "mirror X -> -X leaves it alone, to EVEN, too"
)


def degree(name):
    """The powers of length and of 1/time; the test says what to add where there are none."""
    assert name in DEGREES, MISSING.format(name=name, file=__file__, units="length and 1/time")
    return DEGREES[name]


def textbook(branch):
    """The closed forms of the books, as functions of (theta, ec, AB, BC, omega0, alpha)."""

    def parts(theta, ec, AB, BC, omega0, alpha):
        u = ec + AB * mpmath.sin(theta)
        root = mpmath.sqrt(BC * BC - u * u)
        speed = mpmath.sign(omega0) * mpmath.sqrt(omega0**2 + 2 * alpha * theta)
        return AB * mpmath.sin(theta), AB * mpmath.cos(theta), u, root, speed

    def slopes(*at):
        sine, cosine, u, root, speed = parts(*at)
        first = -sine - branch * u * cosine / root
        second = -cosine - branch * ((cosine**2 - u * sine) / root + u**2 * cosine**2 / root**3)
        return first, second, speed

    def alpha_BC(*at):
        sine, cosine, u, root, speed = parts(*at)
        return (at[5] * cosine - speed**2 * sine) / root + speed**2 * cosine**2 * u / root**3

    def a_C(*at):
        first, second, speed = slopes(*at)
        return speed**2 * second + at[5] * first

    return {
        "Y": lambda *at: parts(*at)[1] + branch * parts(*at)[3],
        "V_C": lambda *at: slopes(*at)[0] * slopes(*at)[2],
        "a_C": a_C,
        "omega_BC": lambda *at: parts(*at)[4] * parts(*at)[1] / parts(*at)[3],
        "alpha_BC": alpha_BC,
    }


@pytest.mark.parametrize("point", POINTS)
@pytest.mark.parametrize("name", SECOND_ORDER)
def test_textbook_formulas_differentiated_numerically(name, point):
    formula = textbook(point.get("branch", 1))[name]
    at = [mpmath.mpf(point[p]) for p in LAW]
    assert agree(truth(name, **point), formula(*at))
    with mpmath.workdps(100):
        for i, j in itertools.combinations_with_replacement(range(6), 2):
            first = tuple(int(k == i) for k in range(6))
            both = tuple(int(k == i) + int(k == j) for k in range(6))
            assert agree(truth(f"{name}_wrt_{LAW[i]}", **point), mpmath.diff(formula, at, first))
            assert agree(truth(f"{name}_wrt_{LAW[i]}_{LAW[j]}", **point), mpmath.diff(formula, at, both))


@pytest.mark.parametrize("point", POINTS)
@pytest.mark.parametrize("third", [("theta",) * 3, ("theta", "ec", "AB"), ("ec", "BC", "BC"), ("AB",) * 3])
def test_third_order(third, point):
    """The condition numbers of second sensitivities need it."""
    at = [mpmath.mpf(point[p]) for p in LAW]
    counts = tuple(third.count(p) for p in LAW)
    tail = "_wrt_" + "_".join(third)

    def phi(theta, ec, AB, BC, omega0, alpha):
        return mpmath.asin((ec + AB * mpmath.sin(theta)) / BC)

    with mpmath.workdps(150):
        assert agree(
            truth("Y" + tail, **point), mpmath.diff(textbook(point.get("branch", 1))["Y"], at, counts)
        )
        assert agree(truth("phi" + tail, **point), mpmath.diff(phi, at, counts))
    assert agree(truth("delta" + tail, **point), -truth("phi" + tail, **point))


@pytest.mark.parametrize("point", POINTS)
def test_closure_and_definitions(point):
    q = truth_all(QUANTITIES, **point)
    theta, ec, AB, BC = (mpmath.mpf(point[p]) for p in LAW[:4])
    branch = point.get("branch", 1)
    B_X, B_Y = AB * mpmath.sin(theta), AB * mpmath.cos(theta)
    assert agree(mpmath.hypot(ec + B_X, q["Y"] - B_Y), BC)
    assert mpmath.sign(q["Y"] - B_Y) == branch
    assert agree(mpmath.sin(q["phi"]) * BC, ec + B_X)
    assert agree(mpmath.cos(q["delta"]) * BC, ec + B_X)
    assert agree(branch * (q["Y"] + branch * q["s"]), mpmath.sqrt((AB + BC) ** 2 - ec**2))
    assert agree(q["V_B_X"], q["omega"] * B_Y)
    assert agree(q["V_B_Y"], -q["omega"] * B_X)
    assert agree(q["a_B_X"], point["alpha"] * B_Y - q["omega"] ** 2 * B_X)
    assert agree(q["a_B_Y"], -point["alpha"] * B_X - q["omega"] ** 2 * B_Y)
    assert agree(q["V_B"], mpmath.hypot(q["V_B_X"], q["V_B_Y"]))
    assert agree(q["a_B"], mpmath.hypot(q["a_B_X"], q["a_B_Y"]))
    assert agree(q["pressure_angle"], abs(q["phi"]))
    assert agree(q["transmission_angle"], mpmath.pi / 2 - abs(q["phi"]))
    assert q["margin"] == BC - AB - abs(ec)


@pytest.mark.parametrize("point", POINTS)
def test_rates_are_omega_times_total_slopes(point):
    omega = truth("omega", **point)
    chains = [
        ("Y", "V_C", "a_C", "j_C"),
        ("phi", "omega_BC", "alpha_BC"),
        ("V_B_X", "a_B_X"),
        ("V_B_Y", "a_B_Y"),
    ]
    for quantity, rate in itertools.chain.from_iterable(map(itertools.pairwise, chains)):
        assert agree(truth(rate, **point), omega * truth(f"{quantity}_wrt_theta", **point))
    assert agree(omega * truth("omega_wrt_theta", **point), point["alpha"])


@pytest.mark.parametrize("name", [*QUANTITIES, *(f"{q}_wrt_ec" for q in SECOND_ORDER)])
def test_law_follows_from_state(name):
    """omega0 = 3 and alpha = 4 give omega = 5 at theta = 2: the chain rule leads from one to the other."""
    joint = "_" if "_wrt_" in name else "_wrt_"
    law = {p: truth(name + joint + p, **LAW_POINT) for p in LAW}
    state = {p: truth(name + joint + p, **STATE_POINT) for p in STATE}
    assert truth("omega", **LAW_POINT) == 5
    assert agree(truth(name, **LAW_POINT), truth(name, **STATE_POINT))
    assert agree(law["theta"], state["theta"] + state["omega"] * 4 / 5)
    assert agree(law["omega0"], state["omega"] * 3 / 5)
    assert agree(law["alpha"], state["alpha"] + state["omega"] * 2 / 5)
    assert all(agree(law[p], state[p]) for p in ("ec", "AB", "BC"))


@pytest.mark.parametrize("point", POINTS)
@pytest.mark.parametrize("name", QUANTITIES)
def test_euler_homogeneity(name, point):
    """Scaling all lengths, and scaling time, multiplies a quantity by a known power; its slopes too."""
    length, frequency = degree(name)
    orders = ["_wrt_", *(f"_wrt_{p}_" for p in LAW)] if name in SECOND_ORDER else ["_wrt_"]
    for prefix in orders:
        given = prefix[5:-1]
        of_length = length - (given in ("ec", "AB", "BC"))
        of_time = frequency - {"omega0": 1, "alpha": 2}.get(given, 0)
        slope = {p: truth(name + prefix + p, **point) * mpmath.mpf(point[p]) for p in LAW}
        value = truth((name + prefix).removesuffix("_wrt_").removesuffix("_"), **point)
        if name != "delta" or given:
            assert agree(slope["ec"] + slope["AB"] + slope["BC"], of_length * value)
        assert agree(slope["omega0"] + 2 * slope["alpha"], of_time * value)


@pytest.mark.parametrize("point", POINTS)
def test_mirror(point):
    mirrored = point | {p: -point[p] for p in ("theta", "ec", "omega0", "alpha")}
    for name in all_names():
        quantity, _, tail = name.partition("_wrt_")
        if quantity == "delta":
            continue
        sign = 1 if quantity in EVEN else -1
        sign *= math.prod(-1 for p in tail.split("_") if p in ("theta", "ec", "omega0", "alpha"))
        message = f"{name}: {'in' if quantity in EVEN else 'not in'} EVEN of {__file__}: is that right?"
        assert agree(truth(name, **mirrored), sign * truth(name, **point)), message
    assert agree(truth("delta", **mirrored) + truth("delta", **point), mpmath.pi)


def test_a_missing_degree_names_what_to_add():
    with pytest.raises(
        AssertionError, match=r"spring_rate has no degree: add it to DEGREES in .*test_truth\.py"
    ):
        degree("spring_rate")


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("name", SECOND_ORDER)
def test_full_turn(name, branch):
    """2 pi is not a double: the rest of it is spanned by the Taylor polynomial."""
    point = STATE_POINT | {"branch": branch}
    turned = point | {"theta": point["theta"] + 2 * math.pi}
    h = mpmath.mpf(point["theta"]) + 2 * mpmath.pi - mpmath.mpf(turned["theta"])
    value, slope, curvature = (
        truth(name + tail, **turned) for tail in ("", "_wrt_theta", "_wrt_theta_theta")
    )
    assert agree(truth(name, **point), value + h * slope + h * h * curvature / 2, digits=40)


@pytest.mark.parametrize(
    ("name", "parity"), [("Y", -1), ("V_C", -1), ("a_C", -1), ("omega_BC", 1), ("alpha_BC", 1)]
)
def test_branches_are_mirror_images(name, parity):
    """Y -> -Y turns theta into pi - theta, backwards, and one branch into the other."""
    other = STATE_POINT | {"branch": -1, "omega": -5.0, "alpha": -4.0, "theta": math.pi - 2.0}
    h = mpmath.pi - 2 - mpmath.mpf(other["theta"])
    value, slope, curvature = (truth(name + tail, **other) for tail in ("", "_wrt_theta", "_wrt_theta_theta"))
    assert agree(parity * truth(name, **STATE_POINT), value + h * slope + h * h * curvature / 2, digits=40)


def test_stroke_starts_at_the_outer_dead_centre():
    concentric = {"ec": 0.0, "AB": 0.125, "BC": 0.35, "omega0": 1.0}
    assert truth("s", theta=0.0, **concentric) == 0
    assert 0 < truth("s", theta=math.pi, branch=-1, **concentric) < 1e-32
    assert agree(truth("s", theta=0.0, branch=-1, **concentric), 2 * mpmath.mpf(0.125))


def test_at_rest():
    lengths = {"theta": 1.0, "ec": 0.01, "AB": 0.125, "BC": 0.35}
    rest, moving = (
        truth_all(all_names(), omega0=0.0, **lengths),
        truth_all(all_names(), omega0=1.0, **lengths),
    )
    for name, (_, frequency) in DEGREES.items():
        assert agree(rest[name], 0 if frequency else moving[name])
    for name in ("V_C", "V_B", "omega", "omega_BC"):
        assert agree(rest[f"{name}_wrt_omega0"], moving[name])
        assert rest[f"{name}_wrt_alpha"] == mpmath.inf * mpmath.sign(moving[f"{name}_wrt_alpha"])
        assert rest[f"{name}_wrt_theta"] == 0
    assert agree(rest["a_C_wrt_alpha"], moving["a_C_wrt_alpha"])
    assert agree(rest["a_C_wrt_omega0_omega0"], 2 * moving["a_C"])
    assert rest["a_C_wrt_omega0"] == rest["j_C_wrt_alpha"] == rest["a_C_wrt_alpha_alpha"] == 0
    assert rest == truth_all(all_names(), omega0=-0.0, **lengths)


def test_starting_from_rest_under_acceleration():
    start = {"theta": 0.0, "ec": 0.01, "AB": 0.125, "BC": 0.35, "omega0": 0.0, "alpha": 2.0}
    slope, curvature = truth("Y_wrt_theta", **start), truth("Y_wrt_theta_theta", **start)
    assert agree(truth("a_C", **start), 2 * slope)
    assert agree(truth("a_C_wrt_theta", **start), 3 * 2 * curvature)
    assert agree(truth("V_C_wrt_omega0", **start), slope)
    assert truth("V_C_wrt_theta", **start) == -mpmath.inf
    state = start | {"omega": 0.0}
    assert agree(truth("j_C_wrt_omega", **state), 3 * 2 * curvature)
    assert truth("V_B_wrt_omega", **state) == 0.125


def test_no_number_where_there_is_none():
    lengths = {"ec": 0.1, "AB": 0.125, "BC": 0.35}
    stalled = {"theta": 1.0, "omega0": 1.0, "alpha": -0.75, **lengths}
    assert mpmath.isnan(truth("V_C", **stalled))
    assert mpmath.isnan(truth("omega", **stalled))
    assert truth("Y", **stalled) == truth("Y", theta=1.0, omega0=1.0, **lengths)
    assert mpmath.isnan(truth("Y", theta=1.0, **lengths | {"ec": 0.25}))
    assert mpmath.isnan(truth("V_C", theta=0.0, omega0=1.0, **lengths | {"ec": 0.35}))


def test_digits_asked_for():
    quick, slow = (truth("a_C_wrt_ec_AB", digits=digits, **POINTS[1]) for digits in (50, 500))
    with mpmath.workdps(600):
        assert 0 < abs(quick - slow) < abs(slow) * mpmath.mpf(10) ** -50
    assert truth("Y", theta=0.0, ec=0.0, AB=0.1, BC=0.7) == mpmath.mpf(0.1) + mpmath.mpf(0.7)


def test_conditions():
    point = POINTS[0]
    assert conditions("omega", **point) == conditions("margin", **point) == 1
    assert conditions("V_B", **point) == 2
    assert conditions("a_B", **point) == 3
    assert conditions("Y_wrt_alpha", **point) == 0
    assert conditions("V_C", **point | {"theta": 0.0, "ec": 0.0}) == math.inf
    near = {"theta": math.pi / 2, "ec": 0.225, "AB": 0.125, "BC": 0.35 + 2**-40, "omega0": 2.0}
    assert conditions("a_C", **near) < 10 < 1e11 < conditions("a_C", gap="ec", **near)
    assert conditions("phi", gap="ec", **point | {"theta": 0.0, "ec": 1e-9}) == pytest.approx(2)
    assert conditions("phi", **point | {"theta": 0.0, "ec": 1e-9}) > 1e8


def test_errors():
    assert ulp_error(1.0, mpmath.mpf(1)) == relative_error(1.0, mpmath.mpf(1)) == 0
    assert ulp_error(1.0, 1 + mpmath.mpf(2) ** -53) == 0.5
    assert ulp_error(1.0, 1 - mpmath.mpf(2) ** -53) == 1
    assert ulp_error(5e-324, mpmath.mpf(0)) == 1
    assert relative_error(1.1, mpmath.mpf(1)) == pytest.approx(0.1)
    assert relative_error(0.0, mpmath.mpf(0)) == 0
    assert relative_error(1e-300, mpmath.mpf(0)) == math.inf
    for error in (ulp_error, relative_error):
        assert error(math.nan, mpmath.nan) == error(math.inf, mpmath.inf) == 0
        assert error(math.nan, mpmath.mpf(1)) == error(1.0, mpmath.nan) == error(1.0, mpmath.inf) == math.inf
