"""The letters of the three papers, each with the value that the raw loop or the free bodies give it."""

from mpmath import mp, mpc, mpf

from tests.papers import free_bodies, loop
from tests.papers import paper_a as A
from tests.papers import paper_b as B
from tests.papers import paper_c as C
from tests.papers.designs import DESIGNS
from tests.papers.designs_b import LOADED, equivalent, exact_case, exact_masses, lumped
from tests.papers.digits import remembered
from tests.papers.states_c import WEIGHTLESS, symbols

# --- paper A --------------------------------------------------------------------------------------


@remembered
def names_a(number):
    """Paper A's names at a random design; vectors as complex numbers x + y j in the paper's axes."""
    motion = DESIGNS[number]
    q = {name: loop.truth(name, motion) for name in loop.QUANTITIES}
    theta, ec, AB, BC, _, alpha = map(mpf, motion)
    design, omega = (theta, ec, AB, BC), q["omega"]
    V_B, a_B = mpc(q["V_B_X"], -q["V_B_Y"]), mpc(q["a_B_X"], -q["a_B_Y"])
    (X_B, Y_B), (X_C, _) = loop.pin(motion), loop.slider(motion)
    return {
        **q,
        **{
            "X_B": X_B,
            "Y_B": Y_B,
            "X_C": X_C,
            "V_Bmag": abs(V_B),
            "a_Bmag": abs(a_B),
            "margin": BC - AB - abs(ec),
        },
        **{"theta": theta, "ec": ec, "AB": AB, "BC": BC, "alpha": alpha, "omega0": mpf(motion.omega0)},
        **{"V_B": V_B, "a_B": a_B, "V_Bx": V_B.real, "V_By": V_B.imag, "a_Bx": a_B.real, "a_By": a_B.imag},
        "alpha_BC1": A.printed_eq15(theta, AB, omega, mp),
        "alpha_BC2": A.printed_eq16(theta, AB, alpha, mp),
        "alpha_BC3": A.printed_eq17(*design, omega, mp),
        "alpha_BC4": A.printed_eq18(*design, mp),
        "a_C1": A.printed_eq20(theta, AB, omega, mp),
        "a_C2": A.printed_eq21(theta, AB, alpha, mp),
        "a_C3": A.printed_eq22(*design, omega, alpha, mp),
        "a_C4": A.printed_eq23(*design, omega, mp),
    }


def relative_a(v, key):
    """Eqs. 1, 3, 8 and 12 speak of vectors and of a crank centre that may move."""
    drift = mpc("0.7", "-1.9")
    along = {"V": mpc(0, -v["V_C"]), "a": mpc(0, -v["a_C"])}
    across, inwards = mpc(mp.cos(v["phi"]), -mp.sin(v["phi"])), mpc(-mp.sin(v["phi"]), -mp.cos(v["phi"]))
    turning, turn = (v["BC"] * v[name] * across for name in ("omega_BC", "alpha_BC"))
    pull = v["AB"] * v["omega"] ** 2 * mpc(-mp.sin(v["theta"]), mp.cos(v["theta"]))
    return {
        "A-eq1": {"V_A": drift, "V_BA": v["V_B"], "V_B": drift + v["V_B"]},
        "A-eq3": {"a_A": drift, "a_BA_n": pull, "a_BA_t": v["a_B"] - pull, "a_B": drift + v["a_B"]},
        "A-eq8": {"V_C": along["V"], "V_BC": turning},
        "A-eq12": {"a_C": along["a"], "a_BC_t": turn, "a_BC_n": v["BC"] * v["omega_BC"] ** 2 * inwards},
    }.get(key, {})


def printed_a(v, key):
    """The values of the sides of a wrong form, or of a form with one side, of paper A."""
    parts = [v[f"a_C{n}"] for n in (1, 2, 3, 4)]
    signed = v["a_C"], parts[0] + parts[1] - parts[2] - parts[3]
    return {
        "A-eq19": [signed],
        "A-listing-a_C": [signed],
        "A-listing-V_C": [(v["V_C"], -v["V_C"])],
        "A-eq24": [(v["V_C"],)],
        "A-eq25": [(v["a_C"],)],
    }.get(key)


