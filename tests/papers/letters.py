"""The letters of the three papers, each with its value by an `ORACLE` (loop, free bodies) or by the package.

What the two have no name for is a definition of the paper, or made of the raw loop's positions.
"""

from typing import NamedTuple

from mpmath import mp, mpc, mpf

import desaxe as dx
from tests.papers import free_bodies, loop
from tests.papers import newton_euler_c as ne
from tests.papers import paper_a as A
from tests.papers import paper_b as B
from tests.papers import paper_c as C
from tests.papers.designs import DESIGNS, exact_point
from tests.papers.designs_b import LOADED, exact_case, exact_masses
from tests.papers.digits import remembered
from tests.papers.free_bodies import Bodies
from tests.papers.states_c import WEIGHTLESS, symbols

ORACLE, PACKAGE = "oracle", "package"
DESIGNS_OF = {"A": len(DESIGNS), "B": len(LOADED), "C": len(WEIGHTLESS)}
SLOPES = "Y", "V_C", "V_B_Y", "phi", "omega_BC"  # whose derivatives by theta paper B has


def quantities(source, motion, bodies=None):
    """The mechanism's quantities by the package's names; with `bodies` also its forces and `SLOPES`."""
    if source == PACKAGE:
        names = [*loop.QUANTITIES]
        names += [*free_bodies.UNKNOWNS, *(f"{name}_wrt_theta" for name in SLOPES)] if bodies else []
        loads = {name: float(x) for name, x in bodies._asdict().items() if x is not None} if bodies else {}
        return {name: mpf(x) for name, x in dx.evaluate(names, **motion._asdict(), **loads).items()}
    result = {name: loop.truth(name, motion) for name in loop.QUANTITIES}
    if not bodies:
        return result
    slopes = {f"{name}_wrt_theta": loop.partial(name, "theta", motion) for name in SLOPES}
    return result | slopes | free_bodies.solve(motion, bodies)


# --- paper A --------------------------------------------------------------------------------------


@remembered
def names_a(number, source=ORACLE):
    """Paper A's names at a random design; vectors as complex numbers x + y j in the paper's axes."""
    motion = DESIGNS[number]
    q = quantities(source, motion)
    theta, ec, AB, BC, _, alpha = map(mpf, motion)
    V_B, a_B = mpc(q["V_B_X"], -q["V_B_Y"]), mpc(q["a_B_X"], -q["a_B_Y"])
    (X_B, Y_B), (X_C, _) = loop.pin(motion), loop.slider(motion)
    along_X, along_Y = (q[name] * alpha / q["omega"] for name in ("V_B_X", "V_B_Y"))  # due to alpha
    return q | {
        **{"X_B": X_B, "Y_B": Y_B, "X_C": X_C, "margin": BC - AB - abs(ec)},
        **{"V_Bmag": abs(V_B), "a_Bmag": abs(a_B)},
        **{"theta": theta, "ec": ec, "AB": AB, "BC": BC, "alpha": alpha, "omega0": mpf(motion.omega0)},
        **{"V_B": V_B, "a_B": a_B, "V_Bx": V_B.real, "V_By": V_B.imag, "a_Bx": a_B.real, "a_By": a_B.imag},
        "alpha_BC1": q["a_B_X"] - along_X,
        "alpha_BC2": along_X,
        "alpha_BC3": -(q["omega_BC"] ** 2) * (X_B - X_C),
        "alpha_BC4": q["Y"] - Y_B,
        "a_C1": q["a_B_Y"] - along_Y,
        "a_C2": along_Y,
        "a_C3": -q["alpha_BC"] * (X_B - X_C),
        "a_C4": -(q["omega_BC"] ** 2) * (q["Y"] - Y_B),
    }


