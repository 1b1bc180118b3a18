"""The schema of a scene file: what editors complete, what is checked when one is read, and its messages."""

import json
import re
from collections.abc import Iterable, Mapping
from math import inf
from typing import Any

from ..evaluation.reductions.kinds import ALLOWED, NAMES
from ..mechanism.inputs import INPUTS, names_in
from ..mechanism.names import parts
from ..mechanism.own import derived_names
from ..mechanism.spelling import did_you_mean
from ..support.shown import shown as as_text

_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
_TYPES: dict[str, Any] = {
    "object": Mapping, "array": list, "string": str, "number": (int, float), "integer": int,
}  # fmt: skip


class SceneError(ValueError):
    """A scene that cannot be used; the message names the key, its value and what is allowed."""


# ---- the keys of a scene ---------------------------------------------------------------------------

Rule = dict[str, Any]  # of JSON Schema; its description is what a message says of the values that it allows


def _rule(description: str, *kinds: Any, **more: Any) -> Rule:
    """A rule for values of one kind, or of several: names of types, or rules."""
    rules = [{"type": kind} if isinstance(kind, str) else kind for kind in kinds]
    return {"description": description, **(rules[0] if len(rules) == 1 else {"anyOf": rules}), **more}


def _list_of(items: Rule, description: str = "", **more: Any) -> Rule:
    return {"type": "array", "items": items, "description": description or items["description"], **more}


def _one_of(*words: Any) -> Rule:
    kind = "string" if isinstance(words[0], str) else "integer"
    quoted = ", ".join(map(str, words)) if kind == "string" else "1 (the papers) or -1"
    return _rule(f"one of {quoted}" if kind == "string" else quoted, kind, enum=[*words])


def _mapping_of(values: Rule, description: str, names: Iterable[str] = ()) -> Rule:
    more = {"propertyNames": {"enum": [*names]}} if names else {}
    return _rule(description, "object", additionalProperties=values, **more)


def _table(description: str, required: Iterable[str] = (), /, **keys: Rule) -> Rule:
    return _rule(description, "object", properties=keys, required=[*required], additionalProperties=False)


_NUMBER = 'a number in SI units, or text with a unit such as "125 mm" or "0.5 kg"'
_RANGE = "or a range {start = ..., stop = ..., num = ...} (or step instead of num)"
_VALUES = f'a number in SI units, text with a unit such as "125 mm" or "0.5 kg", a list of these, {_RANGE}'
_FORCE = (
    f'{_VALUES}, or a load that varies with the motion, such as {{over_theta = "press.csv"}}, '
    '{over_Y = [[0.05, -100], [0.1, -10]]}, {over_stroke = [[0, -80e3], [0.008, 0]], dead_centre = "outer"}, '
    '{spring = "4 N/mm", free = "120 mm"} or {damper = "200 N s/m"}, or a list of these, which is their sum'
)
_MOTOR = (
    'a number in SI units, text with a unit, or a motor such as {over_omega = [["0 rpm", 30], '
    '["1000 rpm", 0]]} or {kloss = {breakdown_torque = 40, breakdown_slip = 0.15, synchronous_speed = 157}}'
)

TEXT = _rule("text", "string")
NAME = _rule("the name of a quantity", "string")


def _file(*suffixes: str) -> Rule:
    either = "|".join(one[1:] for one in (*suffixes, *map(str.upper, suffixes)))
    about = f"the path of a file, which must end in one of {', '.join(suffixes)}"
    return _rule(about, "string", pattern=rf"\.({either})$")


UNIT = _rule('a unit of a column of a file, such as "deg"', "string")
NUMBER = _rule(_NUMBER, "number", "string")
NUMBERS = _rule(f"{_NUMBER}, or a list of these", "number", "string", _list_of(NUMBER))
COUNT = _rule("a whole number, at least 1", "integer", minimum=1)
PAIR = {"minItems": 2, "maxItems": 2}
SPAN = {"start": NUMBER, "stop": NUMBER, "num": _rule("a whole number, at least 2", "integer", minimum=2),
        "step": NUMBER}  # fmt: skip
