"""The torque of one design over its turn, in panels between the angles at which it has kinks."""

from collections.abc import Callable, Mapping, Sequence
from math import copysign, fsum, pi
from typing import Any

import numpy as np

from ...evaluation.evaluate import evaluate
from ...evaluation.extremes import check_range
from ...evaluation.loaded import loads_of
from ...loads.angles import kinks_between, turns_of
from ...mechanism.closed.dead_centres import DEAD_CENTRES
from ...mechanism.closed.functions import closed_form
from ...mechanism.inputs import INPUTS
from ...mechanism.read import read
from ...runtime.request import as_number, check_common, check_inputs, request
from .panels import Array, Panels, resolved

LENGTHS = ("ec", "AB", "BC")
JAMS = 5  # the status where friction leaves no balance of forces
Motion = Callable[[Array], dict[str, Array]]  # angles -> omega and alpha there


class NoCycleError(Exception):
    """The torque is undefined at some angle of the turn; `status` is the reason."""

    def __init__(self, status: int) -> None:
        self.status = status


class Design:
    """The inputs of one design, checked, and the parameters of its torque."""

    def __init__(self, caller: str, inputs: Mapping[str, Any], branch: int) -> None:
        check_inputs(caller, inputs, [name for name in INPUTS if name not in ("theta", "omega")])
        check_common({}, branch)
        self.branch = int(branch)
        given, self.loads = loads_of({name: value for name, value in inputs.items() if value is not None})
        turns_of(caller, self.loads, 1)
        self.numbers = {name: _number(caller, name, value) for name, value in given.items()}
        if not self.numbers.get("alpha"):
            self.numbers.pop("alpha", None)
        for name in (*LENGTHS, "omega0"):
            if name not in self.numbers:
                as_number(name, None, (*LENGTHS, "omega0"), (caller,))
        if not self.numbers["omega0"]:
            raise ValueError(f"{caller}: omega0 = 0 gives no cycle; it must be the speed of the crank")
        everything = {**self.numbers, **self.loads}
        asked = request(("T_in",), everything, self.branch, "standard")
        self.parameters = tuple(n for n in asked.inputs if n != "theta" and n not in self.loads)

    @property
    def direction(self) -> float:
        """1 where the crank turns forwards, -1 backwards."""
        return copysign(1.0, self.numbers["omega0"])

    @property
    def margin(self) -> float:
        """BC - AB - |ec|, rounded once."""
        return fsum((self.numbers["BC"], -self.numbers["AB"], -abs(self.numbers["ec"])))

    @property
    def has_friction(self) -> bool:
        """True if the guide has friction."""
        return bool(self.numbers.get("mu"))

    def values(
        self, names: Sequence[str], theta: Array, motion: Motion | None = None, **other: Any
    ) -> dict[str, Array]:
        """Quantities at angles. `motion` returns the state there; `other` replaces inputs of the design."""
        state = {} if motion is None else {**motion(theta), "omega0": None}
        inputs = {**self.numbers, **self.loads, **state, **other}
        present = {name: value for name, value in inputs.items() if value is not None}
        found = evaluate([*names, "status"], theta=theta, branch=self.branch, **present)
        status = found.pop("status")
        bad = ~np.isfinite([found[name] for name in names]).all(0)
        if bad.any():
            codes = status[bad]
            raise NoCycleError(JAMS if JAMS in codes else int(codes[0]) or 4)
        return {name: np.broadcast_to(found[name], theta.shape) for name in names}

    def breaks(self, motion: Motion | None = None, edges: Sequence[float] = (), **other: Any) -> list[float]:
        """The ends of the turn, the angles at which the torque has a kink, and `edges`, in order."""
        low, high = sorted((0.0, self.direction * 2.0 * pi))
        ec, AB, BC = (self.numbers[name] for name in LENGTHS)
        places = closed_form(DEAD_CENTRES, ("theta_outer", "theta_inner"), branch=float(self.branch))
        own = [low + (angle - low) % (2.0 * pi) for angle in places.point(ec, AB, BC)]
        kinks = kinks_between(self.loads.values(), low, high, (ec, AB, BC), self.branch, smooth=True)
        found = sorted({low, *own, *edges, *kinks, high})
        if self.has_friction:

            def normal_force(theta: Array) -> dict[str, Array]:
                return self.values(["N_C"], theta, motion, **other, mu=None)

            smooth = resolved(normal_force, found)
            found += smooth.roots(smooth.values["N_C"])
        return sorted(found)


def _number(caller: str, name: str, value: Any) -> float:
    each = f"[desaxe.{caller}({name}=value, ...) for value in values]"
    one = f"one number, for one design; call it for each of them, as in {each}"
    return check_range(caller, name, read(INPUTS[name], value, caller, one))


def torque_over(design: Design, names: Sequence[str], **other: Any) -> Panels:
    """Quantities over the turn in panels, the roots of the torque among their edges."""
    found = resolved(lambda theta: design.values(names, theta, **other), design.breaks(**other))
    return found.split(found.roots(found.values["T_in"]))
