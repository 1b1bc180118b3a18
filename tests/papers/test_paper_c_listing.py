"""Paper C: its listing line by line."""

import itertools

import numpy as np
from mpmath import mp, mpf

import desaxe as dx
from tests.papers import newton_euler_c as ne
from tests.papers import paper_c as C
from tests.papers.bars_c import BARS, DEPTH, FACETS, ROUND, bar, reconstructed, thin_rod
from tests.papers.designs import close
from tests.papers.proofs import proves, proves_each
from tests.papers.states_c import report, symbols

LINES = C.scalars()
RUN = C.run_listing()
RELEASED = report(alpha=C.CRANK_ACCELERATION)  # at rest, with the listing's alpha2


def rod_angle():
    """The rod's angle at theta = 0, rad."""
    return mp.asin(mpf(C.ECCENTRICITY) / mpf(C.ROD))


def real(x):
    """A number of the listing, which runs in doubles."""
    return mpf(float(x))


# --- dimensions and arms --------------------------------------------------------------------------


@proves("C-listing-lengths", "correct", says=f"{C.line('r')} {C.line('l')}")
def test_lengths():
    """r and l are metres; the printed angle is the rod's at theta = 0 for an offset of 60 mm."""
    assert (LINES["r"], LINES["l"]) == (C.CRANK, C.ROD) == (140 * 1e-3, 310 * 1e-3)
    e = mpf(60)
    return {"angle": mp.degrees(mp.asin(e / 310)), "e": e}


@proves("C-listing-theta", "correct", says=C.line("theta"))
def test_crank_angle():
    assert LINES["theta"] == 0
    phi = dx.evaluate("phi", theta=LINES["theta"], ec=C.ECCENTRICITY, AB=LINES["r"], BC=LINES["l"])
    return {"angle": mp.degrees(mpf(phi))}


ARMS = {
    "R12x": -1,
    "R12y": -1,
    "R32x": 1,
    "R32y": 1,
    "R23x": -1,
    "R23y": 1,
    "R43y": -1,
}  # signs of the printed


@proves_each(
    {f"C-listing-{arm}": arm for arm in ARMS},
    {f"C-listing-{arm}": "sign" if sign < 0 else "correct" for arm, sign in ARMS.items()},
    says={f"C-listing-{arm}": C.line(arm) for arm in ARMS},
    instead={f"C-listing-{arm}": f"{arm}= {C.RIGHT[arm]};" for arm, sign in ARMS.items() if sign < 0},
)
def test_arm(arm):
    """From the centre of mass to the joint; the crank's arms also away from theta = 0, where y is not 0."""
    angles = (0, 50, 200) if arm[1:] in ("12x", "12y", "32x", "32y") else (0,)
    for degrees in angles:
        printed, run = (C.scalars(text(theta=f"{degrees}"))[arm] for text in (C.changed, C.corrected_listing))
        true = symbols(report(theta=mp.radians(degrees)))[arm]
        assert abs(ARMS[arm] * printed - true) < 1e-9
        assert abs(run - true) < 1e-9
        assert abs(printed) > 0.01 or (degrees, arm[3:]) == (0, "y")
    return {"angles": list(map(mpf, angles))} if arm in ("R32x", "R32y") else {}


@proves("C-listing-R43x", "sign", says=C.line("R43x"), instead=f"R43x= {C.RIGHT['R43x']};")
def test_R43x_must_follow_R23x():
    """With every other line put right, R43x = R23x leaves the matrix without an inverse."""
    assert np.linalg.matrix_rank(C.run_listing(C.corrected_listing(**C.HELD))["A"]) == 8
    kept = C.run_listing(C.corrected_listing(**C.HELD, R43x="R23x"))
    assert kept["R23x"] < 0
    assert abs(LINES["R43x"] - symbols(report())["R43x"]) < 1e-9
    names = symbols(report()) | {"l": mpf(C.ROD), "phi": rod_angle()}
    return {"rank": mpf(int(np.linalg.matrix_rank(kept["A"]))), "printed_arm": names["R43x"], "names": names}


def placements():
    """Slider right or left of the crank, its axis below or above: alpha2 as printed, at theta = 0."""
    for branch, ec in itertools.product((1, -1), (C.ECCENTRICITY, -C.ECCENTRICITY)):
        yield report(alpha=C.CRANK_ACCELERATION, branch=branch, ec=ec)


