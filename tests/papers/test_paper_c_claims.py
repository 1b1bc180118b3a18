"""Paper C: static torques, the comparison with them, driven motions, and the order of its text."""

import itertools
import math
import re
from collections import Counter

import numpy as np
import pytest
from mpmath import mp, mpf

import desaxe as dx
from desaxe.errata.ledger import entries
from tests.papers import newton_euler_c as ne
from tests.papers import paper_c as C
from tests.papers.motion_c import drive, inertia
from tests.papers.states_c import STATES, at_rest, report

PRINTED = np.array(list(C.STATIC_TORQUES.values()))  # N mm
ANGLES = np.radians(list(C.STATIC_TORQUES))
LENGTHS = {"AB": 1e3 * C.CRANK, "BC": 1e3 * C.ROD}  # mm: torques in N mm


@pytest.fixture(autouse=True)
def many_digits():
    with mp.workdps(2 * ne.DIGITS):
        yield


# --- Sec. 1: the static torques -------------------------------------------------------------------

HELD = {  # N mm, and how many times the printed one
    "deg0": (-1380.95, 19.59),
    "deg90": (-7000.00, 28.90),
    "deg180": (1380.95, 18.28),
    "deg270": (7000.00, 48.04),
}


@pytest.mark.parametrize("angle", HELD)
def test_static_torque(angle):
    """Against the torque that holds 50 N along -X: by virtual work, the eight equations and the package."""
    degrees, (value, ratio) = int(angle[3:]), HELD[angle]
    state = report(theta=math.radians(degrees))
    held = 1000 * ne.holding_torque(state)
    assert float(held) == pytest.approx(value, abs=5e-3)
    assert float(1000 * ne.solve(state)["T12"]) == pytest.approx(float(held), rel=1e-12)
    assert 1000 * dx.evaluate("T_in", **state._asdict()) == pytest.approx(float(held), rel=1e-12)
    assert float(held) / C.STATIC_TORQUES[degrees] == pytest.approx(ratio, abs=5e-3)


def test_opposite_angles_need_opposite_torques():
    """Constant forces anywhere, any lengths and masses: T(0) = -T(180) and T(90) = -T(270)."""
    for number, state in enumerate(map(at_rest, STATES[:8])):
        longer = state._replace(ec=0.3 * (-1) ** number, AB=0.2, BC=0.2 + 0.3 + 0.1 * (number + 1))
        torques = [ne.holding_torque(longer._replace(theta=mp.pi * quarter / 2)) for quarter in range(4)]
        sums = abs(torques[0] + torques[2]) + abs(torques[1] + torques[3])
        assert sums < mpf(10) ** -30 * max(map(abs, torques))
        assert min(map(abs, torques)) > 0
    sums = [float(PRINTED[0] + PRINTED[2]), float(PRINTED[1] + PRINTED[3])]
    assert sums == pytest.approx([5.04, -96.53], abs=1e-9)
    assert math.sqrt((sums[0] ** 2 + sums[1] ** 2) / 2) == pytest.approx(68.35, abs=5e-3)
    assert abs(sums[0] - sums[1]) > 100  # nor does a constant torque on top explain both


def reach(ec, tilt=0.0):
    """dx/dtheta of the slider and the rod's slope at the four angles; tilt: of the slider axis."""
    theta = ANGLES - tilt
    side = ec + LENGTHS["AB"] * np.sin(theta)
    along = np.sqrt(LENGTHS["BC"] ** 2 - side**2)
    return -LENGTHS["AB"] * (np.sin(theta) + side * np.cos(theta) / along), -side / along


def misfit(torque_per_newton):
    """The residual of the printed torques for the best force, N mm, and that force, N."""
    force = torque_per_newton @ PRINTED / (torque_per_newton @ torque_per_newton)
    return float(np.linalg.norm(force * torque_per_newton - PRINTED)), float(force)


