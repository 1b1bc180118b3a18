"""Paper C's driven motions from the raw loop: Gauss collocation of the equation of motion."""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

from mpmath import mp, mpf

from tests.papers.newton_euler_c import State, add, by_theta, dot, minus, moment, pin, slider, times

Torque = Callable[[mpf], mpf]
Pair = tuple[mpf, mpf]


class Rule(NamedTuple):
    """Gauss collocation on (0, 1): nodes, weights, and each node's integrals of the Lagrange polynomials."""

    nodes: list[mpf]
    weights: list[mpf]
    integrals: list[list[mpf]]


@cache
def rule(stages: int, digits: int) -> Rule:
    """The collocation rule of this number of stages, in this number of digits."""
    with mp.workdps(2 * digits + 10):
        legendre = mp.taylor(lambda x: mp.legendre(stages, x), 0, stages)
        roots = sorted(mp.re(root) for root in mp.polyroots(legendre[::-1], maxsteps=500, extraprec=400))
        nodes = [(1 + root) / 2 for root in roots]
        powers = mp.matrix([[node**k for node in nodes] for k in range(stages)])

        def quadrature(end: mpf) -> list[mpf]:
            moments = mp.matrix([end ** (k + 1) / (k + 1) for k in range(stages)])
            return list(mp.lu_solve(powers, moments))

        return Rule(nodes, quadrature(mpf(1)), [quadrature(node) for node in nodes])


def inertia(state: State, theta: mpf) -> Pair:
    """Effective moment of inertia at the crank, kg m2, and its slope, as the free bodies have them, but fast.

    Every point of a link is a fixed mixture of its two ends: two paths are differentiated instead of four.
    """
    at, zero = state._replace(theta=theta), (mpf(0), mpf(0))
    B, C = by_theta(pin, at)[1:], by_theta(slider, at)[1:]
    q2, q3 = mpf(state.r_crank) / mpf(state.AB), mpf(state.r_rod) / mpf(state.BC)
    ends = ((zero, zero), B), (B, C), (B, C)
    paths = [
        [add(times(1 - q, start), times(q, end)) for start, end in zip(*pair, strict=True)]
        for q, pair in zip((q2, q3, mpf(1)), ends, strict=True)
    ]
    masses = list(map(mpf, (state.m_crank, state.m_rod, state.m_slider)))
    first, second = rod_turning_of(B, C, at)
    value = mp.fdot(masses, [dot(p[0], p[0]) for p in paths]) + mpf(state.I_rod) * first**2
    slope = mp.fdot(masses, [dot(*p) for p in paths]) + mpf(state.I_rod) * first * second
    return value + mpf(state.I_crank), 2 * slope


def rod_turning_of(B: list[Pair], C: list[Pair], state: State) -> Pair:
    """Derivatives of the rod's angle from those of its ends: (C - B) x (C - B)' = BC^2 angle'."""
    along = minus(slider(state, state.theta), pin(state, state.theta))
    return tuple(moment(along, minus(c, b)) / mpf(state.BC) ** 2 for b, c in zip(B, C, strict=True))


def angular_acceleration(state: State, torque: mpf, theta: mpf, omega: mpf) -> mpf:
    """Acceleration of the crank under the torque alone: M alpha + M' omega^2/2 = T."""
    value, slope = inertia(state, theta)
    return (torque - slope * omega**2 / 2) / value


def step(state: State, torque: Torque, start: mpf, length: mpf, at: Pair, digits: int, stages: int) -> Pair:
    """(theta, omega) one step later, the collocation equations solved by repetition."""
    gauss, (theta0, omega0) = rule(stages, digits), at
    times = [start + length * node for node in gauss.nodes]
    moments = [torque(t) for t in times]
    alphas = [angular_acceleration(state, torque(start), theta0, omega0)] * stages
    while True:
        omegas = [omega0 + length * mp.fdot(row, alphas) for row in gauss.integrals]
        thetas = [theta0 + length * mp.fdot(row, omegas) for row in gauss.integrals]
        result = [
            angular_acceleration(state, *values) for values in zip(moments, thetas, omegas, strict=True)
        ]
        change = max(abs(a - b) for a, b in zip(result, alphas, strict=True))
        alphas = result
        if change <= mpf(10) ** -digits * (1 + max(map(abs, alphas))):
            omegas = [omega0 + length * mp.fdot(row, alphas) for row in gauss.integrals]
            return (
                theta0 + length * mp.fdot(gauss.weights, omegas),
                omega0 + length * mp.fdot(gauss.weights, alphas),
            )


def drive(state: State, torque: Torque, t_end: mpf, steps: int, digits: int = 30, stages: int = 16) -> Pair:
    """(theta, omega) at t_end from the state's own theta and omega at t = 0."""
    with mp.workdps(digits + 10):
        at, length = (mpf(state.theta), mpf(state.omega)), mpf(t_end) / steps
        for number in range(steps):
            at = step(state, torque, number * length, length, at, digits, stages)
        return at
