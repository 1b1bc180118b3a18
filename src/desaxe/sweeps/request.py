"""The identity of a sweep: request, version and digest of the Program, as attributes of its store."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

from ..definitions.tables import text_of
from ..evaluation.outer import Outer
from ..evaluation.reductions import Reductions
from ..mechanism.program import digest
from ..support.version import version as desaxe_version
from .layout import table_of
from .peaks import PeakRequest

IDENTITY = ("request", "version", "digest")


def identity(
    outer: Outer,
    branch: int,
    accuracy: str,
    reduction: Reductions | None,
    peaks: Sequence[PeakRequest],
    own: Sequence[str],
    best: tuple[int, str, str, str] | None = None,
) -> dict[str, str]:
    """The attributes that a store of this sweep has: no time, path or host is among them.

    `own` tells the definitions of quantities that are not the library's, `best` how many designs are
    searched, by which quantity and kind, and which end is the best.
    """
    request = {
        "names": list(outer.names),
        "reduce": {} if reduction is None else reduction.plain(),
        "peaks": [list(one) for one in peaks],
        "definitions": [hashlib.sha256(text.encode()).hexdigest() for text in own],
        "branch": int(branch),
        "accuracy": accuracy,
        "inputs": {name: _input(array) for name, array in outer.axes.items()}
        | {name: {"load": repr(load), "sha256": load.identity} for name, load in outer.loads.items()},
    }
    if best is not None:
        request["best"], request["by"], request["order"] = best[0], list(best[1:3]), best[3]
    own = text_of(outer.names)
    if own:
        request["quantities"] = json.loads(own)
    version, program = versions()
    return {"request": json.dumps(request), "version": version, "digest": program}


def versions() -> tuple[str, str]:
    """The version of desaxe and the digest of its derivation."""
    return desaxe_version(), digest()


def _input(array: NDArray[Any]) -> Any:
    """An input for the request: a number, or size, ends and hash of an axis."""
    if not array.ndim:
        return array.item()
    ends = {"from": float(array[0]), "to": float(array[-1])} if array.size else {}
    values = hashlib.sha256(array.astype("<f8").tobytes()).hexdigest()
    return {"values": array.size, **ends, "sha256": values}


def differences(there: Mapping[str, Any], here: Mapping[str, str]) -> list[str]:
    """The differences between a store's request and the current one, a line for each."""
    lines = [
        f"{name} is {there.get(name)!r} there and {here[name]!r} here"
        for name in ("version", "digest")
        if there.get(name) != here[name]
    ]
    old, new = table_of(there.get("request")), table_of(here["request"])
    old_inputs, new_inputs = (table_of(request.pop("inputs", None)) for request in (old, new))
    for part, other in ((old, new), (old_inputs, new_inputs)):
        lines += [
            f"{name} is {_shown(part.get(name))} there and {_shown(other.get(name))} here"
            for name in dict.fromkeys((*part, *other))
            if part.get(name) != other.get(name)
        ]
    return lines


def _shown(value: Any) -> str:
    if value is None:
        return "not given"
    if not isinstance(value, Mapping) or "sha256" not in value:
        return json.dumps(value)
    digest = f"(sha256 {str(value['sha256'])[:8]})"
    if "load" in value:
        return f"{value['load']} {digest}"
    ends = f" from {value['from']!r} to {value.get('to')!r}" if "from" in value else ""
    return f"{value.get('values')} values{ends} {digest}"
