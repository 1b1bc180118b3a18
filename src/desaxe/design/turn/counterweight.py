"""`counterweight`: the mass that balances a share of the first harmonic of the inertia forces.

With z = F_Y + i F_X (theta turns from Y towards X, so that exp(i theta) points along the crank) the first
harmonic is z = f exp(i theta) + b exp(-i theta): a force that turns with the crank and one that turns
against it. A mass m at the radius r, turning with the crank and ahead of it by psi, adds
m r omega^2 exp(i psi) to f, and nothing to b.
"""

from cmath import phase
from collections.abc import Callable
from math import pi
from typing import Any

import numpy as np

from ...mechanism.inputs import TINY, Input
from ...mechanism.keywords import with_known_keywords
from ...mechanism.quantity_units import unit_of, units_of
from ...mechanism.read import read
from ...support.answer import Answer
from ...support.panels import RESOLVED, Array, resolved
from ...support.shown import shown
from .turn import Turn, check_range, turning

ALONG = {"both": 0.5, "Y": 1.0, "X": 0.0}  # what share of the force along Y is balanced
FORCES = {False: ("F_inertia_X", "F_inertia_Y"), True: ("F_shaking_X", "F_shaking_Y")}  # with loads
BALANCE = Input("balance", "1", "share of the first harmonic along Y", 0.0, "a share from 0 to 1")
RADIUS = Input("radius", "m", "from the crank centre to the counterweight", TINY, "a length > 0")
# Of exp(i n theta), of exp(-i n theta), their error, and the largest force under a counterweight.
Harmonics = tuple[Any, Any, float, Callable[[complex], float]]


@with_known_keywords
def counterweight(
    *,
    along: str = "both",
    balance: Any = None,
    radius: Any = None,
    loads: bool = False,
    branch: int = 1,
    sliders: Any = None,
    **inputs: Any,
) -> dict[str, Any]:
    """The counterweight on the crank that balances the first harmonic of the inertia forces best.

    along   "both": the largest first-harmonic force in any direction is made as small as possible, which
            leaves one of constant size that turns against the crank; "Y" or "X": none is left along that axis
    balance in place of `along`: the share of the first harmonic along Y that is balanced, 0 ("X") to 1 ("Y");
            what turns with the crank is balanced whole, 0.5 ("both") is the rule for one cylinder
    radius  of the counterweight's centre of mass [m], to compute its mass
    loads   False: of F_inertia, what moving masses do to the foundation; True: of F_shaking, with loads that
            come from outside of the machine, unlike gas in a cylinder
    sliders filled in by a `Crankshaft`: its weight is on the shaft, from the direction of the crank of a
            slider at phase = 0, and `throws` has the one of each slider's own crank
    inputs  of one design at constant speed, with masses, as in `evaluate`

    Returns a dict:

    product           mass times radius [kg m]
    angle             from the crank to the counterweight [rad], positive like theta; pi is opposite the crank
    mass              [kg], given the radius
    counter_rotating  dict product, angle: of a second weight that turns against the crank, from the Y axis at
                      theta = 0 [rad, positive like theta], and balances the part of the first harmonic
                      that turns so; with along="both" nothing of that harmonic is left then
    second_order      dict turning, counter_rotating of product and angle: of weights on shafts at twice the
                      speed, from the Y axis at theta = 0, which balance the second harmonic
    before, after     dicts X, Y (amplitudes of the first harmonic [N]), largest (in any direction), second
                      (the same of the second harmonic, which no such weight changes), peak (the largest
                      force over the turn)
    balanced          share of `largest` that the counterweight takes away
    error             bound of the error of the harmonics [N]

    Raises as `harmonics` does, and ValueError for a crank at rest.

    See docs/choose.md: which call for which question.

        >>> import desaxe as dx
        >>> found = dx.counterweight(ec=0, AB=0.05, BC=0.2, omega0=100.0, m_slider=0.4)
        >>> round(found["product"], 6), round(found["balanced"], 6)      # half of m_slider AB
        (0.01, 0.5)
    """
    if not isinstance(along, str) or along not in ALONG:
        raise ValueError(f"along = {shown(along)}: it is one of {', '.join(ALONG)}")
    share = ALONG[along] if balance is None else read(BALANCE, balance, "counterweight", "a share")
    if not share <= 1.0:
        raise ValueError(f"balance = {shown(balance)}: it must be {BALANCE.limit}")
    turn = turning("counterweight", inputs, branch, sliders)
    speed = turn.numbers.get("omega0")
    if not speed:
        raise ValueError("counterweight: omega0 is missing or 0, and a crank at rest shakes nothing")
    forward, backward, error, peak = _harmonics(turn, FORCES[bool(loads)])
    weight = -(forward[1] + (2.0 * share - 1.0) * np.conj(backward[1]))
    before = _shaking(forward[1], backward[1], forward[2], backward[2], peak(0.0))
    after = _shaking(forward[1] + weight, backward[1], forward[2], backward[2], peak(weight))
    result: dict[str, Any] = {
        **_weight(weight, speed),
        "counter_rotating": _weight(-backward[1], speed),
        "second_order": {
            way: _weight(-part[2], 2.0 * speed)
            for way, part in (("turning", forward), ("counter_rotating", backward))
        },
        "before": before,
        "after": after,
        "balanced": 1.0 - after["largest"] / before["largest"] if before["largest"] else 0.0,
        "error": 2.0 * error,
    }
    if radius is not None:
        result["mass"] = result["product"] / _radius(radius)
    if sliders is not None:
        own = {"balance": share, "loads": loads, "omega0": speed}
        every = turn.numbers["sliders"].inputs_of_each()
        alike = [every.index(inputs) for inputs in every]
        throws = {k: counterweight(**own, **every[k]) for k in {*alike}}
        result["throws"] = [{key: throws[k][key] for key in ("product", "angle")} for k in alike]
    weight_units, force = units_of(("product", "angle")), unit_of("F_X")
    return Answer(result, {
        **weight_units, "counter_rotating": weight_units, "mass": unit_of("mass"), "throws": weight_units,
        "second_order": dict.fromkeys(("turning", "counter_rotating"), weight_units),
        "before": force, "after": force, "error": force,
    })  # fmt: skip


