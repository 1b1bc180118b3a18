"""Paper C: what its listing computes, the table of values, and the comparison with the simulation."""

import math

import numpy as np
from mpmath import mp, mpf

from tests.papers import newton_euler_c as ne
from tests.papers import paper_c as C
from tests.papers.bars_c import reconstructed, thin_rod
from tests.papers.designs import close
from tests.papers.proofs import proves, proves_each
from tests.papers.states_c import report, symbols

LINES, RUN = C.scalars(), C.run_listing()
FORCE = mpf(50)


def of_the_listing(label):
    """The value that the listing computes for a row of the table."""
    return mpf(float(RUN["x"][C.UNKNOWNS.index("F14y" if label == "F14x" else label)]))


def held(label):
    """An unknown of the mechanism held at rest against the force."""
    return ne.solve(report())[label]


def four_digits(value, printed):
    """True if a value is the printed one to its last digit."""
    return abs(value - mpf(printed)) <= mpf("5.1e-5")


LABELS = {f"C-value-{label}": label for label in ("F12x", "F12y", "F32y", "F43x", "F43y")}


@proves_each(
    LABELS,
    {key: "sign" if label == "F43x" else "wrong claim" for key, label in LABELS.items()},
    says={key: f"{label} = {C.VALUES[label]}" for key, label in LABELS.items()},
)
def test_value_is_the_listings_and_not_the_mechanisms(label):
    assert four_digits(of_the_listing(label), C.VALUES[label])
    true = held(label)
    assert abs(mpf(C.VALUES[label]) - true) > mpf("0.4") * abs(true)
    if label == "F43x":
        assert C.VALUES[label] == "50.00"
        return {"held": true, "force": [FORCE], "listed": mpf(LINES["Fpx"]), "names": symbols(report())}
    return {"held": true, "force": [FORCE]}


@proves("C-value-F32x", "sign", says=f"F32x = {C.VALUES['F32x']}", cites="1")
def test_value_F32x():
    """Row 1 and row 4 of its own system: F32x = -F12x."""
    computed = of_the_listing("F32x")
    assert four_digits(-computed, C.VALUES["F32x"])
    assert mpf(C.VALUES["F12x"]) + mpf(C.VALUES["F32x"]) < -96
    assert RUN["B"][0] == 0
    return {
        "listing": computed,
        "held": [held("F32x"), FORCE],
        "computed": computed,
        "names": symbols(report(omega=2.0)),
    }


@proves("C-value-F14x", "typo", says=f"F14x = {C.VALUES['F14x']}")
def test_value_F14x():
    """The system has no F14x; without friction it is zero. The number is F14y."""
    assert "F14x" not in C.UNKNOWNS
    computed = of_the_listing("F14y")
    assert four_digits(computed, C.VALUES["F14x"])
    assert C.VALUES["F14x"] == C.VALUES["F43y"]
    return {"listing": computed, "held": [held("F14y"), FORCE], "friction": held("F14x")}


@proves("C-value-T12", "wrong claim", says=f"T12 = {C.VALUES['T12']}", cites="2 3 C-listing-corrected")
def test_value_T12():
    """The decimal point slipped: rows 2 and 3 with the table's own forces give ten times the value."""
    computed = of_the_listing("T12")
    assert abs(10 * mpf(C.VALUES["T12"]) - computed) < mpf("5e-5")
    arm = mpf("0.07")
    by_hand = mpf(LINES["IG2"]) * mpf(LINES["alpha2"]) - arm * (mpf(C.VALUES["F12y"]) - mpf(C.VALUES["F32y"]))
    assert abs(by_hand - computed) < mpf("5e-5")
    return {"held": [held("T12"), FORCE], "listing": computed, "slip": 1000 * mpf(C.VALUES["T12"])}


