"""The histories of `simulate` as a Dataset over time, or over the crank angle, to plot."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..evaluation.labels import attributes, import_xarray
from ..mechanism.inputs import INPUTS
from ..mechanism.quantity_units import SI
from ..support.forks import IMPORTS

if TYPE_CHECKING:
    import xarray as xr

TIME = {"units": "s", "long_name": "time"}


def is_motion(found: Any) -> bool:
    """True for a result of `simulate`."""
    return hasattr(found, "keys") and {"t", "theta", "omega", "energy_residual"} <= found.keys()


def dataset_of_motion(found: Any, over: str) -> "xr.Dataset":
    """The histories of a motion, or of those of many designs, over t or over theta.

    ValueError for another `over`, and for theta of many designs, each of which has angles of its own.
    """
    import_xarray("a picture of a motion")
    with IMPORTS:
        import xarray

    t, designs = np.asarray(found["t"]), np.shape(found["theta"])[:-1]
    if over not in ("t", "theta"):
        raise ValueError(f"over = {over!r}: a motion has its histories over 't' or over 'theta'")
    if over == "theta" and designs:
        raise ValueError("over = 'theta': each of these designs has its own angles; give over='t'")
    names = ["design"] if len(designs) == 1 else [f"design_{k}" for k in range(len(designs))]
    units = getattr(found, "system", None) or SI
    histories = {
        name: ((*names, over), np.asarray(values), _attributes(name, units))
        for name, values in found.items()
        if name not in ("t", over) and np.shape(values) == (*designs, t.size)
    }
    coordinate = (over, np.asarray(found[over]), _attributes(over, units))
    return xarray.Dataset(histories, coords={over: coordinate})


def _attributes(name: str, units: Any) -> dict[str, Any]:
    """Meaning and unit of a history."""
    if name == "t":
        return {**TIME, "units": units.of("t").unit}
    base, _, parameter = name.partition("_wrt_")
    if parameter and base in ("theta", "omega"):
        unit = units.slope(base, parameter).unit
        return {"units": unit, "long_name": f"derivative of {base} by {parameter}"}
    told = {"long_name": INPUTS[name].meaning} if name in INPUTS else attributes(name, state=True)
    return {**told, "units": units.of(name).unit}
