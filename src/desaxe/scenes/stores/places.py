"""The needs of a run and its output files, checked before anything is computed."""

import shutil
from importlib import import_module
from math import prod
from os import PathLike
from os.path import abspath
from pathlib import Path

from ...support.extras import needed
from ...support.files import require_writable
from ...support.memory import size_text
from ...support.written import require_path
from ..content import Content
from ..parts.stored import require_store
from ..schema import SceneError
from .files import check_place, files_of, requirements_of
from .workbook import require_room

LEAST = {".nc": 8, ".npz": 8, ".csv": 4, ".xlsx": 1}  # bytes that a number takes in a file, at least


def require_modules(content: Content) -> None:
    """Fail early if an optional dependency is missing."""
    modules = {"outputs": "xarray"} if content.outputs else {}
    modules |= {"results.store": "zarr", "a results.store": "dask"} if content.store is not None else {}
    modules |= {"[[peak]]": "xarray"} if content.peaks else {}
    modules |= requirements_of(content.data) if content.data is not None else {}
    modules |= (
        {"[[picture]]": "matplotlib", "the values of a [[picture]]": "xarray"} if content.pictures else {}
    )
    for what, module in modules.items():
        with needed(what):
            import_module(module)


def require_places(content: Content, overwrite: bool) -> None:
    """Fail at the start where something cannot be written, or would take the place of what is not ours."""
    places: dict[str, str] = {}
    if content.data is not None:
        for file in data_files(content):
            _claim(places, "results.data", file)
            check_place(file, overwrite)
            require_writable(file)
        _require_room(content, Path(content.data))
    for number, picture in enumerate(content.pictures, 1):
        file = Path(picture.file)
        _claim(places, f"picture #{number}.file", file)
        require_path(file, overwrite)
    if content.store is not None:
        _claim(places, "results.store", content.store)
        require_store(content, overwrite)


def data_files(content: Content) -> list[Path]:
    """The files of results.data."""
    assert content.data is not None
    return files_of(Path(content.data), bool(content.outputs), content.groups)


def _claim(places: dict[str, str], key: str, path: str | PathLike[str]) -> None:
    """Refuse two results in one place."""
    place = abspath(path)
    if place in places:
        raise SceneError(f"{key} = {str(path)!r}: {places[place]} is written there")
    places[place] = key


def _require_room(content: Content, path: Path) -> None:
    """Refuse a file that is larger than what is free."""
    if not content.outputs or content.reduction is not None:
        return
    points = prod(len(value) for value in content.inputs.values() if isinstance(value, tuple))
    if path.suffix == ".xlsx":
        require_room("results.data", points)
    size = LEAST.get(path.suffix, 0) * points * len(content.outputs)
    free = shutil.disk_usage(next(one for one in path.absolute().parents if one.exists())).free
    if size > free:
        raise OSError(28, f"it takes {size_text(size)} or more, {size_text(free)} are free", str(path))
