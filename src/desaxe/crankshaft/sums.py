"""Quantities of a crankshaft: sums over its sliders, each evaluated by state at its own angle.

Slider k is at its outer dead centre (at ec = 0) where theta = phase + bank. It stands under theta - phase -
bank, and its load is taken at theta - firing, which is the same angle of the crank: so it is evaluated there,
at the shaft's omega and alpha. Its axis is turned by the bank b in the sense of theta, so that in the shaft's
frame X = F_X cos b + F_Y sin b and Y = -F_X sin b + F_Y cos b; gravity is turned the other way.
"""

from collections.abc import Iterator, Mapping, Sequence
from re import compile as pattern
from typing import Any, NamedTuple, Self

import numpy as np

from ..evaluation.evaluate import Values, evaluate
from ..loads.resolve import split
from ..mechanism.catalogue import has, quantity
from ..mechanism.closed.limits import margins_of
from ..mechanism.inputs import INPUTS, row_of
from ..mechanism.names import LENGTHS, parts, sensitivity
from ..mechanism.own import Definition, register, using
from ..mechanism.quantity_units import units_by_name
from ..mechanism.read import number_of, read_array
from ..runtime.request import check_common, several

GRAVITY = ("g_X", "g_Y")
STATE = ("theta", "omega0", "omega", "alpha")
POSITION = ("phase", "bank", "position")
FORCES = ("F_shaking", "F_inertia")  # along X and Y, which turn with the bank
COUPLES = {"C_inertia_X": "F_inertia_X", "C_inertia_Y": "F_inertia_Y"}
OF_SHAFT = (
    "T_in",
    "M_shaking",
    "M_inertia",
    "power_in",
    "kinetic_energy",
    "M_eff",
)  # its inertia is in these
SUMS = (*OF_SHAFT, "potential_energy", "P_friction", *(f"{name}_{axis}" for name in FORCES for axis in "XY"))
FACTS = ("omega", "status", "margin")
INDEXED = pattern(r"(\w+)\[(\d+)\]")
SHAFT = -1  # in place of a slider's index: a slider without masses, whose crank is the shaft
BARE: dict[str, Any] = {"ec": 0.0, "AB": 1.0, "BC": 3.0}
NOTHING = 1e-12  # beside what a single slider adds
TINY = 1e-150  # rad/s, in place of rest: slopes by omega^2 stay finite


class ShaftSlider(NamedTuple):
    """A slider: its inputs in SI units, its angles [rad] and, if known, its distance from the middle [m]."""

    inputs: Mapping[str, Any]
    phase: Any = 0.0
    bank: Any = 0.0
    firing: Any = 0.0
    position: Any = None


class Share(NamedTuple):
    """The coefficient of a slider's quantity: constant + cos cos(bank) + sin sin(bank)."""

    constant: Any = 0.0
    cos: Any = 0.0
    sin: Any = 0.0

    def at(self, bank: Any) -> Any:
        """The coefficient at a bank."""
        if isinstance(self.cos, float) and isinstance(self.sin, float) and self.cos == self.sin == 0.0:
            return self.constant
        return self.constant + self.cos * np.cos(bank) + self.sin * np.sin(bank)

    def times(self, factor: Any) -> "Share":
        """The coefficient multiplied by a number."""
        return Share(*(part * factor for part in self))


Terms = dict[tuple[int, str], Share]  # slider and its quantity -> how much of it


class ShaftState(NamedTuple):
    """The crank angle, speed and acceleration of the shaft; `slopes`: of the speed, under the law."""

    theta: Any
    omega: Any
    alpha: Any
    slopes: Mapping[str, Any]
    stalled: Any = False

    @property
    def inputs(self) -> dict[str, Any]:
        """Speed and acceleration as inputs, as far as there are any."""
        return {} if self.omega is None else {"omega": self.omega, "alpha": self.alpha}