def signs_of(v):
    """Signs of the rod's arms and accelerations, from symbols or from the listing."""
    return {name: int(mp.sign(v[name])) for name in ("R23x", "R23y", "R43x", "R43y", "alpha3", "aG3x")}


@proves(
    "C-listing-placement",
    "sign",
    says="R23x, R23y, R43x, R43y, alpha3, aG3x [are all positive, with alpha2 positive]",
)
def test_no_placement_has_the_printed_signs():
    """R43 = R23 holds nowhere; each placement contradicts at least two printed signs, or the text's -X."""
    printed, wrong = signs_of(LINES), {}
    assert set(printed.values()) == {1}
    for state in placements():
        v = symbols(state)
        assert abs(v["R43x"] + v["R23x"]) + abs(v["R43y"] + v["R23y"]) < mpf(10) ** -40
        away = [name for name, sign in signs_of(v).items() if sign != printed[name]]
        pushed = mp.sign(ne.by_theta(ne.slider, state)[1][0])  # the X direction that speeds the crank up
        assert close(abs(v["alpha3"]), real(LINES["alpha3"]), 0, 4)
        wrong[state.branch, state.ec > 0] = " ".join(away), int(pushed)
    pushes = [wrong[key][1] for key in ((1, True), (1, False), (-1, True), (-1, False))]
    assert pushes == [-1, 1, 1, -1]
    names = {
        "right_below": (1, True),
        "right_above": (1, False),
        "left_below": (-1, True),
        "left_above": (-1, False),
    }
    return {name: wrong[key][0] for name, key in names.items()}


@proves("C-listing-Fpx", "sign", cites="7", says=C.line("Fpx"), instead=f"Fpx = {C.RIGHT['Fpx']};")
def test_force_sign():
    """Negative X, as the text has it, puts +50 into row 7; the static torques' signs need it too."""
    torques = {deg: ne.holding_torque(report(theta=mp.radians(deg))) for deg in C.STATIC_TORQUES}
    assert all(torques[degrees] * printed > 0 for degrees, printed in C.STATIC_TORQUES.items())
    assert ne.holding_torque(report(F_Y=50.0)) == -torques[0] > 0
    assert RUN["B"][6] == -LINES["Fpx"] == -50
    true = symbols(report())["FPx"]
    assert C.scalars(C.corrected_listing())["Fpx"] == true == -ne.right_hand_side(report())[6]
    return {"needed": true}


# --- masses and moments of inertia ----------------------------------------------------------------


@proves_each(
    {"C-listing-m2": "2", "C-listing-m3": "3"},
    "given",
    says={f"C-listing-m{n}": C.line(f"m{n}") for n in "23"},
    cites={"C-listing-m3": "C-listing-m2"},
)
def test_mass_of_a_steel_bar(link):
    """The digits need faceted ends; round ones make the bar 2 g heavier."""
    faceted, round_ends = (bar(BARS[link], facets)[0] for facets in (FACETS, ROUND))
    assert abs(LINES[f"m{link}"] - faceted) < 7e-5
    assert round_ends - LINES[f"m{link}"] > 1.7e-3
    result = {
        "length": mpf(round(1000 * BARS[link])),
        "round": real(round_ends),
        "faceted": [real(faceted), mpf(FACETS)],
    }
    return result | ({"bar": [mpf(7801), mpf(30), mpf(round(1000 * DEPTH))]} if link == "2" else {})


@proves("C-listing-m4", "given", cites="C-listing-m2", says=C.line("m4"))
def test_mass_of_the_slider():
    """The density that fits the two bars makes the slider a whole number of cubic centimetres."""
    density = LINES["m2"] / bar(C.CRANK)[0] * 7801
    block = mpf(50) * 50 * 100 / 1000
    assert abs(1e6 * LINES["m4"] / density - block) < 0.03
    return {"volume": real(1e6 * LINES["m4"] / 7801), "block": [mpf(50), mpf(50), mpf(100)]}


