"""The result of `tolerance`: a dict that shows itself in three lines, and the rest on request."""

from collections.abc import Mapping
from typing import Any

from ...mechanism.quantity_units import slopes_of, unit_of
from ...mechanism.status import ToleranceStatus
from ...support.answer import Answer
from ...support.shown import with_unit

SCATTER = ("mean", "std", "mean_error", "std_error", "least", "largest", "percentiles")
SHOWN = 4  # inputs in the line of what drives the scatter
LEAST = 0.005  # of the variance: a smaller share is not listed
UNSEEN = "0 to first order: see monte_carlo"


class Tolerance(Answer):
    """The result of `tolerance`; see there for its keys. `report()` shows all of them.

    `name` is that of the quantity or measure.
    """

    codes = ToleranceStatus

    def __init__(self, result: Mapping[str, Any], name: Any) -> None:
        super().__init__(result, _units(name, result))
        self.name = " of ".join(map(str, name)) if isinstance(name, (tuple, list)) else str(name)

    @property
    def unit(self) -> str:
        """The unit of its values; "" of pint quantities."""
        return str(self.units.get("value", ""))

    def __repr__(self) -> str:
        drawn, first = self["monte_carlo"], self["first_order"]
        unit = with_unit("", self.unit)
        ends = list(drawn["percentiles"].values())
        spread = f"{self.name} scatters by a standard deviation of {drawn['std']:.4g}{unit}"
        spread += f" ({first['std']:.4g} by derivatives)" if first["std"] else f" ({UNSEEN})"
        if ends:
            spread += f", 95 % lie in {ends[1]:.6g} ... {ends[3]:.6g}"
        message = (
            f"; status {self['status']}: {ToleranceStatus(self['status']).words}" if self["status"] else ""
        )
        return "\n".join(
            [
                f"{self.name} is {self['value']:.6g}{unit} with every input at its mean{message}",
                spread,
                self._causes(),
            ]
        )

    def _causes(self) -> str:
        shares = {name: share for name, share in self["contributions"].items() if share >= LEAST}
        listed = [f"{name} {100 * share:.0f} %" for name, share in list(shares.items())[:SHOWN]]
        rest = len(self["contributions"]) - len(listed)
        more = f" and {rest} more" if rest and listed else ""
        flat = ", ".join(name for name, slope in self["gradient"].items() if slope == 0.0)
        unseen = f"; {flat} {UNSEEN}" if flat else ""
        return f"driven by {', '.join(listed) or 'nothing'}{more}{unseen}; report() has everything"

    def report(self) -> str:
        """Every key of the result, a line each."""
        return super().__repr__()


def _units(name: Any, result: Mapping[str, Any]) -> dict[str, Any]:
    """The units of the scatter of a quantity or measure."""
    own = unit_of(name)
    scatter = dict.fromkeys(SCATTER, own)
    return {
        "value": own,
        "gradient": slopes_of(name, result["gradient"]),
        **dict.fromkeys(("first_order", "monte_carlo"), scatter),
        "worst_case": dict.fromkeys(("lower", "upper"), own),
    }
