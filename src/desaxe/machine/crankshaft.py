"""`Crankshaft`: several sliders on one crankshaft, as a machine with every public call."""

from collections.abc import Mapping, Sequence
from html import escape
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ..crankshaft.sliders import Sliders
from ..crankshaft.sums import GRAVITY, STATE, ShaftSlider
from ..mechanism.closed import TURN
from ..mechanism.inputs import Input, row_of
from ..mechanism.messages import amount, errors_in, listed, named
from ..mechanism.quantity_units import UnitSystem
from ..mechanism.read import read, read_array
from ..mechanism.slips import warn_of_slips
from ..runtime.request import MachineSpeed, several
from ..scenes.content import Content
from ..scenes.schema import SceneError, hint
from ..support.files import as_path
from ..support.forks import IMPORTS
from ..support.shown import with_unit
from ..support.toml import read_toml
from ..support.written import Generated
from .arguments import in_si
from .machine import OUTPUTS, Machine, checked_inputs, restored
from .scenes import inputs_of_content

ANGLES = ("phase", "bank", "firing", "spacing", "position", "I_shaft")
OF_SHAFT = ("T_in", "F_shaking_X", "F_shaking_Y", "M_shaking")  # to compile
SAME = 1e-9  # rad: a firing that is at its phase and bank


