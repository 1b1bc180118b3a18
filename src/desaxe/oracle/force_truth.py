"""Reference values of forces, torques and energies at one point, to any number of digits.

Nothing here is shared with the package, and nothing is derived: the places of the three centres of mass are
power series in time, from the raw loop closure of truth.py; their second coefficients are the accelerations,
and Newton's and Euler's equations of the three free bodies, moments about the centres of mass, are solved for
the forces as they stand, by elimination in Taylor polynomials in the parameters.

    truth("T_in_wrt_m_rod", theta=1.0, ec=0.01, AB=0.125, BC=0.35, omega0=157.0, m_rod=2.0, g_Y=-9.81)
    conditions("T_in", theta=1.0, ec=0.01, AB=0.125, BC=0.35, omega0=157.0, m_rod=2.0)
    force_balances(theta=0.2, ec=0.3, AB=0.125, BC=0.35, omega=1.0, F_X=1.0, mu=4.0)           # 0, 1 or 2

Here ``truth``, ``truth_all`` and ``conditions`` know the kinematic names too. What is not given is 0, a
centre of mass (``r_crank``, ``r_rod``) the middle of its link: derivatives by AB and BC then move it; given,
it is held.

Friction opposes the motion of the slider: of V_C, of the motion that alpha starts where the crank stands
still, of none where nothing moves or at a dead centre. Both signs of the normal force are tried, and those
count that come out as assumed. Where none or two do, what friction touches is NaN; the force and moment on
the frame and the energies it does not touch. |N_C| at N_C = 0 is taken from the right.

Where the mechanism cannot be assembled or folds, everything that needs its shape is NaN; where it is stalled,
everything that needs its speed.
"""

from collections.abc import Callable, Iterable
from functools import lru_cache
from typing import Any, NamedTuple

import mpmath
from flint import arb, arb_series

from . import truth as kinematic
from .jet import BITS, REST, Jet, limit, precision, settled, sign, tendency
from .truth import LAW, STATE, loop, split, stands_still, turning

BODIES = ("m_crank", "m_rod", "m_slider", "I_crank", "I_rod", "r_crank", "r_rod")
OTHERS = (*BODIES, "F_X", "F_Y", "g_X", "g_Y", "mu")
PARAMETERS = (*LAW, *OTHERS)
STATE_PARAMETERS = (*STATE, *OTHERS)

TOUCHED = ("T_in", "F_A_X", "F_A_Y", "F_B_X", "F_B_Y", "F_C_X", "F_C_Y", "N_C", "F_friction", "power_in")
MAGNITUDES = ("F_A", "F_B", "F_C", "P_friction")  # of what friction touches
SHAKING = ("F_shaking_X", "F_shaking_Y", "M_shaking")
INERTIA = ("F_inertia_X", "F_inertia_Y", "M_inertia")
ENERGIES = ("kinetic_energy", "potential_energy", "M_eff")
MASSES = ("m_rotating", "m_reciprocating", "I_lumping")
FORCES = (*TOUCHED[:-1], *SHAKING, *INERTIA, "power_in", *MAGNITUDES, *ENERGIES, *MASSES)

Vector = tuple[Jet, Jet]
Equation = tuple[dict[str, Jet], Jet]  # unknown -> coefficient, and the right-hand side


class Point(NamedTuple):
    """One point, and the parameters (by number, repeated for higher orders) to differentiate by."""

    values: tuple[Any, ...]  # a centre of mass that is not given is None
    law: bool
    branch: int
    by: tuple[int, ...]

    @property
    def still(self) -> bool:
        """True if the crank is at rest."""
        return stands_still(self.values[0], *self.values[4:6], self.law)

    @property
    def direction(self) -> int:
        """The sign of the crank's speed or, at rest, of alpha; 0 if nothing moves."""
        speed, alpha = self.values[4:6]
        return sign(speed) if not self.still else sign(alpha) if alpha else 0


class Mechanism(NamedTuple):
    """The mechanism as functions of time: parameters, positions of joints and centres of mass."""

    given: dict[str, Jet]
    theta: Jet
    B: Vector
    C: Vector
    crank: Vector  # the centres of mass
    rod: Vector


