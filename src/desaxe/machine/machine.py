"""`Machine`: the inputs of a design as a frozen mapping, with every public call as a method."""

from collections.abc import Iterable, Iterator, Mapping
from os import PathLike
from typing import Any

from ..evaluation.arrays import as_array
from ..loads.elements import MakeDamper, MakeOverV, MakeSpring
from ..loads.motors import MakeKloss, MakeOverOmega
from ..loads.resolve import settled
from ..loads.tabulated import MakeOverStroke, MakeOverTheta, MakeOverY
from ..mechanism.catalogue import has
from ..mechanism.inputs import INPUTS, is_good
from ..mechanism.keywords import unknown_input
from ..mechanism.messages import errors_in, named
from ..mechanism.own import Definition
from ..mechanism.program import program_of
from ..mechanism.quantity_units import SI, UnitSystem
from ..mechanism.slips import warn_of_slips
from ..mechanism.spelling import meant
from ..runtime.request import MachineSpeed, as_number, check_common
from ..support.forks import IMPORTS
from .arguments import in_si
from .methods import METHODS, Method
from .plots import Plots
from .scenes import inputs_of_scene, is_scene, scene_of, write_scene
from .summary import html_of, text_of

MAKERS = {
    "over_theta": MakeOverTheta, "over_Y": MakeOverY, "over_stroke": MakeOverStroke, "over_V": MakeOverV,
    "spring": MakeSpring, "damper": MakeDamper, "over_omega": MakeOverOmega, "kloss": MakeKloss,
}  # fmt: skip
LOADS = ("F_X", "F_Y")
OUTPUTS = ("Y", "V_C", "a_C")
SPEEDS = ("omega0", "omega", "alpha")


class NoInputError(KeyError):
    """A machine has no such input; the message names the nearest one."""

    def __str__(self) -> str:
        name, machine = self.args
        near = _meant(name, machine) or _meant(name, INPUTS)
        inputs = "" if near in machine else ", which is not given"
        hint = f"did you mean {near}{inputs}?" if near else f"it has {', '.join(machine)}"
        return f"a machine has no input {name!r}; {_as_quantity(name) or hint}"


class NoAttributeError(AttributeError):
    """A machine has no such method; the message names the nearest one."""

    def __str__(self) -> str:
        near = _meant(self.name, (name for name in dir(self.obj) if name[0] != "_"))
        hint = f"its inputs are machine[{self.name!r}] and so on" if self.name in INPUTS else ""
        hint = f"did you mean {near}?" if near else hint
        return "; ".join(
            filter(None, [f"a machine has no method {self.name!r}", _as_quantity(self.name) or hint])
        )


def _as_quantity(name: Any) -> str:
    """The hint for a quantity that was taken for an input or a method; empty for any other name."""
    if not isinstance(name, str) or name in INPUTS or not has(name):
        return ""
    at = ", theta=..." if "theta" in program_of((name,)).inputs else ""
    return f"it is a quantity, which machine.evaluate({name!r}{at}) gives"


def _meant(word: Any, allowed: Iterable[str]) -> str:
    return next(iter(meant(word, allowed)), "")