def relative_a(v, key, motion):
    """Eqs. 1, 3, 8 and 12 speak of vectors, the first two of a crank centre that may move."""

    def rate(order, carried):
        """That of a moving crank centre, or of the pin that it carries."""

        def place(t):
            x, y = loop.pin(motion, t) if carried else (0, 0)
            return x + t * mpf("0.3") - t * t, -(y + t * mpf("0.2") + t * t / 2)

        return mpc(*(loop.rate(lambda t, axis=axis: place(t)[axis], order) for axis in (0, 1)))

    arm = mpc(v["X_B"], v["Y_B"])
    across, inwards = mpc(mp.cos(v["phi"]), -mp.sin(v["phi"])), mpc(-mp.sin(v["phi"]), -mp.cos(v["phi"]))
    sideways = arm.imag + 1j * arm.real  # the arm turned by a quarter, in the paper's axes
    return {
        "A-eq1": lambda: {"V_A": rate(1, False), "V_BA": v["omega"] * sideways, "V_B": rate(1, True)},
        "A-eq3": lambda: {
            "a_A": rate(2, False),
            "a_BA_n": -(v["omega"] ** 2) * arm.conjugate(),
            "a_BA_t": v["alpha"] * sideways,
            "a_B": rate(2, True),
        },
        "A-eq8": lambda: {"V_C": mpc(0, -v["V_C"]), "V_BC": v["BC"] * v["omega_BC"] * across},
        "A-eq12": lambda: {
            "a_C": mpc(0, -v["a_C"]),
            "a_BC_t": v["BC"] * v["alpha_BC"] * across,
            "a_BC_n": v["BC"] * v["omega_BC"] ** 2 * inwards,
        },
    }.get(key, dict)()


class Twin(NamedTuple):
    """A formula written by hand: the values of its sides as printed, and the corrected one if it is wrong."""

    sides: tuple
    corrected: object = None


@remembered
def twins_a(number):
    """The formulas of paper A that are wrong, or that other proofs use."""
    v, p = names_a(number), exact_point(DESIGNS[number])
    turning = *p.design, p.omega
    return {
        "A-eq6": Twin((v["phi"], A.printed_eq6(*p.design, mp))),
        "A-eq7": Twin((v["Y"], A.printed_eq7(*p.design, mp))),
        "A-eq10": Twin((v["omega_BC"], A.printed_eq10(*turning, mp))),
        "A-eq11": Twin((v["V_C"], A.printed_eq11(*turning, mp))),
        "A-eq14": Twin((v["alpha_BC"], A.printed_eq14(*turning, p.alpha, mp))),
        "A-eq15": Twin((v["alpha_BC1"], A.printed_eq15(p.theta, p.AB, p.omega, mp))),
        "A-eq20": Twin((v["a_C1"], A.printed_eq20(p.theta, p.AB, p.omega, mp))),
        "A-eq23": Twin((v["a_C4"], A.printed_eq23(*turning, mp))),
        "A-eq24": Twin((p.sheet.corrected_V_C(*p.design),)),
        "A-eq25": Twin((p.sheet.corrected_a_C(*p.design),)),
        "A-eq19": Twin(
            (v["a_C"], A.printed_eq19(*turning, p.alpha, mp)), A.corrected_eq19(*turning, p.alpha, mp)
        ),
        "A-listing-omega_BC": Twin((v["omega_BC"], p.sheet.omega_BC(*p.design))),
        "A-listing-alpha_BC": Twin((v["alpha_BC"], p.sheet.alpha_BC(*p.design))),
        "A-listing-V_C": Twin((v["V_C"], p.sheet.V_C(*p.design)), p.sheet.corrected_V_C(*p.design)),
        "A-listing-a_C": Twin((v["a_C"], p.sheet.a_C(*p.design)), p.sheet.corrected_a_C(*p.design)),
    }


def small_c(v):
    """The listing's a_c, a_c1 to a_c4."""
    return {name.replace("a_C", "a_c"): v[name] for name in ("a_C", "a_C1", "a_C2", "a_C3", "a_C4")}


# --- paper B --------------------------------------------------------------------------------------


def moved_to_pins(force, pin, slider):
    """The masses at the pins whose masses times accelerations add up to a force."""
    at_pin = force[0] / pin[0]
    return at_pin, (force[1] - at_pin * pin[1]) / slider[1]