def _jet(at: Point, number: int) -> Jet:
    """A parameter as an exact jet, with its derivative if it is one to differentiate by; 0 has no term."""
    value = at.values[number]
    terms = {(): arb_series([arb(value)])} if value or number < len(LAW) else {}
    return Jet(terms | ({(number,): arb_series([1])} if number in at.by else {}), len(at.by))


def _constant(value: arb | int, like: Jet) -> Jet:
    return Jet({(): arb_series([value])}, like.order)


def _given(at: Point) -> dict[str, Jet]:
    """The parameters by name, the speed as omega0 whichever it is."""
    inputs = {name: _jet(at, number) for number, name in enumerate(PARAMETERS)}
    for centre, link in (("r_crank", "AB"), ("r_rod", "BC")):
        if at.values[PARAMETERS.index(centre)] is None:
            inputs[centre] = inputs[centre] + inputs[link] * _constant(arb("0.5"), inputs[link])
    if at.still:
        inputs["omega0"] = inputs["omega0"] + _constant(sign(at.values[4]) * REST, inputs["omega0"])
    return inputs


@lru_cache(maxsize=256)
def _mechanism(at: Point, bits: int, unit_speed: bool = False) -> Mechanism | None:
    """The moving mechanism, or that at speed 1; None if it cannot be assembled, or with too few bits."""
    with precision(bits, terms=3):
        inputs = _given(at)
        theta, ec, AB, BC, omega, alpha = (inputs[p] for p in LAW)
        if unit_speed:
            theta = turning(theta, _constant(1, theta), Jet({}, theta.order), law=False)
        else:
            theta = turning(theta, omega, alpha, at.law)
        sine, cosine, across, rise = loop(theta, ec, AB, BC, at.branch)
        B = AB * sine, AB * cosine
        C = ec.times(-1), B[1] + rise
        along = inputs["r_rod"] * BC.inverse()
        crank = inputs["r_crank"] * sine, inputs["r_crank"] * cosine
        rod = B[0] - along * across, B[1] + along * rise
        moving = theta.rate(2) + C[1].rate(2)
        return Mechanism(inputs, theta, B, C, crank, rod) if moving.terms[()][0].is_finite() else None


def _rod_turn(mechanism: Mechanism) -> Jet:
    """The rod's angular acceleration in the sense of theta: the rate of (r x v) / BC^2, r from B to C."""
    (B_X, B_Y), (C_X, C_Y) = mechanism.B, mechanism.C
    x, y = C_X - B_X, C_Y - B_Y
    length = mechanism.given["BC"].inverse()
    return (y.rate(0) * x.rate(2) - x.rate(0) * y.rate(2)) * length * length


def _body(
    held: list[tuple[str, int, Vector]], mass: Jet, centre: Vector, spin: Jet, mechanism: Mechanism
) -> list[Equation]:
    """Newton's two equations of a body and Euler's about its centre of mass.

    It is held by forces F_<name> with a sign at places; the spin is what its moments add up to.
    """
    one = _constant(1, spin)
    x, y = (p.rate(0) for p in centre)
    moments: dict[str, Jet] = {}
    for name, side, place in held:
        moments[f"F_{name}_X"] = (place[1].rate(0) - y).times(side)
        moments[f"F_{name}_Y"] = (x - place[0].rate(0)).times(side)
    newton: list[Equation] = []
    for axis, p in zip("XY", centre, strict=True):
        forces = {f"F_{name}_{axis}": one.times(side) for name, side, _ in held}
        newton.append((forces, mass * (p.rate(2) - mechanism.given[f"g_{axis}"])))
    return [*newton, (moments, spin)]


