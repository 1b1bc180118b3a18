"""The result of an audit as Markdown, readable as plain text too."""

from collections.abc import Callable, Iterator, Sequence

from desaxe.oracle.families import FAMILIES
from desaxe.support.template import file_text
from desaxe.support.text_table import table as text_table

from .contenders import NAMES
from .errors import TOP, ULPS, Statistics
from .run import GENERIC, SEED, Audit

PICTURE = "accuracy.png"
PLAIN = "in plain ulp"
CLEARLY = 0.95  # a time is shorter only if by this much: the rest is noise


def report(result: Audit) -> str:
    """The whole page."""
    parts = [
        "# Accuracy and time, measured",
        f"![Worst error over time, for every contender]({PICTURE})",
        _made(result),
        file_text(__package__, "reading.txt").rstrip(),
        "## Overview",
        overview(result),
        "\n".join(_dominated(result)),
        "## Share of the promise, worst (median)",
        by_family(result, share_of),
        "## Plain ulp, worst (median)",
        by_family(result, ulp_of),
        "## The families",
        "\n".join(f"* **{_title(name)}**: {_says(name)}" for name in FAMILIES),
    ]
    return "\n\n".join(parts) + "\n"


def overview(result: Audit) -> str:
    """One row for each contender."""
    head = [
        "",
        "time",
        "generic: median",
        "worst",
        "hardest family",
        "worst",
        "plain ulp: generic",
        "anywhere",
    ]
    rows = []
    for one in result.who:
        generic, (family, share) = result.errors[one.name][GENERIC], result.hardest(one.name)
        shares = [number(x, TOP / ULPS) for x in (generic.median, generic.worst, share)]
        ulps = [number(x, TOP) for x in (generic.worst_ulp, result.worst_ulp(one.name))]
        rows.append([one.name, _times(result, one.name), *shares[:2], _title(family), shares[2], *ulps])
    return table(head, rows)


def _made(result: Audit) -> str:
    effort = result.effort
    branches = "both branches" if len(effort.branches) > 1 else "branch +1"
    absent = "" if "heyoka" in result.ratios else " heyoka is not installed here, so it was not measured."
    return (
        "Made by `python -m benchmarks --accuracy --write`: "
        f"{', '.join(NAMES)} at {effort.points} points of each family, {branches},\n"
        f"seed {SEED}; time over {effort.timed} points, {effort.rounds} rounds. The truth is the loop\n"
        f"closure in ball arithmetic, which shares nothing with any contender. NumPy, numba, heyoka and\n"
        f"mpmath evaluate the textbook's closed form (`desaxe.equation`).{absent}\n\n"
        f"{result.machine}."
    )


def by_family(result: Audit, cell: Callable[[Statistics], str]) -> str:
    """One row for each family, one column for each contender."""
    head = ["", *(one.name for one in result.who)]
    rows = [
        [_title(family), *(cell(result.errors[one.name][family]) for one in result.who)]
        for family in FAMILIES
    ]
    return table(head, rows)


def share_of(result: Statistics) -> str:
    """Worst and median share of the promise."""
    return f"{number(result.worst, TOP / ULPS)} ({number(result.median, TOP / ULPS)})"


def ulp_of(result: Statistics) -> str:
    """Worst and median error in ulp."""
    return f"{number(result.worst_ulp, TOP)} ({number(result.median_ulp, TOP)})"


def number(x: float, top: float) -> str:
    """Two digits at most; `none` at the top of the scale."""
    if x >= top:
        return "none"
    if x >= 9.95e3:
        return f"{x:.0e}".replace("e+0", "e").replace("e+", "e")
    return f"{x:.0f}" if x >= 9.95 else f"{x:.1f}" if x >= 0.95 else f"{x:.2g}" if x >= 0.001 else "<0.001"


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table in even columns."""
    first, *others = text_table([[*row, ""] for row in (head, *rows)], gap=" | ", indent="| ")
    rule = "".join(c if c == "|" else "-" for c in first)
    return "\n".join([first, rule, *others])


def measures(result: Audit, name: str) -> dict[str, float]:
    """The three errors that are drawn over time."""
    generic = result.errors[name][GENERIC].worst
    return {
        "at generic points": generic,
        "in the hardest family": result.hardest(name)[1],
        PLAIN: result.worst_ulp(name),
    }


def beaten_by(result: Audit, name: str, measure: str) -> list[str]:
    """Names of the contenders that are clearly faster and no less accurate."""
    mine, limit = measures(result, name)[measure], CLEARLY * result.ratios[name]
    return [n for n, time in result.ratios.items() if time <= limit and measures(result, n)[measure] <= mine]


def _dominated(result: Audit) -> Iterator[str]:
    """Lines that list, measure by measure, the contenders that another one dominates."""
    yield "Dominated: slower than another whose worst error is no larger (the fastest in brackets). Those"
    yield "with no digit right at some point are left out:\n"
    for measure in measures(result, result.who[0].name):
        top = TOP if measure == PLAIN else TOP / ULPS
        some = [name for name in result.ratios if measures(result, name)[measure] < top]
        beaten = [name for name in some if beaten_by(result, name, measure)]
        by = [
            f"{name} (by {min(beaten_by(result, name, measure), key=result.ratios.__getitem__)})"
            for name in beaten
        ]
        yield f"* {measure}: {'; '.join(by) or 'none'}"


def _times(result: Audit, name: str) -> str:
    ratio = result.ratios[name]
    return f"{ratio:.2g}" if ratio < 100 else number(ratio, float("inf"))


def _title(family: str) -> str:
    return family.replace("_", " ")


def _says(family: str) -> str:
    return " ".join((FAMILIES[family].__doc__ or "").split())
