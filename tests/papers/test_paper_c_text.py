"""Paper C: its headings, captions and driving torques."""

import re
from collections import Counter

from mpmath import mp, mpf

import desaxe as dx
from tests.papers import newton_euler_c as ne
from tests.papers import paper_c as C
from tests.papers.designs import close
from tests.papers.motion_c import drive, inertia
from tests.papers.proofs import proves
from tests.papers.states_c import STATES, at_rest, report
from tests.papers.test_paper_c_motion import pair

# --- driving torques, Sec. 3 ----------------------------------------------------------------------

SINUSOID = "T = 350 * (1 - cos(30t)). This gives an amplitude of 350 (1.4 times 250)"


def torque(t, degrees=False):
    """The printed torque at a time, N mm; 30t in radians or in degrees."""
    return C.printed_sinusoid(mpf(t), (lambda x: mp.cos(mp.radians(x))) if degrees else mp.cos)


@proves("C-sinusoid-amplitude", "correct", says=SINUSOID, cites="30t")
def test_sinusoid_of_radians():
    """Mean and amplitude as told, in radians, many periods in the time."""
    top, period = mp.pi / 30, 2 * mp.pi / 30
    amplitude = (torque(top) - torque(0)) / 2
    assert close(amplitude, mpf("1.4") * 250, 0, 30)
    assert all(torque(n / mpf(1000)) <= torque(top) for n in range(0, 2001, 7))
    periods = [2 / period, mpf(2)]
    return {
        "mean": [amplitude, (torque(top) + torque(0)) / 2, torque(top)],
        "period": period,
        "periods": periods,
    }


@proves("C-sinusoid-minimum", "correct", says="0")
def test_sinusoid_starts_at_its_least():
    assert torque(0) == 0 <= min(torque(n / mpf(1000)) for n in range(0, 2001, 7))
    assert close(torque(2 * mp.pi / 30), 0, 1, 30)
    return {"zero": 1 - mp.cos(0), "period": 2 * mp.pi / 30, "names": {}}


@proves("C-sinusoid-unit", "correct", says="cos(30t)", cites="30t")
def test_sinusoid_of_degrees():
    """Read in degrees the torque only rises, to half of the amplitude told, and the crank hardly turns."""
    ends = [torque(mpf(n) / 10, degrees=True) for n in range(21)]
    assert ends == sorted(ends)
    slow = drive(report(), lambda t: torque(t, degrees=True) / 1000, 2, 12, 8, 8)
    claimed = [torque(mp.pi / 30) / 2]
    return {
        "amplitude": claimed,
        "degrees": [ends[-1], mpf(2)],
        "radians": [*pair(("listed", "sinusoid")), mpf(2)],
        "slow": list(slow),
    }


@proves("C-motion-doubled", "correct", says="500")
def test_doubled_torque():
    assert C.TORQUES["3.2.2"] == 2 * C.TORQUES["3.1.1"]
    for state in STATES[:4]:
        free = at_rest(state)._replace(F_X=0.0, F_Y=0.0, g_X=0.0, g_Y=0.0)
        once, twice = (dx.evaluate("T_in", **free._replace(alpha=alpha)._asdict()) for alpha in (30.0, 60.0))
        assert close(mpf(twice), 2 * mpf(once), 0, 12)
    return {"doubled": 2 * mpf(C.TORQUES["3.1.1"]), "names": {}}


@proves("C-motion-percentage", "omission", says="250")
def test_constant_torque_has_no_steady_speed():
    """M omega^2/2 = T theta: the same work each turn for ever, and doubled torque sqrt(2) times the speed."""
    M_eff, T = inertia(report(), mpf(0))[0], mpf(250) / 1000
    for turns in (1, 2, 5):
        assert abs(inertia(report(), 2 * mp.pi * turns)[0] - M_eff) < mpf(10) ** -30
    theta = 2 * mp.pi
    slow, fast = (mp.sqrt(2 * one * theta / M_eff) for one in (T, 2 * T))
    work = T * theta
    assert close(M_eff * slow**2 / 2, work, 0, 30)
    names = {"T": T, "theta": theta, "M_eff": M_eff}
    return {"speed": slow, "factor": fast / slow, "work": [1000 * T, work], "turn": slow, "names": names}


# --- text -----------------------------------------------------------------------------------------


@proves("C-text-section-3.1", "typo", says="3.1", cites="3.2 3.2")
def test_section_3_1_twice():
    numbers = Counter(number for number, _ in C.HEADINGS)
    assert [number for number, count in numbers.items() if count > 1] == ["3.1"]
    assert C.HEADINGS[3][1] == C.HEADINGS[6][1] == "Constant Driving Torque"
    assert C.CONTENTS["3.2"] == "Sinusoidal Driving Force"
    assert "3.2" not in numbers


@proves("C-text-section-3.2.2", "typo", says="Section 3.2.2: Doubled Constant Torque", cites="3.1.2 3.2.1")
def test_section_3_2_2():
    printed = {title: number for number, title in C.HEADINGS}
    contents = {title: number for number, title in C.CONTENTS.items()}
    assert (printed["Doubled Constant Torque"], contents["Doubled Constant Torque"]) == ("3.2.2", "3.1.2")
    assert "3.2.1" not in printed.values()


@proves("C-text-driving-force", "typo", says="3.1 3.2", cites="9")
def test_driving_force():
    """No section drives by a force: each has a torque on the crank."""
    forces = {number for number, title in C.CONTENTS.items() if "Force" in title and number > "3"}
    assert forces == {"3.1", "3.2"}
    assert not [title for number, title in C.HEADINGS if "Force" in title and number > "3"]
    assert C.FIGURES[9][1] == "Sinusoidal Torque on input crank"


@proves("C-text-blue", "given", says="500", cites="7 8")
def test_colours_of_a_figure():
    """The caption is under the heading of the doubled torque, and only there two torques share a figure."""
    assert C.TORQUES["3.2.2"] == 500
    assert C.BLUE == "(Here, blue indicates plot for 500 N mm)"
    return {"other": mpf(C.TORQUES["3.1.1"])}


@proves("C-figure-1", "correct", says="0 90 180 270", cites="1")
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


@proves("C-figure-9", "correct", cites="3")
def test_caption_of_fig_9():
    """Of the three driving torques of Sec. 3 one varies, and the caption names that one."""
    assert torque("0.1") > 600
    assert all(caption == "Sinusoidal Torque on input crank" for caption in C.FIGURES[9])
    assert sorted(C.TORQUES.values()) == [250, 500]


@proves("C-figure-names", "omission")
def test_captions_do_not_tell_figures_apart():
    """Figures 5, 7 and 10 share a caption, and so do 6, 8 and 11: three torques, one name."""
    counts = Counter(under for _, under in C.FIGURES.values())
    assert sorted(counts.values(), reverse=True)[:3] == [3, 3, 1]
    return {
        "torques": [
            mpf(C.TORQUES["3.1.1"]),
            mpf(5),
            mpf(6),
            mpf(C.TORQUES["3.2.2"]),
            mpf(7),
            mpf(8),
            mpf(10),
            mpf(11),
        ]
    }
