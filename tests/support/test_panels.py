"""Extremes of functions on panels."""

import numpy as np
import pytest

from desaxe.support.panels import Panels


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("later", [1.0 - 2.0**-52, 1.0, 1.0 + 2.0**-52])
def test_of_equal_extremes_the_first_counts(sign, later):
    """Mirror images of each other, whichever rounding makes larger; a larger one counts wherever it is."""
    panels = Panels(np.linspace(0.0, 2.0 * np.pi, 19))
    halves = np.where(panels.x > np.pi, later, 1.0)
    _, at, within = panels.extreme(sign * halves * np.sin(panels.x) ** 2, sign)
    assert at == pytest.approx(0.5 * np.pi, abs=1e-7)
    assert within
    clearly = np.where(panels.x > np.pi, 1.0 + 1e-9, 1.0)
    _, at, _ = panels.extreme(sign * clearly * np.sin(panels.x) ** 2, sign)
    assert at == pytest.approx(1.5 * np.pi, abs=1e-7)
