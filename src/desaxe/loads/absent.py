"""A warning where forces are asked for and nothing acts: they are all 0 then, which is rarely meant."""

from functools import lru_cache
from typing import Any
from warnings import warn

from ..mechanism.catalogue import has, inputs_of
from ..mechanism.names import parts
from .load import LoadWarning

ACTING = {"m_crank", "m_rod", "m_slider", "I_crank", "I_rod", "F_X", "F_Y"}


def warn_that_nothing_acts(names: Any, stacklevel: int) -> None:
    """Warn of quantities that are 0 without a mass or a load, in a call with none."""
    every = (names,) if isinstance(names, str) else tuple(names)
    found = dict.fromkeys(parts(name)[0] for name in every if isinstance(name, str) and _needs_a_load(name))
    if found:
        warn(
            f"{', '.join(found)}: 0, since neither a mass nor a load is given, such as m_slider= or F_Y=",
            LoadWarning,
            stacklevel=stacklevel + 1,
        )


@lru_cache
def _needs_a_load(name: str) -> bool:
    return has(name) and not ACTING.isdisjoint(inputs_of(name))