def _equations(mechanism: Mechanism, friction: int) -> list[Equation]:
    """The three free bodies; the guide's friction is mu N_C times 1, -1 or nothing, against +Y."""
    inputs, B, C = mechanism.given, mechanism.B, mechanism.C
    one, nothing = _constant(1, inputs["AB"]), Jet({}, inputs["AB"].order)
    crank_spin = inputs["I_crank"] * mechanism.theta.rate(2)
    rod_spin = inputs["I_rod"] * _rod_turn(mechanism)
    held = [("A", 1, (nothing, nothing)), ("B", -1, B)]
    crank = _body(held, inputs["m_crank"], mechanism.crank, crank_spin, mechanism)
    rod = _body([("B", 1, B), ("C", -1, C)], inputs["m_rod"], mechanism.rod, rod_spin, mechanism)
    slider = _body([("C", 1, C)], inputs["m_slider"], C, nothing, mechanism)[:2]  # it does not turn
    crank[2][0]["T_in"] = one
    slider[0][0]["N_C"] = slider[1][0]["F_friction"] = one
    loads = zip(slider, ("F_X", "F_Y"), strict=True)
    slider = [(left, right - inputs[load]) for (left, right), load in loads]
    coulomb = {"F_friction": one, "N_C": inputs["mu"].times(friction)}, nothing
    return [*crank, *rod, *slider, coulomb]


def _leading(coefficient: Jet) -> arb:
    return coefficient.terms[()][0] if () in coefficient.terms else arb(0)


def _without(unknown: str, row: Equation, pivot: Equation) -> Equation:
    """Eliminate an unknown from a row by the pivot's row, whose coefficient 1 is not stored."""
    left, right = dict(row[0]), row[1]
    factor = left.pop(unknown, Jet({}, right.order))
    for name, coefficient in pivot[0].items():
        term = factor * coefficient
        left[name] = left[name] - term if name in left else term.times(-1)
    return left, right - factor * pivot[1]


def _solve(equations: list[Equation], still: bool) -> dict[str, Jet] | None:
    """Gauss-Jordan elimination with row pivots; empty if singular, None if undecided in these bits."""
    solved: dict[str, Equation] = {}
    for equation in equations:
        left, right = equation
        for unknown, pivot in solved.items():
            left, right = _without(unknown, (left, right), pivot)
        sizes = {name: abs(_leading(coefficient)).abs_lower() for name, coefficient in left.items()}
        unknown = max(sizes, key=sizes.__getitem__)
        if not sizes[unknown] > 0:
            return {} if all(tendency(_leading(a), still) == 0 for a in left.values()) else None
        inverse = left.pop(unknown).inverse()
        pivot = {name: a * inverse for name, a in left.items()}, right * inverse
        solved = {name: _without(unknown, other, pivot) for name, other in solved.items()} | {unknown: pivot}
    return {unknown: right for unknown, (_, right) in solved.items()}


@lru_cache(maxsize=256)
def _balances(at: Point, bits: int) -> list[dict[str, Jet]] | None:
    """The solutions whose normal force is as assumed; None if there is no mechanism, or too few bits."""
    mechanism, steady = _mechanism(at, bits), _mechanism(at, bits, unit_speed=True)
    if mechanism is None or steady is None:
        return None
    with precision(bits):
        slope = tendency(_leading(steady.C[1].rate(1)))
        if slope is None:
            return None
        slides = slope * at.direction if mechanism.given["mu"].terms else 0
        result = []
        for side in (1, -1) if slides else (0,):
            balance = _solve(_equations(mechanism, side * slides), at.still)
            pushes = tendency(_leading(balance["N_C"]), at.still) if balance else None
            if balance is None or (balance and pushes is None):
                return None
            if balance and (pushes == side or side == 0 or (pushes == 0 and side == 1)):
                result.append(balance)
        return result


def _magnitude(x: Jet, y: Jet) -> Jet:
    """The root of x^2 + y^2; where there is no force at all it is 0, and has no derivative."""
    if () in x.terms or () in y.terms:
        return (x * x + y * y).sqrt()
    none = dict.fromkeys((*x.terms, *y.terms), arb_series([arb.nan()]))
    return Jet({**none, (): arb_series([0])}, x.order)


def _touched(at: Point, bits: int) -> dict[str, Jet] | None:
    """The forces that friction affects, of the only force balance; empty unless there is exactly one."""
    mechanism, balances = _mechanism(at, bits), _balances(at, bits)
    if mechanism is None or balances is None:
        return None
    if len(balances) != 1:
        return {}
    with precision(bits):
        result = balances[0] | {"power_in": balances[0]["T_in"] * mechanism.theta.rate(1)}
        for joint in "ABC":
            result[f"F_{joint}"] = _magnitude(result[f"F_{joint}_X"], result[f"F_{joint}_Y"])
        return result | {"P_friction": (result["F_friction"] * mechanism.C[1].rate(1)).times(-1)}


