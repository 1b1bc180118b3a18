"""The schema of a scene file: its keys, their types, and the error messages."""

import re
from collections.abc import Iterator, Mapping
from types import UnionType
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Literal,
    TypeAlias,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

import msgspec
from msgspec import Meta, Struct

from ..evaluation.reductions.kinds import ALLOWED
from ..mechanism.inputs import INPUTS, names_in
from ..mechanism.spelling import did_you_mean
from ..support.shown import shown as as_text

_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")


class SceneError(ValueError):
    """A scene that cannot be used; the message names the key, its value and what is allowed."""


_NUMBER = 'a number in SI units, or text with a unit such as "125 mm" or "0.5 kg"'
_WORDS = "a list of names of quantities"

Text = Annotated[str, Meta(description="text")]
Name = Annotated[str, Meta(description="the name of a quantity")]
File = Annotated[str, Meta(description="the path of a file")]
Store = Annotated[str, Meta(description='the folder of a Zarr store, such as "press.zarr"')]
Chunks = Annotated[
    int | str | dict[str, int | str],
    Meta(description='"auto", a number of points, or a table such as { theta = 1000 }'),
]
Memory = Annotated[int | str, Meta(description='text such as "200 MB", or a number of bytes')]
Number = Annotated[float | str, Meta(description=_NUMBER)]
Count = Annotated[int, Meta(ge=1, description="a whole number, at least 1")]
Points = Annotated[int, Meta(ge=2, description="a whole number, at least 2")]
Printed = Annotated[
    int | float | str, Meta(description='text as it is printed, such as "-20.2 m/s", or a number')
]
Percent = Annotated[int | float | str, Meta(description='a percentage such as "33 %"')]
Branch = Annotated[Literal[1, -1], Meta(description="1 (the papers) or -1")]
Kind = Annotated[Literal["absmax", "max", "min"], Meta(description="one of absmax, max, min")]
Units = Annotated[
    str | dict[str, str],
    Meta(description='units such as "mm, deg, rpm", or a table such as { length = "mm", angle = "deg" }'),
]
Accuracy = Annotated[str | float, Meta(description='"standard", "extended", or an error such as 1e-9')]
Angles = Annotated[tuple[Number, Number], Meta(description='two angles such as ["0 deg", "360 deg"]')]


class SceneSection(Struct, frozen=True, forbid_unknown_fields=True):
    """A table of the scene file."""


class Range(SceneSection, frozen=True):
    """Evenly spaced values, both ends included: by number (`num`) or by distance (`step`)."""

    start: Number
    stop: Number
    num: Points | None = None
    step: Number | None = None


_VALUES = (
    'a number in SI units, text with a unit such as "125 mm" or "0.5 kg", a list of these, '
    "or a range {start = ..., stop = ..., num = ...} (or step instead of num)"
)
Values = Annotated[float | str | tuple[Number, ...] | Range, Meta(description=_VALUES)]
_POINTS = 'the path of a file such as "press.csv", or points such as [["0 deg", "0 N"], ["90 deg", "-400 N"]]'
Table = Annotated[str | tuple[Number | tuple[Number, ...], ...], Meta(description=_POINTS)]
Unit = Annotated[str, Meta(description='a unit of a column of a file, such as "deg"')]
Column = Annotated[tuple[Number, ...], Meta(description="a list of numbers in SI units, or texts with units")]
TableKind = Annotated[
    Literal["cubic", "linear", "step"], Meta(description='one of "cubic", "linear", "step"')
]
MotorPoints = Annotated[
    str | tuple[tuple[Number, Number], ...],
    Meta(
        description='the path of a file such as "motor.csv", or points of speed and torque, such as '
        '[["0 rpm", 30], ["1000 rpm", 0]]'
    ),
]
MotorKind = Annotated[Literal["linear", "smooth"], Meta(description='one of "linear", "smooth"')]
Numbers = Annotated[float | str | tuple[Number, ...], Meta(description=f"{_NUMBER}, or a list of these")]
DeadCentre = Annotated[
    Literal["outer", "inner"],
    Meta(description='"outer" or "inner": the dead centre from which over_stroke measures distances'),
]


