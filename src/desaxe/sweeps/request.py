"""A sweep that is ready to run: its plan, its chunks, and its identity, as attributes of its store."""

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from math import prod
from os import PathLike
from typing import TYPE_CHECKING, Any, NamedTuple

from numpy.typing import NDArray

from ..definitions.tables import text_of
from ..evaluation.chunks import chunk_lengths, uniform
from ..evaluation.plan import Plan, margin_of, plan_of
from ..evaluation.points import Outer, outer_of
from ..evaluation.reductions.argument import Reductions, names_reduced, reductions_of
from ..mechanism.program import digest
from ..runtime.request import accuracy_of, several
from ..support.memory import bytes_of, size_text
from ..support.progress import Progress
from ..support.shown import shown
from ..support.version import version as desaxe_version
from .peak_step import PeakRequest, PeakStep, peak_requests, peak_steps

if TYPE_CHECKING:
    import xarray as xr


DEFAULT_MEMORY = 256_000_000  # bytes of the chunks in flight
IN_FLIGHT = 2  # chunks at once that an automatic layout leaves memory for
STORED = 2**21  # points of a stored chunk: 16 MiB of doubles
REDUCED = 2**23  # points of the grid behind a chunk of a reduced one
MOST_CHUNKS, FEWEST_POINTS = 10_000, 1_000  # beyond these the memory allowed is a slip: a file a chunk
WRITING = 3 * 8  # bytes a point while an array is written: copied, compressed, and masked


class SweepRequest(NamedTuple):
    """The request of a sweep: names and inputs; how they are computed, cut and reduced; where they go."""

    names: str | Sequence[str]
    inputs: Mapping[str, Any]
    branch: int = 1
    accuracy: Any = "standard"
    threads: int | None = None
    reduce: Any = None
    peaks: Any = ()
    chunks: Any = "auto"
    memory: Any = None  # bytes, or a text
    store: str | PathLike[str] | None = None
    overwrite: bool = False
    client: Any = None  # of Dask
    watch: Progress | None = None
    tell: Callable[[str], None] | None = None