def test_reach_is_the_loop_s():
    for ec in (60.0, -60.0):
        for degrees, value in zip(C.STATIC_TORQUES, reach(ec)[0], strict=True):
            state = report(theta=math.radians(degrees), ec=ec / 1000)
            assert value / 1000 == pytest.approx(float(ne.by_theta(ne.slider, state)[1][0]), rel=1e-12)


def by_offset(offsets):
    """The best force along X for the best of some offsets."""
    return min(misfit(-reach(ec)[0]) for ec in offsets)


def by_friction():
    """T = -F dx/dtheta / (1 - s mu slope): each position on either limit of friction, any mu."""
    return min(
        misfit(-speed / (1 - mu * np.array(sides) * slope))
        for ec in (60.0, -60.0)
        for mu in np.linspace(0.0, 1.1, 111)
        for speed, slope in [reach(ec)]
        for sides in itertools.product((1, -1), repeat=4)
    )


def by_tilt():
    """Crank angles counted from any other direction than the slider axis."""
    tilts = np.linspace(-np.pi, np.pi, 3601)
    return min(misfit(-reach(ec, tilt)[0]) for ec in (60.0, -60.0) for tilt in tilts)


def test_no_reading_gives_the_static_torques():
    """Root sum square of what remains of 300.99 N mm, and the size of the best force in N."""
    assert float(np.linalg.norm(PRINTED)) == pytest.approx(300.99, abs=5e-3)
    found = {
        "e below": by_offset([60.0]),
        "e above": by_offset([-60.0]),
        "any e": by_offset(np.linspace(-169.5, 169.5, 3391)),
        "friction": by_friction(),
        "tilt": by_tilt(),
    }
    assert {name: (round(rest, 1), round(abs(force), 2)) for name, (rest, force) in found.items()} == {
        "e below": (83.6, 1.43),
        "e above": (168.9, 1.23),
        "any e": (68.3, 1.39),
        "friction": (53.1, 1.23),
        "tilt": (45.5, 1.48),
    }
    ratios = PRINTED / [value for value, _ in HELD.values()]
    assert ratios.max() / ratios.min() == pytest.approx(2.63, abs=5e-3)  # nor one unit or length for all four


def test_four_free_numbers_fit_four_torques():
    """Force, rod, offset and tilt all free do fit, on the edge of assembly: not the report's mechanism."""
    force, rod, ec, tilt = -1.0428343400323759, 260.96813778554116, 120.85286011922257, 0.022403868254254933
    theta = ANGLES - tilt
    side = ec + LENGTHS["AB"] * np.sin(theta)
    speed = -LENGTHS["AB"] * (np.sin(theta) + side * np.cos(theta) / np.sqrt(rod**2 - side**2))
    assert -force * speed == pytest.approx(PRINTED, abs=1e-6)
    assert rod - LENGTHS["AB"] - ec == pytest.approx(0.115, abs=1e-3)
    assert abs(rod - LENGTHS["BC"]) > 45
    assert abs(ec - 60) > 60
    assert abs(force) < 50 / 45


# --- Sec. 2: assumptions and the comparison -------------------------------------------------------


def test_masses_are_not_concentrated():
    """Point masses at the centres have no inertia of their own; the bars' is a quarter of M_eff at 0 deg."""
    assert C.run_listing()["B"][[2, 5]] == pytest.approx([6.179e-3, 5.887e-3], rel=1e-3)
    points = report(I_crank=0.0, I_rod=0.0)
    bars = report(I_crank=1758.88e-6, I_rod=14559.33e-6)
    values = [float(ne.effective_inertia(state)) for state in (points, report(), bars)]
    assert values == pytest.approx([0.013169, 0.013285, 0.018012], abs=1e-6)
    assert (values[2] - values[0]) / values[2] == pytest.approx(0.269, abs=5e-4)


def test_listing_is_in_metres():
    """With lengths in mm the moments of the force would be N mm; the listing's are N m and kg m2/s2."""
    names = C.run_listing(C.corrected_listing(**C.HELD))
    in_mm = C.run_listing(C.corrected_listing(**C.HELD, r="140", l="310"))
    assert in_mm["x"][7] == pytest.approx(1000 * names["x"][7], rel=1e-12)
    assert in_mm["x"][:7] == pytest.approx(names["x"][:7], rel=1e-9)
    assert names["r"] == 0.14
    assert names["l"] == 0.31