@proves(
    "C-values-solve",
    "wrong claim",
    says="the eight values [as the solution of the system]",
    cites="1 4 3 6 3 2",
)
def test_table_does_not_solve_the_listing():
    """With its slips put right it is pinv's answer; as printed it is not even that."""
    printed = np.array([float(value) for value in C.VALUES.values()])
    mended = printed * [1, 1, -1, 1, 1, 1, 1, 10]
    assert np.allclose(mended, RUN["x"], rtol=0, atol=1e-4)
    as_printed, after = (np.abs(RUN["A"] @ x - RUN["B"]) for x in (printed, mended))
    assert np.allclose(after, np.abs(RUN["A"] @ RUN["x"] - RUN["B"]), rtol=0, atol=1e-4)
    rows = [mpf(float(as_printed[n])) for n in (0, 3, 2, 5)]
    paper_row_3 = C.run_listing(C.LISTING.replace(C.ROW_3, C.CORRECTED_ROW_3))
    mends = [mpf(float(mended[n])) for n in (2, 7)]
    return {
        "row_1": rows[0],
        "row_4": rows[1],
        "row_3": rows[2],
        "row_6": rows[3],
        "mends": mends,
        "mixed": mpf(float(paper_row_3["x"][7])),
    }


@proves("C-listing-corrected", "wrong claim", cites="3")
def test_corrected_listing_holds_the_force():
    """Arms and signs put right, the listing at rest gives the static torque; with its alpha2 next to none."""
    names = C.run_listing(C.corrected_listing(**C.HELD))
    forces = ne.solve(report())
    assert np.allclose(names["x"], [float(forces[name]) for name in C.UNKNOWNS], rtol=1e-8, atol=0)
    v = symbols(report())
    moving = symbols(reconstructed(alpha=C.CRANK_ACCELERATION))
    loop = {name: mp.nstr(moving[name], 17) for name in C.HELD}
    exact, rounded = (C.run_listing(C.corrected_listing(**C.FREE | own))["x"][7] for own in (loop, {}))
    assert abs(exact - moving["T12"]) < 1e-7
    thin = ne.solve(thin_rod(alpha=C.CRANK_ACCELERATION))["T12"]
    more = (
        v
        | symbols(report(theta=mpf("0.4")))
        | {
            "FPx": v["FPx"],
            "r": mpf(C.CRANK),
            "phi": mp.asin(mpf(C.ECCENTRICITY) / mpf(C.ROD)),
            "T12": forces["T12"],
        }
    )
    return {
        "force": v["FPx"],
        "T12": forces["T12"],
        "alpha2": mpf(C.CRANK_ACCELERATION),
        "released": mpf(float(exact)),
        "rounded": mpf(float(rounded)),
        "thin": thin,
        "names": more,
    }


@proves("C-listing-blind", "wrong claim", says="Fpx = 50; ... T12")
def test_listing_does_not_see_the_force():
    """T12 is the same for any Fpx: the rod's moment, as printed, sees only differences of F32 and F43."""
    forces, torque = ("0", "50", "-50", "5000"), mpf(float(RUN["x"][7]))
    for force in forces:
        names = C.run_listing(C.changed(Fpx=force))
        assert math.isclose(names["x"][7], float(torque), rel_tol=1e-9)
        assert math.isclose(names["x"][4], float(force), abs_tol=1e-9)
    once, twice = (ne.holding_torque(report(F_Y=force)) for force in (-50.0, -100.0))
    assert abs(twice - 2 * once) < mpf(10) ** -30
    names = {"r": mpf(C.CRANK), "phi": mp.asin(mpf(C.ECCENTRICITY) / mpf(C.ROD)), "FPx": mpf(-50)}
    return {
        "torque": torque,
        "tried": list(map(mpf, forces)),
        "held": once,
        "phi": mp.degrees(names["phi"]),
        "names": names,
    }