RANGE = _table("evenly spaced values, both ends included", ("start", "stop"), **SPAN)
VALUES = _rule(_VALUES, "number", "string", _list_of(NUMBER), RANGE)
COLUMN = _list_of(NUMBER, "a list of numbers in SI units, or texts with units")
_POINTS = 'the path of a file such as "press.csv", or points such as [["0 deg", "0 N"], ["90 deg", "-400 N"]]'
POINTS = _rule(_POINTS, "string", _list_of(_rule(_POINTS, "number", "string", _list_of(NUMBER))))
CENTRE = _rule('"outer" or "inner": the dead centre from which over_stroke measures distances', "string",
               enum=["outer", "inner"])  # fmt: skip
VARYING = _table(
    "values, or a load over the motion; with the bore or the area of a piston its values are pressures",
    **SPAN, over_theta=POINTS, over_Y=POINTS, over_stroke=POINTS, over_V=POINTS, spring=NUMBER, damper=NUMBER,
    dead_centre=CENTRE, values=COLUMN, outward=COLUMN, inward=COLUMN, period=NUMBER, theta=UNIT, Y=UNIT,
    distance=UNIT, value=UNIT, V_C=UNIT, bore=NUMBER, area=NUMBER, ambient=NUMBER, free=NUMBER,
    quadratic=NUMBER, scale=_rule("a number by which the load is multiplied", "number"),
    kind=_one_of("cubic", "linear", "step", "smooth"),
)  # fmt: skip
TERM = _rule(f"{_NUMBER}, or in a sum a load", "number", "string", VARYING)
FORCE = _rule(_FORCE, "number", "string", _list_of(TERM), VARYING)
DESIGN = _mapping_of(NUMBER, "a table of inputs, such as { ec = 0 }", INPUTS)
AXES = _mapping_of(VALUES, 'a table of inputs, such as { ec = [0, "50 mm"] }', INPUTS)
_PATTERN = {"anyOf": [{"enum": [*NAMES]}, {"pattern": r"^p\d+(\.\d+)?$"}]}
_TAKEN = f'one of {ALLOWED}, ["rms", name], ["at", "60 deg", name], or a list of these'
_PARTS = {"type": "array", "items": {"anyOf": [{"type": "string"}, {"type": "number"}]}}
REDUCED = _mapping_of(
    _rule(_TAKEN, {"type": "string", **_PATTERN}, _list_of(_rule(_TAKEN, "string", _PARTS), minItems=1)),
    'a table axis = what is taken of it, such as { theta = "absmax" }; several axes at once '
    'are a key "theta, ec"',
)
SPEED_POINTS = _rule(
    'the path of a file such as "motor.csv", or points of speed and torque, such as '
    '[["0 rpm", 30], ["1000 rpm", 0]]',
    "string",
    _list_of(_list_of(NUMBER, "a point of speed and torque", **PAIR)),
)  # fmt: skip
KLOSS = _table(
    "an induction motor by Kloss's formula", ("breakdown_torque", "breakdown_slip", "synchronous_speed"),
    breakdown_torque=NUMBER, breakdown_slip=NUMBER, synchronous_speed=NUMBER, gear=NUMBER,
)  # fmt: skip
MOTOR = _table("a motor", over_omega=SPEED_POINTS, kind=_one_of("linear", "smooth"), omega=UNIT, torque=UNIT,
               kloss=KLOSS)  # fmt: skip


def _section(name: str, meaning: str, first: tuple[str, ...] = (), **more: Rule) -> Rule:
    """The section of the inputs whose rows name it; forces may vary with the motion."""
    rows = [INPUTS[each] for each in dict.fromkeys((*first, *names_in(name)))]
    keys = {
        row.name: {"title": f"{row.meaning} [{row.unit}]", **(FORCE if row.unit == "N" else VALUES)}
        for row in rows
    }
    return _table(f"a table, [{name}]: {meaning}", (), **keys, **more)


