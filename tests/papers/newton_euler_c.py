"""The three free bodies of the offset slider-crank, by hand, in paper C's frame and names, at 40 digits.

Frame: x along the slider axis, y to the left of it, crank angle theta anticlockwise from +x, moments and
torques positive anticlockwise. Link 1 is the frame, 2 the crank, 3 the rod, 4 the slider; `Fij` is the force
of link i on link j. A = (0, 0), B the crank pin, C the slider on the line y = -ec. All SI.

Nothing here is a solved formula. Positions come from the raw loop; their derivatives by theta are central
differences at 120 digits; the eight unknowns solve the eight equations of motion of the bodies. The package
derives its forces symbolically in a frame of its own: `paper_c.PACKAGE` maps them.
"""

from collections.abc import Callable
from typing import NamedTuple

from mpmath import mp, mpf

DIGITS = 40
UNKNOWNS = ("F12x", "F12y", "F32x", "F32y", "F43x", "F43y", "F14y", "T12")

Vector = tuple[mpf, mpf]


class State(NamedTuple):
    """A mechanism in motion, by the package's names (a force along its Y is one along x here)."""

    theta: float
    ec: float
    AB: float
    BC: float
    omega: float
    alpha: float
    branch: int = 1
    m_crank: float = 0.0
    m_rod: float = 0.0
    m_slider: float = 0.0
    I_crank: float = 0.0
    I_rod: float = 0.0
    r_crank: float = 0.0
    r_rod: float = 0.0
    F_X: float = 0.0
    F_Y: float = 0.0
    g_X: float = 0.0
    g_Y: float = 0.0
    mu: float = 0.0


def add(*vectors: Vector) -> Vector:
    """Sum of plane vectors."""
    return mp.fsum(v[0] for v in vectors), mp.fsum(v[1] for v in vectors)


def times(factor: mpf, vector: Vector) -> Vector:
    """A vector stretched."""
    return factor * vector[0], factor * vector[1]


def minus(end: Vector, start: Vector) -> Vector:
    """The vector from start to end."""
    return end[0] - start[0], end[1] - start[1]


def dot(a: Vector, b: Vector) -> mpf:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1]


def moment(arm: Vector, force: Vector) -> mpf:
    """Moment of a force at the end of an arm, anticlockwise."""
    return arm[0] * force[1] - arm[1] * force[0]


# --- positions and their derivatives --------------------------------------------------------------


def pin(state: State, theta: mpf) -> Vector:
    """Crank pin B."""
    return mpf(state.AB) * mp.cos(theta), mpf(state.AB) * mp.sin(theta)


def slider(state: State, theta: mpf) -> Vector:
    """Slider C: on the line y = -ec, one rod length from B, on the side of its branch."""
    x, y = pin(state, theta)
    reach = mp.sqrt(mpf(state.BC) ** 2 - (y + mpf(state.ec)) ** 2)
    return x + state.branch * reach, -mpf(state.ec)


def rod(state: State, theta: mpf) -> Vector:
    """Unit vector from B to C."""
    return times(1 / mpf(state.BC), minus(slider(state, theta), pin(state, theta)))


def crank_centre(state: State, theta: mpf) -> Vector:
    """Centre of mass of the crank."""
    return times(mpf(state.r_crank) / mpf(state.AB), pin(state, theta))


def rod_centre(state: State, theta: mpf) -> Vector:
    """Centre of mass of the rod."""
    return add(pin(state, theta), times(mpf(state.r_rod), rod(state, theta)))


def by_theta(path: Callable[[State, mpf], Vector], state: State) -> tuple[Vector, Vector, Vector]:
    """A path with its first and second derivative by the crank angle, to some 50 digits."""
    with mp.workdps(3 * DIGITS):
        theta, h = mpf(state.theta), mpf(10) ** -30
        behind, here, ahead = (path(state, theta + step) for step in (-h, mpf(0), h))
        first = times(1 / (2 * h), minus(ahead, behind))
        second = times(1 / h**2, add(ahead, behind, times(mpf(-2), here)))
        return here, first, second


def acceleration(path: Callable[[State, mpf], Vector], state: State) -> Vector:
    """Second time derivative of a path in this state."""
    _, first, second = by_theta(path, state)
    return add(times(mpf(state.alpha), first), times(mpf(state.omega) ** 2, second))


def rod_turning(state: State) -> tuple[mpf, mpf]:
    """First and second derivative of the rod's angle by theta, anticlockwise."""
    here, first, second = by_theta(rod, state)
    return moment(here, first), moment(here, second)


def rod_acceleration(state: State) -> mpf:
    """alpha3, rad/s2."""
    first, second = rod_turning(state)
    return mpf(state.alpha) * first + mpf(state.omega) ** 2 * second


# --- equations of motion --------------------------------------------------------------------------


class Bodies(NamedTuple):
    """The known values of the free bodies; R from each centre of mass to a joint."""

    R12: Vector
    R32: Vector
    R23: Vector
    R43: Vector
    a_G2: Vector
    a_G3: Vector
    a_G4: Vector
    alpha2: mpf
    alpha3: mpf
    gravity: Vector
    force: Vector