@proves_each(
    {"C-listing-IG2": "2", "C-listing-IG3": "3"},
    "wrong claim",
    says={f"C-listing-IG{n}": C.line(f"IG{n}") for n in "23"},
    cites={"C-listing-IG2": "C-listing-m2", "C-listing-IG3": "C-listing-m3"},
)
def test_inertia_is_about_the_long_axis(link):
    """About its own long axis the reconstructed bar has what is printed; about z it has many times that."""
    length, mass, printed = BARS[link], LINES[f"m{link}"], LINES[f"IG{link}"]
    (_, long, about_z), (_, round_long, round_z) = bar(length), bar(length, ROUND)
    assert abs(long / printed - 1) < 2e-4
    thin = mpf(mass) * mpf(length) ** 2 / 12
    names = {f"m{link}": mpf(mass), "r": mpf(length), "l": mpf(length)}
    result = {"z": [real(about_z), mpf(FACETS), real(round_z)], "thin": thin, "names": names}
    return result | {
        "long": [real(long), mpf(FACETS)],
        "round": real(round_long),
        "ratio": real(about_z / printed),
        "printed_inertia": real(printed),
    }


# --- accelerations --------------------------------------------------------------------------------


def start(state):
    """The crank's acceleration when a state at rest is let go, rad/s2."""
    return -ne.holding_torque(state) / ne.effective_inertia(state)


@proves("C-listing-alpha2", "wrong claim", says=C.line("alpha2"))
def test_alpha2_is_the_start_of_a_free_mechanism():
    """Not equilibrium: what 50 N does to the undriven, weightless bars at rest."""
    free = reconstructed()
    assert close(start(free), real(LINES["alpha2"]), 0, 4)
    moved = free._replace(alpha=LINES["alpha2"])
    assert abs(ne.solve(moved)["T12"]) < mpf("1e-4") * abs(ne.holding_torque(free))
    thin, listed = start(thin_rod()), start(report())
    result = {"held": symbols(report())["alpha2"], "released": real(LINES["alpha2"]), "thin": thin}
    return result | {"start": start(free), "force": mpf(50), "listed": listed}


SIMILAR = {"aG2x": 0, "aG2y": 3e-5, "aG3x": 2e-4, "aG3y": 3e-5, "alpha3": 1e-4}
REVERSED = {"aG3x", "alpha3"}
ACCELERATIONS = {f"C-listing-{name}": name for name in SIMILAR}


@proves_each(
    ACCELERATIONS,
    {
        key: "correct" if name == "aG2x" else "sign" if name in REVERSED else "wrong claim"
        for key, name in ACCELERATIONS.items()
    },
    says={key: C.line(name) for key, name in ACCELERATIONS.items()},
    instead={
        "C-listing-aG3x": f"aG3x= {C.FREE['aG3x']};",
        "C-listing-alpha3": f"alpha3 = {C.FREE['alpha3']};",
    },
)
def test_acceleration(name):
    """What alpha2 does at rest, by the loop: size to four digits, sign as in the slider's placement."""
    v, held = symbols(RELEASED), symbols(report())
    sign = -1 if name in REVERSED else 1
    assert abs(sign * LINES[name] - v[name]) <= SIMILAR[name] * abs(v[name])
    assert v[name] != 0 or name == "aG2x"
    assert held[name] == 0
    names = {"r": mpf(C.CRANK), "l": mpf(C.ROD), "phi": rod_angle(), "omega": mpf(0), **v}
    if name == "aG2x":
        moving = report(omega=2.0)
        return {"moving": ne.acceleration(ne.crank_centre, moving)[0], "names": names | {"omega": mpf(2)}}
    if name in ("aG2y", "aG3y"):
        return {"held": held[name], "released": v[name], "names": names}
    if name == "aG3x":
        return {"released": v[name], "names": names}
    alpha_BC = dx.evaluate(
        "alpha_BC", theta=0.0, ec=C.ECCENTRICITY, AB=C.CRANK, BC=C.ROD, omega=0.0, alpha=LINES["alpha2"]
    )
    assert close(-mpf(alpha_BC), v["alpha3"], 0, 12)
    above = real(LINES["alpha3"]) / -v["alpha3"] - 1
    return {"loop": v["alpha3"], "above": above, "package": real(alpha_BC), "names": names}


@proves("C-listing-aG4x", "wrong claim", says=C.line("aG4x"))
def test_slider_acceleration_is_left_out():
    """The rod's middle moves half as fast along x as the slider where the pin moves across: aG4x = 2 aG3x."""
    v = symbols(RELEASED)
    assert LINES["aG4x"] == 0
    motion = {"theta": 0.0, "ec": C.ECCENTRICITY, "AB": C.CRANK, "BC": C.ROD, "omega": 0.0}
    assert close(mpf(dx.evaluate("a_C", alpha=LINES["alpha2"], **motion)), v["aG4x"], 0, 12)
    return {"released": v["aG4x"], "force": v["m4"] * v["aG4x"], "names": v}


