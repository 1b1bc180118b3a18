"""Paper C: its listing line by line, what it computes, and the table of values printed after it."""

import itertools
import math

import numpy as np
import pytest
from mpmath import mp, mpf

import desaxe as dx
from tests.papers import newton_euler_c as ne
from tests.papers import paper_c as C
from tests.papers.states_c import report, symbols

LINES = C.scalars()
RUN = C.run_listing()
ANGLE = 11.1599368  # deg, as printed
RELEASED = report(alpha=C.CRANK_ACCELERATION)  # at rest, with the listing's alpha2
RIGHT_ARMS = C.corrected_listing()


@pytest.fixture(autouse=True)
def many_digits():
    with mp.workdps(2 * ne.DIGITS):
        yield


# --- dimensions and arms --------------------------------------------------------------------------


def test_lengths():
    """r and l are metres; the printed angle is the rod's at theta = 0 for an offset of 60 mm."""
    assert (LINES["r"], LINES["l"]) == (C.CRANK, C.ROD) == (140 * 1e-3, 310 * 1e-3)
    assert math.degrees(math.asin(C.ECCENTRICITY / LINES["l"])) == pytest.approx(ANGLE, abs=1e-7)
    assert LINES["l"] * math.sin(math.radians(ANGLE)) == pytest.approx(0.06, abs=1e-9)


def test_crank_angle():
    assert LINES["theta"] == 0
    phi = dx.evaluate("phi", theta=LINES["theta"], ec=C.ECCENTRICITY, AB=LINES["r"], BC=LINES["l"])
    assert math.degrees(phi) == pytest.approx(ANGLE, abs=1e-7)


ARM_SIGNS = {"R12x": -1, "R12y": -1, "R32x": 1, "R32y": 1, "R23x": -1, "R23y": 1, "R43x": 1, "R43y": -1}


@pytest.mark.parametrize("arm", ARM_SIGNS)
def test_arm(arm):
    """From the centre of mass to the joint; the crank's arms also away from theta = 0, where y is not 0."""
    for degrees in (0, 50, 200) if arm[1:] in ("12x", "12y", "32x", "32y") else (0,):
        printed = C.scalars(C.changed(theta=str(degrees)))[arm]
        true = symbols(report(theta=math.radians(degrees)))[arm]
        assert ARM_SIGNS[arm] * printed == pytest.approx(float(true), abs=1e-9)
        assert abs(printed) > 0.01 or (degrees, arm[3:]) == (0, "y")


def placements():
    """Slider right or left of the crank, its axis below or above: alpha2 as printed, at theta = 0."""
    for branch, ec in itertools.product((1, -1), (C.ECCENTRICITY, -C.ECCENTRICITY)):
        yield report(alpha=C.CRANK_ACCELERATION, branch=branch, ec=ec)


def signs_of(v):
    """Signs of the rod's arms and accelerations, from symbols or from the listing."""
    return {name: int(mp.sign(v[name])) for name in ("R23x", "R23y", "R43x", "R43y", "alpha3", "aG3x")}


def test_no_placement_has_the_printed_signs():
    """R43 = R23 holds nowhere; each placement contradicts at least two printed signs, or the text's -X."""
    printed, wrong = signs_of(LINES), {}
    for state in placements():
        v = symbols(state)
        assert abs(v["R43x"] + v["R23x"]) + abs(v["R43y"] + v["R23y"]) < mpf(10) ** -70
        away = {name for name, sign in signs_of(v).items() if sign != printed[name]}
        pushed = mp.sign(ne.by_theta(ne.slider, state)[1][0])  # the X direction that speeds the crank up
        assert abs(v["alpha3"]) == pytest.approx(LINES["alpha3"], rel=1e-4)
        wrong[state.branch, state.ec > 0] = away, int(pushed)
    assert wrong == {
        (1, True): ({"R23x", "R43y", "alpha3", "aG3x"}, -1),
        (1, False): ({"R23x", "R23y", "alpha3"}, 1),
        (-1, True): ({"R43x", "R43y"}, 1),
        (-1, False): ({"R23y", "R43x", "aG3x"}, -1),
    }