@remembered
def equivalent_masses(number):
    """The masses of crank, rod and all that move with the crank pin, and of rod and all with the slider."""
    motion, masses = LOADED[number]
    where = Bodies(r_crank=masses.k_1, r_rod=masses.c_2)
    rate = free_bodies.second_rate
    crank, rod = (
        [mpf(m) * a for a in rate(lambda t, centre=centre: centre(motion, where, t))]
        for m, centre in ((masses.m_k, free_bodies.crank_centre), (masses.m_c, free_bodies.rod_centre))
    )
    pin, slider = (rate(lambda t, point=point: point(motion, t)) for point in (loop.pin, loop.slider))
    block = [mpf(masses.m_s) * a for a in slider]
    total = [sum(parts) for parts in zip(crank, rod, block, strict=True)]
    (m_2k, _), rods, (m_2, m_3) = (moved_to_pins(force, pin, slider) for force in (crank, rod, total))
    return {"m_2k": m_2k, "m_2c": rods[0], "m_3c": rods[1], "m_2": m_2, "m_3": m_3}


def masses_of_the_package(motion, masses):
    """m_2 and m_3."""
    bodies = {"m_crank": masses.m_k, "m_rod": masses.m_c, "m_slider": masses.m_s}
    centres = {"r_crank": masses.k_1, "r_rod": masses.c_2}
    result = dx.evaluate(["m_rotating", "m_reciprocating"], **motion._asdict(), **bodies, **centres)
    return {"m_2": mpf(result["m_rotating"]), "m_3": mpf(result["m_reciprocating"])}


@remembered
def names_b(number, source=ORACLE):
    """Paper B's names at a random design with random masses, at constant speed; i and j are 1 and 1j."""
    motion, masses = LOADED[number]
    lumps = equivalent_masses(number) | (masses_of_the_package(motion, masses) if source == PACKAGE else {})
    m_2, m_3 = lumps["m_2"], lumps["m_3"]
    f = quantities(source, motion, Bodies(m_crank=m_2, r_crank=motion.AB, m_slider=m_3))
    q, w = exact_case(motion), exact_masses(masses)
    x, alpha, omega, t = f["Y"], f["phi"], f["omega"], q.theta / q.omega
    v_s, a_s, v_c, a_c, v_1 = -f["V_C"], -f["a_C"], f["omega_BC"], f["alpha_BC"], -f["V_B_Y"]
    by_theta = {name: f[f"{name}_wrt_theta"] for name in SLOPES}
    a_B, a_k = mpc(f["a_B_Y"], f["a_B_X"]), mp.hypot(f["a_B_X"], f["a_B_Y"])
    outer, inner = B.dead_centres(q.e, q.k, q.c, mp)
    back = inner - outer
    return {
        **f,
        **{"theta": loop.crank_angle(motion._replace(theta=0.0), t), "t": t, "omega": omega},
        **{"e": q.e, "k": q.k, "c": q.c, "gamma": q.e / q.c, "delta": q.k / q.c},
        **{"x": x, "s": q.k + q.c - x, "h": loop.pin(motion)[0], "alpha": alpha},
        **{"v_k": mp.hypot(f["V_B_X"], f["V_B_Y"]), "a_k": a_k},
        **{"v_s": v_s, "a_s": a_s, "v_c": v_c, "a_c": a_c, "v_1": v_1, "v_2": v_s - v_1},
        **{"d__theta__t": loop.rate(lambda t: loop.crank_angle(motion, t), 1), "d__s__t": v_s},
        **{"d__v_s__t": a_s, "d__alpha__t": v_c, "d__v_c__t": a_c},
        **{"d__s__theta": -by_theta["Y"], "d__v_s__theta": -by_theta["V_C"]},
        **{"d__alpha__theta": by_theta["phi"], "d__v_c__theta": by_theta["omega_BC"]},
        "d__v_1__theta": -by_theta["V_B_Y"],
        "d__v_2__theta": by_theta["V_B_Y"] - by_theta["V_C"],
        **lumps,
        **w._asdict(),
        **{"c_3": q.c - w.c_2, "a_B": a_B, "F_k": m_2 * a_k, "F_Is": -m_3 * a_s},
        **{"R_x": f["F_A_Y"], "R_y": f["F_A_X"], "F_h": f["F_C_Y"], "F_v": -f["F_C_X"], "F_s": f["F_C_Y"]},
        **{"F_c": f["F_C_Y"] * mp.cos(alpha) - f["F_C_X"] * mp.sin(alpha), "F_i": f["F_A_Y"]},
        **{"F_t": f["F_B_Y"] * q.sin - f["F_B_X"] * q.cos, "T": -f["T_in"], "T_k": mpf(0)},
        "F_I": mpc(f["F_A_Y"], f["F_A_X"] + f["N_C"]),
        **{"outer": outer, "inner": inner},
        **{"i": mpf(1), "j": mpc(0, 1), "a_is": B.printed_eq52(q), "T_i": B.printed_eq53(q, m_3)},
        **{"Q": (2 * mp.pi - back) / back},
        **{"advance_crank_angle": 2 * mp.pi - back, "time_of_advance_stroke": (2 * mp.pi - back) / omega},
        **{"return_crank_angle": back, "time_of_return_stroke": back / omega},
    }