def state_of(inputs: Mapping[str, Any]) -> ShaftState:
    """The state of the shaft that these inputs are."""
    check_common(inputs, 1)
    theta, omega0, omega, alpha = (number(name, inputs.get(name)) for name in STATE)
    alpha = 0.0 if alpha is None else alpha
    if omega is not None or omega0 is None:
        return ShaftState(theta, omega, alpha, {"omega": 1.0})
    start = 0.0 if theta is None else theta
    omega = evaluate("omega", theta=start, omega0=omega0, alpha=alpha, **BARE)
    with np.errstate(invalid="ignore"):
        stalled = np.isnan(omega) & np.isfinite(omega0 + start + alpha)
    if np.any(stalled):
        omega = np.where(stalled, 1.0, omega)
    moving = np.where(np.equal(omega, 0.0), TINY, omega)
    slopes = {"theta": alpha / moving, "alpha": start / moving, "omega0": omega0 / moving}
    at_rest = np.equal(omega0, 0.0) & np.equal(omega, 0.0)
    slopes["omega0"] = np.where(at_rest, 1.0, slopes["omega0"]) if np.any(at_rest) else slopes["omega0"]
    moving = moving if np.any(np.not_equal(moving, omega) & np.not_equal(alpha, 0.0)) else omega
    return ShaftState(theta, moving, alpha, slopes, stalled)


def number(name: str, value: Any) -> Any:
    """A number, or an array as it broadcasts; None where it is not given."""
    if value is None or hasattr(value, "dims"):
        return value
    row = row_of(name)
    result = number_of(row, value)
    return read_array(row, value) if result is None else result


def indexed(name: str) -> tuple[str, int | None]:
    """A name without its index, and this; None where it has none."""
    match = INDEXED.fullmatch(name)
    return (match[1], int(match[2])) if match else (name, None)


