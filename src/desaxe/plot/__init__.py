"""Pictures of labelled results (extra `plot`); pyplot and its global state are never touched."""

from .families import curves as curves
from .families import save as save

__all__ = ["curves", "save"]
