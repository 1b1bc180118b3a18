"""Loads and motors of a scene: from a file, from points, or of a few numbers."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from sys import float_info
from typing import Any, NamedTuple, cast

from ..loads.along_motion import OverSpeed
from ..loads.elements import FREE, LINEAR, QUADRATIC, STIFFNESS, Damper, Spring, damper, over_V, spring
from ..loads.load import Load, OverY, TableOverTheta
from ..loads.motors import Motor, kloss, over_omega
from ..loads.pressure import PISTON
from ..loads.resolve import plain_units, settled
from ..loads.stroke import OverStroke
from ..loads.tabulated import over_stroke, over_theta, over_Y
from ..mechanism.inputs import Input
from ..mechanism.quantity_units import SI, UnitSystem
from ..mechanism.read import in_si
from ..support.extras import MissingExtraError
from .reading.values import Value, is_sum, values_of
from .schema import SceneError, shown

RANGE = ("start", "stop", "num", "step")


class LoadKind(NamedTuple):
    """A load of a scene: how it is read, and written.

    maker    the call that makes it, and `made`, the class that it makes
    columns  keys of its values beside a list of positions
    units    keys of the units of positions and values
    options  its other keys
    along    the quantity of its positions
    numbers  the rows of a load of a few numbers: its own, and those of its options
    example  of its points
    needs    a key that it cannot do without, and what that is
    """

    maker: Any
    made: Any = None
    columns: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    options: tuple[str, ...] = ()
    along: str = ""
    numbers: tuple[Input, ...] = ()
    example: str = ""
    needs: tuple[str, str] | None = None

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys beside that of the load."""
        return (*self.columns, *self.units, *self.options)


GAS = ("kind", *(row.name for row in PISTON))
WAYS, BOTH = ("outward", "inward"), "with the way inward"
KINDS = {
    "over_theta": LoadKind(over_theta, TableOverTheta, ("values",), ("theta", "value"), (*GAS, "period"),
                           "theta", example="[[0, 0], [1.57, -400]]"),
    "over_Y": LoadKind(over_Y, OverY, WAYS, ("Y", "value"), GAS, "Y",
                       example="[[0.2, 0], [0.37, -400]], or [[0.2, 0, 0], [0.37, -400, -50]] " + BOTH),
    "over_stroke": LoadKind(over_stroke, OverStroke, WAYS, ("distance", "value"), (*GAS, "dead_centre"), "Y",
                            example="[[0, -400], [0.005, 0]], or [[0, -400, 0], [0.005, 0, 0]] " + BOTH,
                            needs=("dead_centre", '"outer" or "inner", from which over_stroke measures')),
    "over_V": LoadKind(over_V, OverSpeed, ("values",), ("V_C", "value"), GAS, "V_C",
                       example="[[-2, 900], [0, 0], [2, -400]]"),
    "spring": LoadKind(spring, Spring, options=("free",), numbers=(STIFFNESS, FREE),
                       needs=("free", "the position along Y at which the spring has no force")),
    "damper": LoadKind(damper, Damper, options=("quadratic",), numbers=(LINEAR, QUADRATIC)),
}  # fmt: skip
MOTORS = {
    "over_omega": LoadKind(over_omega, units=("omega", "torque"), options=("kind",),
                           example="[[0, 30], [100, 0]]"),
    "kloss": LoadKind(kloss),
}  # fmt: skip


def kind_of(load: Any) -> tuple[str, LoadKind | None]:
    """The key and the row of a load that is data; None for any other."""
    return next(((name, kind) for name, kind in KINDS.items() if kind.made is type(load)), ("", None))


def without_objects(data: Mapping[str, Any]) -> dict[str, Any]:
    """The data of a scene with each Load or Motor object replaced by a number, for the schema."""
    return {
        section: {name: 0.0 if isinstance(value, (Load, Motor)) else value for name, value in table.items()}
        if section in ("loads", "steady") and isinstance(table, Mapping)
        else table
        for section, table in data.items()
    }