def test_force_sign():
    """Negative X, as the text has it, puts +50 into row 7; the static torques' signs need it too."""
    torques = {deg: ne.holding_torque(report(theta=math.radians(deg))) for deg in C.STATIC_TORQUES}
    assert all(torques[degrees] * printed > 0 for degrees, printed in C.STATIC_TORQUES.items())
    assert ne.holding_torque(report(F_Y=50.0)) == -torques[0] > 0
    assert LINES["Fpx"] == 50
    assert RUN["B"][6] == -50 == -ne.right_hand_side(report())[6]


# --- masses and moments of inertia ----------------------------------------------------------------

DENSITY, WIDTH, DEPTH, FACETS = 7801.0, 0.030, 0.020, 20  # steel; bars 30 x 20 mm with rounded, faceted ends
ROUND = 20000  # facets that are as good as round


def outline(length, facets=FACETS):
    """Corners of a bar whose ends are half polygons about its joints, anticlockwise, m."""
    turn = [math.pi * (n / (facets / 2) - 0.5) for n in range(facets // 2 + 1)]
    end = [(length / 2 + WIDTH / 2 * math.cos(t), WIDTH / 2 * math.sin(t)) for t in turn]
    return end + [(-x, -y) for x, y in end]


def bar(length, facets=FACETS):
    """Mass, moment of inertia about the long axis and about z, kg and kg m2."""
    area = long = across = 0.0
    corners = outline(length, facets)
    for (x, y), (p, q) in zip(corners, corners[1:] + corners[:1], strict=True):
        cross = x * q - p * y
        area += cross / 2
        long += cross * (y * y + y * q + q * q) / 12
        across += cross * (x * x + x * p + p * p) / 12
    sheet = DENSITY * DEPTH
    return sheet * area, sheet * (long + area * DEPTH**2 / 12), sheet * (long + across)


BARS = {"2": C.CRANK, "3": C.ROD}


@pytest.mark.parametrize("mass", ["m2", "m3"])
def test_mass_of_a_steel_bar(mass):
    """The digits need faceted ends; round ones make the bar 2 g heavier."""
    faceted, round_ends = (bar(BARS[mass[1]], facets)[0] for facets in (FACETS, ROUND))
    assert LINES[mass] == pytest.approx(faceted, abs=7e-5)
    assert round_ends == pytest.approx({"m2": 0.76557, "m3": 1.56127}[mass], abs=5e-6)
    assert round_ends - LINES[mass] > 1.7e-3


def test_mass_of_the_slider():
    """The density that fits the two bars makes the slider a whole number of cubic centimetres."""
    sheet = DEPTH * bar(C.CRANK)[0] / (DENSITY * DEPTH)  # volume of the crank's bar, m3
    assert 1e6 * LINES["m4"] / (LINES["m2"] / sheet) == pytest.approx(250, abs=0.03)


@pytest.mark.parametrize("inertia", ["IG2", "IG3"])
def test_inertia_is_about_the_long_axis(inertia):
    length, mass = BARS[inertia[2]], LINES["m" + inertia[2]]
    _, about_the_bar, about_z = bar(length)
    assert LINES[inertia] == pytest.approx(about_the_bar, rel=1e-4)
    _, round_long, round_z = bar(length, ROUND)
    assert round_long == pytest.approx({"IG2": 80.87e-6, "IG3": 167.07e-6}[inertia], abs=5e-9)
    assert round_z == pytest.approx({"IG2": 1770.5e-6, "IG3": 14608.4e-6}[inertia], abs=5e-8)
    assert about_z == pytest.approx({"IG2": 1758.88e-6, "IG3": 14559.33e-6}[inertia], rel=1e-5)
    assert about_z / LINES[inertia] == pytest.approx({"IG2": 21.8, "IG3": 87.3}[inertia], abs=0.05)
    thin = mass * length**2 / 12
    assert thin == pytest.approx({"IG2": 1247.4e-6, "IG3": 12488.7e-6}[inertia], rel=1e-4)
    assert thin / LINES[inertia] == pytest.approx({"IG2": 15.5, "IG3": 74.9}[inertia], abs=0.05)


# --- accelerations --------------------------------------------------------------------------------


def test_alpha2_is_the_start_of_a_free_mechanism():
    """Not equilibrium: what 50 N does to the undriven, weightless bars at rest."""
    free = report(I_crank=bar(C.CRANK)[2], I_rod=bar(C.ROD)[2])
    start = ne.holding_torque(free) / -ne.effective_inertia(free)
    assert float(start) == pytest.approx(76.6665, abs=1e-4)
    assert float(start) == pytest.approx(LINES["alpha2"], rel=5e-5)
    moved = free._replace(alpha=LINES["alpha2"])
    assert abs(ne.solve(moved)["T12"]) < 1e-4 * abs(ne.holding_torque(free))
    thin = free._replace(I_crank=C.CRANK_MASS * C.CRANK**2 / 12, I_rod=C.ROD_MASS * C.ROD**2 / 12)
    assert float(ne.holding_torque(thin) / -ne.effective_inertia(thin)) == pytest.approx(80.94, abs=0.01)
    listed = report()
    assert float(ne.holding_torque(listed) / -ne.effective_inertia(listed)) == pytest.approx(103.95, abs=0.01)


SIMILAR = {"aG2x": 0, "aG2y": 3e-5, "aG3x": 2e-4, "aG3y": 3e-5, "alpha3": 1e-4}
REVERSED = {"aG3x", "alpha3"}


@pytest.mark.parametrize("name", SIMILAR)
def test_acceleration(name):
    """What alpha2 does at rest, by the loop: size to four digits, sign as in the slider's placement."""
    true, sign = float(symbols(RELEASED)[name]), -1 if name in REVERSED else 1
    assert sign * LINES[name] == pytest.approx(true, rel=SIMILAR[name], abs=1e-12)
    assert true != 0 or name == "aG2x"


def test_alpha3_of_the_package():
    motion = {"theta": 0.0, "ec": C.ECCENTRICITY, "AB": C.CRANK, "BC": C.ROD, "omega": 0.0}
    alpha_BC = dx.evaluate("alpha_BC", alpha=LINES["alpha2"], **motion)
    assert alpha_BC == pytest.approx(LINES["alpha3"], rel=1e-4)
    assert -alpha_BC == pytest.approx(float(symbols(RELEASED)["alpha3"]), rel=1e-12)
    assert alpha_BC == pytest.approx(35.2893, abs=5e-5)
    assert LINES["alpha3"] / alpha_BC - 1 == pytest.approx(3.6e-5, abs=5e-7)


def test_R43x_must_follow_R23x():
    """With every other line put right, R43x = R23x leaves the matrix without an inverse."""
    held = C.corrected_listing(**C.HELD)
    assert np.linalg.matrix_rank(C.run_listing(held)["A"]) == 8
    kept = C.run_listing(C.corrected_listing(**C.HELD, R43x="R23x"))
    assert kept["R23x"] < 0
    assert np.linalg.matrix_rank(kept["A"]) == 7
    assert LINES["R43x"] == pytest.approx(float(symbols(report())["R43x"]), abs=1e-9)


def test_slider_acceleration_is_left_out():
    """The rod's middle moves half as fast along x as the slider where the pin moves across: aG4x = 2 aG3x."""
    v = symbols(RELEASED)
    assert LINES["aG4x"] == 0
    assert float(v["aG4x"]) == pytest.approx(2 * float(v["aG3x"]), rel=1e-12)
    assert float(v["aG4x"]) == pytest.approx(-2.1174, abs=5e-5)
    assert float(v["m4"] * v["aG4x"]) == pytest.approx(-4.13, abs=5e-3)
    motion = {"theta": 0.0, "ec": C.ECCENTRICITY, "AB": C.CRANK, "BC": C.ROD, "omega": 0.0}
    assert dx.evaluate("a_C", alpha=LINES["alpha2"], **motion) == pytest.approx(-2.1174, abs=5e-5)


# --- the system -----------------------------------------------------------------------------------

ROWS = ["row1", "row2", "row3", "row4", "row5", "row6", "row7", "row8"]
RIGHT_ROWS = [row for row in ROWS if row != "row3"]


def system_at(angle, listing=C.LISTING):
    """The listing's matrix and the paper's own for its own arms, at some crank angle."""
    names = C.run_listing(listing.replace("theta = 0;", f"theta = {angle};"))
    return names["A"], np.array(C.printed_matrix(names), float)


@pytest.mark.parametrize("row", RIGHT_ROWS)
def test_listing_matrix_row(row):
    mine, paper = system_at(35)
    assert mine[ROWS.index(row)].tolist() == paper[ROWS.index(row)].tolist()


def test_listing_matrix_row3():
    """-R32x for +R32x: with the printed R12 the crank's moments of F12 and F32 come out reversed."""
    mine, paper = system_at(35)
    assert (mine != paper).tolist() == [[(r, c) == (2, 3) for c in range(8)] for r in range(8)]
    assert mine[2, 3] == -paper[2, 3] != 0
    right = ne.matrix(report())
    assert RUN["A"][2, [1, 3]] == pytest.approx([0.07, -0.07])
    assert [float(right[2, column]) for column in (1, 3)] == pytest.approx([-0.07, 0.07])
    corrected = C.run_listing(RIGHT_ARMS)["A"]
    assert np.allclose(corrected, np.array(right.tolist(), float), rtol=0, atol=1e-9)


def test_listing_unknowns():
    assert C.rows(C.bracket("x")) == [list(C.UNKNOWNS)]
    assert C.LISTING.count("syms " + " ".join(C.UNKNOWNS)) == 1


def test_listing_right_hand_side():
    expected = C.printed_right_hand_side(LINES | {"FPx": LINES["Fpx"], "FPy": 0})
    assert RUN["B"].tolist() == expected


def test_listing_right_hand_side_is_broken():
    """The longest line breaks where a page would wrap it; a typed new line would start a second row."""
    lengths = {line: len(line) for line in C.LISTING.splitlines()}
    assert max(lengths, key=lengths.get).startswith("B= [")
    assert [len(row) for row in C.rows(C.bracket("B"))] == [7, 1]
    assert [len(row) for row in C.rows(C.bracket("A"))] == [8] * 8
    assert [len(row) for row in C.rows(C.bracket("B"), newline_ends_row=False)] == [8]


def test_listing_solution_is_a_compromise():
    """Rank 7 and no solution: pinv minimises the imbalance, 1.19 N m of it stay in the rod's moment."""
    A, B, x = RUN["A"], RUN["B"], RUN["x"]
    assert np.linalg.matrix_rank(A) == 7
    assert np.linalg.matrix_rank(np.column_stack([A, B])) == 8
    imbalance = A @ x - B
    assert imbalance[5] == pytest.approx(1.18868, abs=5e-6)
    assert abs(imbalance[5]) > 1.6 * abs(x[7])
    assert np.abs(imbalance).argmax() == 5
    null = np.linalg.svd(A)[2][-1]
    assert np.abs(A @ null).max() < 1e-12
    assert abs(null[7]) > 0.05  # T12 is not determined: any multiple of this may be added
    assert abs(x @ null) < 1e-9


def test_right_arms_need_no_compromise():
    names = C.run_listing(RIGHT_ARMS)
    assert np.linalg.cond(names["A"]) < 13
    assert names["x"] == pytest.approx(np.linalg.solve(names["A"], names["B"]), rel=1e-12)
    assert np.abs(names["A"] @ names["x"] - names["B"]).max() < 1e-12


# --- the table of values --------------------------------------------------------------------------

HELD = {
    "F12x": 50,
    "F12y": -9.8639,
    "F32y": 9.8639,
    "F43x": -50,
    "F43y": 9.8639,
}  # N, at rest


def of_the_listing(label):
    """The value that the listing computes for a row of the table."""
    return RUN["x"][C.UNKNOWNS.index("F14y" if label == "F14x" else label)]


@pytest.mark.parametrize("label", ["F12x", "F12y", "F32y", "F43x", "F43y"])
def test_value_is_the_listing_s_and_not_the_mechanism_s(label):
    assert of_the_listing(label) == pytest.approx(float(C.VALUES[label]), abs=5e-5)
    held = ne.solve(report())[label]
    assert float(held) == pytest.approx(HELD[label], abs=5e-5)
    assert abs(float(C.VALUES[label]) - held) > 0.4 * abs(held)


def test_value_F32x():
    """Row 1 and row 4 of its own system: F32x = -F12x."""
    assert of_the_listing("F32x") == pytest.approx(-float(C.VALUES["F32x"]), abs=5e-5)
    assert float(C.VALUES["F12x"]) + float(C.VALUES["F32x"]) == -96.6272
    assert RUN["B"][0] == 0
    assert float(ne.solve(report())["F32x"]) == pytest.approx(-50, rel=1e-12)


def test_value_F14x():
    """The system has no F14x; without friction it is zero. The number is F14y."""
    assert "F14x" not in C.UNKNOWNS
    assert of_the_listing("F14y") == pytest.approx(float(C.VALUES["F14x"]), abs=5e-5)
    assert C.VALUES["F14x"] == C.VALUES["F43y"]
    assert ne.solve(report())["F14x"] == 0


def test_value_T12():
    """The decimal point slipped: rows 2 and 3 with the table's own forces give -0.707 N m."""
    assert of_the_listing("T12") == pytest.approx(-0.70697, abs=5e-6)
    assert 10 * float(C.VALUES["T12"]) == pytest.approx(of_the_listing("T12"), abs=5e-5)
    by_hand = LINES["IG2"] * LINES["alpha2"] - 0.07 * (float(C.VALUES["F12y"]) - float(C.VALUES["F32y"]))
    assert by_hand == pytest.approx(-0.7070, abs=5e-5)
    assert float(ne.solve(report())["T12"]) == pytest.approx(-1.38095, abs=5e-6)


def test_table_does_not_solve_the_listing():
    """With its slips put right it is pinv's answer; as printed it is not even that."""
    printed = np.array([float(value) for value in C.VALUES.values()])
    mended = printed * [1, 1, -1, 1, 1, 1, 1, 10]
    assert mended == pytest.approx(RUN["x"], abs=1e-4)
    as_printed, after = (np.abs(RUN["A"] @ x - RUN["B"]) for x in (printed, mended))
    assert as_printed[[0, 2, 3]] == pytest.approx([96.627, 0.636, 96.663], abs=5e-4)
    assert as_printed[5] == pytest.approx(1.7101, abs=5e-5)
    assert after == pytest.approx(np.abs(RUN["A"] @ RUN["x"] - RUN["B"]), abs=1e-4)
    paper_row_3 = C.run_listing(C.LISTING.replace(C.ROW_3, C.CORRECTED_ROW_3))
    assert paper_row_3["x"][7] == pytest.approx(-0.28071, abs=5e-6)


def test_corrected_listing_holds_the_force():
    """Arms and signs put right, the listing at rest gives the static torque; with its alpha2 next to none."""
    names = C.run_listing(C.corrected_listing(**C.HELD))
    forces = ne.solve(report())
    assert names["x"] == pytest.approx([float(forces[name]) for name in C.UNKNOWNS], rel=1e-8)
    free = C.run_listing(C.corrected_listing(**C.FREE))
    assert free["x"][7] == pytest.approx(-5.6e-5, abs=5e-7)
    assert float(forces["T12"]) == pytest.approx(-50 * 0.14 * math.tan(math.asin(6 / 31)), rel=1e-12)
