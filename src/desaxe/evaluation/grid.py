"""`grid`: the outer product of its arguments, as a labelled xarray.Dataset."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Unpack, overload

from numpy.typing import NDArray

from ..mechanism.inputs import INPUTS, Inputs
from ..mechanism.keywords import check_inputs
from ..mechanism.names import LENGTHS
from ..runtime.request import check_sliders, several, with_named_inputs
from .arrays import outputs_for
from .labelled import is_labelled
from .labels import import_xarray, input_attributes, provenance, with_loads
from .plan import lazy_values, plan_of
from .points import ARGUMENTS, axis_of, outer_of, points_of
from .reductions.argument import names_reduced, reductions_of
from .under_loads.loaded import split_axes
from .values import values

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

    Labelled arrays that share a dimension vary together along it: it is one axis, and they are coordinates.
    So do pandas Series whose index has a name, along that.

    `sliders` are filled in by a `Crankshaft`: without `reduce`, `chunks` and `out`.

        dx.grid(["a_C"], theta=th, ec=ecs, AB=.125, BC=bcs, omega0=157.08).a_C.max("theta")

    See docs/choose.md: which call for which question.
    """
    if sliders is not None:
        check_sliders(sliders)
        result: xr.Dataset = sliders.grid(names, inputs, accuracy, out=out, reduce=reduce, chunks=chunks)
        return result
    if _vary_together(inputs):
        plain = "is for plain arrays, not for inputs that vary together along a dimension: pass their values"
        _refuse(plain, reduce=reduce, chunks=chunks, out=out)
        check_inputs("grid", inputs, ARGUMENTS)
        requested = (names,) if isinstance(names, str) else several(names)
        return _grid_by_labels(requested, inputs, branch, accuracy, threads)
    if out is not None:
        _refuse("and out=: give one of them", reduce=reduce, chunks=chunks)
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
    return plan.dataset(lazy_values(plan, chunks, threads))


def _vary_together(inputs: Mapping[str, Any]) -> bool:
    """True if inputs of a grid share a dimension, or a pandas Series has an index with a name."""
    labelled = (value for value in inputs.values() if is_labelled(value))
    dims = [dim for value in labelled for dim in value.dims if dim not in inputs]
    return len(set(dims)) < len(dims) or any(map(_has_named_index, inputs.values()))


def _has_named_index(value: Any) -> bool:
    return hasattr(value, "iloc") and isinstance(getattr(value.index, "name", None), str)


def _labelled_axis(name: str, value: Any, names: Sequence[str]) -> "xr.DataArray":
    """A number without dimensions, or an array along its dimension, its own name or that of its index."""
    xarray = import_xarray()
    plain = axis_of(name, value, tuple(INPUTS), names)
    if is_labelled(value):
        result: xr.DataArray = value.copy(data=plain)
    elif _has_named_index(value):
        result = xarray.DataArray(plain, dims=value.index.name, coords={value.index.name: value.index})
    else:
        result = xarray.DataArray(
            plain, dims=(name,) * plain.ndim, coords={name: plain} if plain.ndim else None
        )
    return result


def _grid_by_labels(
    names: Sequence[str], inputs: Mapping[str, Any], branch: int, accuracy: str | float, threads: int | None
) -> "xr.Dataset":
    """A grid whose inputs of one dimension vary together along it; Series do along the name of their index.

    Each such dimension has its labels, and the inputs along it are coordinates; other arrays are dimensions
    of their own.
    """
    numbers, loads = split_axes({name: value for name, value in inputs.items() if value is not None})
    arrays = {name: _labelled_axis(name, value, names) for name, value in numbers.items()}
    given = {**numbers, **{name: array for name, array in arrays.items() if array.ndim}, **loads}
    lengths = {name: given.get(name) for name in (*LENGTHS, "omega0", "omega")}
    given = {**dict.fromkeys(("theta", *lengths)), "alpha": 0.0, **given}
    result = values(list(names), given, branch, accuracy, threads)
    result |= values(["status"], given, branch, accuracy, threads)
    result |= values(["margin"], lengths, branch, accuracy, threads)
    about = provenance(names, {name: array.values for name, array in arrays.items()}, branch, accuracy)
    message = {name: array.assign_attrs(input_attributes(name)) for name, array in arrays.items()}
    dataset = import_xarray().Dataset(result, attrs=about).assign_coords(message)
    return with_loads(dataset, loads)


def _refuse(why: str, **options: Any) -> None:
    """TypeError for an option that is given, beside what it does not go with."""
    for name, value in options.items():
        if value is not None:
            raise TypeError(f"{name}= {why}")