def force_of(key: str, name: str, written: Any, folder: Path | None, units: UnitSystem) -> Value:
    """The values of a force, or a load that varies with the motion.

    folder   of the scene file: a load's file is looked for there first, then in the current directory
    """
    if isinstance(written, Load):
        return cast(Value, _settled(key, name, written, units))
    if is_sum(written):
        parts = [force_of(f"{key} #{k}", name, part, folder, units) for k, part in enumerate(written, 1)]
        return _sum(key, parts, units)
    if not isinstance(written, Mapping) or (kind := _kind_of(written, KINDS)) is None:
        if isinstance(written, Mapping):
            _refuse(key, written, RANGE, lambda wrong: f"it belongs to {_kinds_with(wrong)}")
        return values_of(key, name, written, units)
    written = dict(written)
    scale, needs = written.pop("scale", 1.0), KINDS[kind].needs
    if needs is not None and needs[0] not in written:
        raise SceneError(f"{key}.{needs[0]} is missing: {needs[1]}")
    load = _made(key, kind, KINDS[kind], written, folder, units)
    plain = plain_units(name, load, units) if isinstance(written[kind], str) else {}
    if plain:
        force = plain.pop("value", "") or plain.pop("pressure", "")
        named = zip(KINDS[kind].units, (next(iter(plain.values()), ""), force), strict=True)
        beside = ", ".join(f'{unit_key} = "{unit}"' for unit_key, unit in named if unit)
        raise SceneError(
            f"{key}.{kind} = {shown(written[kind])}: its plain numbers would be in SI units, but those of "
            f"the scene are not: name the units of its columns in its heading, or by {beside} beside the file"
        )
    if not abs(scale) <= float_info.max:
        raise SceneError(f"{key}.scale = {shown(scale)}: expected a finite number")
    return cast(Value, _settled(key, name, load if scale == 1.0 else load * scale, units))


def _sum(key: str, parts: Sequence[Any], units: UnitSystem) -> Value:
    """The sum of loads and numbers."""
    wrong = next((k for k, part in enumerate(parts, 1) if isinstance(part, tuple)), None)
    if wrong is not None:
        raise SceneError(f"{key} #{wrong}: a sum is of loads and numbers, not of a range of values")
    loads = [part for part in parts if isinstance(part, Load)]
    total = sum(loads[1:], loads[0]).in_units(SI)
    number = sum(part for part in parts if not isinstance(part, Load))
    return cast(Value, (total + number if number else total).in_units(units))


def motor_of(key: str, written: Mapping[str, Any], folder: Path | None, units: UnitSystem) -> Motor:
    """The motor of a table."""
    kind = _kind_of(written, MOTORS)
    if kind is None or len(MOTORS.keys() & written.keys()) > 1:
        raise SceneError(f'{key}: a motor has over_omega = "motor.csv", [...] or kloss = {{...}}')
    motor = _made(key, kind, MOTORS[kind], written, folder, units)
    return cast(Motor, _settled(f"{key}.{kind}", "torque", motor, units))


def _kind_of(written: Mapping[str, Any], kinds: Mapping[str, LoadKind]) -> str | None:
    return next((kind for kind in kinds if kind in written), None)


def _kinds_with(key: str) -> str:
    """The loads that a key belongs to."""
    return " or ".join(name for name, kind in KINDS.items() if key in kind.keys)


def _refuse(key: str, written: Mapping[str, Any], allowed: Sequence[str], why: Any) -> None:
    wrong = next((name for name in written if name not in allowed), None)
    if wrong is not None:
        raise SceneError(f"{key}.{wrong} = {shown(written[wrong])}: {why(wrong)}")


def _settled(key: str, name: str, load: Any, units: UnitSystem) -> Any:
    """A load whose numbers mean what they do in the scene; SceneError where they could be others."""
    try:
        return settled(name, load, units)
    except ValueError as error:
        raise SceneError(f"{key}: {str(error).removeprefix(f'{name}: ')}") from None


