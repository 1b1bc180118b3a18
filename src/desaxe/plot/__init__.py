"""Pictures of labelled results (extra `plot`); pyplot and its global state are never touched."""

from .families import curves as curves
from .files import save as save
from .round import polar as polar

__all__ = ["curves", "polar", "save"]