@lru_cache(maxsize=256)
def _shaking(at: Point, bits: int) -> dict[str, Jet] | None:
    """Shaking force and moment, to which friction adds nothing; empty unless there is one force balance."""
    mechanism, balances = _mechanism(at, bits), _balances(at, bits)
    if balances is not None and len(balances) != 1:
        return {}
    with precision(bits):
        balance = mechanism and _solve(_equations(mechanism, 0), at.still)
        if not mechanism or not balance:
            return None
        return {
            "F_shaking_X": (balance["F_A_X"] + balance["N_C"]).times(-1),
            "F_shaking_Y": balance["F_A_Y"].times(-1),
            "M_shaking": (balance["T_in"] + mechanism.C[1].rate(0) * balance["N_C"]).times(-1),
        }


@lru_cache(maxsize=256)
def _inertia(at: Point, bits: int) -> dict[str, Jet] | None:
    """The rates of the momentum and of the angular momentum about A of the three bodies, reversed."""
    mechanism = _mechanism(at, bits)
    if mechanism is None:
        return None
    with precision(bits):
        inputs = mechanism.given
        nothing = Jet({}, inputs["AB"].order)
        X, Y = nothing, nothing
        M = inputs["I_crank"] * mechanism.theta.rate(2) + inputs["I_rod"] * _rod_turn(mechanism)
        for mass, (x, y) in zip(BODIES[:3], (mechanism.crank, mechanism.rod, mechanism.C), strict=True):
            force_X, force_Y = inputs[mass] * x.rate(2), inputs[mass] * y.rate(2)
            X, Y, M = X + force_X, Y + force_Y, M + y.rate(0) * force_X - x.rate(0) * force_Y
        return {name: rate.times(-1) for name, rate in zip(INERTIA, (X, Y, M), strict=True)}


def _kinetic_energy(mechanism: Mechanism) -> Jet:
    """Half of mass times speed squared, of the centres; half of inertia times turning speed squared."""
    inputs, (B_X, B_Y), (C_X, C_Y) = mechanism.given, mechanism.B, mechanism.C
    x, y, length = C_X - B_X, C_Y - B_Y, inputs["BC"].inverse()
    rod_turns = (y.rate(0) * x.rate(1) - x.rate(0) * y.rate(1)) * length * length
    speeds = [(inputs["I_crank"], mechanism.theta.rate(1)), (inputs["I_rod"], rod_turns)]
    centres = (("m_crank", mechanism.crank), ("m_rod", mechanism.rod), ("m_slider", mechanism.C))
    speeds += [(inputs[mass], p.rate(1)) for mass, place in centres for p in place]
    twice = sum((mass * speed * speed for mass, speed in speeds), Jet({}, x.order))
    return twice * _constant(arb("0.5"), twice)


@lru_cache(maxsize=256)
def _energies(at: Point, bits: int) -> dict[str, Jet] | None:
    moving, steady = _mechanism(at, bits), _mechanism(at, bits, unit_speed=True)
    if steady is None:
        return None
    inputs = steady.given
    with precision(bits, terms=3):
        energies = {"M_eff": _kinetic_energy(steady).times(2), "potential_energy": Jet({}, len(at.by))}
        for mass, place in (("m_crank", steady.crank), ("m_rod", steady.rod), ("m_slider", steady.C)):
            for axis, p in zip("XY", place, strict=True):
                energies["potential_energy"] -= inputs[mass] * inputs[f"g_{axis}"] * p.rate(0)
        return energies | ({"kinetic_energy": _kinetic_energy(moving)} if moving else {})