def bodies(state: State) -> Bodies:
    """Arms, accelerations and applied forces in this state."""
    theta = mpf(state.theta)
    B, C = pin(state, theta), slider(state, theta)
    G2, G3 = crank_centre(state, theta), rod_centre(state, theta)
    return Bodies(
        R12=minus((mpf(0), mpf(0)), G2),
        R32=minus(B, G2),
        R23=minus(B, G3),
        R43=minus(C, G3),
        a_G2=acceleration(crank_centre, state),
        a_G3=acceleration(rod_centre, state),
        a_G4=acceleration(slider, state),
        alpha2=mpf(state.alpha),
        alpha3=rod_acceleration(state),
        gravity=(mpf(state.g_Y), mpf(state.g_X)),
        force=(mpf(state.F_Y), mpf(state.F_X)),
    )


def imbalance(state: State, at: Bodies, unknowns: list[mpf], friction: mpf) -> list[mpf]:
    """The residuals of each body's force and moment balance; zero for the right unknowns.

    `friction` is F14x/F14y: plus or minus mu.
    """
    F12, F32, F43 = tuple(unknowns[0:2]), tuple(unknowns[2:4]), tuple(unknowns[4:6])
    F14y, T12 = unknowns[6:]
    F14 = friction * F14y, F14y
    m2, m3, m4 = map(mpf, (state.m_crank, state.m_rod, state.m_slider))
    crank = minus(add(F12, F32, times(m2, at.gravity)), times(m2, at.a_G2))
    coupler = minus(minus(add(F43, times(m3, at.gravity)), F32), times(m3, at.a_G3))
    block = minus(minus(add(F14, at.force, times(m4, at.gravity)), F43), times(m4, at.a_G4))
    crank_moment = T12 + moment(at.R12, F12) + moment(at.R32, F32) - mpf(state.I_crank) * at.alpha2
    rod_moment = moment(at.R43, F43) - moment(at.R23, F32) - mpf(state.I_rod) * at.alpha3
    return [*crank, crank_moment, *coupler, rod_moment, *block]


def matrix(state: State, friction: mpf | int = 0) -> mp.matrix:
    """The coefficients of the unknowns: the imbalance is linear in them."""
    at, zero = bodies(state), [mpf(0)] * 8
    free = imbalance(state, at, zero, friction)
    columns = [
        imbalance(state, at, [mpf(row == column) for row in range(8)], friction) for column in range(8)
    ]
    return mp.matrix([[columns[c][r] - free[r] for c in range(8)] for r in range(8)])


def right_hand_side(state: State) -> mp.matrix:
    """The right-hand side: inertia less applied forces."""
    return mp.matrix([-value for value in imbalance(state, bodies(state), [mpf(0)] * 8, mpf(0))])


def solve(state: State, friction: mpf | int = 0) -> dict[str, mpf]:
    """The eight unknowns and F14x, for F14x = friction * F14y."""
    with mp.workdps(2 * DIGITS):
        result = mp.lu_solve(matrix(state, friction), right_hand_side(state))
        forces = dict(zip(UNKNOWNS, result, strict=True))
        return forces | {"F14x": friction * forces["F14y"]}


# --- friction: which sign ------------------------------------------------------------------------


def sliding(state: State) -> int:
    """Sign of the slider's velocity along x; at rest, of the motion that alpha starts; 0 if there is none."""
    direction = by_theta(slider, state)[1][0]
    turning = state.omega if state.omega else state.alpha
    return int(mp.sign(direction) * mp.sign(turning))


def balances(state: State) -> list[dict[str, mpf]]:
    """Every solution in which friction opposes sliding: one, or none or two where it jams."""
    with mp.workdps(2 * DIGITS):
        mu, sense = mpf(state.mu), sliding(state)
        if not mu or not sense:
            return [solve(state)]
        tried = (solve(state, sign * mu) for sign in (1, -1))
        return [forces for forces in tried if forces["F14x"] * sense < 0]


# --- energy ---------------------------------------------------------------------------------------


def effective_inertia(state: State) -> mpf:
    """Twice the kinetic energy at a crank speed of 1 rad/s, kg m2."""
    speeds = ((state.m_crank, crank_centre), (state.m_rod, rod_centre), (state.m_slider, slider))
    velocities = [(mpf(mass), by_theta(path, state)[1]) for mass, path in speeds]
    turning = mpf(state.I_crank) + mpf(state.I_rod) * rod_turning(state)[0] ** 2
    return turning + mp.fsum(mass * dot(v, v) for mass, v in velocities)


def kinetic_energy(state: State) -> mpf:
    """Kinetic energy, J."""
    return effective_inertia(state) * mpf(state.omega) ** 2 / 2


def potential_energy(state: State) -> mpf:
    """Energy of gravity, J, zero with everything at A."""
    gravity, theta = (mpf(state.g_Y), mpf(state.g_X)), mpf(state.theta)
    paths = ((state.m_crank, crank_centre), (state.m_rod, rod_centre), (state.m_slider, slider))
    return -mp.fsum(mpf(mass) * dot(gravity, path(state, theta)) for mass, path in paths)


def holding_torque(state: State) -> mpf:
    """T12 that holds the mechanism at rest without friction, by virtual work, N m."""
    gravity, force = (mpf(state.g_Y), mpf(state.g_X)), (mpf(state.F_Y), mpf(state.F_X))
    paths = ((state.m_crank, crank_centre), (state.m_rod, rod_centre), (state.m_slider, slider))
    weights = (mpf(mass) * dot(gravity, by_theta(path, state)[1]) for mass, path in paths)
    return -dot(force, by_theta(slider, state)[1]) - mp.fsum(weights)