def special_b(v, key):
    """Letters that mean something else in one equation."""
    return {
        "B-eq37b": {"F_k": v["m_2"] * v["a_B"]},
        "B-eq49": {"s": B.corrected_eq49(v["e"], v["k"], v["c"], mp)},
    }.get(key, {})


@remembered
def twins_b(number):
    """The formulas of paper B that are wrong, or that other proofs use."""
    v, w = names_b(number), exact_masses(LOADED[number][1])
    q = B.Case(*(v[name] for name in ("theta", "e", "k", "c", "omega")), mp)
    m_2, m_3, alpha = v["m_2"], v["m_3"], v["alpha"]
    F_Is, F_c = B.corrected_eq42a(q, m_3), B.corrected_eq41(q, m_3)
    stroke = B.corrected_eq49(q.e, q.k, q.c, mp)
    return {
        "B-eq2b": Twin((v["v_k"], B.printed_eq2b_middle(q.omega, q.omega), v["v_k"])),
        "B-eq8": Twin((v["x"], B.printed_eq8(q))),
        "B-eq10": Twin((v["s"], B.printed_eq10(q)), B.corrected_eq10(q)),
        "B-eq12": Twin((v["d__s__theta"], B.printed_eq12(q))),
        "B-eq13": Twin((v["v_s"], B.printed_eq13(q))),
        "B-eq17": Twin((v["d__v_1__theta"], B.printed_eq17(q)), B.corrected_eq17(q)),
        "B-eq18": Twin((v["d__v_2__theta"], B.printed_eq18(q)), B.corrected_eq18(q)),
        "B-eq20": Twin((v["a_s"], B.printed_eq20(q)), B.corrected_eq20(q)),
        "B-eq22": Twin((v["alpha"], B.printed_eq22(q))),
        "B-eq27": Twin((v["v_c"], B.printed_eq27(q))),
        "B-eq29": Twin((v["d__v_c__theta"], B.printed_eq29(q)), B.corrected_eq29(q)),
        "B-eq30": Twin((v["a_c"], B.printed_eq30(q)), B.corrected_eq30(q)),
        "B-eq32": Twin((v["m_2c"], B.printed_eq32(q, w))),
        "B-eq33": Twin((v["m_3c"], B.printed_eq33(q, w))),
        "B-eq34": Twin((v["m_3"], B.printed_eq34(q, w))),
        "B-eq36": Twin((v["m_2"], B.printed_eq36(q, w))),
        "B-eq37b": Twin((m_2 * v["a_B"], mpc(*B.printed_eq37b(q, m_2)))),
        "B-eq38": Twin((v["R_x"], B.printed_eq38(q, m_2)), B.corrected_eq38(q, m_2, m_3)),
        "B-eq39": Twin((v["R_y"], B.printed_eq39(q, m_2)), B.corrected_eq39(q, m_2, m_3)),
        "B-eq40": Twin((v["F_t"], B.printed_eq40(q, m_2)), B.corrected_eq40(q, F_c)),
        "B-eq41": Twin((v["F_c"], B.printed_eq41(q, m_2)), F_c),
        "B-eq42a": Twin((v["F_Is"], F_Is)),
        "B-eq42b": Twin((v["F_Is"], B.printed_eq42b(q, m_3)), B.corrected_eq42b(q, m_3)),
        "B-eq45": Twin((v["F_s"], B.printed_eq45(F_Is, F_c, alpha, mp)), F_Is),
        "B-eq46a": Twin((v["F_I"], mpc(*B.printed_eq46a(q, m_2, m_3, v["a_s"])))),
        "B-eq46b": Twin((v["F_i"], B.printed_eq46b(q, m_2, m_3, v["a_s"]))),
        "B-eq47": Twin((0, v["R_x"] * v["k"], B.printed_eq47(q, m_2))),
        "B-eq48": Twin((v["T"], B.printed_eq48(q, v["F_i"])), B.corrected_eq48(q, F_Is)),
        "B-eq49": Twin((stroke, B.printed_eq49(q.k)), stroke),
        "B-eq50": Twin((v["c"], B.printed_eq50(q.e))),
    }