@proves("C-claim-equilibrium", "wrong claim", says="70.70")
def test_listing_is_not_in_equilibrium():
    """Five inertia terms are not zero; without them the listing as printed needs no torque for 50 N."""
    B = C.run_listing()["B"]
    assert (B != 0).tolist() == [False, True, True, True, True, True, True, False]
    resting = C.run_listing(C.changed(**C.HELD))
    assert resting["B"].tolist() == [0, 0, 0, 0, 0, 0, -50, 0]
    assert abs(resting["x"][7]) < 1e-10
    return {
        "held": [-1000 * held("T12"), held("T12")],
        "resting": [mpf(round(float(resting["x"][7]), 9)), FORCE],
    }


@proves("C-claim-similar", "wrong claim", says="70.70 70.5")
def test_agreement_is_a_slipped_point():
    computed, printed, simulated = (
        of_the_listing("T12") * 1000,
        1000 * mpf(C.VALUES["T12"]),
        mpf(C.STATIC_TORQUES[0]),
    )
    assert close(computed / simulated, 10, 0, 2)
    true = 1000 * ne.holding_torque(report())
    apart = 100 * (abs(printed / simulated) - 1)
    return {"computed": -computed, "held": [FORCE, -true, true / simulated], "apart": apart}


@proves("C-value-units", "correct")
def test_table_units():
    """F43x is the force in N; T12 of the listing follows from it and lengths in m."""
    twice = C.run_listing(C.corrected_listing(**C.HELD, Fpx="-100"))["x"]
    once = C.run_listing(C.corrected_listing(**C.HELD))["x"]
    assert math.isclose(once[4], -50)
    assert np.allclose(twice, 2 * once, rtol=1e-9)
    assert math.isclose(once[7], 0.14 * math.tan(math.radians(11.1599368)) * once[4], rel_tol=1e-8)


@proves("C-assumption-units", "wrong claim", cites="1")
def test_listing_is_in_metres():
    """With lengths in mm the moments of the force would be N mm; the listing's are N m and kg m2/s2."""
    names = C.run_listing(C.corrected_listing(**C.HELD))
    in_mm = C.run_listing(C.corrected_listing(**C.HELD, r="140", l="310"))
    assert np.allclose(in_mm["x"][:7], names["x"][:7], rtol=1e-9)
    assert math.isclose(in_mm["x"][7], 1000 * names["x"][7], rel_tol=1e-9)
    return {"metres": [mpf(names["r"]), mpf(names["l"])], "mm": [mpf(in_mm["r"]), mpf(in_mm["l"])]}


@proves("C-assumption-concentrated", "wrong claim")
def test_masses_are_not_concentrated():
    """Point masses at the centres have no inertia of their own; the bars' is a quarter of M_eff at 0 deg."""
    assert min(RUN["B"][2], RUN["B"][5]) > 0
    states = report(I_crank=0.0, I_rod=0.0), reconstructed(), thin_rod()
    points, bars, thin = map(ne.effective_inertia, states)
    assert (bars - points) / bars > mpf("0.25")
    return {"points": points, "bars": bars, "thin": thin}


@proves("C-kinematics", "not reproducible", says="1")
def test_kinematics_are_of_a_start_from_rest():
    """No speed fits aG2x = 0; at rest one alpha2 gives the others to four digits, but not aG4x = 0."""
    lines = {name: mpf(value) for name, value in C.scalars().items()}
    from_pin, from_rod = 2 * lines["aG2y"] / lines["r"], lines["alpha3"] / ne.rod_turning(report())[0]
    moving = report(omega=1.0, alpha=C.CRANK_ACCELERATION)
    assert ne.acceleration(ne.crank_centre, moving)[0] < 0 == lines["aG2x"]
    assert abs(ne.acceleration(ne.slider, report(alpha=C.CRANK_ACCELERATION))[0]) > 2
    errors = [from_pin / lines["alpha2"] - 1, abs(from_rod) / lines["alpha2"] - 1]
    return {"alpha2": mpf(C.CRANK_ACCELERATION), "errors": errors}