class Crankshaft(Machine):
    """Several sliders on one crankshaft: a machine to every call.

        four = dx.Crankshaft(cylinder, phase=[0, 180, 180, 0], firing=[0, 540, 180, 360], spacing="90 mm")
        four.harmonics("F_inertia_Y")            # of the sum
        four.evaluate(["T_in", "a_C[2]", "T_in_wrt_AB[2]", "T_in_wrt_phase[1]"], theta=30)
        four.drive(), four.peak("T_in"), four.counterweight(), four.steady(torque=motor)

    source    a Machine, which all sliders are, or a list of machines with a slider each, 0, 1, ...
    phase     lag of each: slider k is at its outer dead centre (at ec = 0) where theta = phase[k] + bank[k]
    bank      angle of each slider's axis, positive like theta, in V engines; or one for all
    firing    where the cycle of each slider's load begins: phase + bank, plus whole turns in a four-stroke
              engine; phase + bank if not given
    spacing   of neighbours along the shaft, or `position`: of each; the couples need one of them
    I_shaft   moment of inertia of shaft and flywheel, beside those of the sliders' cranks
    units     as in `Machine`; by default those of the first machine, in which phases are as well

    All sliders turn with one theta and speed of the shaft, and gravity is one for all, in the shaft's frame:
    +Y is the axis of a slider at bank = 0. Quantities: T_in, F_shaking_X/Y, M_shaking, F_inertia_X/Y,
    M_inertia, power_in, P_friction, kinetic_energy, potential_energy, M_eff, and those of `define`, are sums;
    C_inertia_X and C_inertia_Y are the couples of F_inertia_X and F_inertia_Y about the middle of the shaft.
    Those of one slider, in its own frame, have its index, "a_C[2]". Derivatives are by an input of all
    ("AB"), of one ("AB[2]"), by "phase[1]" and "bank[1]", with which the firing moves, and "I_shaft".
    `status` is the worst slider's, `margin` the least. `members` are the sliders as machines, each in its
    frame from its firing on, with the speed of the shaft if that has no alpha.

    Inputs of calls and of `replace` are those of all sliders or, as in `**{"AB[2]": 0.05}`, of one.
    Raises ValueError and TypeError that name the input.
    """

    __slots__ = ("members",)
    members: tuple[Machine, ...]

    def __init__(
        self,
        source: Machine | Sequence[Machine],
        /,
        *,
        phase: Any,
        bank: Any = 0.0,
        firing: Any = None,
        spacing: Any = None,
        position: Any = None,
        I_shaft: Any = 0.0,
        units: str | Mapping[str, str] | UnitSystem | None = None,
    ) -> None:
        machines = (source,) if isinstance(source, Machine) else tuple(source)
        wrong = next((one for one in machines if not isinstance(one, Machine) or "sliders" in one), None)
        if not machines or wrong is not None:
            raise TypeError("Crankshaft: expected a Machine or a list of them, with one slider each")
        system = machines[0].units if units is None else UnitSystem.read(units)
        angles = {"phase": phase, "bank": bank, "firing": firing, "position": position}
        warn_of_slips({**angles, "spacing": spacing}, system)
        with errors_in(system):
            rows = {n: _array(n, v, system) for n, v in angles.items() if v is not None}
            count = max(len(machines), *(row.size for row in rows.values()))
            phases, banks = (_row(n, rows[n], count) for n in ("phase", "bank"))
            fired = phases + banks
            if firing is not None:
                fired = _fired(_row("firing", rows["firing"], count), fired)
            places = _places(count, spacing, rows.get("position"), system)
            inertia = read(Input("I_shaft", "kg*m^2", "", 0.0, "a finite moment of inertia >= 0"), I_shaft,
                           "Crankshaft", system=system)  # fmt: skip
        if len(machines) not in (1, count):
            raise ValueError(f"Crankshaft: {len(machines)} machines and {count} phases: give one for each")
        every = machines * count if len(machines) == 1 else machines
        shared = {name: _shared(name, every) for name in (*STATE[1:], *GRAVITY)}
        members = [
            ShaftSlider(_design_of(machine), *angles)
            for machine, *angles in zip(every, phases, banks, fired, places, strict=True)
        ]
        definitions = tuple(dict.fromkeys(own for machine in machines for own in machine.definitions))
        sliders = Sliders(members, {n: shared[n] for n in GRAVITY}, inertia, definitions)
        speeds = {n: MachineSpeed(shared[n]) for n in STATE[1:] if shared[n] is not None}
        self._fill({**speeds, "sliders": sliders}, system)

    @classmethod
    def read(cls, path: str | PathLike[str], *, units: Any = None) -> "Crankshaft":
        """The crankshaft of a scene file with a table [crankshaft].

        The table has phase, bank, firing, spacing or position, I_shaft as they are given here; the other
        tables are those of one slider. Other results that the file asks for are left out.
        """
        shaft = shaft_of(*content_of_shaft(path))
        return shaft if units is None else shaft.replace(units=units)

    def _fill(self, inputs: dict[str, Any], units: UnitSystem) -> "Crankshaft":
        """Fill a new crankshaft."""
        sliders = inputs["sliders"]
        self._set(inputs, units, {}, sliders.definitions)
        speeds = {n: self.get(n) for n in ("omega0", "omega") if self.get(n) is not None}
        speeds = {} if np.any(self.get("alpha", 0.0)) else speeds  # at another angle for each slider
        members = (Machine(sliders.inputs_of(k), **speeds, units=None) for k in range(len(sliders.members)))
        object.__setattr__(self, "members", tuple(one.replace(units=units) for one in members))
        return self

    def replace(self, **inputs: Any) -> "Crankshaft":
        """The crankshaft with other inputs: of all sliders, "AB", or of one, "AB[2]", "phase[1]", ..."""
        system = UnitSystem.read(inputs.pop("units", self.units))
        warn_of_slips(inputs, system)
        with errors_in(system):
            si = {key: in_si(system, key, value) for key, value in inputs.items()}
            others = {n: v for n, v in si.items() if n not in STATE}
            sliders = self["sliders"].replaced(others)
            speeds = {n: self.get(n) for n in STATE[1:]} | {n: v for n, v in si.items() if n in STATE}
        if si.get("omega") is not None or si.get("omega0") is not None:
            del speeds["omega0" if si.get("omega") is not None else "omega"]
        kept = {n: MachineSpeed(v) for n, v in speeds.items() if v is not None}
        return _restored({**kept, "sliders": sliders}, system)

    def only(self, index: int) -> "Crankshaft":
        """The crankshaft with one of its sliders, in its place: what it adds to every sum."""
        every = self["sliders"]
        sliders = Sliders([every.members[index]], every.gravity, 0.0, every.definitions)
        return _restored({**self._inputs, "sliders": sliders}, self.units)

    def scene(self, outputs: Any = (), **more: Any) -> Any:
        """Not of several sliders: TypeError."""
        raise TypeError("a scene is of one slider: crankshaft.members[0].scene(...)")

    def to_scene(self, path: Any, outputs: Any = (), *, overwrite: bool = False, **more: Any) -> Any:
        """Not of several sliders: TypeError."""
        return self.scene()

    def compile(
        self,
        path: Any,
        outputs: Any = OUTPUTS,
        to: str = "numba",
        *,
        check: bool = False,
        overwrite: bool = False,
        input: str = "torque",
        **more: Any,
    ) -> Any:
        """Write quantities of the shaft as source code that needs nothing of desaxe; the path.

        path, to, check, overwrite as in `desaxe.compile`, but for FMUs; without outputs the torque and what
        shakes the frame. The code takes theta, the speed of
        the shaft if it has none, and gives SI units; all else is folded in. That of slider 2, "a_C[2]", is
        `a_C_2` there. Inputs of `more` replace those of the crankshaft; `alpha=None` leaves it open.
        """
        with IMPORTS:
            from ..scenes.export.compile import write_or_check

        place = as_path("path", path)
        opened = {n: None for n, value in more.items() if n in STATE and value is None}
        shaft = self.replace(**{n: value for n, value in more.items() if n not in opened})
        outputs = OF_SHAFT if outputs is OUTPUTS else outputs
        return write_or_check(files_of(shaft, place, outputs, to, opened=opened), place, check, overwrite)

    def report(
        self,
        path: Any,
        outputs: Any = None,
        *,
        tolerances: Mapping[str, Any] | None = None,
        fluctuation: float = 0.03,
        overwrite: bool = False,
        **more: Any,
    ) -> Any:
        """Write a page to hand on, .html or .md: sliders, drive, peaks of outputs, balance; its path.

        Inputs of `more` replace those of the crankshaft; `title` is that of the page, tolerances are those of
        `tolerance` alone. Needs the extras `labelled` and `plot`.
        """
        if tolerances:
            raise TypeError("report: of a crankshaft without tolerances; see crankshaft.tolerance(...)")
        with IMPORTS:
            from .crankshaft_report import write_report

        title = more.pop("title", "")
        return write_report(self.replace(**more), path, outputs, fluctuation, overwrite, title)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._inputs, self.units)

    def _key(self) -> frozenset[Any]:
        sliders = self["sliders"]
        angles = tuple(tuple(member[1:]) for member in sliders.members)
        speeds = tuple((name, self.get(name)) for name in STATE)
        return frozenset([self.members, angles, speeds, sliders.I_shaft])

    def __repr__(self) -> str:
        return f"{self._title()}\n{self.members[0]!r}"

    def _repr_html_(self) -> str:
        return f"<p>{escape(self._title())}</p>{self.members[0]._repr_html_()}"

    def _title(self) -> str:
        """The sliders, their phases, the speed and I_shaft, in a line."""
        values = {n: self.get(n) for n in STATE[1:]} | {"I_shaft": self["sliders"].I_shaft or None}
        facts = [
            f"{n} = " + with_unit(f"{self.units.of(n).shown(value):.6g}", self.units.of(n).unit)
            for n, value in values.items()
            if value is not None
        ]
        return ", ".join([f"crankshaft of {self['sliders']!r}", *facts]) + "; slider 0:"


