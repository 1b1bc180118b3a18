"""A frozen table of the ledgers: each entry's verdict, and hashes of what the paper prints and of the rest.

It guards words, which no proof can. `python -m tests.papers.frozen` writes it again, after a change that is
meant.
"""

import hashlib
from functools import cache
from pathlib import Path

from tests.papers.entry_checks import raw_entries

TABLE = Path(__file__).with_name("frozen.txt")


def row_of(entry: dict[str, str]) -> tuple[str, str, str]:
    """The verdict of an entry, the hash of its printed form and that of its other texts."""
    rest = "\n".join(entry[field] for field in ("where", "corrected", "evidence", "test"))
    return entry["verdict"], digest(entry["printed"]), digest(rest)


def digest(text: str) -> str:
    """A short hash of a text."""
    return hashlib.sha256(text.encode()).hexdigest()[:10]


@cache
def frozen() -> dict[str, tuple[str, str, str]]:
    """The table as written: id -> verdict and the two hashes."""
    rows = (line.split("\t") for line in TABLE.read_text("utf-8").splitlines())
    return {key: (verdict, printed, rest) for key, verdict, printed, rest in rows}


def main() -> None:
    """Write the table."""
    rows = ("\t".join((key, *row_of(entry))) for key, entry in raw_entries().items())
    TABLE.write_text("".join(f"{row}\n" for row in rows), "utf-8")


if __name__ == "__main__":
    main()
