"""Loads over the crank angle or the slider's position: tables, files and functions."""

from .load import Load, LoadWarning
from .tabulated import over_theta, over_Y

__all__ = ["Load", "LoadWarning", "over_Y", "over_theta"]