class Machine(Mapping[str, Any]):
    """A machine: frozen lengths, speed, masses and loads, with every public call as a method.

        press = dx.Machine(ec="10 mm", AB="50 mm", BC="200 mm", omega0="300 rpm", m_slider=4, F_Y=-600)
        press.peak("T_in")                       # dx.peak("T_in", **press)
        press.drive(fluctuation=0.03)
        press.replace(ec="12 mm").events()["stroke"]

    inputs  those of `evaluate` except theta: numbers, texts with units, pint quantities, loads, and arrays of
            one dimension for families of designs. Or a mapping of these, including `units`, or a scene as a
            mapping (`Machine.read` takes the path of one). Inputs that are not given have no effect
    branch  +1 or -1
    units   the units of plain numbers, here and in the methods, and of results, pictures, reports, exports:
            "mm, deg, rpm", or a mapping of dimensions and quantities to units, {"length": "mm"}. Only
            what is named changes; velocity and acceleration follow the length, per second, so that g_Y is in
            mm/s^2 then, and sensitivities are quotients. SI units and radians without

    As a mapping a machine holds its inputs in SI units, so that `**press` is right in every call; `branch`
    among them where it is -1. Methods are the public functions with these inputs filled in, and take the same
    arguments; `as_quantity=True` gives pint quantities. `plot`, `replace`, `scene`, `to_scene` and `in_units`
    are its own. Two machines are equal if their inputs and units are.

    Raises ValueError or TypeError that name the input, as `evaluate` does, and warns (`UnitWarning`) of a
    number that is almost certainly in another unit, such as a crank of 125 m.
    """

    __slots__ = ("_given", "_inputs", "definitions", "units")
    _given: dict[str, Any]
    _inputs: dict[str, Any]
    definitions: tuple[Definition, ...]  # the own quantities of the scene that it was read from
    units: UnitSystem

    def __init__(
        self,
        source: Mapping[str, Any] | None = None,
        /,
        *,
        units: Any = None,  # a text, a mapping or a UnitSystem; Any, so that **inputs of numbers have types
        **inputs: Any,
    ) -> None:
        if source is not None and not isinstance(source, Mapping):
            raise TypeError(f"Machine: expected a mapping, got {source!r}; Machine.read takes a path")
        given = dict(source or {})
        made: tuple[Definition, ...] = ()
        if is_scene(given):
            given, own, made = inputs_of_scene(given)
            units = own if units is None else units
        elif "units" in given:
            own = given.pop("units")
            units = own if units is None else units
        elif isinstance(source, Machine):
            units, made = source.units if units is None else units, source.definitions
        system = UnitSystem.read(units)
        plain = {} if isinstance(source, Machine) or (source and is_scene(source)) else given
        named = {**plain, **inputs}
        with errors_in(system):
            si = {**given, **{key: in_si(system, key, value) for key, value in named.items()}}
            checked = checked_inputs(si)
        warn_of_slips(named, system, inputs=checked)
        self._set(checked, system, named, made)

    def _set(
        self,
        inputs: dict[str, Any],
        units: UnitSystem,
        given: Mapping[str, Any],
        made: tuple[Definition, ...] = (),
    ) -> None:
        """Fill a new machine: checked inputs in SI units, units, numbers as they were given, own quantities.

        Arrays are its own, also those out of a pickle, which may be written to.
        """
        for value in inputs.values():
            if hasattr(value, "setflags"):
                value.setflags(write=False)
        object.__setattr__(self, "_inputs", inputs)
        object.__setattr__(self, "units", units)
        object.__setattr__(self, "definitions", made)
        object.__setattr__(self, "_given", {key: v for key, v in given.items() if key in inputs})

    @classmethod
    def read(cls, path: str | PathLike[str], *, units: str | Mapping[str, str] | None = None) -> "Machine":
        """The machine of a scene file, with its units; its crank angles are left out."""
        inputs, own, made = inputs_of_scene(path)
        return restored(checked_inputs(inputs), own if units is None else UnitSystem.read(units), {}, made)

    def replace(self, **inputs: Any) -> "Machine":
        """The machine with other inputs; None takes one away. `units=` changes the units alone."""
        units = inputs.pop("units", self.units)
        other = {"omega": "omega0", "omega0": "omega"}
        gone = {key for key, value in inputs.items() if value is None}
        gone |= {other[key] for key in inputs if key in other and inputs[key] is not None}
        kept = {key: value for key, value in self.items() if key not in gone}
        system = UnitSystem.read(units)
        given = {**self.in_units(), **inputs} if system == self.units else inputs
        with errors_in(system):
            new = {key: in_si(system, key, value) for key, value in inputs.items() if value is not None}
            checked = checked_inputs({**kept, **new})
        loaded = checked if {"BC", "F_X", "F_Y"} & {*inputs} else {}
        warn_of_slips(inputs, system, inputs=loaded)
        return restored(checked, system, given, self.definitions)

    def in_units(self) -> dict[str, Any]:
        """The inputs in the units of the machine: numbers as they were given."""
        result = {}
        for name, value in self._inputs.items():
            own = self._given.get(name)
            if isinstance(own, (int, float)) and not isinstance(own, bool):
                result[name] = own
            elif name in ("branch", "sliders") or callable(value):
                result[name] = value
            else:
                result[name] = self.units.of(name).shown(value)
        return result

    @property
    def plot(self) -> Plots:
        """Pictures: `plot("a_C")` over the crank angle, `plot.mechanism()` and others of `desaxe.plot`."""
        return Plots(self)

    def scene(self, outputs: Any = OUTPUTS, **more: Any) -> Any:
        """A scene of this machine: its inputs, the outputs, and further keys of a scene file.

        outputs  names of quantities over the crank angle
        theta    the crank angles: a number, a list, or a range, by default that of a turn,
                 {"start": 0, "stop": "360 deg", "num": 721}, or of those after which the loads repeat
        more     other inputs, such as ec=["1 mm", "2 mm"], as `replace` takes them; further keys of a scene,
                 such as title="...", peak=[...], results={"data": "values.nc"}

        `press.scene("T_in").run()` computes it.
        """
        return scene_of(self, outputs, more)

    def explain(self, outputs: Any = OUTPUTS, **more: Any) -> Any:
        """`desaxe.explain` of the scene of this machine: what computing it does in which loop, and its cost.

        Arguments are those of `scene`.
        """
        with IMPORTS:
            from ..scenes.explain.explain import explain

        return explain(self.scene(outputs, **more))

    def compile(
        self,
        path: str | PathLike[str],
        outputs: Any = OUTPUTS,
        to: str = "numba",
        *,
        check: bool = False,
        overwrite: bool = False,
        input: str = "torque",
        **more: Any,
    ) -> Any:
        """`desaxe.compile` of the scene of this machine: source code that needs nothing of desaxe; its path.

        path, to, check, overwrite, input as there, others as in `scene`. The code
        takes and gives SI units.
        """
        with IMPORTS:
            from ..scenes.export.compile import compile

        options: Any = {"check": check, "overwrite": overwrite, "input": input}
        return compile(self.scene(outputs, **more), path, to, **options)

    def report(
        self,
        path: str | PathLike[str],
        outputs: Any = None,
        *,
        tolerances: Mapping[str, Any] | None = None,
        fluctuation: float = 0.03,
        overwrite: bool = False,
        **more: Any,
    ) -> Any:
        """Write a report to hand on: one page, .html or .md, that needs no network and prints well; its path.

        outputs      names of quantities to draw and to find the peaks of; by default position, velocity,
                     acceleration, and drive torque and guide force under masses or loads
        tolerances   dict input -> half its range, in the units of the machine or texts: what they do to the
                     outputs
        fluctuation  of the speed, for the flywheel
        more         as in `scene`: title, theta, peak, picture, check

        It has the inputs, the mechanism to scale, curves, peaks with angle, side and gradient, the drive,
        what tolerances do, warnings, versions and this call; of an array of designs a few. A file that desaxe
        did not write is replaced only with `overwrite`. Needs the extras `labelled`, `plot`.
        """
        with IMPORTS:
            from .report import write_report

        options = {"tolerances": tolerances or {}, "fluctuation": fluctuation, "overwrite": overwrite}
        return write_report(self, path, outputs, options, more)

    def to_scene(
        self, path: str | PathLike[str], outputs: Any = OUTPUTS, *, overwrite: bool = False, **more: Any
    ) -> Any:
        """Write the scene of this machine as a TOML file for `Machine.read` and `desaxe run`; its path.

        Other arguments are those of `scene`. The file stands for the same doubles; tables of loads stand in
        it, long ones in a CSV file beside it. Raises TypeError for a load that is a function, which is no
        data, and FileExistsError for a file that desaxe did not write or that was edited, unless `overwrite`.
        """
        return write_scene(self, path, outputs, overwrite, more)

    def __getitem__(self, name: str) -> Any:
        if name not in self._inputs:
            raise NoInputError(name, self)
        return self._inputs[name]

    def __contains__(self, name: object) -> bool:
        return name in self._inputs

    def get(self, name: str, default: Any = None) -> Any:
        """The input in SI units, or the default where it is not given."""
        return self._inputs.get(name, default)

    def __getattr__(self, name: str) -> Any:  # also says that methods, made from functions, may be anything
        raise NoAttributeError(name=name, obj=self)

    def __iter__(self) -> Iterator[str]:
        return iter(self._inputs)

    def __len__(self) -> int:
        return len(self._inputs)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"a machine is frozen; machine.replace({name}=...) gives another one")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"a machine is frozen; machine.replace({name}=None) gives another one")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Machine):
            return NotImplemented
        same = self._key() == other._key() and self.units == other.units
        return same and self.definitions == other.definitions

    def __hash__(self) -> int:
        return hash((self._key(), self.units))

    def _key(self) -> frozenset[Any]:
        return frozenset(
            (name, tuple(value.tolist()) if hasattr(value, "tolist") else value)
            for name, value in self._inputs.items()
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return restored, (self._inputs, self.units, self._given, self.definitions)

    def __repr__(self) -> str:
        return text_of(self)

    def _repr_html_(self) -> str:
        return html_of(self)

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *METHODS})


