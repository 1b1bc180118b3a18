"""The answer of a call: on the terminal, as JSON, as CSV, or in a file."""

import argparse
import csv
import io
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from .words import UsageError

TEXTS = (".json", ".csv")
DATASETS = (".csv", ".nc", ".npz", ".xlsx", ".zarr")


def require_target(path: Path, overwrite: bool) -> None:
    """Fail before the work where the file could not be written."""
    from ..scenes.stores.files import check_place
    from ..support.files import require_writable

    if path.suffix not in (*TEXTS, *DATASETS):
        raise UsageError(f"-o {path}: its name must end in {', '.join(dict.fromkeys((*TEXTS, *DATASETS)))}")
    check_place(path, overwrite)
    require_writable(path)


def written(answer: Any, options: argparse.Namespace) -> None:
    """Print an answer as the options say, and write it to the file that they name."""
    is_dataset = hasattr(answer, "data_vars")
    if options.json:
        print(json_text(answer))
    elif options.csv:
        print(csv_text(answer), end="")
    elif options.file is None:
        print(answer.report() if hasattr(answer, "report") else repr(answer))
    if options.file is None:
        return
    path = Path(options.file)
    if is_dataset and path.suffix in DATASETS:
        from ..scenes.stores.files import write

        write(path, answer, {}, options.overwrite)
    elif path.suffix in TEXTS:
        from ..support.written import write_whole

        with write_whole(path, options.overwrite) as staged:
            staged.write_text(_file_text(answer, path.suffix), encoding="utf-8", newline="\n")
    else:
        raise UsageError(f"-o {path}: this answer is no table of arrays; name a .json or .csv file")
    print(f"{path}: written")


def _file_text(answer: Any, suffix: str) -> str:
    """The text of a file, with its source, which is its mark."""
    from ..evaluation.labels import source

    if suffix == ".csv":
        return f"# {source()}\n{csv_text(answer)}"
    return json.dumps({"source": source(), **json.loads(json_text(answer))}, indent=2) + "\n"


def json_text(answer: Any) -> str:
    """The numbers as JSON with their units; null for NaN and infinity."""
    if hasattr(answer, "data_vars"):
        columns = {**answer.coords, **answer.data_vars}
        values = {name: plain(column.values) for name, column in columns.items()}
        units = {name: column.attrs["units"] for name, column in columns.items() if "units" in column.attrs}
        dims = {name: list(column.dims) for name, column in columns.items()}
        return json.dumps({**values, "dims": dims, "units": units}, indent=2)
    if not hasattr(answer, "units"):
        return json.dumps(plain(answer))
    return json.dumps({**plain(answer), "units": plain(answer.units)}, indent=2)


def plain(value: Any) -> Any:
    """A value of types that JSON has; a key that is no text as its words."""
    if hasattr(value, "_asdict"):
        value = value._asdict()
    if isinstance(value, Mapping):
        return {_key(key): plain(part) for key, part in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(part) for part in value]
    if isinstance(value, (bool, int, str)) or value is None:
        return value
    if isinstance(value, float):
        return value if value - value == 0.0 else None
    return str(value)


def _key(key: Any) -> str:
    return " ".join(map(str, key)) if isinstance(key, tuple) else str(key)


def csv_text(answer: Any) -> str:
    """A table: columns of arrays of one length, or a row for each number."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(_rows(answer))
    return text.getvalue()


def _rows(answer: Any) -> Iterator[list[Any]]:
    if hasattr(answer, "data_vars"):
        from ..scenes.stores.tables import table_of

        yield from table_of(answer)
        return
    units = plain(answer.units)
    columns = {name: part for name, part in answer.items() if getattr(part, "ndim", 0) == 1 and part.size > 1}
    longest = max((part.size for part in columns.values()), default=0)
    columns = {name: part.tolist() for name, part in columns.items() if part.size == longest}
    if columns:
        yield [_heading(name, units.get(name, "")) for name in columns]
        yield from map(list, zip(*columns.values(), strict=True))
        return
    yield ["name", "value", "unit"]
    yield from _flat("", plain(answer), units)


def _flat(prefix: str, value: Any, unit: Any) -> Iterator[list[Any]]:
    """A row for each number of nested tables and lists."""
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _flat(f"{prefix}.{key}" if prefix else key, part, _under(unit, key))
    elif isinstance(value, list):
        for index, part in enumerate(value):
            yield from _flat(f"{prefix}[{index}]", part, unit)
    else:
        yield [prefix, value, unit if isinstance(unit, str) else ""]


def _under(unit: Any, key: str) -> Any:
    return unit.get(key, "") if isinstance(unit, dict) else unit


def _heading(name: str, unit: Any) -> str:
    from ..scenes.stores.tables import heading

    return heading(name, unit if isinstance(unit, str) else "")
