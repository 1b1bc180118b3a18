"""From what is written in a scene file to inputs in SI units and names that exist."""

import tomllib
import warnings
from collections.abc import Iterable, Mapping
from math import pi
from os import PathLike
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from ..definitions.tables import read_definitions, redefine
from ..evaluation.chunks import chunk_lengths
from ..evaluation.reduce import NO_STATUS, Reduction, reduction_of
from ..loads.load import Load, OverTheta
from ..mechanism.catalogue import law_name, quantity
from ..mechanism.inputs import INPUTS
from ..mechanism.names import CENTRES, LENGTHS, LOADS, sensitivity
from ..mechanism.own import Definition
from ..mechanism.program import Variant, program_of
from ..mechanism.slips import UnitWarning
from ..mechanism.unit_system import SI, UnitSystem
from ..peaks.programs import WITHOUT_COURSE
from ..runtime.accuracy import accuracy_of
from ..sweeps.layout import bytes_of
from . import schema
from .loads import varying, without_objects
from .printed import Printed, read_percentage, read_printed
from .schema import SceneError, shown
from .units import slips_of, units_of, with_units
from .values import Value, design_of, number_of, only_inputs, values_of

SECTIONS: dict[str, type[schema.Section]] = {
    "mechanism": schema.Mechanism,
    "motion": schema.Motion,
    "masses": schema.Masses,
    "loads": schema.Loads,
}
OPTIONAL = ("alpha", *LOADS)  # 0 where they are not given, or half of a length
SENSITIVITIES = LENGTHS  # of a peak, those on which it depends, unless others are asked for

PICTURES = (".png", ".svg", ".pdf")
DATA = (".nc", ".zarr", ".csv", ".npz")


class Check(NamedTuple):
    """One printed value, and the inputs at which it is to be computed."""

    title: str
    source: str
    quantity: str
    printed: Printed
    inputs: dict[str, Any]


class Claim(NamedTuple):
    """What somebody says about the peak of one design: its increase over the baseline."""

    source: str
    at: dict[str, float]
    design: dict[str, float]
    increase: Printed


class Peak(NamedTuple):
    """A peak over the crank angle, for the outer product of `axes` with everything else fixed."""

    title: str
    quantity: str
    kind: str
    axes: dict[str, tuple[float, ...]]
    fixed: dict[str, float]
    theta: tuple[float, float]
    at_baseline: dict[str, float]
    baseline: dict[str, float]
    claims: tuple[Claim, ...]
    sensitivities: tuple[str, ...]
    loads: Mapping[str, Load] = MappingProxyType({})  # that vary with the motion


class Picture(NamedTuple):
    """A family of curves and the file it goes to."""

    title: str
    file: str
    quantity: str
    over: str
    family: str | None
    inputs: dict[str, Value]


class Content(NamedTuple):
    """All that a scene says, in SI units; inputs in the order in which they are written."""

    title: str
    outputs: tuple[str, ...]
    accuracy: str
    branch: int
    inputs: dict[str, Value]
    checks: tuple[Check, ...]
    peaks: tuple[Peak, ...]
    pictures: tuple[Picture, ...]
    data: str | None
    reduction: Reduction | None = None
    threads: int | None = None
    units: UnitSystem = SI
    store: str | None = None
    chunks: Any = None
    memory: int | None = None
    definitions: tuple[Definition, ...] = ()


