"""`design_map`: quantities over a plane or space of designs, labelled, with their feasibility."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..evaluation.arrays import as_array
from ..evaluation.labels import STATUS_FLAGS, import_xarray, input_attributes, provenance, with_loads
from ..evaluation.points import outer_arrays, outer_of
from ..evaluation.reductions.own_measure import OwnMeasure
from ..mechanism.catalogue import quantity
from ..mechanism.inputs import INPUTS
from ..mechanism.keywords import check_inputs, with_known_keywords
from ..mechanism.names import LENGTHS, sensitivity
from ..mechanism.quantity_units import SI, unit_of
from ..runtime.request import check_common
from ..support.forks import IMPORTS
from .feasibility.feasibility import KINDS, of_arrays
from .measures import Measure, checked, measured, text_of

if TYPE_CHECKING:
    import xarray as xr

FEASIBLE = ("margin", "can_turn", "status", "kind")


@with_known_keywords
def design_map(names: Any = (), *, branch: int = 1, derivatives: bool = False, **inputs: Any) -> "xr.Dataset":
    """Quantities of designs over the outer product of the inputs, as an xarray.Dataset with units.

    names        of quantities of a design: "margin", those of `events`, and peaks such as ("absmax", "a_C"),
                 which are called absmax_a_C in the Dataset; one, a list, or none
    inputs       as in `evaluate`, without theta; each 1-d array is a dimension, in the order given, labelled
                 arrays that share one vary together along it, as in `grid`; a load that varies with the
                 motion is that of all designs
    derivatives  whether each quantity's exact derivatives come along, as stroke_wrt_ec

    `margin`, `status` (0 the crank turns fully, 1 it does not, 2 change point, 4 bad input), `can_turn` and
    `kind` (int8 with CF flags, see `feasibility`) always come along. Needs the extra `labelled`. Raises as
    `evaluate` does, and for an input of more than one dimension.

        dx.design_map(["stroke", ("absmax", "a_C")], ec=ecs, BC=rods, AB=.125, omega0=157.08).stroke.plot()

    See docs/choose.md: which call for which question.
    """
    check_common({}, branch)
    known = tuple(name for name in INPUTS if name != "theta")
    check_inputs("design_map", inputs, known)
    one = isinstance(names, (str, tuple)) and bool(names)
    requested: Sequence[Measure] = [checked(name) for name in ([names] if one else names)]
    outer = outer_of(("design_map",), inputs, branch, None, always=False)
    axes, dimensions = outer.axes, outer.dimensions
    for name in LENGTHS:
        if name not in axes:
            as_array(name, None, LENGTHS, ("design_map",))
    shape = tuple(outer.sizes[dim] for dim in dimensions)
    grids = {**axes, **outer_arrays(axes, outer.along, dimensions)}
    designs = {n: np.broadcast_to(grid, shape).reshape(-1) for n, grid in grids.items()}
    variables = _feasible(designs, shape, dimensions)
    for measure, result in measured(requested, {**designs, **outer.loads}, branch).items():
        name, meaning = _name(measure), _meaning(measure)
        rows = {name: (result.value, _about(measure), meaning)}
        for p, slope in result.gradient.items() if derivatives else ():
            rows[f"{name}_wrt_{p}"] = slope, _about(measure, p), f"{meaning}, with respect to {p}"
        for row, (values, about, words) in rows.items():
            if row in variables and measure != "margin":
                raise ValueError(f"design_map: two variables would be called {row}; ask for them one by one")
            array = np.broadcast_to(values, designs["ec"].shape).reshape(shape)
            variables[row] = (dimensions, array, {**about, "long_name": words})
    import_xarray("design_map")
    with IMPORTS:
        import xarray
    coordinates = {
        n: ((outer.along[n],) if axis.ndim else (), axis, input_attributes(n)) for n, axis in axes.items()
    }
    about = provenance(
        [_name(measure) for measure in requested], axes, branch, title="offset slider-crank designs"
    )
    return with_loads(xarray.Dataset(variables, {**outer.labels, **coordinates}, about), outer.loads)


def _feasible(designs: dict[str, Any], shape: tuple[int, ...], dimensions: list[str]) -> dict[str, Any]:
    result = {
        n: np.reshape(v, shape) for n, v in of_arrays(*(designs[n] for n in LENGTHS)).items() if n in FEASIBLE
    }
    kinds = np.array([KINDS.index(kind) for kind in result["kind"].flat], np.int8).reshape(shape)
    variables: dict[str, Any] = {
        "margin": (dimensions, result["margin"], {"units": "m", "long_name": "margin BC - AB - |ec|"}),
        "can_turn": (dimensions, result["can_turn"], {"long_name": "the crank turns fully"}),
    }
    flags = (
        ("status", result["status"], STATUS_FLAGS[:5], "status"),
        ("kind", kinds, tuple(kind.replace(" ", "_") for kind in KINDS), "how the crank can move"),
    )
    for name, codes, meanings, words in flags:
        values = {"flag_values": np.arange(len(meanings), dtype=np.int8), "flag_meanings": " ".join(meanings)}
        variables[name] = (dimensions, codes, {"long_name": words, **values})
    return variables


def _name(measure: Measure) -> str:
    """The variable of a measure."""
    return text_of(measure).replace(" ", "_")


def _about(measure: Measure, parameter: str = "") -> dict[str, str]:
    """The unit of a measure, or of its derivative, and its quantity."""
    if isinstance(measure, OwnMeasure):
        return {"units": str(unit_of("", parameter))}
    name = measure if isinstance(measure, str) else measure[-1]
    name = sensitivity(name, parameter) if parameter else name
    return {"units": SI.of(name).unit, "quantity": name}


def _meaning(measure: Measure) -> str:
    if not isinstance(measure, tuple):
        return text_of(measure).replace("_", " ")
    if measure[0] == "at":
        return f"at {measure[1]}: {quantity(measure[2]).meaning}"
    kinds = {"absmax": "largest magnitude", "max": "largest value", "min": "smallest value"}
    kinds |= {"mean": "mean", "rms": "root of the mean square"}
    return f"{kinds[measure[0]]} over a turn: {quantity(measure[1]).meaning}"
