"""Stubs of the functions that `dop853` calls, for a crank alone; a compiled module has its own instead."""

from typing import Any


def still(theta: float, branch: float, p: Any) -> tuple[float, float, float]:
    """M_eff [kg m^2], the torque of gravity [N m] and Y' [m]."""
    return 1.0, 0.0, 0.0


def moving(theta: float, branch: float, p: Any) -> tuple[float, float, float, float]:
    """M_eff, its derivative by theta, the torque of gravity and Y'."""
    return 1.0, 0.0, 0.0, 0.0


def potential(theta: float, branch: float, p: Any) -> float:
    """The potential energy [J]."""
    return 0.0


def torque(t: float, theta: float, omega: float, number: float) -> float:
    """The torque [N m]."""
    return number