class Varying(SceneSection, frozen=True):
    """A range of values, or a load over the motion: over the angle, over Y, or from a dead centre.

    With the bore or the area of a piston its values are pressures, less the ambient one.
    """

    start: Number | None = None
    stop: Number | None = None
    num: Points | None = None
    step: Number | None = None
    over_theta: Table | None = None
    over_Y: Table | None = None
    over_stroke: Table | None = None
    dead_centre: DeadCentre | None = None
    values: Column | None = None
    outward: Column | None = None
    inward: Column | None = None
    kind: TableKind | None = None
    period: Number | None = None
    theta: Unit | None = None
    Y: Unit | None = None
    distance: Unit | None = None
    value: Unit | None = None
    bore: Number | None = None
    area: Number | None = None
    ambient: Number | None = None


_FORCE = (
    f'{_VALUES}, or a load that varies with the motion, such as {{over_theta = "press.csv"}}, '
    '{over_Y = [[0.05, -100], [0.1, -10]]} or {over_stroke = [[0, -80e3], [0.008, 0]], dead_centre = "outer"}'
)
Force = Annotated[float | str | tuple[Number, ...] | Varying, Meta(description=_FORCE)]
_INPUT_NAMES = {"propertyNames": {"enum": list(INPUTS)}}
Design = Annotated[
    dict[str, Number],
    Meta(description="a table of inputs, such as { ec = 0 }", extra_json_schema=_INPUT_NAMES),
]
Axes = Annotated[
    dict[str, Values],
    Meta(description='a table of inputs, such as { ec = [0, "50 mm"] }', extra_json_schema=_INPUT_NAMES),
]
Reduced = Annotated[
    dict[
        str,
        Annotated[
            str | tuple[str | tuple[str | float, ...], ...],
            Meta(description=f'one of {ALLOWED}, ["rms", name], ["at", "60 deg", name], or a list of these'),
        ],
    ],
    Meta(
        description='a table axis = what is taken of it, such as { theta = "absmax" }; several axes at once '
        'are a key "theta, ec"',
    ),
]


def _of_inputs(name: str, meaning: str, first: tuple[str, ...] = (), *more: tuple[str, Any, Any]) -> Any:
    """The section of a scene in which the inputs stand that name it; forces may vary with the motion."""
    rows = [INPUTS[each] for each in dict.fromkeys((*first, *names_in(name)))]
    fields = [(row.name, (Force if row.unit == "N" else Values) | None, None) for row in rows]
    told = {"__doc__": f"`[{name}]`: {meaning}."}
    options: Any = {"bases": (SceneSection,), "namespace": told, "module": __name__, "frozen": True}
    return msgspec.defstruct(name.capitalize(), [*fields, *more], **options)


if TYPE_CHECKING:
    Mechanism: TypeAlias = Any
    Motion: TypeAlias = Any
    Masses: TypeAlias = Any
    Loads: TypeAlias = Any
else:
    Mechanism = _of_inputs(
        "mechanism",
        "crank, rod, eccentricity, and on which side of the crank pin the slider is",
        ("AB", "BC"),
        ("branch", Branch, 1),
    )
    Motion = _of_inputs(
        "motion",
        "paper A's law (omega0, alpha) or a given state (omega, alpha), at crank angles theta",
        ("theta", "omega0", "omega"),
    )
    Masses = _of_inputs(
        "masses", "masses, moments of inertia and centres of mass; halfway along the links without these"
    )
    Loads = _of_inputs("loads", "the force on the slider, gravity, and the friction of the guide")
SECTIONS: dict[str, Any] = {"mechanism": Mechanism, "motion": Motion, "masses": Masses, "loads": Loads}


class KlossTable(SceneSection, frozen=True):
    """An induction motor by Kloss's formula; see `desaxe.kloss`."""

    breakdown_torque: Number
    breakdown_slip: Number
    synchronous_speed: Number
    gear: Number = 1.0


class MotorTable(SceneSection, frozen=True):
    """A motor: a file or points of its torque over the crank's speed, or Kloss's formula."""

    over_omega: MotorPoints | None = None
    kind: MotorKind | None = None
    omega: Unit | None = None
    torque: Unit | None = None
    kloss: KlossTable | None = None


_MOTOR = (
    'a number in SI units, text with a unit, or a motor such as {over_omega = [["0 rpm", 30], '
    '["1000 rpm", 0]]} or {kloss = {breakdown_torque = 40, breakdown_slip = 0.15, synchronous_speed = 157}}'
)


class SteadyTable(SceneSection, frozen=True):
    """`[steady]`: the steady state of the machine on its motor; see `desaxe.steady`."""

    torque: Annotated[float | str | MotorTable, Meta(description=_MOTOR)]
    flywheel_inertia: Numbers = 0.0
    fluctuation: Numbers | None = None


