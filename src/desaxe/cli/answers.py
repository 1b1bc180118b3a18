"""The answer of a call: on the terminal, as JSON, as CSV, or in a file."""

import argparse
import csv
import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..support.shown import printable
from .words import UsageError

DATASETS = (".csv", ".nc", ".npz", ".xlsx", ".zarr")
PICTURES = (".png", ".svg", ".pdf")


def require_target(path: Path, overwrite: bool) -> None:
    """Fail before the work where the file could not be written."""
    from ..scenes.stores.files import check_place
    from ..support.files import require_writable

    suffixes = (".json", *DATASETS, *PICTURES)
    if path.suffix not in suffixes:
        raise UsageError(f"-o {printable(path)}: its name must end in {', '.join(suffixes)}")
    check_place(path, overwrite)
    require_writable(path)


def written(answer: Any, options: argparse.Namespace, columns: Mapping[str, Any]) -> None:
    """Print an answer as the options say, or write it to the file that they name.

    columns  the inputs of several designs with their units, which stand beside the answer in a table
    """
    if options.file is not None:  # before the text, whose reader may be gone
        _write(answer, Path(options.file), options.overwrite, columns)
    if options.json:
        print(json_text(answer))
    elif options.csv:
        print(csv_text(answer, columns), end="")
    elif options.file is None:
        from ..support.answer import Answer

        plain_dict = type(answer) is dict
        print(answer.report() if hasattr(answer, "report") else Answer(answer) if plain_dict else answer)
    if options.file is not None:
        print(f"{printable(options.file)}: written")


def _write(answer: Any, path: Path, overwrite: bool, columns: Mapping[str, Any]) -> None:
    from ..evaluation.labels import source
    from ..scenes.stores.files import write
    from ..scenes.stores.tables import to_excel
    from ..support.written import write_whole

    is_dataset = hasattr(answer, "data_vars")
    if path.suffix in PICTURES:
        _picture(answer, path).save(path, overwrite=overwrite)
    elif is_dataset and path.suffix in DATASETS:
        write(path, answer, {}, overwrite)
    elif path.suffix == ".xlsx":
        to_excel(answer, path, overwrite=overwrite)
    elif path.suffix in (".json", ".csv"):
        with write_whole(path, overwrite) as staged:  # with its source, which is its mark
            text = f"# {source()}\n{csv_text(answer, columns)}"
            if path.suffix == ".json":
                text = json.dumps({"source": source(), **json.loads(json_text(answer))}, indent=2) + "\n"
            staged.write_text(text, encoding="utf-8", newline="\n")
    else:
        raise UsageError(f"-o {printable(path)}: this answer is no Dataset; name a .json or .csv file")


def _picture(answer: Any, path: Path) -> Any:
    """The picture of an answer; of a grid its curves, of one quantity over two inputs their map."""
    if not hasattr(answer, "data_vars"):
        if hasattr(answer, "plot"):
            return answer.plot()
        raise UsageError(f"-o {printable(path)}: this answer has no picture; name a .json or .csv file")
    from .. import plot

    dims = list(map(str, answer.dims))
    beside = ("status", "margin", "can_turn", "kind")
    names = [str(n) for n, a in answer.data_vars.items() if a.dims and n not in beside]
    over = "theta" if "theta" in dims else dims[0] if len(dims) == 1 else ""
    if over and len(dims) < 3:
        return plot.panels(answer, names, over=over)
    if len(dims) == 2 and len(names) == 1:
        return plot.design_map(answer, names[0])
    words = f"{', '.join(names)} over {', '.join(dims)}"
    raise UsageError(
        f"-o {printable(path)}: a picture is of curves over one input, or of one map; not {words}"
    )


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
        return {" ".join(map(str, k)) if isinstance(k, tuple) else str(k): plain(v) for k, v in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(part) for part in value]
    if isinstance(value, float) and value - value != 0.0:
        return None
    return value if isinstance(value, (bool, int, float, str)) or value is None else str(value)


def csv_text(answer: Any, columns: Mapping[str, Any]) -> str:
    """A table: a column for each array, those of the inputs first, or a row for each number."""
    from ..scenes.stores.tables import table_of, tables_of

    rows: Any = table_of(answer) if hasattr(answer, "data_vars") else ()
    if not rows:
        arrays = {name: array for name, (array, _) in columns.items()}
        units = {name: unit for name, (_, unit) in columns.items()}
        rows = next(iter(tables_of({**arrays, **answer}, {**units, **answer.units}).values()))
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()
