"""A sweep that is ready to run: its plan, its chunks, and its identity, as attributes of its store."""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from numpy.typing import NDArray

from ..definitions.tables import text_of
from ..evaluation.axes import Outer, outer_of
from ..evaluation.plan import Block, Plan, margin_of, plan_of
from ..evaluation.reductions.argument import Reductions, names_reduced, reductions_of
from ..mechanism.program import digest
from ..runtime.accuracy import accuracy_of
from ..runtime.request import several
from ..support.version import version as desaxe_version
from .layout import Layout, layout_of, table_of
from .peak_step import PeakRequest, PeakStep, peak_requests, peak_steps

if TYPE_CHECKING:
    import xarray as xr

IDENTITY = ("request", "version", "digest")


class SweepRequest(NamedTuple):
    """The request of a sweep: names and inputs, and how they are computed, cut and reduced."""

    names: str | Sequence[str]
    inputs: Mapping[str, Any]
    branch: int = 1
    accuracy: Any = "standard"
    threads: int | None = None
    reduce: Any = None
    peaks: Any = ()
    chunks: Any = "auto"
    memory: int | None = None


class Sweep(NamedTuple):
    """A sweep that is ready to run.

    plan      what it computes
    layout    its dimensions and chunks
    template  its Dataset with lazy variables, for names, dimensions and attributes
    identity  the attributes that tell whether a store is of the same sweep
    """

    plan: Plan
    layout: Layout
    template: "xr.Dataset"
    identity: dict[str, str]

    def blocks(self) -> Iterator[Block]:
        """The chunks of the sweep, with what is computed in each."""
        return self.plan.blocks(self.layout.chunk)


def sweep_of(asked: SweepRequest) -> Sweep:
    """The sweep of a request, checked; nothing is computed or written."""
    names, branch, accuracy = asked.names, asked.branch, asked.accuracy
    if asked.reduce is not None:
        names = ((names,) if isinstance(names, str) else several(names)) + names_reduced(asked.reduce)
    outer = outer_of(names, asked.inputs, branch, asked.threads, always=asked.reduce is None)
    for name in outer.dimensions:
        if not outer.axes[name].size:
            raise ValueError(f"{name}: a sweep needs at least one value of it")
    kept = accuracy_of(accuracy)
    reductions = reductions_asked(asked.reduce, outer)
    requests = peak_requests(asked.peaks, outer)
    plan = _plan_of(outer, branch, accuracy, reductions, peak_steps(requests, outer, branch, accuracy))
    sizes, outputs = plan.sizes, ((s, o) for s in plan.all for o in s.outputs.values())
    stored = sum(output.dtype.itemsize for step, output in outputs if len(step.dims) == len(sizes))
    layout = layout_of(asked.chunks, sizes, stored, None if reductions is None else plan.behind, asked.memory)
    return Sweep(plan, layout, plan.empty(), identity(plan, kept, requests))


def reductions_asked(reduce: Any, outer: Outer) -> Reductions | None:
    """The reductions that are asked for, checked."""
    return None if reduce is None else reductions_of(reduce, outer.dimensions, outer.names)


def _plan_of(
    outer: Outer, branch: int, accuracy: Any, reductions: Reductions | None, peaks: Sequence[PeakStep]
) -> Plan:
    """The plan of a grid with peaks beside it, or of peaks alone; the margin comes always."""
    lost = [n for step in peaks for n in step.dims if reductions is not None and n in reductions.axes]
    if lost:
        raise ValueError(f"peaks: each is of one design, and {lost[0]} is reduced; sweep them by themselves")
    _require_names_apart(peaks)
    if not (outer.names or peaks):
        raise ValueError("sweep: nothing is requested, give names or peaks=")
    if outer.names:
        plan = plan_of(outer, branch, accuracy, reductions)
    else:
        designs = tuple(name for name in outer.dimensions if name != "theta")
        plan = Plan(outer, branch, accuracy, (), designs)
    margin = () if outer.names and reductions is None else margin_of(outer, branch, accuracy, plan.dims)
    return plan._replace(beside=(*margin, *peaks))


def _require_names_apart(peaks: Sequence[PeakStep]) -> None:
    """ValueError for a name that is that of a peak and of a derivative of another one."""
    known: dict[str, str] = {}
    for step in peaks:
        for name in step.outputs:
            if name in known:
                both = f"that of {known[name]} and that of {step.quantity}"
                raise ValueError(f"peaks: {name} would be {both}; sweep them one by one")
            known[name] = step.quantity


def identity(plan: Plan, accuracy: str, peaks: Sequence[PeakRequest] = ()) -> dict[str, str]:
    """The attributes that a store of this plan has: no time, path or host is among them."""
    outer = plan.outer
    texts = [repr(step.own) for step in plan.all if step.own]
    request = {
        "names": list(outer.names),
        "reduce": {} if plan.reductions is None else plan.reductions.plain(),
        "peaks": [list(one) for one in peaks],
        "definitions": [hashlib.sha256(text.encode()).hexdigest() for text in texts],
        "branch": int(plan.branch),
        "accuracy": accuracy,
        "inputs": {name: _input(array) for name, array in outer.axes.items()}
        | {name: {"load": load.told(), "sha256": load.identity} for name, load in outer.loads.items()},
    }
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