def files_of(
    shaft: Crankshaft,
    path: Path,
    outputs: Any,
    to: str,
    source: str = "",
    opened: Mapping[str, None] | None = None,
) -> Generated:
    """The files that `compile` writes; `opened` are inputs that stay open."""
    with IMPORTS:
        from ..scenes.export.compile import generated_of_shaft

    speeds = {n: shaft.get(n) for n in STATE[1:] if shaft.get(n) is not None}
    speeds = {"alpha": 0.0, **({} if "omega" in speeds else {"omega0": None}), **speeds, **(opened or {})}
    names = (outputs,) if isinstance(outputs, str) else several(outputs)
    return generated_of_shaft(shaft["sliders"], speeds, names, path, to, source)


def shaft_of(content: Content, table: Mapping[str, Any]) -> Crankshaft:
    """The crankshaft of the scene of one slider and a table [crankshaft]."""
    inputs, system, made = inputs_of_content(content)
    return Crankshaft(restored(checked_inputs(inputs), system, {}, made), **table)


def content_of_shaft(path: str | PathLike[str]) -> tuple[Content, dict[str, Any]]:
    """The scene of one slider without its results, and the table [crankshaft] of its file."""
    with IMPORTS:
        from ..scenes.reading.read import read as read_scene

    file = as_path("path", path)
    data = read_toml(file)
    table = data.pop("crankshaft", None)
    if not isinstance(table, dict):
        raise ValueError(f"{file}: there is no table [crankshaft]; Machine.read reads one slider")
    wrong = next((key for key in table if key not in ANGLES), None)
    if wrong is not None:
        raise SceneError(f"{file}: crankshaft.{wrong}: unknown key; {hint(wrong, ANGLES)}")
    if "phase" not in table:
        raise TypeError(f"{file}: phase is missing in [crankshaft]")
    return read_scene(data, file.parent, alone=True), table


