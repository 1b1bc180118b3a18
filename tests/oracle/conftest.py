"""Sixty digits for all tests of the oracle."""

import mpmath
import pytest


@pytest.fixture(autouse=True)
def sixty_digits():
    with mpmath.workdps(60):
        yield