def test_table_units():
    """F43x is the force in N; T12 of the listing follows from it and lengths in m."""
    twice = C.run_listing(C.corrected_listing(**C.HELD, Fpx="-100"))["x"]
    once = C.run_listing(C.corrected_listing(**C.HELD))["x"]
    assert once[4] == pytest.approx(-50)
    assert twice == pytest.approx(2 * once, rel=1e-9)
    assert once[7] == pytest.approx(0.14 * math.tan(math.radians(11.1599368)) * once[4], rel=1e-8)


def test_listing_is_not_in_equilibrium():
    """Five inertia terms are not zero; without them the listing as printed needs no torque for 50 N."""
    B = C.run_listing()["B"]
    assert (B != 0).tolist() == [False, True, True, True, True, True, True, False]
    resting = C.run_listing(C.changed(**C.HELD))
    assert resting["B"].tolist() == [0, 0, 0, 0, 0, 0, -50, 0]
    assert abs(resting["x"][7]) < 1e-10


def test_listing_does_not_see_the_force():
    """T12 is the same for any Fpx: the rod's moment, as printed, sees only differences of F32 and F43."""
    for force in ("0", "-50", "5000"):
        names = C.run_listing(C.changed(Fpx=force))
        assert names["x"][7] == pytest.approx(-0.70697, abs=5e-6)
        assert names["x"][4] == pytest.approx(float(force), abs=1e-9)
    held = [ne.holding_torque(report(F_Y=force)) for force in (-50.0, -100.0)]
    assert abs(held[1] - 2 * held[0]) < mpf(10) ** -30


def test_agreement_is_a_slipped_point():
    computed = 1000 * C.run_listing()["x"][7]
    printed = 1000 * float(C.VALUES["T12"])
    assert printed == pytest.approx(-70.70)
    assert abs(printed) / 70.5 - 1 == pytest.approx(0.0028, abs=5e-5)
    assert computed == pytest.approx(-706.97, abs=5e-3)
    assert computed / C.STATIC_TORQUES[0] == pytest.approx(10.03, abs=5e-3)
    held = float(1000 * ne.holding_torque(report()))
    assert held / printed == pytest.approx(19.53, abs=5e-3)


def test_kinematics_are_of_a_start_from_rest():
    """No speed fits aG2x = 0; at rest one alpha2 gives the others to four digits, but not aG4x = 0."""
    lines = C.scalars()
    from_pin, from_rod = 2 * lines["aG2y"] / lines["r"], lines["alpha3"] / ne.rod_turning(report())[0]
    assert from_pin / lines["alpha2"] - 1 == pytest.approx(1.7e-5, abs=5e-7)
    assert abs(float(from_rod)) / lines["alpha2"] - 1 == pytest.approx(3.6e-5, abs=5e-7)
    moving = report(omega=1.0, alpha=lines["alpha2"])
    assert float(ne.acceleration(ne.crank_centre, moving)[0]) == pytest.approx(-0.07, rel=1e-12)
    assert abs(ne.acceleration(ne.slider, report(alpha=lines["alpha2"]))[0]) > 2


# --- Sec. 3 ---------------------------------------------------------------------------------------


def test_sinusoid_of_radians():
    """Mean and amplitude 350 N mm, peak 700, period 0.209 s: 9.5 periods in 2 s."""
    t = np.linspace(0.0, 2.0, 20001)
    torque = C.printed_sinusoid(t, np.cos)
    assert (
        (torque.max() - torque.min()) / 2
        == pytest.approx(350, abs=1e-3)
        == pytest.approx(1.4 * 250, abs=1e-3)
    )
    assert torque.max() == pytest.approx(700, abs=2e-3)
    assert 2 * math.pi / 30 == pytest.approx(0.2094, abs=5e-5)
    assert C.printed_sinusoid(math.pi / 30, math.cos) == pytest.approx(700)


