"""Memory of a fit grows with its samples, not with their square."""

import numpy as np

from desaxe.design.fit.spread import spread_of


def test_a_hundred_thousand_samples():
    # A square matrix of their number would take 80 GB.
    jacobian = np.random.default_rng(0).normal(size=(100_000, 3))
    spread = spread_of(jacobian, np.ones(3), ("ec", "AB", "BC"), 1.0)
    assert np.allclose(spread.covariance, np.linalg.inv(jacobian.T @ jacobian), rtol=1e-9, atol=1e-15)


def test_fewer_samples_than_unknowns_leave_directions_open():
    spread = spread_of(np.array([[1.0, 2.0, 0.0]]), np.ones(3), ("ec", "AB", "BC"), 1.0)
    assert len(spread.unidentified) == 2
