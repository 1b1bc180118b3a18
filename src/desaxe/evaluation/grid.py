"""`grid`: the outer product of its arguments, as a labelled xarray.Dataset."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Unpack, overload

from numpy.typing import NDArray

from ..mechanism.inputs import Inputs
from ..runtime.request import check_sliders, several, with_named_inputs
from .arrays import outputs_for
from .plan import lazy_values, plan_of
from .points import outer_of, points_of
from .reductions.argument import names_reduced, reductions_of

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
    names: str | Sequence[str], *, out: Array | Mapping[str, Array], **inputs: Any
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

    The inputs are those of `evaluate`. Each 1-d input is a dimension, in the order of the call; a number
    becomes a scalar coordinate, and a load that varies with the motion follows theta: `over_theta`,
    `over_Y` and the others of `evaluate`, or a labelled array over the dimension theta. The Dataset holds the
    requested names over all dimensions, `status` (int8, with CF flags), and `margin` over the lengths.

    With `out` (an array, or a dict name -> array, of the shape of the grid) these arrays are filled and
    returned as a dict, and xarray is not needed; otherwise the extra `labelled` is. Raises as
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

    Labelled arrays that share a dimension vary together along it: it is one axis, and they are coordinates.
    So do pandas Series whose index has a name, along that. Where such an axis is reduced, the place of an
    extreme is the position along it, from 0.

    `sliders` are filled in by a `Crankshaft`: without `chunks`, `out` and functions of a design.

        dx.grid(["a_C"], theta=th, ec=ecs, AB=.125, BC=bcs, omega0=157.08).a_C.max("theta")

    See docs/choose.md: which call for which question.
    """
    if sliders is not None:
        check_sliders(sliders)
        result: xr.Dataset = sliders.grid(names, inputs, accuracy, out=out, reduce=reduce, chunks=chunks)
        return result
    if out is not None:
        _refuse("and out=: give one of them", reduce=reduce, chunks=chunks)
    if reduce is not None:
        names = ((names,) if isinstance(names, str) else several(names)) + names_reduced(reduce)
    outer = outer_of(names, inputs, branch, threads, always=out is None)
    if out is not None and not outer.names:
        return outputs_for((), (), out)
    if out is not None:
        step = points_of(outer.names, outer, outer.dimensions, branch, accuracy)
        return step.compute(outer.columns, threads, out)
    reductions = None if reduce is None else reductions_of(reduce, outer.dimensions, outer.names)
    plan = plan_of(outer, branch, accuracy, reductions)
    if chunks is None:
        return plan.dataset(plan.values(threads))
    return plan.dataset(lazy_values(plan, chunks, threads))


def _refuse(why: str, **options: Any) -> None:
    """TypeError for an option that is given, beside what it does not go with."""
    for name, value in options.items():
        if value is not None:
            raise TypeError(f"{name}= {why}")