def test_sinusoid_starts_at_its_least():
    assert C.printed_sinusoid(0.0, math.cos) == 0
    assert C.printed_sinusoid(np.linspace(0.0, 2.0, 20001), np.cos).min() == 0
    assert C.printed_sinusoid(0.001, math.cos) > 0


def test_sinusoid_of_degrees():
    """Sixty degrees in 2 s: it only rises, to half of the amplitude claimed, and the crank turns 77 deg."""
    torque = C.printed_sinusoid(np.linspace(0.0, 2.0, 2001), lambda x: np.cos(np.radians(x)))
    assert (np.diff(torque) > 0).all()
    assert torque[-1] == pytest.approx(175, rel=1e-12)
    slow = drive(report(), lambda t: C.printed_sinusoid(mp.radians(t), mp.cos) / 1000, 2, 12, 8, 8)
    assert list(map(float, slow)) == pytest.approx([1.336, 1.706], abs=5e-4)


def test_doubled_torque():
    assert C.TORQUES["3.2.2"] == 2 * C.TORQUES["3.1.1"]
    for state in STATES[:4]:
        free = at_rest(state)._replace(F_X=0.0, F_Y=0.0, g_X=0.0, g_Y=0.0)
        once, twice = (dx.evaluate("T_in", **free._replace(alpha=alpha)._asdict()) for alpha in (30.0, 60.0))
        assert twice == pytest.approx(2 * once, rel=1e-12)


def test_constant_torque_has_no_steady_speed():
    """M omega^2/2 = T theta: 250 N mm add 1.57 J a turn for ever, doubled torque sqrt(2) times the speed."""
    assert 0.25 * 2 * math.pi == pytest.approx(1.571, abs=5e-4)
    for turns in (1, 2, 5):
        value = inertia(report(), 2 * mp.pi * turns)[0]
        assert abs(value - inertia(report(), mpf(0))[0]) < mpf(10) ** -30
        slow, fast = (mp.sqrt(2 * torque * 2 * mp.pi * turns / value) for torque in (0.25, 0.5))
        assert abs(fast / slow - mp.sqrt(2)) < mpf(10) ** -30
        assert float(slow) == pytest.approx(15.378 * math.sqrt(turns), rel=1e-4)


# --- text -----------------------------------------------------------------------------------------


def test_section_3_1_twice():
    numbers = Counter(number for number, _ in C.HEADINGS)
    assert [number for number, count in numbers.items() if count > 1] == ["3.1"]
    assert C.HEADINGS[3][1] == C.HEADINGS[6][1] == "Constant Driving Torque"
    assert C.CONTENTS["3.2"] == "Sinusoidal Driving Force"
    assert "3.2" not in numbers


def test_section_3_2_2():
    printed = {title: number for number, title in C.HEADINGS}
    contents = {title: number for number, title in C.CONTENTS.items()}
    assert (printed["Doubled Constant Torque"], contents["Doubled Constant Torque"]) == ("3.2.2", "3.1.2")
    assert "3.2.1" not in printed.values()


def test_driving_force():
    """No section drives by a force: each has a torque on the crank."""
    assert {number for number, title in C.CONTENTS.items() if "Force" in title and number > "3"} == {
        "3.1",
        "3.2",
    }
    assert not [title for number, title in C.HEADINGS if "Force" in title and number > "3"]
    assert C.FIGURES[9][1] == "Sinusoidal Torque on input crank"


def test_static_captions():
    """The angles of the captions are those of the table, the pin on the four sides of its centre."""
    angles = [
        [int(re.search(r"(\d+)deg", caption).group(1)) for caption in C.FIGURES[n]] for n in range(1, 5)
    ]
    assert angles == [[degrees, degrees] for degrees in C.STATIC_TORQUES]
    sides = [ne.pin(report(), mp.radians(degrees)) for degrees, _ in angles]
    assert [[round(float(part / C.CRANK)) for part in side] for side in sides] == [
        [1, 0],
        [0, 1],
        [-1, 0],
        [0, -1],
    ]