def small_c(v):
    """The listing's a_c, a_c1 to a_c4."""
    return {name.replace("a_C", "a_c"): v[name] for name in ("a_C", "a_C1", "a_C2", "a_C3", "a_C4")}


# --- paper B --------------------------------------------------------------------------------------


@remembered
def names_b(number):
    """Paper B's names at a random design with random masses, at constant speed; i and j are 1 and 1j."""
    motion, masses = LOADED[number]
    truth = {name: loop.truth(name, motion) for name in loop.QUANTITIES}
    q, w = exact_case(motion), exact_masses(masses)
    _, m_2, m_3 = equivalent(motion, masses)
    f = free_bodies.solve(motion, lumped(motion, masses))
    h, height = loop.pin(motion)
    x, alpha, omega = truth["Y"], truth["phi"], q.omega
    v_s, a_s, v_c, a_c = -truth["V_C"], -truth["a_C"], truth["omega_BC"], truth["alpha_BC"]
    v_1, dv_1 = omega * h, omega * height
    push = f["F_C_Y"] * mp.cos(alpha) - f["F_C_X"] * mp.sin(alpha)
    outer, inner = B.dead_centres(q.e, q.k, q.c, mp)
    back = inner - outer
    return {
        **truth,
        **{"T_in": f["T_in"], "N_C": f["N_C"], "F_B_X": f["F_B_X"], "F_B_Y": f["F_B_Y"]},
        **{"theta": q.theta, "e": q.e, "k": q.k, "c": q.c, "omega": omega, "t": q.theta / omega},
        **{"x": x, "s": q.k + q.c - x, "h": h, "alpha": alpha, "gamma": q.e / q.c, "delta": q.k / q.c},
        **{"v_k": mp.hypot(truth["V_B_X"], truth["V_B_Y"]), "a_k": mp.hypot(truth["a_B_X"], truth["a_B_Y"])},
        **{"v_s": v_s, "a_s": a_s, "v_c": v_c, "a_c": a_c, "v_1": v_1, "v_2": v_s - v_1},
        **{"d__theta__t": omega, "d__s__t": v_s, "d__s__theta": v_s / omega},
        **{
            "d__v_s__t": a_s,
            "d__v_s__theta": a_s / omega,
            "d__alpha__t": v_c,
            "d__alpha__theta": v_c / omega,
        },
        **{"d__v_1__theta": dv_1, "d__v_2__theta": a_s / omega - dv_1},
        **{"d__v_c__t": a_c, "d__v_c__theta": a_c / omega},
        **{"m_c": w.m_c, "m_k": w.m_k, "m_s": w.m_s, "k_1": w.k_1, "c_2": w.c_2, "c_3": q.c - w.c_2},
        **{"m_2": m_2, "m_3": m_3, "m_2k": w.m_k * w.k_1 / q.k, "m_3c": m_3 - w.m_s},
        **{"m_2c": w.m_c - (m_3 - w.m_s), "F_k": m_2 * mp.hypot(truth["a_B_X"], truth["a_B_Y"])},
        **{"R_x": f["F_A_Y"], "R_y": f["F_A_X"], "F_Is": -m_3 * a_s, "F_c": push, "F_h": f["F_C_Y"]},
        **{"F_v": -f["F_C_X"], "F_s": f["F_C_Y"], "F_i": f["F_A_Y"], "T": -f["T_in"], "T_k": mpf(0)},
        "F_t": -(f["F_B_X"] * q.cos - f["F_B_Y"] * q.sin),
        "F_I": mpc(f["F_A_Y"], f["F_A_X"] + f["N_C"]),
        **{"outer": outer, "inner": inner},
        **{"i": mpf(1), "j": mpc(0, 1), "a_is": B.printed_eq52(q), "T_i": B.printed_eq53(q, m_3)},
        **{
            "Q": (2 * mp.pi - back) / back,
            "advance_crank_angle": 2 * mp.pi - back,
            "return_crank_angle": back,
        },
        "time_of_advance_stroke": (2 * mp.pi - back) / omega,
        "time_of_return_stroke": back / omega,
    }


