"""The JSON schema of a scene file: what editors complete and check while it is written."""

import json
from typing import Any

import msgspec

from ..evaluation.reductions.kinds import NAMES
from ..mechanism.inputs import INPUTS
from ..mechanism.names import parts
from ..mechanism.own import derived_names
from .schema import SECTIONS, SceneFile


def json_schema() -> dict[str, Any]:
    """The schema, from the same types that check a scene when it is read."""
    found: dict[str, Any] = _for_toml(msgspec.json.schema(SceneFile))
    for section in map(str.capitalize, SECTIONS):
        for name, rule in found["$defs"][section]["properties"].items():
            if name in INPUTS:
                row = INPUTS[name]
                rule["description"] = f"{row.meaning} [{row.unit}]: {rule['description']}"
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "A scene of desaxe", **found}


def json_schema_text() -> str:
    """The JSON schema as the text of a file."""
    return json.dumps(json_schema(), indent=2) + "\n"


def _for_toml(rule: Any) -> Any:
    """A schema rule for TOML: without null, with the names of quantities and reductions."""
    if isinstance(rule, list):
        return [_for_toml(part) for part in rule]
    if not isinstance(rule, dict):
        return rule
    found = {key: _for_toml(part) for key, part in rule.items() if key != "default"}
    choices = [part for part in found.get("anyOf", []) if part != {"type": "null"}]
    if len(choices) == 1:
        del found["anyOf"]
        found |= choices[0]
    elif choices:
        found["anyOf"] = choices
    if found.get("description") == "the name of a quantity":
        found["anyOf"] = [{"enum": _base_quantities()}, {"pattern": "^[A-Za-z][A-Za-z0-9_]*$"}]
    if found.get("description", "").startswith("one of max, min"):
        kind = {"anyOf": [{"enum": [*NAMES]}, {"pattern": r"^p\d+(\.\d+)?$"}]}
        one = {"anyOf": [*kind["anyOf"], {"type": "array", "minItems": 2, "maxItems": 3}]}
        found["anyOf"] = [*kind["anyOf"], {"type": "array", "items": one, "minItems": 1}]
    return found


def _base_quantities() -> list[str]:
    """The names that are no sensitivities, of which there are hundreds, nor a user's own."""
    return [name for name in derived_names() if not parts(name)[1]]