class SliderSums:
    """Sliders on one shaft: gravity in its frame, its moment of inertia, and its quantities.

    definitions   user-defined quantities; one without an index is the sum of the sliders'
    """

    def __init__(
        self,
        members: Sequence[ShaftSlider],
        gravity: Mapping[str, Any] | None = None,
        I_shaft: Any = 0.0,
        definitions: tuple[Definition, ...] = (),
    ) -> None:
        self.members, self.I_shaft, self.definitions = tuple(members), I_shaft, definitions
        self.gravity = {name: (gravity or {}).get(name) or 0.0 for name in GRAVITY}

    def replaced(self, inputs: Mapping[str, Any]) -> Self:
        """The sliders with other inputs: "AB" of all, "AB[2]" of one; without those that are None."""
        rows = [{**row.inputs} for row in self.members]
        members, gravity, I_shaft = list(self.members), dict(self.gravity), self.I_shaft
        for key, value in inputs.items():
            name, index = indexed(key)
            if index is not None and index >= len(rows):
                raise TypeError(f"{key}: there are sliders 0 to {len(rows) - 1}")
            if name in POSITION and index is not None:
                members[index] = _moved(members[index], name, number(key, value))
            elif key == "I_shaft":
                I_shaft = number(key, value)
            elif key in GRAVITY:
                gravity[key] = 0.0 if value is None else value
            elif name in (*INPUTS, "branch") and name not in (*STATE, *GRAVITY):
                for row in rows if index is None else [rows[index]]:
                    row[name] = value
            else:
                raise TypeError(f"a crankshaft has no input {key!r}: it has those of its sliders, such as "
                                "AB or AB[0], phase[0], bank[0], I_shaft, g_X, g_Y")  # fmt: skip
        kept = ({n: v for n, v in row.items() if v is not None} for row in rows)
        members = [member._replace(inputs=row) for member, row in zip(members, kept, strict=True)]
        return type(self)(members, gravity, I_shaft, self.definitions)

    def inputs_of(self, k: int) -> dict[str, Any]:
        """The inputs of a slider in its own frame, with the gravity there."""
        if k == SHAFT:
            return {**BARE, "I_crank": self.I_shaft}
        result, bank = dict(self.members[k].inputs), self.members[k].bank
        for name, shares in self._gravity_along(bank).items():
            g = sum(share * self.gravity[axis] for axis, share in shares.items())
            if np.any(g):
                result[name] = g
        return result

    def without_speed(self) -> Self | None:
        """The sliders without the loads that depend on how fast the crank turns; None if there is no such."""
        loads = [split(member.inputs)[1] for member in self.members]
        every = {f"{n}[{k}]": load for k, row in enumerate(loads) for n, load in row.items()}
        free = {n: 0.0 for n, load in every.items() if load.follows_speed}
        return self.replaced(free) if free else None

    def inputs_of_each(self) -> list[dict[str, Any]]:
        """The inputs of all sliders in their frames."""
        return [self.inputs_of(k) for k in range(len(self.members))]

    @property
    def smooth(self) -> bool:
        """True where no load, friction or user-defined quantity can have a kink."""
        rows = [member.inputs for member in self.members]
        bent = (callable(v) or (name == "mu" and np.any(v)) for row in rows for name, v in row.items())
        return not any(bent) and not register().definitions

    def shared_lengths(self, inputs: Sequence[str]) -> dict[str, Any]:
        """The lengths that all sliders have; TypeError for inputs that there are none of."""
        self.replaced({name: 0.0 for name in inputs if name not in STATE})
        first, *others = (member.inputs for member in self.members)
        return {n: first[n] for n in LENGTHS if all(row[n] == first[n] for row in others)}

    def least_margin(self, side: float, inputs: Mapping[str, Any]) -> tuple[Any, dict[str, Any]]:
        """The least BC - AB - side ec, with other inputs of the sliders, and its derivatives."""
        here = self.replaced({n: v for n, v in inputs.items() if n not in (*STATE, "sliders")})
        lengths = ([member.inputs[n] for n in LENGTHS] for member in here.members)
        every = np.array(np.broadcast_arrays(*(margins_of(side * ec, *more)[0] for ec, *more in lengths)))
        least, slopes = every.argmin(0), dict(zip(LENGTHS, (-side, -1.0, 1.0), strict=True))
        rows = range(len(every))
        by_one = {f"{n}[{k}]": np.where(least == k, s, 0.0) for k in rows for n, s in slopes.items()}
        return every.min(0), {**{n: s + 0.0 * every[0] for n, s in slopes.items()}, **by_one}

    def numbers(self) -> dict[str, Any]:
        """The inputs that are numbers by name, of all sliders and of one, their angles, and loads."""
        result: dict[str, Any] = {**self.gravity, "I_shaft": self.I_shaft}
        for k, member in enumerate(self.members):
            angles = {"phase": member.phase, "bank": member.bank}
            result |= {f"{name}[{k}]": value for name, value in {**member.inputs, **angles}.items()}
            result |= {n: v for n, v in member.inputs.items() if n != "branch"}
        return {n: v for n, v in result.items() if not callable(v)}

    @staticmethod
    def _gravity_along(bank: Any) -> dict[str, dict[str, Any]]:
        """A slider's gravity by that in the frame of the shaft."""
        c, s = np.cos(bank), np.sin(bank)
        return {"g_X": {"g_X": c, "g_Y": -s}, "g_Y": {"g_X": s, "g_Y": c}}

    def evaluate(
        self,
        names: str | Sequence[str],
        inputs: Mapping[str, Any],
        accuracy: Any = "standard",
        threads: int | None = None,
        out: Any = None,
    ) -> Any:
        """`desaxe.evaluate` of the shaft: its state, and inputs that replace those of the sliders."""
        requested = (names,) if isinstance(names, str) else several(names)
        state = state_of(inputs)
        here = self.replaced({n: v for n, v in inputs.items() if n not in STATE and v is not None})
        with using(self.definitions):
            result = Values(here._values(requested, state, accuracy, threads))
            result.become(units_by_name(result), None)
        if out is not None:
            for name, buffer in (out if isinstance(out, Mapping) else {requested[0]: out}).items():
                buffer[...] = result[name]
            return out
        return result[names] if isinstance(names, str) else result

    def _values(
        self, names: Sequence[str], state: ShaftState, accuracy: Any, threads: int | None
    ) -> dict[str, Any]:
        """The values by name."""
        terms = {name: self.terms(name, state.slopes) for name in names if name not in FACTS}
        asked: dict[int, dict[str, None]] = {}
        for k, name in (key for own in terms.values() for key in own):
            asked.setdefault(k, {})[name] = None
        for name in {"status", "margin"} & {*names}:
            for k in range(len(self.members)):
                asked.setdefault(k, {})[name] = None
        values = {}
        for k, requested in asked.items():
            angle = None if state.theta is None else state.theta - (0.0 if k < 0 else self.members[k].firing)
            inputs = {**self.inputs_of(k), **state.inputs}
            values[k] = evaluate([*requested], theta=angle, accuracy=accuracy, threads=threads, **inputs)
        result = {name: self._fact(name, values, state) for name in names if name in FACTS}
        for name, own in terms.items():
            bank = {k: self.members[k].bank for k, _ in own if k != SHAFT} | {SHAFT: 0.0}
            total = sum(values[k][q] * share.at(bank[k]) for (k, q), share in own.items())
            result[name] = np.where(state.stalled, np.nan, total) if np.any(state.stalled) else total
        return _together({name: result[name] for name in names}, state)

    def _fact(self, name: str, values: Mapping[int, Any], state: ShaftState) -> Any:
        """The speed, the worst status, the least margin."""
        if name == "omega":
            return np.where(state.stalled, np.nan, state.omega) if np.any(state.stalled) else state.omega
        own = [row[name] for k, row in values.items() if k != SHAFT]
        if name == "margin":
            return min(own) if all(np.ndim(v) == 0 for v in own) else np.minimum.reduce(own)
        worst = max(own) if all(np.ndim(v) == 0 for v in own) else np.maximum.reduce(own)
        return np.where(state.stalled, 3, worst) if np.any(state.stalled) else worst

    def __repr__(self) -> str:
        phases = ", ".join(f"{float(np.degrees(member.phase)):.6g}" for member in self.members)
        return f"{len(self.members)} sliders at {phases} deg"

    def terms(self, name: str, slopes: Mapping[str, Any]) -> Terms:
        """A quantity or sensitivity as a sum; `slopes`: of the speed by theta, omega0, alpha or omega."""
        base, parameters = parts(name)
        terms = self.quantity_terms(base)
        if len(parameters) > 1 and any(indexed(p)[0] in (*STATE, *POSITION, *GRAVITY) for p in parameters):
            raise ValueError(f"{name!r}: this derivative is not derived")
        for parameter in parameters:
            result: Terms = {}
            for (k, q), share in terms.items():
                for own, part in self._by(k, q, share, parameter, slopes):
                    result[k, own] = Share(*map(sum, zip(result.get((k, own), Share()), part, strict=True)))
            terms = result
        return terms

    def quantity_terms(self, base: str) -> Terms:
        """A quantity without parameters."""
        name, index = indexed(base)
        members = range(len(self.members))
        if index is not None:
            self._check(base, index)
        if name in COUPLES:  # with an index: what a slider adds to it
            if any(member.position is None for member in self.members):
                raise ValueError(f"{base}: of sliders along a shaft: give Crankshaft spacing= or position=")
            return {
                (k, q): share.times(self.members[k].position)
                for (k, q), share in self.quantity_terms(COUPLES[name]).items()
                if index in (None, k)
            }
        if index is not None:
            quantity(name, True)
            return {(index, name): Share(1.0)}
        if base[:-2] in FORCES:
            X, Y = f"{base[:-1]}X", f"{base[:-1]}Y"
            shares = (Share(cos=1.0), Share(sin=1.0 if base == X else -1.0))
            mine, other = (X, Y) if base == X else (Y, X)
            return {(k, n): s for k in members for n, s in zip((mine, other), shares, strict=True)}
        if base in SUMS or base in register().definitions:
            shaft = [SHAFT] if base in OF_SHAFT else []
            return {(k, base): Share(1.0) for k in [*members, *shaft]}
        quantity(base)
        raise ValueError(f"{base!r} is each slider's own: {base}[0] to {base}[{len(self.members) - 1}]")

    def _check(self, name: str, index: int) -> None:
        if index >= len(self.members):
            raise ValueError(f"{name!r}: there are sliders 0 to {len(self.members) - 1}")

    def _by(
        self, k: int, q: str, share: Share, parameter: str, slopes: Mapping[str, Any]
    ) -> Iterator[tuple[str, Share]]:
        """The derivative of a term by a parameter, as terms of the same slider."""
        name, index = indexed(parameter)
        if index is not None:
            self._check(parameter, index)
        if index not in (None, k):
            return
        if parameter == "I_shaft" or (k == SHAFT and name not in STATE):
            if k == SHAFT and parameter == "I_shaft":
                yield sensitivity(q, "I_crank"), share
        elif name in ("phase", "bank") and index is not None:
            yield sensitivity(q, "theta"), share.times(-1.0)
            if name == "bank":
                yield from self._by_bank(k, q, share)
        elif name == "position" and index is not None:
            raise ValueError(f"{parameter}: divide the couples' parts by it, they are proportional")
        elif name in GRAVITY:
            shares = self._gravity_along(self.members[k].bank)
            for axis in GRAVITY:
                yield sensitivity(q, axis), share.times(shares[axis][name])
        else:
            yield from self._by_input(q, share, name, slopes)

    def _by_input(
        self, q: str, share: Share, name: str, slopes: Mapping[str, Any]
    ) -> Iterator[tuple[str, Share]]:
        """The derivative with respect to an input of the slider or by the state of the shaft."""
        if name not in ("omega0", "omega"):
            by = f"{q}_wrt_{name}" if name not in INPUTS else sensitivity(q, name)
            quantity(by, True)
            yield by, share
        if name in slopes:
            by = sensitivity(q, "omega")
            if has(by, True):
                yield by, share.times(slopes[name])
        elif name in ("omega0", "omega"):
            quantity(f"{q}_wrt_{name}", "omega" in slopes)
            raise ValueError(f"{q}_wrt_{name}: the speed is missing")

    def _by_bank(self, k: int, q: str, share: Share) -> Iterator[tuple[str, Share]]:
        """The derivative with respect to a bank at one crank angle, which turns axes and gravity."""
        yield q, Share(0.0, share.sin, -1.0 * share.cos)
        inputs = self.inputs_of(k)
        for axis, other, side in (("g_X", "g_Y", -1.0), ("g_Y", "g_X", 1.0)):
            by = sensitivity(q, axis)
            if other in inputs and has(by, True):
                yield by, share.times(side * inputs[other])

    def floor(self, name: str, given: Mapping[str, Any]) -> Any:
        """The magnitude of a sum that is rounding beside what one slider adds; theta is the last axis."""
        state, size = state_of(given), 0.0
        here = self.replaced({n: v for n, v in given.items() if n not in STATE})
        for k, q in here.terms(name, state.slopes):
            if k != SHAFT:
                angle = state.theta - here.members[k].firing
                own = evaluate(q, theta=angle, **here.inputs_of(k), **state.inputs)
                every = np.broadcast_to(own, np.broadcast_shapes(np.shape(own), np.shape(angle)))
                size = np.fmax(size, np.fmax.reduce(np.abs(every), axis=-1))
        return NOTHING * size


def _moved(member: ShaftSlider, name: str, value: Any) -> ShaftSlider:
    """A slider at another phase or bank, whose firing moves along, or at another position."""
    firing = member.firing if name == "position" else member.firing + value - getattr(member, name)
    return member._replace(**{name: value}, firing=firing)


def _together(result: dict[str, Any], state: ShaftState) -> dict[str, Any]:
    """Arrays of one shape, where anything is one; floats else."""
    every = (*result.values(), state.theta, state.omega, state.alpha)
    if any(hasattr(value, "dims") for value in every):
        return result
    shape = np.broadcast_shapes(*(np.shape(value) for value in every if value is not None))
    if not shape:
        return {n: int(v) if n == "status" else float(v) for n, v in result.items()}
    return {
        n: np.array(np.broadcast_to(v, shape), np.int8 if n == "status" else float) for n, v in result.items()
    }
