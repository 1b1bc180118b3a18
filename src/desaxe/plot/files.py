"""Pictures as files."""

import os
from os import PathLike
from pathlib import Path
from typing import Any


def save(figure: Any, path: str | PathLike[str], dpi: float = 150.0) -> Path:
    """Write a figure to a file of the kind that its name says; folders are made as needed."""
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    staged = target.with_name(f".{target.stem}.new{target.suffix}")
    try:
        figure.savefig(staged, dpi=dpi)
        os.replace(staged, target)
    finally:
        staged.unlink(missing_ok=True)
    return target
