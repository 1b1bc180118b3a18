"""The result of a simulation: a dict with a readable repr."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from ..mechanism.status import SimulationStatus
from ..support.answer import Answer
from ..support.forks import IMPORTS

DONE, REST, LIMIT, JAMS, FAILED, NO_INERTIA, NO_START = map(int, SimulationStatus)
SENSITIVITIES = "; sensitivities: "  # what a message says of them follows
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

    def __repr__(self) -> str:
        lines = [f"simulation: {self['message']}"]
        for name, value in self.items():
            if name in ("message", "events", "solution"):
                continue
            lines.append(f"  {name:16} {_shown(value)}")
        events = self.get("events", [])
        lines += [f"  {_event(event)}" for event in events[:12]]
        if len(events) > 12:
            lines.append(f"  ... {len(events) - 12} more events")
        return "\n".join(lines)

    def plot(self, ax: Any = None) -> Any:
        """The histories over time, one above the other, and the events: see `desaxe.plot.motion`."""
        with IMPORTS:
            from ..plot import motion

        return motion(self, ax=ax)


def _shown(value: Any) -> str:
    if isinstance(value, str):
        return value
    shape = getattr(value, "shape", ())
    if shape and value.dtype.kind == "U":
        return f"{shape}  {', '.join(sorted(set(value.reshape(-1).tolist()) - {''}))}"
    if not shape:
        return f"{value:.6g}"
    known = value[value == value]  # no NaN
    if not known.size:
        return f"{shape}"
    return (
        f"{shape}  {value.flat[0]:.6g} ... {value.flat[-1]:.6g}, from {known.min():.6g} to {known.max():.6g}"
    )


def _event(event: Event) -> str:
    which = f" ({event.which})" if event.which else ""
    return f"t = {event.t:.6g} s: {event.kind}{which}, theta = {event.theta:.6g}, omega = {event.omega:.6g}"