def plain_data(source: str | PathLike[str] | Mapping[str, Any]) -> dict[str, Any]:
    """The tables of a scene file, or of the same thing in Python (NumPy numbers and arrays are fine)."""
    if isinstance(source, Mapping):
        return {str(name): _plain(value) for name, value in source.items()}
    if not isinstance(source, (str, PathLike)):
        raise TypeError(f"a scene is the path of a TOML file or a mapping, got {type(source).__name__}")
    try:
        return tomllib.loads(Path(source).read_bytes().decode("utf-8"))
    except UnicodeDecodeError as error:
        raise SceneError(f"not a text in UTF-8: {error}") from None
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"not a TOML file: {error}") from None


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(name): _plain(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    if hasattr(value, "tolist"):
        return value.tolist()
    return str(value) if isinstance(value, PathLike) else value


def read(data: Mapping[str, Any], folder: Path | None = None) -> Content:
    """The content of a scene; SceneError names the first key that is wrong.

    folder   where the scene file is, and perhaps the files of its loads
    """
    units = _units(data)
    data = with_units(data, units)
    file = schema.decoded(without_objects(data))
    own = _defined(data.get("quantities", {}))
    inputs = _inputs(data, file, folder)
    branch = file.mechanism.branch
    if "omega" in inputs and "omega0" in inputs:
        raise SceneError(
            f"motion.omega = {inputs['omega']}: give omega0 (the law) or omega (a state), not both"
        )
    outputs = tuple(dict.fromkeys(file.outputs))
    for index, name in enumerate(outputs, 1):
        _known(f"outputs #{index}", name, "omega" in inputs)
    if outputs:
        _require_for_grid("outputs", outputs, inputs)
    if not (outputs or file.peak or file.check or file.picture):
        raise SceneError("nothing is asked for: give outputs = [...], [[peak]], [[check]] or [[picture]]")
    _require_names(file)
    checks = [
        c for index, table in enumerate(file.check, 1) for c in _checks(f"check #{index}", table, inputs)
    ]
    peaks = [_peak(f"peak #{index}", table, inputs) for index, table in enumerate(file.peak, 1)]
    pictures = [_picture(f"picture #{index}", table, inputs) for index, table in enumerate(file.picture, 1)]
    return Content(
        file.title, outputs, _accuracy(file.accuracy), branch, inputs,
        tuple(checks), tuple(peaks), tuple(pictures), file.results.data,
        _reduction(file, outputs, inputs), file.threads, units, *_storage(file, outputs, inputs), own,
    )  # fmt: skip


def _storage(
    file: schema.SceneFile, outputs: tuple[str, ...], inputs: Mapping[str, Value]
) -> tuple[str | None, Any, int | None]:
    """The store of a sweep, its chunks, and the memory that they may take."""
    results = file.results
    if results.store is not None and results.data is not None:
        raise SceneError(
            f"results.store = {shown(results.store)}: give a store or a file (results.data), not both"
        )
    if results.store is not None and not (outputs or file.peak):
        raise SceneError(f"results.store = {shown(results.store)}: there is nothing to store")
    try:
        memory = bytes_of(results.memory)
    except ValueError as error:
        raise SceneError(f"results.{error}") from None
    if results.chunks is not None and outputs:
        axes = {name: len(value) for name, value in inputs.items() if isinstance(value, tuple)}
        reduced = dict.fromkeys(file.reduce, 1)
        try:
            chunk_lengths(results.chunks, {n: s for n, s in axes.items() if n not in reduced}, 1)
        except (ValueError, TypeError) as error:
            raise SceneError(f"results.{error}") from None
    return results.store, results.chunks, memory


def _units(data: Mapping[str, Any]) -> UnitSystem:
    """The units of the scene; a warning where a plain number is almost surely meant in another one."""
    try:
        units = units_of(data)
    except (ValueError, TypeError) as error:
        raise SceneError(str(error)) from None
    slips = slips_of(data, units)
    if slips:
        warnings.warn(f"almost surely a slip: {'; '.join(slips)}", UnitWarning, stacklevel=4)
    return units


def _defined(tables: Mapping[str, Any]) -> tuple[Definition, ...]:
    """The quantities of the scene's own, known from now on."""
    try:
        own = read_definitions(tables)
        redefine(own)
    except (ValueError, TypeError) as error:
        raise SceneError(f"quantities: {error}") from None
    return own


def _accuracy(written: str | float) -> str:
    """One of the accuracies, or the cheapest one that keeps an error everywhere."""
    try:
        return accuracy_of(written)
    except ValueError as error:
        raise SceneError(f"accuracy = {shown(written)}: {str(error).partition(': ')[2]}") from None


def _reduction(
    file: schema.SceneFile, outputs: tuple[str, ...], inputs: Mapping[str, Value]
) -> Reduction | None:
    """The reduction that a scene asks for instead of the grid."""
    if not file.reduce:
        return None
    if not outputs:
        raise SceneError("reduce: there is nothing to reduce, give outputs = [...]")
    if "status" in outputs:
        raise SceneError(f'outputs #{outputs.index("status") + 1} = "status": with [reduce] {NO_STATUS}')
    axes = [name for name, value in inputs.items() if isinstance(value, tuple)]
    try:
        return reduction_of(file.reduce, axes, outputs)
    except (ValueError, TypeError) as error:
        raise SceneError(str(error)) from None


def _require_names(file: schema.SceneFile) -> None:
    """The names of files say what is written into them."""
    data = file.results.data
    if data is not None and not data.endswith(DATA):
        ends = ", ".join(DATA)
        raise SceneError(f"results.data = {shown(data)}: its name must end in one of {ends}")
    if data is not None and not (file.outputs or file.peak):
        raise SceneError(f"results.data = {shown(data)}: there is nothing to write, give outputs = [...]")
    for index, picture in enumerate(file.picture, 1):
        if not picture.file.lower().endswith(PICTURES):
            allowed = ", ".join(PICTURES)
            raise SceneError(f"picture #{index}.file = {shown(picture.file)}: must end in one of {allowed}")


# ---- values of inputs ----------------------------------------------------------------------------


def _inputs(data: Mapping[str, Any], file: schema.SceneFile, folder: Path | None) -> dict[str, Value]:
    """The inputs of the sections in the order in which they stand in the file."""
    order = [(section, name) for section in data if section in SECTIONS for name in data[section]]
    found: dict[str, Value] = {}
    for section, name in order:
        key, written = f"{section}.{name}", getattr(getattr(file, section), name)
        if name not in INPUTS:
            continue
        if isinstance(data[section][name], Load):
            found[name] = data[section][name]
        elif isinstance(written, schema.Varying):
            found[name] = varying(key, name, written, folder)
        else:
            found[name] = values_of(key, name, written)
    return found


# ---- what is asked for ---------------------------------------------------------------------------


def _known(key: str, name: str, state: bool) -> None:
    try:
        quantity(name, state)
    except ValueError as error:
        raise SceneError(f"{key} = {shown(name)}: {error}") from None


def _needs(names: Iterable[str], inputs: Mapping[str, Any]) -> tuple[str, ...]:
    """The inputs that quantities can use, under the law or for a given state."""
    state = "omega" in inputs
    law = tuple(law_name(name) if state else name for name in names)
    if "mu" in inputs:  # then the status tells what the friction does, too
        law = tuple("force_status" if name == "status" else name for name in law)
    return tuple(name for name in program_of(law, Variant(state)).inputs if name != "branch")


def _require(key: str, needs: Iterable[str], what: str, inputs: Mapping[str, Any]) -> list[str]:
    """The needed inputs from those given; SceneError for a missing one."""
    for name in needs:
        if name not in inputs and name not in OPTIONAL:
            section = next(s for s, table in SECTIONS.items() if name in table.__struct_fields__)
            raise SceneError(f"{key}: {what} needs {section}.{name}, which is missing")
    return [name for name in needs if name in inputs]


def _require_for_grid(key: str, names: tuple[str, ...], inputs: Mapping[str, Any]) -> list[str]:
    """The needed inputs of a grid, which has `status` and `margin` too; they need no speed."""
    always = [name for name in _needs(("status", "margin"), inputs) if name in ("theta", *LENGTHS)]
    needs = dict.fromkeys([*_needs(names, inputs), *always])
    return _require(key, needs, ", ".join(names), inputs)


def _with(inputs: Mapping[str, Value], other: Mapping[str, Value]) -> dict[str, Value]:
    """Inputs with others in their place; a given state takes the place of the law, and back."""
    swapped = {"omega": "omega0", "omega0": "omega"}
    replaced = {swapped[name] for name in other if name in swapped}
    return {**{name: value for name, value in inputs.items() if name not in replaced}, **other}


def _numbers(key: str, names: Iterable[str], inputs: Mapping[str, Value]) -> dict[str, Any]:
    """Inputs that must be single: a number or a load that varies; SceneError for a list or range."""
    found: dict[str, Any] = {}
    for name in names:
        value = inputs[name]
        if isinstance(value, tuple):
            raise SceneError(f"{key}: {name} has {len(value)} values, one is wanted: give at.{name}")
        found[name] = value
    return found


def _checks(key: str, table: schema.CheckTable, inputs: Mapping[str, Value]) -> list[Check]:
    there = _with(inputs, design_of(f"{key}.at", table.at))
    checks = []
    for name, written in table.printed.items():
        place = f"{key}.printed.{name}"
        _known(place, name, "omega" in there)
        needed = _require(place, _needs((name,), there), name, there)
        printed = read_printed(place, written, table.digits, quantity(name, "omega" in there).unit)
        checks.append(Check(table.title, table.source, name, printed, _numbers(place, needed, there)))
    if not checks:
        raise SceneError(f"{key}.printed = {{}}: at least one printed value is wanted")
    return checks


def _peak(key: str, table: schema.PeakTable, inputs: Mapping[str, Value]) -> Peak:
    name = table.quantity
    only_inputs(f"{key}.over", table.over)
    over = {n: values_of(f"{key}.over.{n}", n, written) for n, written in table.over.items()}
    if "theta" in over:
        raise SceneError(f"{key}.over.theta: a peak is taken over theta; its range is {key}.theta")
    there = _completed(key, table, _with(inputs, over))
    _known(f"{key}.quantity", name, "omega" in there)
    slope = _slope(f"{key}.quantity", name, "omega" in there)
    needed = _require(
        f"{key}.quantity", [n for n in _needs((name, slope), there) if n != "theta"], name, there
    )
    for n in over:
        if n not in needed:
            raise SceneError(f"{key}.over.{n}: {name} does not depend on it")
    # Whether the mechanism can be assembled at all depends on its lengths.
    lengths = _require(f"{key}.quantity", [n for n in LENGTHS if n not in needed], name, there)
    ordered = dict.fromkeys((*over, *needed, *lengths))
    axes = {n: value for n in ordered if isinstance(value := there[n], tuple)}
    fixed = {n: value for n in ordered if isinstance(value := there[n], float)}
    loads = {n: value for n in ordered if isinstance(value := there[n], Load)}
    base = (
        _other_design(f"{key}.baseline", table.baseline or {}, axes, fixed)
        if table.baseline is not None
        else {}
    )
    claims = tuple(
        _claim(f"{key}.claim #{index}", claim, axes, fixed, bool(base))
        for index, claim in enumerate(table.claim, 1)
    )
    wanted = _sensitivities(f"{key}.sensitivities", table, needed)
    angles = _angles(key, table, inputs)
    at_base = design_of(f"{key}.baseline", table.baseline or {})
    return Peak(table.title, name, table.kind, axes, fixed, angles, at_base, base, claims, wanted, loads)


def _completed(key: str, table: schema.PeakTable, inputs: Mapping[str, Value]) -> dict[str, Value]:
    """The inputs, with 0 for those that only the baseline, a claim or a sensitivity names."""
    found = dict(inputs)
    named: dict[str, Iterable[str]]
    named = {f"{key}.sensitivities": table.sensitivities or (), f"{key}.baseline": table.baseline or ()}
    named |= {f"{key}.claim #{index}.at": claim.at for index, claim in enumerate(table.claim, 1)}
    for place, names in named.items():
        for name in names:
            if name in CENTRES and name not in found:
                raise SceneError(f"{place}: {name} is half a length unless it is given: give masses.{name}")
            if name in OPTIONAL:
                found.setdefault(name, 0.0)
    return found


def _sensitivities(key: str, table: schema.PeakTable, needed: Iterable[str]) -> tuple[str, ...]:
    """The parameters of the wanted sensitivities."""
    if table.sensitivities is None:
        return tuple(name for name in SENSITIVITIES if name in needed)
    only_inputs(key, table.sensitivities)
    for name in table.sensitivities:
        if name not in needed:
            reason = "a peak is taken over it" if name == "theta" else "it does not depend on it"
            raise SceneError(f"{key}: {table.quantity} has no sensitivity by {name}, {reason}")
    return table.sensitivities


def _slope(key: str, name: str, state: bool) -> str:
    """The derivative of a quantity by theta, whose inputs a peak needs; itself where there is none."""
    if name in WITHOUT_COURSE:
        raise SceneError(f"{key} = {shown(name)}: it has no peak over theta")
    slope = sensitivity(name, "theta")
    try:
        quantity(slope, state)
    except ValueError:
        return name
    return slope


def _angles(key: str, table: schema.PeakTable, inputs: Mapping[str, Value]) -> tuple[float, float]:
    """The range of theta: that of the peak, else that of the motion, else one turn."""
    if table.theta is not None:
        low, high = (number_of(f"{key}.theta #{i}", "theta", part) for i, part in enumerate(table.theta, 1))
        if low > high:
            raise SceneError(f"{key}.theta = {shown(list(table.theta))}: its lower end comes first")
        return low, high
    theta = inputs.get("theta")
    if isinstance(theta, tuple) and len(theta) > 1:
        return min(theta), max(theta)
    return 0.0, max([2.0 * pi, *(load.period for load in inputs.values() if isinstance(load, OverTheta))])


def _other_design(
    key: str, written: Mapping[str, float | str], axes: Mapping[str, Any], fixed: Mapping[str, float]
) -> dict[str, float]:
    """All inputs of a design that says only what is different."""
    design = {**fixed, **design_of(key, written)}
    for name in written:
        if name not in axes and name not in fixed:
            raise SceneError(f"{key}.{name}: the peak does not depend on it")
    for name in axes:
        if name not in design:
            raise SceneError(f"{key}: {name} has {len(axes[name])} values, one is wanted: give {key}.{name}")
    return {name: design[name] for name in (*axes, *fixed)}


def _claim(
    key: str, claim: schema.ClaimTable, axes: Mapping[str, Any], fixed: Mapping[str, float], based: bool
) -> Claim:
    if not based:
        raise SceneError(
            f"{key}.increase = {shown(claim.increase)}: an increase needs the peak's baseline = {{...}}"
        )
    design = _other_design(f"{key}.at", claim.at, axes, fixed)
    at = design_of(f"{key}.at", claim.at)
    return Claim(claim.source, at, design, read_percentage(f"{key}.increase", claim.increase))


def _picture(key: str, table: schema.PictureTable, inputs: Mapping[str, Value]) -> Picture:
    name = table.quantity
    only_inputs(f"{key}.family", table.family)
    if len(table.family) > 1:
        raise SceneError(f"{key}.family: one input makes a family, got {', '.join(table.family)}")
    family = {n: values_of(f"{key}.family.{n}", n, written) for n, written in table.family.items()}
    there = _with(_with(inputs, design_of(f"{key}.at", table.at)), family)
    _known(f"{key}.quantity", name, "omega" in there)
    needed = _require_for_grid(f"{key}.quantity", (name,), there)
    if table.over not in INPUTS:
        raise SceneError(
            f"{key}.over = {shown(table.over)}: unknown input; {schema.hint(table.over, tuple(INPUTS))}"
        )
    if not isinstance(there.get(table.over), tuple) or table.over in family:
        raise SceneError(
            f"{key}.over = {shown(table.over)}: it must be an input that has a list or range of values"
        )
    member = next(iter(family), None)
    curves = [n for n in (member, table.over) if n is not None]
    fixed = _numbers(key, [n for n in needed if n not in curves], there)
    return Picture(
        table.title, table.file, name, table.over, member, {**{n: there[n] for n in curves}, **fixed}
    )
