"""Tables as text: cells in even columns."""

from collections.abc import Sequence


def table(
    rows: Sequence[Sequence[str]],
    align: str = "l",
    gap: str = "  ",
    indent: str = "",
    most: int | None = None,
) -> list[str]:
    """Rows of cells as lines.

    align  a letter for each column, the last one for all that follow: l flush left, r flush right
    gap    stands between two columns
    most   the largest width of a column: a longer cell takes its own
    """
    kept = [[len(row[k]) for row in rows if most is None or len(row[k]) <= most] for k in range(len(rows[0]))]
    widths = [max(lengths, default=0) for lengths in kept]
    sides = align + align[-1] * len(widths)
    return [
        (indent + gap.join(_padded(*cell) for cell in zip(row, widths, sides, strict=False))).rstrip()
        for row in rows
    ]


def _padded(cell: str, width: int, side: str) -> str:
    return cell.rjust(width) if side == "r" else cell.ljust(width)