class CheckTable(SceneSection, frozen=True):
    """`[[check]]`: printed values, shown next to the computed ones."""

    printed: Annotated[
        dict[str, Printed], Meta(description='a table quantity = value, such as { V_C = "-20.2 m/s" }')
    ]
    at: Design = {}
    digits: Count | None = None
    title: Text = ""
    source: Text = "printed"


class ClaimTable(SceneSection, frozen=True):
    """`[[peak.claim]]`: a claim about the peak of one design."""

    at: Design
    increase: Percent
    source: Text = "printed"


class PeakTable(SceneSection, frozen=True):
    """`[[peak]]`: the refined extremum of a quantity over the crank angle, for many designs."""

    quantity: Name
    kind: Kind = "absmax"
    over: Axes = {}
    theta: Angles | None = None
    baseline: Design | None = None
    sensitivities: Annotated[tuple[str, ...] | None, Meta(description="a list of inputs")] = None
    claim: Annotated[tuple[ClaimTable, ...], Meta(description="a list of tables, [[peak.claim]]")] = ()
    title: Text = ""


class PictureTable(SceneSection, frozen=True):
    """`[[picture]]`: a quantity over one input, one curve for each value of another."""

    file: File
    quantity: Name
    over: Annotated[str, Meta(description="the name of an input")] = "theta"
    family: Axes = {}
    at: Design = {}
    title: Text = ""


class Results(SceneSection, frozen=True):
    """`[results]`: where the labelled values go: .nc (NetCDF), .zarr, .csv, .xlsx or .npz (NumPy).

    With `store`, a folder such as "press.zarr", they are swept into it chunk by chunk and need not fit
    into memory.
    """

    data: File | None = None
    store: Store | None = None
    chunks: Chunks | None = None
    memory: Memory | None = None


class QuantityTable(SceneSection, frozen=True):
    """`[quantities.NAME]`: a quantity of your own; see `desaxe.define`."""

    expression: Text
    unit: Text | None = None
    meaning: Text = ""
    constants: Annotated[
        dict[str, Number], Meta(description="a table of constants, such as { f = 0.08 }")
    ] = {}


class SceneFile(SceneSection, frozen=True):
    """A scene as it is written."""

    title: Text = ""
    outputs: Annotated[tuple[Name, ...], Meta(description=_WORDS)] = ()
    accuracy: Accuracy = "standard"
    reduce: Reduced = {}
    threads: Count | None = None
    mechanism: Annotated[Mechanism, Meta(description="a table, [mechanism]")] = Mechanism()
    motion: Annotated[Motion, Meta(description="a table, [motion]")] = Motion()
    masses: Annotated[Masses, Meta(description="a table, [masses]")] = Masses()
    loads: Annotated[Loads, Meta(description="a table, [loads]")] = Loads()
    quantities: Annotated[
        dict[str, QuantityTable], Meta(description="tables of quantities of your own, [quantities.NAME]")
    ] = {}
    steady: Annotated[SteadyTable | None, Meta(description="a table, [steady]")] = None
    check: Annotated[tuple[CheckTable, ...], Meta(description="a list of tables, [[check]]")] = ()
    peak: Annotated[tuple[PeakTable, ...], Meta(description="a list of tables, [[peak]]")] = ()
    picture: Annotated[tuple[PictureTable, ...], Meta(description="a list of tables, [[picture]]")] = ()
    results: Annotated[Results, Meta(description="a table, [results]")] = Results()
    units: Units = {}


# A range is taken for a mapping, and some whole numbers are too long to be written in a message.
_INVALID = (msgspec.ValidationError, AttributeError, ValueError)


def decoded(data: Mapping[str, Any]) -> SceneFile:
    """The scene that plain data stands for; SceneError names the first key that is wrong."""
    _refuse_control_characters(data, "")
    try:
        return msgspec.convert(data, SceneFile)
    except _INVALID as error:
        raise SceneError(_complaint(data, SceneFile, "") or str(error)) from None


def _refuse_control_characters(value: Any, place: str) -> None:
    """Reject texts that steer a terminal, or that look other than they are; lines and tabs are fine."""
    if isinstance(value, str):
        found = _CONTROL.search(value)
        if found:
            raise SceneError(f"{place} = {shown(value)}: it has the control character {found[0]!r}")
    elif isinstance(value, Mapping):
        for name, part in value.items():
            _refuse_control_characters(name, "a key")
            _refuse_control_characters(part, f"{place}.{name}" if place else str(name))
    elif isinstance(value, (list, tuple)) and not all(isinstance(part, (int, float)) for part in value):
        for number, part in enumerate(value, 1):
            _refuse_control_characters(part, f"{place} #{number}")


