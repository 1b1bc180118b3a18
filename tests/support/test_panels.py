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


def test_a_root_at_an_edge_is_found_there_whatever_rounding_makes_of_its_sign():
    rng = np.random.default_rng(7)
    share = rng.uniform(0.5, 2.0, (400, 3))
    panels = Panels(np.tile([0.0, 0.7, 1.6], (400, 1)))
    x = panels.x
    values = (x - 0.7) * (share[:, :1, None] + share[:, 1:2, None] * x + share[:, 2:, None] * np.sin(x) ** 2)
    roots = panels.roots(values)
    assert np.abs(roots[roots != 0.0] - 0.7).max() < 1e-12
    assert (roots != 0.0).any(1).all()