def _harmonics(turn: Turn, forces: tuple[str, str]) -> Harmonics:
    """The first harmonics of the force, and the largest force under a counterweight."""
    panels = turn.panels(forces)
    z = panels.values[forces[1]] + 1j * panels.values[forces[0]]
    result = np.array(
        [panels.integral(z * np.exp(-1j * n * panels.x)) / turn.angle for n in (0, 1, 2, 0, -1, -2)]
    )
    result[np.abs(result) <= max(map(turn.floor, forces))] = 0.0
    forward, backward = result[:3], result[3:]

    def peak(weight: complex) -> float:
        def squared(theta: Array, row: Array) -> dict[str, Array]:
            X, Y = (panels.at(theta, panels.values[name]) for name in forces)
            return {"square": np.abs(Y + 1j * X + weight * np.exp(1j * theta)) ** 2}

        result = resolved(squared, panels.edges)
        return float(np.sqrt(result.extreme(result.values["square"], 1.0)[0]))

    return forward, backward, RESOLVED * float(np.abs(z).max()), peak


def _shaking(f: Any, b: Any, f2: Any, b2: Any, peak: float) -> dict[str, float]:
    return {
        "X": float(abs(f - np.conj(b))),
        "Y": float(abs(f + np.conj(b))),
        "largest": float(abs(f) + abs(b)),
        "second": float(abs(f2) + abs(b2)),
        "peak": peak,
    }


def _weight(force: Any, speed: float) -> dict[str, float]:
    """The mass times radius whose centrifugal force this is, and its angle in 0 ... 2 pi."""
    angle = float(phase(force) % (2.0 * pi)) if force else 0.0
    return {"product": float(abs(force) / speed**2), "angle": angle}


def _radius(value: Any) -> float:
    return check_range("counterweight", "radius", read(RADIUS, value, "counterweight", "a length > 0"))