class Sweep(NamedTuple):
    """A sweep that is ready to run.

    plan      what it computes
    chunk     the length of its chunks along each dimension of the store
    memory    bytes that the chunks in flight may take
    template  its Dataset with lazy variables, for names, dimensions and attributes
    identity  the attributes that tell whether a store is of the same sweep
    """

    plan: Plan
    chunk: dict[str, int]
    memory: int | None
    template: "xr.Dataset"
    identity: dict[str, str]

    @property
    def chunks(self) -> int:
        """The number of chunks of a variable over all dimensions."""
        return prod(-(-size // self.chunk[name]) for name, size in self.plan.sizes.items())

    @property
    def in_flight(self) -> int:
        """Bytes of one chunk while it is computed and written."""
        return _bytes_a_point(self.plan) * prod(self.chunk.values())

    @property
    def at_once(self) -> int:
        """The number of chunks in flight that fit into the memory, at least one."""
        return max(1, min(self.chunks, (self.memory or DEFAULT_MEMORY) // self.in_flight))

    @property
    def shape(self) -> str:
        """The shape of a chunk as text."""
        return " x ".join(f"{length} {name}" for name, length in self.chunk.items()) or "one point"

    def cut(self, chunk: Any) -> "Sweep":
        """The sweep with the chunks of an existing store, from its attribute; ValueError for others."""
        try:
            lengths, sizes = json.loads(chunk), self.plan.sizes
            if set(lengths) == set(sizes) and all(type(n) is int and n > 0 for n in lengths.values()):
                return self._replace(chunk={name: lengths[name] for name in sizes})
        except (ValueError, TypeError, AttributeError, RecursionError):
            pass
        raise ValueError(f"its chunks are {shown(chunk)}")

    def require_memory(self) -> None:
        """MemoryError where a chunk takes more memory than is allowed."""
        if self.memory is not None and self.in_flight > self.memory:
            raise MemoryError(
                f"memory: a chunk of {self.shape} takes {size_text(self.in_flight)} while it is computed and "
                f"written, {size_text(self.memory)} are allowed; give smaller chunks or more memory"
            )


def sweep_of(request: SweepRequest) -> Sweep:
    """The sweep of a request, checked; nothing is computed or written."""
    names, branch, accuracy, reduce = request.names, request.branch, request.accuracy, request.reduce
    if reduce is not None:
        names = ((names,) if isinstance(names, str) else several(names)) + names_reduced(reduce)
    outer = outer_of(names, request.inputs, branch, request.threads, always=reduce is None)
    for name, size in outer.sizes.items():
        if not size:
            raise ValueError(f"{name}: a sweep needs at least one value of it")
    checked = accuracy_of(accuracy)
    reductions = None if reduce is None else reductions_of(reduce, outer.dimensions, outer.names)
    peaks = peak_requests(request.peaks, outer)
    plan = _plan_of(outer, branch, accuracy, reductions, peak_steps(peaks, outer, branch, accuracy))
    memory = bytes_of(request.memory)
    points = _points_of_chunk(plan, memory)
    chunk = uniform(chunk_lengths(request.chunks, plan.sizes, points))
    sweep = Sweep(plan, chunk, memory, plan.empty(), identity(plan, checked, peaks))
    few = memory is not None and points < FEWEST_POINTS
    if isinstance(request.chunks, str) and few and sweep.chunks > MOST_CHUNKS:
        raise MemoryError(
            f"memory: {size_text(memory or 0)} make {sweep.chunks} chunks of {points} points, a file each; "
            'give more, such as "100 MB"'
        )
    return sweep


def _bytes_a_point(plan: Plan) -> int:
    """Bytes of a point of the store while it is computed and written."""
    steps = (step for step in plan.all if len(step.dims) == len(plan.sizes))
    stored = sum(output.dtype.itemsize for step in steps for output in step.outputs.values())
    return stored + WRITING + 8 * len(plan.sizes)


def _points_of_chunk(plan: Plan, memory: int | None) -> int:
    """The points of a chunk of an automatic layout, from the request alone."""
    per_point = _bytes_a_point(plan)
    most = STORED if plan.reductions is None else max(1, REDUCED // max(plan.behind, 1))
    points = min(most, (memory or DEFAULT_MEMORY) // (IN_FLIGHT * per_point))
    if points < 1:
        raise MemoryError(f"memory = {memory} bytes: a single point takes {IN_FLIGHT * per_point}")
    return points


def _plan_of(
    outer: Outer, branch: int, accuracy: Any, reductions: Reductions | None, peaks: Sequence[PeakStep]
) -> Plan:
    """The plan of a grid with peaks beside it, or of peaks alone; the margin comes always."""
    lost = [n for step in peaks for n in step.dims if reductions is not None and n in reductions.axes]
    if lost:
        raise ValueError(f"peaks: each is of one design, and {lost[0]} is reduced; sweep them by themselves")
    every = [name for step in peaks for name in step.outputs]
    twice = next((name for name in every if every.count(name) > 1), None)
    if twice is not None:  # of a peak and of a derivative of another one
        raise ValueError(f"peaks: {twice} would be two variables; sweep them one by one")
    if not (outer.names or peaks):
        raise ValueError("sweep: nothing is requested, give names or peaks=")
    if outer.names:
        plan = plan_of(outer, branch, accuracy, reductions)
    else:
        designs = tuple(outer.of([name for name in outer.axes if name != "theta"]))
        plan = Plan(outer, branch, accuracy, (), designs)
    margin = () if outer.names and reductions is None else margin_of(outer, branch, accuracy, plan.dims)
    return plan._replace(beside=(*margin, *peaks))


def identity(plan: Plan, accuracy: str, peaks: Sequence[PeakRequest] = ()) -> dict[str, str]:
    """The attributes that a store of this plan has: no time, path or host is among them."""
    outer = plan.outer
    request = {
        "names": list(outer.names),
        "reduce": {} if plan.reductions is None else plan.reductions.plain(),
        "peaks": [list(one) for one in peaks],
        "definitions": [_digest(repr(step.own).encode()) for step in plan.all if step.own],
        "quantities": json.loads(text_of(outer.names) or "{}"),
        "branch": int(plan.branch),
        "accuracy": accuracy,
        **{name: _input(array) for name, array in outer.axes.items()},
        **{f"dimension of {name}": dim for name, dim in outer.along.items() if dim != name},
        **{name: f"{load.told()} ({load.identity})" for name, load in outer.loads.items()},
    }
    return {"request": json.dumps(request), "version": desaxe_version(), "digest": digest()}


def _input(array: NDArray[Any]) -> Any:
    """An input for the request: a number, or size, ends and digest of an axis."""
    if not array.ndim:
        return array.item()
    ends = f" from {float(array[0])!r} to {float(array[-1])!r}" if array.size else ""
    return f"{array.size} values{ends} ({_digest(array.astype('<f8').tobytes())})"


def _digest(data: bytes) -> str:
    return f"sha256 {hashlib.sha256(data).hexdigest()[:16]}"


def differences(there: Mapping[str, Any], here: Mapping[str, str]) -> list[str]:
    """The differences between a store's attributes and the current identity, a line for each."""
    old, new = _facts(there), _facts(here)
    return [
        f"{name} is {_text(old.get(name))} there and {_text(new.get(name))} here"
        for name in dict.fromkeys((*new, *old))
        if old.get(name) != new.get(name)
    ]


def _facts(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """The facts of an identity by name; a damaged request has none."""
    facts = {name: attributes.get(name) for name in ("version", "digest")}
    try:
        return {**facts, **json.loads(attributes["request"])}
    except (KeyError, ValueError, TypeError, RecursionError):
        return facts


def _text(value: Any) -> str:
    return "not given" if value is None else value if isinstance(value, str) else json.dumps(value)