def _made(
    key: str, name: str, kind: LoadKind, written: Mapping[str, Any], folder: Path | None, units: UnitSystem
) -> Any:
    """The load or motor of a table; SceneError where it is none."""
    source, options = written[name], {n: v for n, v in written.items() if n != name}
    if isinstance(source, list) and kind is MOTORS.get(name):
        _refuse(key, options, kind.options, lambda _: "it has no place beside points")
    _refuse(key, options, kind.keys, lambda _: f"it has no place beside {name}")
    maker = type(kind.maker)(units or None)
    try:
        if isinstance(source, list):
            return _from_points(name, kind, maker, source, options)
        if isinstance(source, str) and hasattr(maker, "read"):
            return _from_file(kind, source, options, folder, units)
        if kind.columns:
            raise ValueError(f"expected points such as {kind.example}")
        return maker(**source) if isinstance(source, Mapping) else maker(source, **options)
    except MissingExtraError:
        raise
    except (ValueError, TypeError) as error:
        raise SceneError(f"{key}{f'.{name}' if name in MOTORS else ''}: {error}") from None
    except OSError as error:
        raise SceneError(f"{key}.{name} = {shown(source)}: {error.strerror or error}") from None


def _from_file(
    kind: LoadKind, name: str, options: dict[str, Any], folder: Path | None, units: UnitSystem
) -> Any:
    """A load of a file beside the scene, else in the current directory."""
    columns = [column for column in kind.columns if column in options]
    if columns:
        raise ValueError(f"{columns[0]} beside a file: the file has the values")
    for row in PISTON:  # plain numbers of the scene, where those of the file are in SI units
        if isinstance(options.get(row.name), (int, float)):
            options[row.name] = in_si(row, options[row.name], units)
    if "period" in options:  # in the unit of its angles, as beside points
        unit = options.get("theta") or units.of("theta").unit
        (options["period"],) = _with_unit([options["period"]], unit)
    beside = None if folder is None else folder / name
    return kind.maker.read(beside if beside is not None and beside.exists() else Path(name), **options)


def _from_points(
    name: str, kind: LoadKind, maker: Any, points: Sequence[Any], options: dict[str, Any]
) -> Any:
    along, value = (options.pop(key, None) for key in kind.units)
    first = kind.columns[:1]
    columns: list[Any] = []
    if first and first[0] in options:
        columns = [options.pop(column) for column in kind.columns if column in options]
    if not columns:
        rows = [row if isinstance(row, list) else [row] for row in points]
        _require_points(name, kind, [len(row) for row in rows])
        points, *columns = (list(column) for column in zip(*rows, strict=True))
    elif any(isinstance(point, list) for point in points):
        raise ValueError(f"points with their values and {kind.columns[0]} = [...] beside them: give one")
    if "period" in options:
        (options["period"],) = _with_unit([options["period"]], along)
    return maker(_with_unit(points, along), *(_with_unit(column, value) for column in columns), **options)


def _require_points(name: str, kind: LoadKind, widths: list[int]) -> None:
    """ValueError for points of other than two numbers, or three with the way inward, all alike."""
    width = max(widths, key=widths.count, default=0)
    odd = [index for index, count in enumerate(widths) if count != width]
    if not odd and width in (2, 1 + len(kind.columns)):
        return
    wrong, rest = (odd[0], f", {'the others' if len(odd) == 1 else 'most'} {width}") if odd else (0, "")
    said = "no points"
    if widths:
        said = f"point {wrong + 1} has {widths[wrong]} number{'' if widths[wrong] == 1 else 's'}{rest}"
    beside = f"; or {kind.columns[0]} = [...] beside a list of places" if kind.columns else ""
    raise ValueError(f"{name}: {said}: expected points such as {kind.example}{beside}")


def _with_unit(column: Sequence[Any], unit: str | None) -> list[Any]:
    """Numbers in a unit; texts carry their own."""
    return [f"{x!r} {unit}" if unit and not isinstance(x, str) else x for x in column]
