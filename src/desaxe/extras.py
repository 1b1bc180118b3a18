"""A missing extra is one clear line that says what to install."""

from collections.abc import Iterator
from contextlib import contextmanager

EXTRAS = {
    "sympy": "derive",
    "mpmath": "derive",
    "xarray": "labelled",
    "h5netcdf": "labelled",
    "matplotlib": "plot",
    "pint": "units",
    "msgspec": "scene",
    "tqdm": "scene",
    "desaxe.derive": "derive",
}


class MissingExtra(ImportError):
    """An optional dependency is not installed."""


@contextmanager
def needed(what: str) -> Iterator[None]:
    """Turn the ImportError of an optional dependency into the line that says what to install."""
    try:
        yield
    except ModuleNotFoundError as error:
        extra = EXTRAS.get((error.name or "").partition(".")[0]) or EXTRAS.get(error.name or "")
        if extra is None:
            raise
        raise MissingExtra(f"{what} needs {error.name}: python -m pip install 'desaxe[{extra}]'") from None
