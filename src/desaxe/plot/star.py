"""The star of a harmonic: what each slider of a crankshaft adds to it, as arrows."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..support.extras import needed
from .picture import Picture

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE = (5.2, 5.0)  # inches
NOTHING = 1e-9  # of the largest arrow: a sum that is none


def star(
    arrows: Mapping[str, complex], title: str = "", unit: str = "", *, ax: "Axes | None" = None
) -> Picture:
    """Draw complex amplitudes as arrows from the centre, and tip to tail; a Picture of the arrows.

    arrows  label -> amplitude exp(i phase); the phase counts like theta: 0 is up, and it turns to the right
    title   by default none
    unit    of the amplitudes

    Tip to tail, thin, the arrows end where the sum does: at the centre where they balance.
    """
    with needed("plot.star"):
        from matplotlib.figure import Figure
    ax = Figure(figsize=SIZE, layout="constrained").add_subplot() if ax is None else ax
    total, drawn = 0j, []
    for number, (label, value) in enumerate(arrows.items()):
        colour = f"C{number}"
        drawn.append(
            ax.annotate(
                "", (value.imag, value.real), (0.0, 0.0),
                arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 2.0, "shrinkA": 0, "shrinkB": 0},
            )
        )  # fmt: skip
        end = total + value
        ax.plot([total.imag, end.imag], [total.real, end.real], color=colour, lw=1.0, ls="--", label=label)
        total = end
    size = max((abs(value) for value in arrows.values()), default=1.0) or 1.0
    ax.plot(total.imag, total.real, "ko", ms=5, label="sum")
    sum_text = "0" if abs(total) <= NOTHING * size else f"{abs(total):.4g} {unit}".strip()
    ax.set_title(f"{title}; sum {sum_text}".removeprefix("; "), loc="left", fontsize="medium")
    for value in arrows.values():  # annotations do not set the limits
        ax.plot(value.imag, value.real, alpha=0.0)
    ax.set_aspect("equal", adjustable="datalim")
    ax.margins(0.12)
    ax.set_xlabel(f"sine part [{unit}]" if unit else "sine part")
    ax.set_ylabel(f"cosine part [{unit}]" if unit else "cosine part")
    ax.axhline(0.0, color="0.85", lw=0.8, zorder=0)
    ax.axvline(0.0, color="0.85", lw=0.8, zorder=0)
    ax.legend(fontsize="small")
    return Picture(ax, drawn)
