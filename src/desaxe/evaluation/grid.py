"""`grid`: the outer product of its arguments, as a labelled xarray.Dataset."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Unpack, overload

from numpy.typing import NDArray

from ..mechanism.inputs import Inputs
from ..mechanism.keywords import check_inputs
from ..runtime.request import check_sliders, several, with_named_inputs
from ..support.forks import IMPORTS
from .arrays import outputs_for
from .axes import ARGUMENTS, outer_of
from .labelled import grid_by_index, has_named_index
from .plan import plan_of
from .points import points_of
from .reductions.argument import names_reduced, reductions_of
from .under_loads.loaded import evaluate_loaded

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[Any]


@overload
def grid(
    names: str | Sequence[str],
    *,
    branch: int = 1,
    accuracy: str | float = "standard",
    threads: int | None = None,
    out: None = None,
    reduce: Any = None,
    chunks: Any = None,
    **inputs: Unpack[Inputs[Any]],
) -> "xr.Dataset": ...


@overload
def grid(
    names: str | Sequence[str],
    *,
    branch: int = 1,
    accuracy: str | float = "standard",
    threads: int | None = None,
    out: Array | Mapping[str, Array],
    **inputs: Unpack[Inputs[Any]],
) -> dict[str, Array]: ...


@with_named_inputs
def grid(
    names: str | Sequence[str],
    *,
    branch: int = 1,
    accuracy: str | float = "standard",
    threads: int | None = None,
    out: Any = None,
    reduce: Any = None,
    chunks: Any = None,
    sliders: Any = None,
    **inputs: Any,
) -> "xr.Dataset | dict[str, Array]":
    """Quantities over the outer product of the inputs, as an xarray.Dataset with units.

    The inputs are those of `evaluate`. Each 1-d input is a dimension, in the order given; a number
    becomes a coordinate without one, and a load that varies with the motion follows theta: `over_theta`,
    `over_Y`, others of `evaluate`, or a labelled array over the dimension theta. The Dataset has the names
    requested over all dimensions, `status` (int8, with CF flags) and `margin`, over those that it depends on.

    With `out` (an array, or a dict name -> array, of the grid's shape) the arrays are filled and
    returned as a dict, and xarray is not needed. Otherwise needs the extra `labelled`. Raises as
    `evaluate` does, and for an input of more than one dimension.

    `reduce={"theta": "absmax"}` (max, min, absmax, mean, rms, or a list of these) reduces an axis
    without storing the grid: the Dataset has `a_C_absmax` over the other axes, `a_C_absmax_theta`,
    where the largest or smallest sample is, and `a_C_skipped`, how many points along the axis have no
    value. The extremes are those of the samples; `peak` refines them. Other kinds are std, median and
    percentiles ("p95", or ("percentile", 95)). `{("theta", "ec"): "rms"}` goes over all points of both axes,
    `{"theta": "max", "ec": "mean"}` over one after the other: `a_C_max_mean`; equal kinds in a row go over
    all their axes at once. Of single names, along one axis: `{"theta": [("rms", "T_in"), ("at", "60 deg",
    "Y")]}` gives `T_in_rms` and `Y_at_60_deg`, and a function f of a design, which gives its value and a dict
    of its derivatives, gives `f` and `f_wrt_ec`, ...; a list of these alone goes along theta.

    `chunks={"theta": 1000}` (as in xarray: a dict, a number or "auto"; dimensions not named are whole)
    gives lazy Dask arrays, each chunk computed by compiled kernels when it is needed, with the same
    digits whatever the chunks. Needs the extra `scale`.

    A pandas Series whose index has a name varies along that index: Series of one index belong together.

    `sliders` are filled in by a `Crankshaft`: without `reduce`, `chunks` and `out`.

        dx.grid(["a_C"], theta=th, ec=ecs, AB=.125, BC=bcs, omega0=157.08).a_C.max("theta")

    See docs/choose.md: which call for which question.
    """
    if sliders is not None:
        check_sliders(sliders)
        found: xr.Dataset = sliders.grid(names, inputs, accuracy, out=out, reduce=reduce, chunks=chunks)
        return found
    if any(hasattr(value, "iloc") and has_named_index(value) for value in inputs.values()):
        _refuse_with_series(reduce=reduce, chunks=chunks, out=out)
        wanted = (names,) if isinstance(names, str) else several(names)
        check_inputs("grid", inputs, ARGUMENTS)

        def each(own: list[str], given: dict[str, Any]) -> dict[str, Any]:
            found: dict[str, Any] = evaluate_loaded(own, given, branch, accuracy, threads)
            return found

        return grid_by_index(each, wanted, inputs, branch, accuracy)
    if out is not None:
        _refuse_with_out(reduce=reduce, chunks=chunks)
    if reduce is not None:
        names = ((names,) if isinstance(names, str) else several(names)) + names_reduced(reduce)
    outer = outer_of(names, inputs, branch, threads, always=out is None)
    if out is not None and not outer.names:
        return outputs_for((), (), out)
    if out is not None:
        step = points_of(outer.names, outer, outer.dimensions, branch, accuracy)
        return step.compute(outer.axes, threads, out)
    reductions = None if reduce is None else reductions_of(reduce, outer.dimensions, outer.names)
    plan = plan_of(outer, branch, accuracy, reductions)
    if chunks is None:
        return plan.dataset(plan.values(threads))
    with IMPORTS:
        from .lazy import lazy_values

    return plan.dataset(lazy_values(plan, chunks, threads))


def _refuse_with_series(**options: Any) -> None:
    """TypeError for an option that goes along the dimensions of inputs, beside Series along an index."""
    for name, value in options.items():
        if value is not None:
            raise TypeError(
                f"{name}= is for plain arrays, not for Series with a named index: pass .to_numpy()"
            )


def _refuse_with_out(**options: Any) -> None:
    """TypeError for an option that makes arrays of its own, beside those of out=."""
    for name, value in options.items():
        if value is not None:
            raise TypeError(f"{name}= and out=: give one of them")
