"""The run as pictures: error over time, as the audit draws it; and the time per point over their number."""

from typing import TYPE_CHECKING

from .accuracy.errors import Statistics
from .accuracy.picture import COLOURS, draw
from .accuracy.run import QUICK, Audit
from .contenders import BY_NAME, STANDARD
from .errors import judged
from .measure import Data

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = (9.0, 5.6)  # inches
DASHES = {"desaxe standard": "-", "desaxe extended": (0, (4, 2))}
SHADES = ("#C44E00", "#8C564B", "#7F7F7F", "#BCBD22", "#9467BD", "#2CA02C", "#98DF8A", "#E377C2", "#D62728")


def errors_over_time(data: Data) -> "Figure":
    """Everyone's worst error over the time for the same names."""
    raced = data["one core"]["audited"]
    names = [name for name in data["who"] if "seconds" in raced[name]]
    base = raced[STANDARD]["seconds"]
    return draw(
        Audit(
            QUICK,
            data["machine"],
            tuple(judged(BY_NAME[name], None) for name in names),
            {name: raced[name]["seconds"] / base for name in names},
            {name: {f: Statistics(*s) for f, s in data["errors"][name].items()} for name in names},
        )
    )


def time_over_points(data: Data) -> "Figure":
    """Time for a point, as a multiple of desaxe's at a million."""
    from matplotlib.figure import Figure

    grown = data["growth"]
    largest = max((size for size in grown if STANDARD in grown[size]), key=int)
    base = grown[largest][STANDARD] / int(largest)
    figure = Figure(figsize=SIZE, layout="constrained")
    ax = figure.subplots()
    shades = iter(SHADES)
    for name in data["who"]:
        ours = name in DASHES
        sizes = [size for size in grown if name in grown[size]]
        ax.loglog(
            [int(size) for size in sizes],
            [grown[size][name] / int(size) / base for size in sizes],
            color=COLOURS["desaxe"] if ours else next(shades),
            linestyle=DASHES.get(name, "-"),
            linewidth=2.2 if ours else 1.3,
            marker=".",
            label=name,
        )
    ax.set_title("V_C and a_C on one core: time for a point over the number of points in a call", loc="left")
    ax.set_xlabel("points")
    ax.set_ylabel(f"time for a point, as a multiple of desaxe standard's\nat {int(largest):,} points")
    ax.grid(True, color="0.9", linewidth=0.8)
    ax.set_axisbelow(True)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    ax.legend(frameon=False, ncols=2)
    return figure
