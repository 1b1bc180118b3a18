"""Paper C: the equations of its links, its matrix, and what it says of them."""

import itertools

import numpy as np
import pytest
from mpmath import mp, mpf

import desaxe as dx
from tests.papers import newton_euler_c as ne
from tests.papers import paper_c as C
from tests.papers.newton_euler_c import State
from tests.papers.proofs import proves, proves_each
from tests.papers.states_c import STATES, WEIGHTLESS, at_rest, force_scale, report, symbols

TINY = mpf(10) ** -35
SOLVED = [symbols(state) for state in WEIGHTLESS]


@proves("C-link4-no-turning", "given", says="alpha4 = 0 and aG4y is also zero")
def test_link4_does_not_turn():
    """The rates of the raw loop: the slider keeps its axis and is accelerated along it."""
    for state in STATES:
        places = [ne.slider(state, mpf(state.theta) + mpf(step) / 1000) for step in range(3)]
        assert max(place[1] for place in places) == min(place[1] for place in places) == -mpf(state.ec)
        assert places[0][0] != places[1][0]
        assert ne.acceleration(ne.slider, state)[0] != 0


@proves(
    "C-link4-third", "correct", says="The third equation for link 4 is essentially 0=0 and is not needed."
)
def test_link4_third_equation():
    """0 = 0 where all forces meet in the slider's centre; elsewhere it places the guide's force."""
    for v in SOLVED:
        assert C.link4_moment(v) == 0
        offset = v | {"R34x": mpf("0.01"), "R34y": mpf("0.02")}
        needed = (mpf("0.01") * v["F43y"] - mpf("0.02") * v["F43x"]) / v["F14y"]
        assert abs(C.link4_moment(offset)) > 0
        assert abs(C.link4_moment(offset | {"R14x": needed})) < TINY * force_scale(v)


@proves_each(
    {f"C-matrix-row{n}": n for n in range(1, 9)},
    "correct",
    says={f"C-matrix-row{n}": f"[{C.MATRIX[n - 1]}]" for n in range(1, 9)},
    cites={"C-matrix-row7": "C-matrix-friction-sign"},
)
def test_matrix_row(number):
    for state, v in list(zip(WEIGHTLESS, SOLVED, strict=True))[:8]:
        for friction in (mpf("0.3"), mpf("-0.3")):
            mine, printed = ne.matrix(state, friction), C.printed_matrix(v, friction)[number - 1]
            assert all(abs(entry - mine[number - 1, k]) < TINY for k, entry in enumerate(printed))


@proves("C-right-hand-side", "correct", says=C.RIGHT_HAND_SIDE)
def test_right_hand_side():
    for state, v in zip(WEIGHTLESS, SOLVED, strict=True):
        mine, printed = ne.right_hand_side(state), C.printed_right_hand_side(v)
        assert all(abs(p - q) < TINY * (1 + abs(q)) for p, q in zip(printed, mine, strict=True))
        assert all(q != 0 for q in mine)


@proves("C-unknowns", "correct", says=f"[{' '.join(C.UNKNOWNS)}]")
def test_order_of_the_unknowns():
    for v in SOLVED:
        A, b = C.printed_matrix(v), C.printed_right_hand_side(v)
        x = [v[name] for name in C.UNKNOWNS]

        def residual(x, A=A, b=b):
            return max(abs(mp.fdot(row, x) - right) for row, right in zip(A, b, strict=True))

        scale = force_scale(v) + abs(v["T12"])
        assert residual(x) < TINY * scale
        for i, j in itertools.combinations(range(8), 2):
            swapped = list(x)
            swapped[i], swapped[j] = x[j], x[i]
            assert residual(swapped) > mpf(10) ** -6 * abs(x[i] - x[j])


@proves("C-matrix-friction-sign", "omission", says="+-mu", cites="7")
def test_friction_needs_a_sign():
    """One sign of +-mu opposes sliding, the other drives it; which, depends on the motion and on F14y."""
    right = set()
    for state in STATES:
        forces = [ne.solve(state, sign * mpf("0.1")) for sign in (1, -1)]
        powers = [result["F14x"] * ne.sliding(state) for result in forces]
        assert powers[0] * powers[1] < 0
        right.add((1 if powers[0] < 0 else -1, ne.sliding(state)))
        kept = ne.balances(state._replace(mu=0.1))
        assert [result["F14x"] * ne.sliding(state) < 0 for result in kept] == [True]
    assert right == set(itertools.product((1, -1), (1, -1)))
    state = next(state for state in STATES if ne.solve(state)["F14y"] * ne.sliding(state) < 0)
    (result,) = ne.balances(state._replace(mu=0.1))
    v = symbols(state) | {name: result[name] for name in ("F14x", "F14y")}
    return {"friction": v["F14x"], "names": v | {"mu": mpf(0.1), "sense": mpf(ne.sliding(state))}}


