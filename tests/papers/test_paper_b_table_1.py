"""Paper B: the data of Table 1."""

import pytest
from mpmath import mp, mpf

import desaxe as dx
from tests.papers import curves_b as curves
from tests.papers import paper_b as B
from tests.papers.curves_b import SPEED, case_1, stroke
from tests.papers.designs import close
from tests.papers.designs_b import OFFSETS, TABLE_1
from tests.papers.proofs import proves, proves_each

K, C = TABLE_1["k"], TABLE_1["c"]
ROWS = {
    "B-table1-omega": "Angular Velocity [omega] 251 Rad/s",
    "B-table1-N": "Frequency [N] 2400 Rev/min",
    "B-table1-k": "Crank Length [k] 40 Mm",
    "B-table1-M_k": "Crank Mass [M_k] 0.2 Kg",
    "B-table1-c": "Length of Connecting Rod [c] 64 Mm",
    "B-table1-M_c": "Mass of Connecting Rod [M_c] 0.5 Kg",
    "B-table1-e": "Offset distance [e] 20 Mm",
    "B-table1-M_s": "Mass of Slider [M_s] 0.8 Kg",
    "B-table1-t": "Time range (t) 0.01 - 0.06 S",
}


@proves("B-claim-speed", "correct", says="2400 251")
@proves("B-table1-omega", "correct", says=ROWS["B-table1-omega"])
@proves("B-table1-N", "correct", says=ROWS["B-table1-N"])
def test_speed():
    exact = mpf(2400) * 2 * mp.pi / 60
    assert round(exact) == SPEED
    hertz = [mpf(2400) / 60, mpf(SPEED)]
    turn = [mpf(SPEED), 2 * mp.pi / SPEED]
    return {"exact": exact, "rpm": mpf(2400), "turn": turn, "hertz": hertz}


@proves_each(
    {"B-table1-k": "k", "B-table1-e": "e"},
    {"B-table1-k": "correct", "B-table1-e": "given"},
    says={key: ROWS[key] for key in ("B-table1-k", "B-table1-e")},
)
def test_table_1_turns(which):
    """Crank, rod and all three offsets make a mechanism that turns fully."""
    for margin, e in zip(margins(), OFFSETS, strict=True):
        result = dx.evaluate(("Y", "margin"), theta=0.3, ec=e, AB=K, BC=C, omega0=SPEED)["margin"]
        assert result == pytest.approx(float(margin) / 1000, abs=1e-15)
    names = {"c": mpf(64), "k": mpf(40)}
    assert names["k"] == stroke(0) / 2
    return {"limit": names["c"] - names["k"], "names": names} if which == "e" else {}


def margins():
    """Margin at each offset, mm."""
    return [mpf(64) - 40 - e for e in curves.OFFSETS]


@proves_each(
    {f"B-table1-{mass}": mass for mass in ("M_k", "M_c", "M_s")},
    "given",
    says={f"B-table1-{mass}": ROWS[f"B-table1-{mass}"] for mass in ("M_k", "M_c", "M_s")},
)
def test_table_1_masses(mass):
    """What the masses alone leave open: m_3 is anything between two bounds, and the torque with it."""
    q = case_1(mpf(1))
    weights = [
        B.Masses(mpf("0.2"), mpf("0.5"), mpf("0.8"), q.k / 2, share * q.c) for share in (0, mpf(1) / 2, 1)
    ]
    ends = [B.printed_eq34(q, w) for w in weights]
    both = B.printed_eq36(q, weights[1]), ends[1]
    assert all(
        close(result, want, 0, 30) for result, want in zip(both, curves.like(q, *curves.CENTRES), strict=True)
    )
    torques = [B.drive_torque(q, m_3) for m_3 in ends]
    assert close(torques[2] / torques[0], ends[2] / ends[0], 0, 30)
    return {"range": [ends[0], ends[2]]} if mass == "M_c" else {}


@proves("B-table-units", "typo")
def test_units_of_the_tables():
    """Mm is a megametre: with the printed units the crank pin would outrun light."""
    crank = mpf(40)
    assert crank * 10**6 * SPEED > 299792458
    return {"crank": crank}


@proves("B-table1-t", "correct", says=ROWS["B-table1-t"], cites="15 16")
def test_time_range():
    """Two turns, as Figs. 15 and 16 show."""
    assert (mpf("0.06") - mpf("0.01")) / (mpf(60) / 2400) == 2
