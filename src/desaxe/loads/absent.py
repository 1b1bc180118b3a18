"""A warning where forces are asked for and nothing acts: they are all 0 then, which is rarely meant."""

from collections.abc import Iterable, Sequence
from warnings import warn

from ..mechanism.catalogue import inputs_of
from ..mechanism.inputs import INPUTS
from ..mechanism.names import LOADS, parts
from .load import LoadWarning

ACTING = {name for name in LOADS if INPUTS[name].unit in ("kg", "kg*m^2", "N")}


def warn_that_nothing_acts(names: Sequence[str], inputs: Iterable[str]) -> None:
    """Warn of quantities that are 0 without a mass or a load, where none is given."""
    result = dict.fromkeys(parts(name)[0] for name in names if not ACTING.isdisjoint(inputs_of(name)))
    if result and ACTING.isdisjoint(inputs):
        warn(
            f"{', '.join(result)}: 0, since neither a mass nor a load is given, such as m_slider= or F_Y=",
            LoadWarning,
            stacklevel=2,
        )