def _in_its_units(name: str, maker: Any) -> property:
    """The maker of a load or motor as a property."""
    doc = f"`desaxe.{name}`, and its `read`, with plain numbers in the units of the machine."
    return property(lambda machine: maker(machine.units), doc=doc)


for _name in METHODS:
    setattr(Machine, _name, Method(_name))
for _name, _maker in MAKERS.items():
    setattr(Machine, _name, _in_its_units(_name, _maker))


def restored(
    inputs: dict[str, Any],
    units: UnitSystem,
    given: Mapping[str, Any],
    made: tuple[Definition, ...] = (),
) -> Machine:
    """A machine of checked inputs, such as one out of a pickle."""
    machine = Machine.__new__(Machine)
    machine._set(inputs, units, given, made)
    return machine


def checked_inputs(si: Mapping[str, Any]) -> dict[str, Any]:
    """Inputs in the order of the catalogue, branch last where it is -1; errors name what is wrong."""
    if "theta" in si:
        raise TypeError(
            "Machine: theta is where the crank is: give it to a call, machine.evaluate(..., theta=)"
        )
    allowed = [name for name in (*INPUTS, "branch") if name != "theta"]
    for name in si:
        if name not in allowed:
            raise unknown_input("Machine", name, [*allowed, *({"units"} - {name})])
    branch = si.get("branch", 1)
    check_common(si, branch)
    result = {name: _checked(name, si[name]) for name in INPUTS if si.get(name) is not None}
    return {**result, "branch": -1} if branch == -1 else result


def _checked(name: str, value: Any) -> Any:
    """An input in SI units: a float, a frozen array, or a load as it is."""
    if name in LOADS and callable(value):
        return settled(name, value, SI)
    number = as_number(name, value, (name,), ("Machine",))
    if number is not None:
        return MachineSpeed(number) if name in SPEEDS else number
    array = as_array(name, value, (name,), ("Machine",))
    if array.ndim != 1:
        raise ValueError(
            f"Machine: {name} is a number or an array of one dimension, got the shape {array.shape}"
        )
    bad = next((v for v in array.tolist() if not is_good(name, v)), None)
    if bad is not None or not array.size:
        raise ValueError(named(name, bad) + f": it must be {INPUTS[name].limit}")
    return array.copy()
