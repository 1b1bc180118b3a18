"""Optional dependencies: a missing one raises one line with the command that installs it."""

from collections.abc import Iterator
from contextlib import contextmanager

from .forks import IMPORTS

EXTRAS = {
    package: extra
    for extra, packages in {
        "derive": "sympy desaxe.derive",
        "labelled": "xarray pandas h5netcdf h5py",
        "zarr": "zarr",
        "scale": "dask distributed",
        "plot": "matplotlib",
        "units": "pint",
        "explore": "plotly",
        "excel": "xlsxwriter openpyxl",
        "fmu": "fmpy",
        "simulate": "scipy",
        "rigorous": "flint python-flint mpmath",
    }.items()
    for package in packages.split()
}


class MissingExtraError(ImportError):
    """An optional dependency is not installed."""


@contextmanager
def needed(what: str, extra: str | None = None) -> Iterator[None]:
    """Turn the ImportError of an optional dependency into MissingExtraError, as `IMPORTS` does imports.

    The extra is the one that has the dependency, or the one named here. The block imports, and nothing else:
    interrupts and forks wait for its end, since a package that is imported halfway cannot be imported again.
    """
    with IMPORTS, explained(what, extra):
        yield


@contextmanager
def explained(what: str, extra: str | None = None) -> Iterator[None]:
    """Turn the ImportError of an optional dependency into MissingExtraError, in a block of any length."""
    try:
        yield
    except ModuleNotFoundError as error:
        missing = error.name or ""
        package = missing if missing in EXTRAS else missing.partition(".")[0]
        known = EXTRAS.get(package)
        if known is None:
            raise
        remedy = f"python -m pip install 'desaxe[{extra or known}]'"
        raise MissingExtraError(f"{what} needs {package}: {remedy}") from None