SECTIONS = {
    "mechanism": _section("mechanism", "crank, rod, eccentricity, and on which side of the pin the slider is",
                          ("AB", "BC"), branch=_one_of(1, -1)),
    "motion": _section("motion", "paper A's law (omega0, alpha) or a given state (omega, alpha), at angles "
                       "theta", ("theta", "omega0", "omega")),
    "masses": _section("masses", "masses, moments of inertia, centres of mass; halfway along the links "
                       "without these"),
    "loads": _section("loads", "the force on the slider, gravity, and the friction of the guide"),
}  # fmt: skip
CLAIM = _table(
    "a claim about the peak of one design", ("at", "increase"), at=DESIGN, source=TEXT,
    increase=_rule('a percentage such as "33 %"', "number", "string"),
)  # fmt: skip
LISTED = {
    "check": _table(
        "printed values, shown next to the computed ones", ("printed",), at=DESIGN, digits=COUNT, title=TEXT,
        source=TEXT,
        printed=_mapping_of(
            _rule('text as it is printed, such as "-20.2 m/s", or a number', "number", "string"),
            'a table quantity = value, such as { V_C = "-20.2 m/s" }',
        ),
    ),
    "peak": _table(
        "the refined extremum of a quantity over the crank angle, for many designs", ("quantity",),
        quantity=NAME, kind=_one_of("absmax", "max", "min"), over=AXES, baseline=DESIGN, title=TEXT,
        theta=_list_of(NUMBER, 'two angles such as ["0 deg", "360 deg"]', **PAIR),
        sensitivities=_list_of(TEXT, "a list of inputs"),
        claim=_list_of(CLAIM, "a list of tables, [[peak.claim]]"),
    ),
    "picture": _table(
        "a quantity over one input, one curve for each value of another", ("file", "quantity"),
        file=_file(".png", ".svg", ".pdf"), quantity=NAME, family=AXES, at=DESIGN, title=TEXT,
        over=_rule("the name of an input", "string"),
    ),
}  # fmt: skip
STEADY = _table(
    "a table, [steady]: the steady state of the machine on its motor; see `desaxe.steady`", ("torque",),
    torque=_rule(_MOTOR, "number", "string", MOTOR), flywheel_inertia=NUMBERS, fluctuation=NUMBERS,
)  # fmt: skip
RESULTS = _table(
    "a table, [results]: where the labelled values go: .nc, .zarr, .csv, .xlsx or .npz, or a store that they "
    "are swept into chunk by chunk",
    data=_file(".nc", ".zarr", ".csv", ".xlsx", ".npz"),
    store=_rule('the folder of a Zarr store, such as "press.zarr"', "string"),
    chunks=_rule('"auto", a number of points, or a table such as { theta = 1000 }', "integer", "string",
                 _mapping_of(_rule("a number of points", "integer", "string"), "chunks")),
    memory=_rule('text such as "200 MB", or a number of bytes', "integer", "string"),
)  # fmt: skip
QUANTITY = _table(
    "a table, [quantities.NAME]: a quantity of your own; see `desaxe.define`", ("expression",),
    expression=TEXT, unit=TEXT, meaning=TEXT,
    constants=_mapping_of(NUMBER, "a table of constants, such as { f = 0.08 }"),
)  # fmt: skip
SCENE = _table(
    "a scene of desaxe",
    title=TEXT, outputs=_list_of(NAME, "a list of names of quantities"),
    accuracy=_rule('"standard", "extended", or an error such as 1e-9', "string", "number"),
    reduce=REDUCED, threads=COUNT, **SECTIONS,
    quantities=_mapping_of(QUANTITY, "tables of quantities of your own, [quantities.NAME]"),
    steady=STEADY, results=RESULTS,
    **{name: _list_of(rule, f"a list of tables, [[{name}]]") for name, rule in LISTED.items()},
    units=_rule('units such as "mm, deg, rpm", or a table such as { length = "mm", angle = "deg" }',
                "string", _mapping_of(UNIT, "a table of units")),
)  # fmt: skip


ONE_SLIDER = (
    "crankshaft: this takes a slider by itself: leave [crankshaft] out of the file. Several sliders are for "
    "desaxe.Crankshaft.read, `desaxe run`, `desaxe scene`, `desaxe compile` and calls with --machine"
)