@proves(
    "C-no-friction",
    "correct",
    says="we will take FPy = 0 ... the coefficient of friction is also zero",
    cites="7 8",
)
def test_no_vertical_force_no_friction():
    """The case of the listing: FPy = 0 and mu = 0 leave no F14x and a guide force equal to F43y."""
    for state in WEIGHTLESS:
        v = symbols(state._replace(F_X=0.0))
        assert v["F14x"] == v["FPy"] == 0
        assert abs(v["F14y"] - v["F43y"]) < TINY * force_scale(v)
    listing = C.run_listing()
    assert listing["A"][6].tolist() == [0, 0, 0, 0, -1, 0, 0, 0]
    assert listing["B"][7] == 0


@proves(
    "C-balance",
    "wrong claim",
    says="Forces along X and Y directions and Moments along Z direction are balanced i.e.,"
    " sum Fx = 0, sum Fy = 0, sum Mz = 0",
)
def test_balance_of_forces_is_not_zero():
    """Sum F = 0 and sum M = 0 hold at rest only; the equations that follow, and the listing, have m a."""
    held = symbols(at_rest(report()))
    assert held["F12x"] + held["F32x"] == held["F43y"] - held["F32y"] == 0
    listing = C.run_listing()
    for v in SOLVED:
        assert abs(v["F12x"] + v["F32x"]) > 0
        assert abs(v["F12x"] + v["F32x"] - v["m2"] * v["aG2x"]) < TINY * force_scale(v)
    return {"inertia": [mpf(x) for x in listing["B"][[1, 3, 4]].tolist()]}


@proves("C-assumption-frame", "given", says="1", cites="1")
def test_frame_bears_the_links():
    """F12 and F14, with the load, are all the force there is on the three links: mass times acceleration."""
    for v in SOLVED:
        for axis in "xy":
            total = v["F12" + axis] + v["F14" + axis] + v["FP" + axis]
            moved = sum(v[f"m{link}"] * v[f"aG{link}{axis}"] for link in (2, 3, 4))
            assert abs(total - moved) < TINY * force_scale(v)


@proves("C-inverse", "correct", says="Solving the equations in the form Ax = b, and computing x = A^-1 b")
def test_inverse_solves_the_system():
    """With right arms the matrix has an inverse wherever the rod is not across the slider axis."""
    for state, v in zip(WEIGHTLESS, SOLVED, strict=True):
        x = mp.inverse(mp.matrix(C.printed_matrix(v))) * mp.matrix(C.printed_right_hand_side(v))
        scale = force_scale(v) + abs(v["T12"])
        assert all(abs(x[n] - v[name]) < mpf(10) ** -30 * scale for n, name in enumerate(C.UNKNOWNS))
        reach = abs(v["R43x"] - v["R23x"])  # the determinant, by expansion: the rod's reach along the axis
        assert abs(abs(mp.det(ne.matrix(state))) - reach) < mpf(10) ** -30
    return {"reach": mp.det(ne.matrix(state)), "names": v}


@proves(
    "C-inverse-of-the-listing", "wrong claim", says="computing x = A^-1 b [for the matrix A of the listing]"
)
def test_inverse_of_the_listing_does_not_exist():
    A, right = (C.run_listing(listing)["A"] for listing in (C.LISTING, C.corrected_listing()))
    rank = int(np.linalg.matrix_rank(A))
    assert rank < np.linalg.matrix_rank(right) == 8
    condition = mpf(float(np.linalg.cond(right)))
    result = {"rank": [mp.det(mp.matrix(A.tolist())), mpf(rank)], "condition": condition}
    return result | {"names": symbols(report())}


@proves("C-anticlockwise", "correct")
def test_anticlockwise_is_positive():
    """A positive torque alone starts the crank towards growing theta, anticlockwise in these axes."""
    for state in STATES:
        free = State(*at_rest(state))._replace(F_X=0.0, F_Y=0.0, g_X=0.0, g_Y=0.0, alpha=1.0)
        torque = ne.solve(free)["T12"]
        assert torque > 0
        assert abs(torque - ne.effective_inertia(free)) < TINY * torque
        pin, turned, _ = ne.by_theta(ne.pin, free)
        assert ne.moment(pin, turned) > 0


def test_accelerations_are_those_of_the_package():
    """The free bodies' kinematics against the package's, through the mapping of the frames."""
    names = ["Y", "a_C", "a_B_X", "a_B_Y", "alpha_BC"]
    for state in STATES:
        motion = {
            name: getattr(state, name) for name in ("theta", "ec", "AB", "BC", "omega", "alpha", "branch")
        }
        result = dx.evaluate(names, **motion)
        pin, block = ne.acceleration(ne.pin, state), ne.acceleration(ne.slider, state)
        assert result["Y"] == pytest.approx(float(ne.slider(state, mpf(state.theta))[0]), rel=1e-11)
        assert (result["a_B_Y"], result["a_B_X"]) == pytest.approx(tuple(map(float, pin)), rel=1e-11)
        assert result["a_C"] == pytest.approx(float(block[0]), rel=1e-9)
        assert -state.branch * result["alpha_BC"] == pytest.approx(
            float(ne.rod_acceleration(state)), rel=1e-9
        )