def shown(value: Any) -> str:
    """A value as it would stand in a scene file, cut short where it is long."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        value = value if value.isprintable() else repr(value)[1:-1]
        return f'"{value}"' if len(value) <= 80 else f'"{value[:40]} ... {value[-20:]}"'
    text = "a table" if isinstance(value, Mapping) else as_text(value)
    return text if len(text) <= 60 else text[:57] + "..."


def hint(word: str, allowed: tuple[str, ...]) -> str:
    """The allowed words, preceded by the most similar one if there is one."""
    return f"{did_you_mean(word, allowed)}allowed: {', '.join(allowed)}"


# ---- which key is wrong --------------------------------------------------------------------------


def _complaint(value: Any, kind: Any, key: str) -> str | None:
    """The error of a value, of its innermost part where possible; None where it is valid."""
    if _fits(value, kind):
        return None
    struct = _member(kind, lambda part: isinstance(part, type) and issubclass(part, Struct))
    if struct is not None and isinstance(value, Mapping):
        found = _wrong_keys(value, struct, key)
        if found:
            return found
    for part, part_kind, part_key in _parts(value, kind, key):
        found = _complaint(part, part_kind, part_key)
        if found:
            return found
    return f"{key or 'the scene'} = {shown(value)}: it must be {_allowed(kind)}"


def _fits(value: Any, kind: Any) -> bool:
    try:
        msgspec.convert(value, kind)
    except _INVALID:
        return False
    return True


def _wrong_keys(value: Mapping[str, Any], struct: type[Struct], key: str) -> str | None:
    fields = msgspec.structs.fields(struct)
    names = tuple(field.name for field in fields)
    for name in value:
        if name not in names:
            home = INPUTS[name].section if name in INPUTS else ""
            told = f"{name} belongs in [{home}]" if home else hint(str(name), names)
            if _dotted(key, name) == "crankshaft":
                told = "several sliders are for desaxe.Crankshaft.read and desaxe CALL --machine FILE"
            return f"{_dotted(key, name)} = {shown(value[name])}: unknown key; {told}"
    for field in fields:
        if field.required and field.name not in value:
            return f"{_dotted(key, field.name)} is missing: it must be {_allowed(field.type)}"
    return None


def _parts(value: Any, kind: Any, key: str) -> Iterator[tuple[Any, Any, str]]:
    """The parts of a table or list, each with its type and key; a list is counted from 1."""
    if isinstance(value, Mapping):
        struct = _member(kind, lambda part: isinstance(part, type) and issubclass(part, Struct))
        table = _member(kind, lambda part: _origin(part) is dict)
        hints = get_type_hints(struct, include_extras=True) if struct else {}
        for name, part in value.items():
            part_kind = hints[name] if struct else get_args(table)[1] if table else None
            if part_kind is not None:
                yield part, part_kind, _dotted(key, name)
    elif isinstance(value, list):
        sequence = _member(kind, lambda part: _origin(part) is tuple)
        kinds = get_args(sequence) if sequence else ()
        if kinds and (kinds[-1] is Ellipsis or len(kinds) == len(value)):
            for index, part in enumerate(value):
                part_kind = kinds[0] if kinds[-1] is Ellipsis else kinds[index]
                yield part, part_kind, f"{key} #{index + 1}"


def _member(kind: Any, wanted: Any) -> Any:
    """The first member of a union, or the type itself, that satisfies a predicate."""
    if get_origin(kind) is Annotated:
        return _member(get_args(kind)[0], wanted)
    if get_origin(kind) in (Union, UnionType):
        return next((found for part in get_args(kind) if (found := _member(part, wanted))), None)
    return kind if wanted(kind) else None


def _origin(kind: Any) -> Any:
    """The origin of a type, as a value that a type checker takes for no type."""
    return get_origin(kind)


def _allowed(kind: Any) -> str:
    """The description of the values that a type allows."""
    if get_origin(kind) is Annotated:
        return next(meta.description for meta in get_args(kind)[1:] if isinstance(meta, Meta)) or ""
    parts = [part for part in get_args(kind) if part is not type(None)]
    return _allowed(parts[0]) if parts else "a table"


def _dotted(key: str, name: str) -> str:
    return f"{key}.{name}" if key else str(name)