def test_caption_of_fig_9():
    """Of the three driving torques of Sec. 3 one varies, and the caption names that one."""
    t = np.linspace(0.0, 0.2, 201)
    assert np.ptp(C.printed_sinusoid(t, np.cos)) > 600
    assert all(caption == "Sinusoidal Torque on input crank" for caption in C.FIGURES[9])
    assert sorted(C.TORQUES.values()) == [250, 500]


def test_weights_are_left_out():
    """41.9 N of links beside a load of 50 N: held at 0 deg, the weights weigh more than the load."""
    weights = [9.81 * mass for mass in (C.CRANK_MASS, C.ROD_MASS, C.SLIDER_MASS)]
    assert weights == pytest.approx([7.5, 15.3, 19.1], abs=0.05)
    assert sum(weights) == pytest.approx(41.9, abs=0.05)
    alone = 1000 * ne.holding_torque(report(g_X=-9.81, F_Y=0.0))
    both = 1000 * ne.holding_torque(report(g_X=-9.81))
    assert float(alone) == pytest.approx(1595, abs=0.5)
    assert float(both) == pytest.approx(214, abs=0.5)
    assert float(1000 * ne.solve(report(g_X=-9.81))["T12"]) == pytest.approx(float(both), rel=1e-12)
    # By hand: for a small turn the pin rises by r, both centres by half of it, and the slider, on y = -e,
    # moves along x by -r tan(phi), where sin(phi) = e / BC.
    lifted = 1000 * (weights[0] + weights[1]) * C.CRANK / 2
    pushed = -1000 * C.FORCE * C.CRANK * C.ECCENTRICITY / np.sqrt(C.ROD**2 - C.ECCENTRICITY**2)
    torques = [held_by_the_printed_matrix([sign * weight for weight in weights]) for sign in (1, 0, -1)]
    assert torques == pytest.approx([pushed + lifted, pushed, pushed - lifted], rel=1e-12)
    assert [round(torque) for torque in torques] == [214, -1381, -2976]
    (entry,) = [entry for entry in entries("C") if entry.id == "C-weights"]
    assert "+m2*g, +m3*g and +m4*g to the right-hand side" in entry.corrected


def held_by_the_printed_matrix(weights):
    """T12 in N mm at 0 deg, at rest, with these terms on the right of the rows along Y."""
    pin = np.array([C.CRANK, 0.0])
    slider = np.array([C.CRANK + np.sqrt(C.ROD**2 - C.ECCENTRICITY**2), -C.ECCENTRICITY])
    crank, rod = pin / 2, (pin + slider) / 2
    arms = {"R12": -crank, "R32": pin - crank, "R23": pin - rod, "R43": slider - rod}
    parts = {f"{arm}{axis}": place[k] for arm, place in arms.items() for k, axis in enumerate("xy")}
    right = [0, weights[0], 0, 0, weights[1], 0, C.FORCE, weights[2]]
    return 1000 * np.linalg.solve(np.array(C.printed_matrix(parts), float), right)[-1]


def test_captions_do_not_tell_figures_apart():
    """Figures 5, 7 and 10 share a caption, and so do 6, 8 and 11: three torques, one name."""
    counts = Counter(under for _, under in C.FIGURES.values())
    assert sorted(counts.values(), reverse=True)[:3] == [3, 3, 1]


def test_point_A_is_two_points():
    """Force and output are at A, an end of "crank AB"; at either end 50 N along X need no torque at 0 deg."""
    named = [re.findall(r"(point|output|crank) (A\w?)", sentence) for sentence in C.SENTENCES]
    assert named == [[("point", "A")], [("crank", "AB")], [("output", "A")]]
    assert all("Slider D" in C.FIGURES[number][1] for number in (5, 6, 7, 8, 10, 11))
    assert abs(ne.by_theta(ne.pin, report())[1][0]) < mpf(10) ** -30
    assert abs(ne.by_theta(ne.slider, report())[1][0]) > 0.02
    assert C.STATIC_TORQUES[0] != 0