@lru_cache(maxsize=256)
def _masses(at: Point, bits: int) -> dict[str, Jet]:
    """The papers' masses at B, and at C; they need no shape, so no mechanism."""
    with precision(bits):
        inputs = _given(at)
        m_rod, r_rod, AB, BC = (inputs[p] for p in ("m_rod", "r_rod", "AB", "BC"))
        of_crank = inputs["m_crank"] * inputs["r_crank"] * AB.inverse()
        return {
            "m_rotating": m_rod * (BC - r_rod) * BC.inverse() + of_crank,
            "m_reciprocating": inputs["m_slider"] + m_rod * r_rod * BC.inverse(),
            "I_lumping": m_rod * r_rod * (BC - r_rod) - inputs["I_rod"],
        }


_GROUPS: dict[str, Callable[[Point, int], dict[str, Jet] | None]] = {
    **dict.fromkeys((*TOUCHED, *MAGNITUDES), _touched),
    **dict.fromkeys(SHAKING, _shaking),
    **dict.fromkeys(INERTIA, _inertia),
    **dict.fromkeys(ENERGIES, _energies),
    **dict.fromkeys(MASSES, _masses),
}


def _point(
    by: tuple[int, ...],
    *,
    theta: float,
    ec: float,
    AB: float,
    BC: float,
    omega0: float = 0.0,
    alpha: float = 0.0,
    omega: float | None = None,
    branch: int = 1,
    **others: float | None,
) -> Point:
    if not others.keys() <= set(OTHERS):
        raise TypeError(f"unknown: {', '.join(others.keys() - set(OTHERS))}")
    motion = (theta, ec, AB, BC, omega0 if omega is None else omega, alpha)
    centres = dict.fromkeys(("r_crank", "r_rod"))
    inputs = dict.fromkeys(OTHERS, 0.0) | centres | others
    values = (*motion, *(inputs[name] for name in OTHERS))
    return Point(tuple(x if x is None else float(x) for x in values), omega is None, branch, by)


def _value(jet: Jet | None, by: tuple[int, ...], bits: int, digits: int) -> mpmath.mpf | None:
    """A partial derivative; None if it has fewer digits."""
    if jet is None:
        return None
    with precision(bits):
        return settled(jet.partial(by), digits)


def truth(name: str, *, digits: int = 50, **point: Any) -> mpmath.mpf:
    """One quantity or sensitivity (``q``, ``q_wrt_p``, ``q_wrt_p_p``, ...) to `digits` correct digits."""
    law = point.get("omega") is None
    if name.partition("_wrt_")[0] not in FORCES:
        motion = {p: value for p, value in point.items() if p not in OTHERS}
        return kinematic.truth(name, digits=digits, **motion)
    quantity, by = split(name, PARAMETERS if law else STATE_PARAMETERS)
    at = _point(by, **point)
    for bits in BITS[-1:] if at.still else BITS:
        jets = _GROUPS[quantity](at, bits)
        if jets == {}:
            break
        result = _value(jets.get(quantity), by, bits, digits) if jets else None
        if result is not None:
            return limit(result) if at.still else result
    return mpmath.mpf("nan")


def truth_all(names: Iterable[str], **point: Any) -> dict[str, mpmath.mpf]:
    """Many names at one point; the work is shared."""
    return {name: truth(name, **point) for name in names}


def force_balances(**point: Any) -> int | None:
    """The number of force balances: 0, 1 or 2; None if it cannot be assembled or does not move."""
    at = _point((), **point)
    for bits in BITS[-1:] if at.still else BITS:
        balances = _balances(at, bits)
        if balances is not None:
            return len(balances)
    return None


def force_names(parameters: tuple[str, ...] = PARAMETERS) -> list[str]:
    """Every force quantity with its first sensitivities."""
    return [*FORCES, *(f"{q}_wrt_{p}" for q in FORCES for p in parameters)]


def conditions(name: str, gap: str = "margin", others: Iterable[str] = (), **point: Any) -> float:
    """Sum of |x/f df/dx| over theta, AB, BC, omega0 (or omega), alpha and a gap, as for kinematic names.

    That is what the promise of accuracy counts. Others of the inputs (``OTHERS`` for all) count if asked for
    and given; a derivative by AB or BC moves a centre of mass that is not given.
    """
    has_others = name.partition("_wrt_")[0] in FORCES
    inputs = tuple(p for p in others if has_others and point.get(p))
    plain = {p: value for p, value in point.items() if value is not None}
    return kinematic.conditions(name, gap, inputs, truth, **plain)