def _restored(inputs: dict[str, Any], units: UnitSystem) -> Crankshaft:
    """A crankshaft of checked inputs."""
    return Crankshaft.__new__(Crankshaft)._fill(inputs, units)


def _array(name: str, value: Any, system: UnitSystem) -> Any:
    """A number for each slider, or one for all, in SI units."""
    return np.atleast_1d(read_array(row_of(name), value, system))


def _row(name: str, array: Any, count: int) -> Any:
    """A number for each slider; one number is that of all."""
    if array.ndim > 1 or array.size not in (1, count) or not np.isfinite(array).all():
        requested = amount(name, tuple(array.ravel()), "g", says_unit=True)
        raise ValueError(f"{name}: expected a finite number for each of {count} sliders, got " + requested)
    return np.broadcast_to(array, (count,)).copy()


def _fired(firing: Any, dead: Any) -> Any:
    """Firings that are whole turns from the dead centres; ValueError that names both."""
    turns = np.round((firing - dead) / TURN)
    for k, (own, centre, n) in enumerate(zip(firing, dead, turns, strict=True)):
        if abs(own - centre - n * TURN) > SAME:
            angles = listed([named(f"firing[{k}]", own, "g"), named(f"phase[{k}] + bank[{k}]", centre, "g")])
            raise ValueError(angles + ": they are to be equal but for whole turns")
    return dead + turns * TURN


def _places(count: int, spacing: Any, position: Any, system: UnitSystem) -> Any:
    """The distances of the sliders from the middle of the shaft."""
    if spacing is not None and position is not None:
        raise ValueError("Crankshaft: give spacing=, or position= of each slider, not both")
    if position is None and spacing is None:
        return [0.0 if count == 1 else None] * count
    if position is None:
        step = read(Input("spacing", "m", ""), spacing, "Crankshaft", system=system)
        return step * (np.arange(count) - 0.5 * (count - 1))
    places = _row("position", position, count)
    return places - 0.5 * (places.min() + places.max())


def _shared(name: str, machines: Sequence[Machine]) -> Any:
    """A speed or gravity, which is one for all sliders."""
    values = [machine.get(name) for machine in machines]
    if any(np.ndim(value) for value in values):
        raise ValueError(f"Crankshaft: {name} is an array; a slider is of one design")
    if any(value != values[0] for value in values):
        raise ValueError(f"Crankshaft: {name} is one for all sliders, but they have {values}")
    return values[0]


def _design_of(machine: Machine) -> dict[str, Any]:
    """The inputs of a slider: those of a machine but for what is one for all."""
    arrays = [name for name, value in machine.items() if np.ndim(value)]
    if arrays:
        raise ValueError(f"Crankshaft: {arrays[0]} is an array; a slider is of one design")
    return {name: value for name, value in machine.items() if name not in (*STATE, *GRAVITY)}
