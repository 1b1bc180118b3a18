"""Names, units and CF attributes for labelled results."""

from collections.abc import Iterable, Mapping, Sequence
from functools import cache, lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..definitions.tables import text_of
from ..mechanism.catalogue import quantity
from ..mechanism.inputs import INPUTS
from ..mechanism.own import Register, register
from ..mechanism.program import digest
from ..mechanism.quantity_units import SI, UnitSystem, unit_of
from ..mechanism.status import PointStatus
from ..support.extras import explained
from ..support.forks import IMPORTS, imported
from ..support.signals import finished
from ..support.version import version

if TYPE_CHECKING:
    import xarray as xr

STATUS_FLAGS = tuple(status.name.lower() for status in PointStatus)


CONVENTIONS = "CF-1.11"


class Output(NamedTuple):
    """The type of a variable and its CF attributes."""

    dtype: np.dtype[Any]
    attributes: dict[str, Any]


def attributes(name: str, state: bool = False) -> dict[str, Any]:
    """CF attributes of a quantity."""
    if name == "status":
        flags = np.arange(len(STATUS_FLAGS), dtype=np.int8)
        return {"long_name": "status", "flag_values": flags, "flag_meanings": " ".join(STATUS_FLAGS)}
    return {**_attributes(name, state, register())}


@lru_cache(maxsize=256)
def _attributes(name: str, state: bool, known: Register) -> dict[str, str]:
    row = quantity(name, state, known)
    result = {"units": row.unit, "long_name": row.meaning}
    if row.source:
        result["references"] = row.source
    return result


def side_attributes() -> dict[str, Any]:
    """CF attributes of the side of a jump that an extremum is on."""
    words = "side of a jump from which the value is the limit, by theta"
    flags = np.array([-1, 0, 1], np.int8)
    return {"long_name": words, "flag_values": flags, "flag_meanings": "smaller no_jump larger"}


def input_attributes(name: str) -> dict[str, str]:
    """CF attributes of an input."""
    return {**_input_attributes(name)}


@lru_cache(maxsize=256)
def _input_attributes(name: str) -> dict[str, str]:
    row = INPUTS.get(name.partition("[")[0])  # that of one slider of several
    return {"units": str(unit_of(name)), "long_name": row.meaning if row else name}


@cache
def source() -> str:
    """The source of a dataset: version of desaxe and digest of its derivation."""
    return f"desaxe {version()}, derivation {digest()[:16]}"


def said(name: str, number: Any, unit: str) -> str:
    """An input of a dataset that is a number, as its attribute `scene` has it."""
    return f"{name} = {number.item()!r} {unit}".removesuffix(" 1")


def provenance(
    names: Iterable[str],
    inputs: Mapping[str, NDArray[Any]],
    branch: int,
    accuracy: str | float = "standard",
    title: str = "offset slider-crank",
    of: Iterable[str] = (),
) -> dict[str, Any]:
    """Attributes of a dataset: the request, and the version that computed it; `of`: names behind `names`."""
    axes = [name for name, array in inputs.items() if array.ndim]
    fixed = [said(n, a, _input_attributes(n)["units"]) for n, a in inputs.items() if not a.ndim]
    names = tuple(names)
    own = text_of((*names, *of)) if register().definitions else ""
    scene = ", ".join(names) + (f" over {', '.join(axes)}" if axes else "")
    return {
        **({"quantities": own} if own else {}),
        "title": title,
        "scene": "; ".join(part for part in (scene, ", ".join(fixed)) if part),
        "source": source(),
        "Conventions": CONVENTIONS,
        "branch": branch,
        "accuracy": accuracy,
    }


@cache
def import_xarray(what: str = "a labelled result") -> Any:
    """The module xarray, with all that it imports itself when it makes its first Dataset."""
    with explained(what):
        xarray = imported("xarray")

    def make_a_dataset() -> None:
        with IMPORTS:
            xarray.Dataset({"x": ("x", np.zeros(1))})

    finished(make_a_dataset)
    return xarray


def labelled(
    values: Mapping[str, tuple[Sequence[str], Any, dict[str, Any]]],
    inputs: Mapping[str, NDArray[Any]],
    branch: int,
    accuracy: str | float = "standard",
    of: Iterable[str] = (),
    along: Mapping[str, str] = MappingProxyType({}),
) -> "xr.Dataset":
    """A Dataset of variables by name (dimensions, array, attributes); a 1-d input is a dimension.

    of     names that stand behind those of the variables
    along  input -> its dimension, where that has another name
    """
    xarray = import_xarray()
    variables = dict(values)
    for name, (_, _, message) in variables.items():
        if "status" in variables and name not in ("status", "margin"):
            message["ancillary_variables"] = "status"
    coordinates = {
        name: ((along.get(name, name),) if array.ndim else (), array, input_attributes(name))
        for name, array in inputs.items()
    }
    names = [name for name in values if name not in ("status", "margin")]
    about = provenance(names, inputs, branch, accuracy, of=of)
    ranks = [len(dims) for dims, _, _ in values.values()]
    axes_in_order = not ranks or ranks[0] == max(ranks)  # else those of the coordinates come first
    dataset: xr.Dataset = xarray.Dataset(variables if axes_in_order else None, coordinates, about)
    return dataset if axes_in_order else dataset.assign(variables)


def with_loads(dataset: "xr.Dataset", loads: Mapping[str, Any]) -> "xr.Dataset":
    """A new Dataset with its varying loads: one over theta as a coordinate, and what each is."""
    if not loads:
        return dataset
    over_theta = {name: load for name, load in loads.items() if load.over == "theta"}
    if over_theta and "theta" in dataset.dims:
        theta = dataset["theta"]
        columns = {
            n: (theta.dims, load.value(theta.values), input_attributes(n)) for n, load in over_theta.items()
        }
        dataset = dataset.assign_coords(columns)
    return tell_loads(dataset, loads)


def tell_loads(dataset: "xr.Dataset", loads: Mapping[str, Any]) -> "xr.Dataset":
    """A Dataset that knows its varying loads, and says what each is."""
    if loads:
        dataset.attrs["loads"] = loads_text(loads)
        dataset.encoding = {**dataset.encoding, KNOWN: KnownLoads(loads)}
    return dataset


KNOWN = "loads"  # the key in a Dataset's `encoding`, which no file gets


class KnownLoads(dict[str, Any]):
    """The loads themselves, for as long as a Dataset stays in this process."""

    def __reduce__(self) -> tuple[type[dict[str, Any]], tuple[()]]:
        return dict, ()

    def __deepcopy__(self, memo: Any) -> "KnownLoads":
        return self


def known_loads(dataset: "xr.Dataset") -> Mapping[str, Any]:
    """The loads that vary with the motion, if the Dataset still knows them."""
    result: Mapping[str, Any] = dataset.encoding.get(KNOWN, {})
    return result


def loads_text(loads: Mapping[str, Any], units: UnitSystem = SI) -> str:
    """The loads that vary with the motion, as text for an attribute."""
    return "; ".join(f"{name}: {load.in_units(units).told(units.of(name))}" for name, load in loads.items())