def special_b(v, key):
    """Letters that mean something else in one equation."""
    return {
        "B-eq37b": {"F_k": -v["m_2"] * v["omega"] ** 2 * v["k"] * mp.expj(v["theta"])},
        "B-eq49": {"s": B.corrected_eq49(v["e"], v["k"], v["c"], mp)},
    }.get(key, {})


def printed_b(v, key):
    """The values of the sides of a wrong form of paper B: the named quantity, and the printed expression."""
    q = B.Case(*(v[name] for name in ("theta", "e", "k", "c", "omega")), mp)
    m_2, m_3 = v["m_2"], v["m_3"]
    return {
        "B-eq2b": [(v["v_k"], B.printed_eq2b_middle(q.omega, q.omega), v["v_k"])],
        "B-eq10": [(v["s"], B.printed_eq10(q))],
        "B-eq17": [(v["d__v_1__theta"], B.printed_eq17(q))],
        "B-eq18": [(v["d__v_2__theta"], B.printed_eq18(q))],
        "B-eq20": [(v["a_s"], B.printed_eq20(q))],
        "B-eq29": [(v["d__v_c__theta"], B.printed_eq29(q))],
        "B-eq30": [(v["a_c"], B.printed_eq30(q))],
        "B-eq38": [(v["R_x"], B.printed_eq38(q, m_2))],
        "B-eq39": [(v["R_y"], B.printed_eq39(q, m_2))],
        "B-eq40": [(v["F_t"], B.printed_eq40(q, m_2))],
        "B-eq41": [(v["F_c"], B.printed_eq41(q, m_2))],
        "B-eq42b": [(v["F_Is"], B.printed_eq42b(q, m_3))],
        "B-eq45": [(v["F_s"], B.printed_eq45(v["F_Is"], v["F_c"], v["alpha"], mp))],
        "B-eq47": [(0, v["R_x"] * v["k"], B.printed_eq47(q, m_2))],
        "B-eq48": [(v["T"], B.printed_eq48(q, v["F_i"]))],
        "B-eq49": [(v["s"], B.printed_eq49(q.k))],
        "B-eq50": [(v["c"], mpf("3.2") * q.e)],
    }.get(key)


# --- paper C --------------------------------------------------------------------------------------


@remembered
def names_c(number):
    """Paper C's symbols in a random state, its unknowns solved from the free bodies."""
    return symbols(WEIGHTLESS[number]) | {"IG4": mpf(2), "alpha4": mpf(0)}


def special_c(key, v):
    """Link 4 with arms, a friction, a turning and an acceleration across the guide that are not zero."""
    if key == "C-link4-y":
        return {"aG4y": mpf(2), "F14y": v["F14y"] + 2 * v["m4"]}
    arms = {
        "R14x": "0.3",
        "R14y": "0.7",
        "R34x": "-1.1",
        "R34y": "0.9",
        "RPx": "1.7",
        "RPy": "-0.4",
        "F14x": "0.6",
    }
    return (
        {name: mpf(text) for name, text in arms.items()} | {"alpha4": mpf(3)}
        if key == "C-link4-moment"
        else {}
    )


WORDS = {
    "C_1",
    "C_2",
    "m/s2",
    "rad/s2",
    "rad/s3",
    "rad2/s2",
    "m2",
    "mm2",
    "cm3",
    "kg/m3",
    "d2",
    "phi/dt2",
    "d2x/dt2",
    "d2s/dt2",
}


@remembered
def known(letter):
    """The names with a digit that a text on a paper may hold."""
    names = {"A": names_a, "B": names_b, "C": names_c}[letter](0)
    vectors = {name[:-1] for name in names if name[-1] in "xy"} if letter == "C" else set()
    return {*names, *vectors, *WORDS, *(small_c(names) if letter == "A" else ())}


def names_of(key, number):
    """The names of an entry's paper, with what is special to the entry, and its sides if printed wrong."""
    if key[0] == "A":
        v = names_a(number)
        v = v | small_c(v) | relative_a(v, key)
        return v, printed_a(v, key)
    if key[0] == "B":
        v = names_b(number)
        v = v | special_b(v, key)
        return v, printed_b(v, key)
    v = names_c(number) | special_c(key, names_c(number))
    return v, [(C.link4_moment(v), v["IG4"] * v["alpha4"])] if key == "C-link4-moment" else None