def json_schema_text() -> str:
    """The JSON schema as the text of a file: what editors complete and check while a scene is written."""
    return json.dumps(json_schema(), indent=2) + "\n"


def json_schema() -> dict[str, Any]:
    """The schema, with the names of quantities: no sensitivities, of which there are hundreds."""
    names = [name for name in derived_names() if not parts(name)[1]]
    known = {"anyOf": [{"enum": names}, {"pattern": "^[A-Za-z][A-Za-z0-9_]*$"}]}
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "A scene of desaxe"}
    rules = json.loads(json.dumps(SCENE), object_hook=lambda rule: rule | known if rule == NAME else rule)
    return {**head, **rules}


# ---- the check -------------------------------------------------------------------------------------


def check(data: Mapping[str, Any]) -> None:
    """SceneError for the first key of a scene that is wrong."""
    _refuse_control_characters(data, "")
    message = _complaint(data, SCENE, "")
    if message:
        raise SceneError(message)


def _refuse_control_characters(value: Any, key: str) -> None:
    """Reject texts that steer a terminal, or that look other than they are; lines and tabs are fine."""
    if isinstance(value, str):
        wrong = _CONTROL.search(value)
        if wrong:
            raise SceneError(f"{key} = {shown(value)}: it has the control character {wrong[0]!r}")
    elif isinstance(value, Mapping):
        for name, part in value.items():
            _refuse_control_characters(name, "a key")
            _refuse_control_characters(part, _dotted(key, name))
    elif isinstance(value, (list, tuple)) and not all(isinstance(part, (int, float)) for part in value):
        for number, part in enumerate(value, 1):
            _refuse_control_characters(part, f"{key} #{number}")


def _complaint(value: Any, rule: Rule, key: str) -> str | None:
    """The message of the first part of a value that is not as its rule says; None where all are."""
    part = next((one for one in rule.get("anyOf", [rule]) if _is_of(value, one)), None)
    if part is None:
        return f"{key or 'the scene'} = {shown(value)}: it must be {rule['description']}"
    if isinstance(value, Mapping):
        keys = part.get("properties")
        wrong = None if keys is None else _wrong_key(value, part, key)
        rules = keys or dict.fromkeys(value, part["additionalProperties"])
        return wrong or _first(_complaint(v, rules[name], _dotted(key, name)) for name, v in value.items())
    if isinstance(value, list) and "description" in part["items"]:
        return _first(_complaint(v, part["items"], f"{key} #{k}") for k, v in enumerate(value, 1))
    return None


def _first(messages: Iterable[str | None]) -> str | None:
    return next(filter(None, messages), None)


def _is_of(value: Any, rule: Rule) -> bool:
    """True for a value of the type of a rule, and within its limits."""
    if isinstance(value, bool) or not isinstance(value, _TYPES[rule.get("type", "object")]):
        return False
    if isinstance(value, list):
        return bool(rule.get("minItems", 0) <= len(value) <= rule.get("maxItems", len(value)))
    if isinstance(value, str) and "pattern" in rule and not re.search(rule["pattern"], value):
        return False
    least: float = rule.get("minimum", -inf)
    return value in rule.get("enum", [value]) and (isinstance(value, (str, Mapping)) or value >= least)


def _wrong_key(value: Mapping[str, Any], rule: Rule, key: str) -> str | None:
    names = tuple(rule["properties"])
    for name in value:
        if name not in names:
            home = INPUTS[name].section if name in INPUTS else ""
            if _dotted(key, name) == "crankshaft":
                return ONE_SLIDER
            allowed = f"{name} belongs in [{home}]" if home else hint(str(name), names)
            return f"{_dotted(key, name)} = {shown(value[name])}: unknown key; {allowed}"
    for name in rule["required"]:
        if name not in value:
            return f"{_dotted(key, name)} is missing: it must be {rule['properties'][name]['description']}"
    return None


def _dotted(key: str, name: Any) -> str:
    return f"{key}.{name}" if key else str(name)


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
