"""The result of a simulation: a dict with a readable repr."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from ..mechanism.quantity_units import slopes_of, unit_of, units_of
from ..mechanism.status import SimulationStatus
from ..support.answer import Answer, text_of
from ..support.forks import IMPORTS
from ..support.shown import with_unit

if TYPE_CHECKING:
    from ..evaluation.in_units import Shown

DONE, REST, LIMIT, JAMS, FAILED, NO_INERTIA, NO_START = map(int, SimulationStatus)
SENSITIVITIES = "; sensitivities: "  # what a message says of them follows
MOTION = ("theta", "omega", "t_last", "work")  # whose derivatives may be by what starts and drives it, too
WORDLESS = ("events", "status", "message", "method", "energy_residual", "solution")  # without a unit
WORDS = {int(status): status.words for status in SimulationStatus}


class Event(NamedTuple):
    """An event: kind, time [s], crank angle [rad], speed [rad/s].

    `which` says more: outer or inner dead centre, what the friction does. `wrt`, of a motion with
    sensitivities: parameter -> dt/dp.
    """

    kind: str
    t: float
    theta: float
    omega: float
    which: str = ""
    wrt: Mapping[str, float] | None = None


class Simulation(Answer):
    """The histories by name, `events`, `status`, `message`, `work`, `t_last` and others; `plot()`."""

    @property
    def units(self) -> Mapping[str, Any]:
        """The units of the numbers by key, of the histories and of each event."""
        known = super().units
        return known or _units(self)

    def convert_rest(self, shown: "Shown") -> None:
        """The solution in other units, its time too."""
        solution = self.get("solution")
        if solution is not None:
            to_si, units = shown.system.of("t").to_si, units_of(("theta", "omega"))
            self["solution"] = lambda t: shown.entry(solution(to_si(t)), units)

    def __repr__(self) -> str:
        units = self.units
        lines = [f"simulation: {self['message']}"]
        for name, value in self.items():
            if name not in ("message", "events", "solution"):
                lines.append(f"  {name:16} {_shown(value, units.get(name, ''))}")
        events = self.get("events", [])
        lines += [f"  {_event(event, units.get('events', {}))}" for event in events[:12]]
        if len(events) > 12:
            lines.append(f"  ... {len(events) - 12} more events")
        return "\n".join(lines)

    def plot(self, ax: Any = None) -> Any:
        """The histories over time, one above the other, and the events: see `desaxe.plot.motion`."""
        with IMPORTS:
            from ..plot import motion

        return motion(self, ax=ax)


def _units(result: Mapping[str, Any]) -> dict[str, Any]:
    """The units of a motion; of a derivative with respect to a parameter a quotient."""
    units: dict[str, Any] = {}
    for key in result:
        base, _, parameter = key.partition("_wrt_")
        if base in MOTION and parameter:
            units[key] = unit_of(base, parameter)
        elif key not in WORDLESS:
            units[key] = unit_of(key)
    by: Mapping[str, Any] = next((event.wrt for event in result.get("events", ()) if event.wrt), {})
    return {**units, "events": {**units_of(("t", "theta", "omega")), "wrt": slopes_of("t", by)}}


def _shown(value: Any, unit: str) -> str:
    shape = getattr(value, "shape", ())
    if shape and value.dtype.kind == "U":
        return f"{shape}  {', '.join(sorted(set(value.reshape(-1).tolist()) - {''}))}"
    if not shape:
        return text_of(value, unit)
    known = value[value == value]  # no NaN
    if not known.size:
        return f"{shape}"
    first, last, low, high = value.flat[0], value.flat[-1], known.min(), known.max()
    return with_unit(f"{shape}  {first:.6g} ... {last:.6g}, from {low:.6g} to {high:.6g}", unit)


def _event(event: Event, units: Mapping[str, Any]) -> str:
    which = f" ({event.which})" if event.which else ""
    t, theta, omega = (
        f"{name} = {text_of(getattr(event, name), units.get(name, ''))}" for name in ("t", "theta", "omega")
    )
    return f"{t}: {event.kind}{which}, {theta}, {omega}"