# --- the system -----------------------------------------------------------------------------------

RIGHT_ROWS = [row for row in range(1, 9) if row != 3]


def row_of(number):
    """A row of the listing's A as printed."""
    return " ".join(C.rows(C.bracket("A"))[number - 1]) + ";"


def system_at(angle):
    """The listing's matrix and the paper's own for its own arms, at some crank angle."""
    names = C.run_listing(C.LISTING.replace("theta = 0;", f"theta = {angle};"))
    return names["A"], np.array(C.printed_matrix(names), float)


@proves_each(
    {f"C-listing-A-row{n}": n for n in RIGHT_ROWS},
    "correct",
    says={f"C-listing-A-row{n}": row_of(n) for n in RIGHT_ROWS},
    cites={f"C-listing-A-row{n}": "2" for n in RIGHT_ROWS},
)
def test_listing_matrix_row(number):
    mine, paper = system_at(35)
    assert mine[number - 1].tolist() == paper[number - 1].tolist()


@proves("C-listing-A-row3", "sign", cites="2", says=row_of(3), instead=C.CORRECTED_ROW_3)
def test_listing_matrix_row3():
    """-R32x for +R32x: with the printed R12 the crank's moments of F12 and F32 come out reversed."""
    mine, paper = system_at(35)
    assert (mine != paper).tolist() == [[(r, c) == (2, 3) for c in range(8)] for r in range(8)]
    assert mine[2, 3] == -paper[2, 3] != 0
    right = np.array(ne.matrix(report()).tolist(), float)
    assert np.allclose(RUN["A"][2, [1, 3]], -right[2, [1, 3]], rtol=0, atol=1e-12)
    assert np.allclose(C.run_listing(C.corrected_listing())["A"], right, rtol=0, atol=1e-9)
    return {"names": symbols(report(theta=mpf("0.4")))}


@proves("C-listing-syms", "correct", says=f"syms {' '.join(C.UNKNOWNS)}; x = [{' '.join(C.UNKNOWNS)}]';")
def test_listing_unknowns():
    assert C.rows(C.bracket("x")) == [list(C.UNKNOWNS)]
    assert C.LISTING.count("syms " + " ".join(C.UNKNOWNS)) == 1


@proves("C-listing-B", "correct", says=f"B= [{C.bracket('B')}]';", cites="2")
def test_listing_right_hand_side():
    assert RUN["B"].tolist() == C.printed_right_hand_side(LINES | {"FPx": LINES["Fpx"], "FPy": 0})


@proves("C-listing-B-line", "correct", says="m4*aG4x-Fpx (new line) 0]'")
def test_listing_right_hand_side_is_broken():
    """The longest line breaks where a page would wrap it; a typed new line would start a second row."""
    lengths = {line: len(line) for line in C.LISTING.splitlines()}
    assert max(lengths, key=lengths.get).startswith("B= [")
    assert [len(row) for row in C.rows(C.bracket("B"))] == [7, 1]
    assert [len(row) for row in C.rows(C.bracket("A"))] == [8] * 8
    assert [len(row) for row in C.rows(C.bracket("B"), newline_ends_row=False)] == [8]


@proves("C-listing-pinv", "wrong claim", says="x = pinv(A)*B", instead="x = A\\B")
def test_listing_solution_is_a_compromise():
    """No solution: pinv minimises the imbalance, most of it left in the rod's moment."""
    A, B, x = RUN["A"], RUN["B"], RUN["x"]
    rank = int(np.linalg.matrix_rank(A))
    assert np.linalg.matrix_rank(np.column_stack([A, B])) == rank + 1 == 8
    imbalance = A @ x - B
    assert np.abs(imbalance).argmax() == 5
    null = np.linalg.svd(A)[2][-1]
    assert np.abs(A @ null).max() < 1e-12
    assert abs(null[7]) > 0.05  # T12 is not determined: any multiple of this may be added
    assert abs(x @ null) < 1e-9
    right = C.run_listing(C.corrected_listing())
    assert np.allclose(right["x"], np.linalg.solve(right["A"], right["B"]), rtol=1e-9)
    left = {"left": real(abs(imbalance[5])), "share": real(abs(imbalance[5] / x[7]))}
    return left | {"rank": mpf(rank), "names": symbols(report())}