# --- paper C --------------------------------------------------------------------------------------


@remembered
def names_c(number, source=ORACLE):
    """Paper C's symbols in a random state; of the package the forces, and what slider and rod do."""
    state = WEIGHTLESS[number]
    v = symbols(state) | {"IG4": mpf(2), "alpha4": mpf(0)}
    if source == ORACLE:
        return v
    result = dx.evaluate([*C.PACKAGE, "a_C", "alpha_BC"], **state._asdict())
    forces = {unknown: sign * mpf(result[name]) for name, (unknown, sign) in C.PACKAGE.items()}
    return v | forces | {"aG4x": mpf(result["a_C"]), "alpha3": -state.branch * mpf(result["alpha_BC"])}


def special_c(key, v):
    """Link 4 with a friction, arms, a turning and an acceleration across the guide that are not zero."""
    if key == "C-link4-x":
        return {"F14x": mpf("0.6"), "FPx": v["FPx"] - mpf("0.6")}
    if key == "C-link4-y":
        return {"aG4y": mpf(2), "F14y": v["F14y"] + 2 * v["m4"]}
    if key != "C-link4-moment":
        return {}
    arms = {"R14x": "0.3", "R14y": "0.7", "R34x": "-1.1", "R34y": "0.9", "RPx": "1.7", "RPy": "-0.4"}
    v = v | {name: mpf(text) for name, text in (arms | {"F14x": "0.6"}).items()}
    guide, joint, load = (
        ne.moment(*((v[name + "x"], v[name + "y"]) for name in pair))
        for pair in (("R14", "F14"), ("R34", "F43"), ("RP", "FP"))
    )
    return v | {"alpha4": (guide - joint + load) / v["IG4"]}


_WORDS = "C_1 C_2 m/s2 rad/s2 rad/s3 rad2/s2 m2 mm2 cm3 kg/m3 d2 phi/dt2 d2x/dt2 d2s/dt2"
WORDS = frozenset(_WORDS.split())  # with a digit, and no name of a quantity


@remembered
def known(letter):
    """The names with a digit that a text on a paper may hold."""
    names = {"A": names_a, "B": names_b, "C": names_c}[letter](0)
    vectors = {name[:-1] for name in names if name[-1] in "xy"} if letter == "C" else set()
    return {*names, *vectors, *WORDS, *(small_c(names) if letter == "A" else ())}


def names_of(key, number, source=ORACLE):
    """The names of an entry's paper at a design, with what is special to the entry."""
    v = {"A": names_a, "B": names_b, "C": names_c}[key[0]](number, source)
    if key[0] == "A":
        return v | small_c(v) | relative_a(v, key, DESIGNS[number])
    return v | (special_b(v, key) if key[0] == "B" else special_c(key, v))


def twin_of(key, number):
    """The hand-written form of an entry at a design, if there is one."""
    return {"A": twins_a, "B": twins_b}[key[0]](number).get(key) if key[0] != "C" else None
