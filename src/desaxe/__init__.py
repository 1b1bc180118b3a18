"""Offset (eccentric) slider-crank: exact kinematics and sensitivities, derived and compiled.

    import desaxe as dx

    dx.evaluate("a_C", theta=1.047, ec=0.0, AB=0.125, BC=0.350, omega0=157.08)   # -> float

SI units and radians. Nothing is imported until it is used: one point needs only `math`.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import plot as plot
    from ._compile import compile as compile
    from ._design.counterweight import counterweight as counterweight
    from ._design.design_map import design_map as design_map
    from ._design.events import events as events
    from ._design.flywheel import flywheel as flywheel
    from ._design.harmonics import harmonics as harmonics
    from ._design.optimize import optimize as optimize
    from ._design.synthesize import synthesize as synthesize
    from ._design.tolerance import tolerance as tolerance
    from ._enclose import enclose as enclose
    from ._evaluate import evaluate as evaluate
    from ._explain import explain as explain
    from ._explore import explore as explore
    from ._feasibility import feasibility as feasibility
    from ._grid import grid as grid
    from ._inverse import inverse as inverse
    from ._peak import peak as peak
    from ._scene import scene as scene
    from ._simulate import simulate as simulate
    from .catalogue import quantities as quantities
    from .design.drive.drive import drive as drive
    from .sweeps.sweep import sweep as sweep

# Public name -> the room it lives in; `equation` is SymPy's and comes with the extra `derive`.
_ROOMS = {
    "evaluate": "desaxe._evaluate",
    "grid": "desaxe._grid",
    "peak": "desaxe._peak",
    "inverse": "desaxe._inverse",
    "enclose": "desaxe._enclose",
    "design_map": "desaxe._design.design_map",
    "events": "desaxe._design.events",
    "optimize": "desaxe._design.optimize",
    "synthesize": "desaxe._design.synthesize",
    "tolerance": "desaxe._design.tolerance",
    "harmonics": "desaxe._design.harmonics",
    "counterweight": "desaxe._design.counterweight",
    "flywheel": "desaxe._design.flywheel",
    "drive": "desaxe.design.drive.drive",
    "explore": "desaxe._explore",
    "feasibility": "desaxe._feasibility",
    "scene": "desaxe._scene",
    "explain": "desaxe._explain",
    "compile": "desaxe._compile",
    "simulate": "desaxe._simulate",
    "sweep": "desaxe.sweeps.sweep",
    "quantities": "desaxe.catalogue",
    "equation": "desaxe.derive.equation",
}
_MODULES = ("plot",)

__all__ = [
    "compile",
    "counterweight",
    "design_map",
    "drive",
    "enclose",
    "equation",
    "evaluate",
    "events",
    "explain",
    "explore",
    "feasibility",
    "flywheel",
    "grid",
    "harmonics",
    "inverse",
    "optimize",
    "peak",
    "plot",
    "quantities",
    "scene",
    "simulate",
    "sweep",
    "synthesize",
    "tolerance",
]

# In a clone derive/ and generated/ stand beside src/; a wheel has them in this folder.
_clone = __file__.replace("\\", "/").rpartition("/src/desaxe/")[0]
if _clone:
    __path__.append(_clone)


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name == "__version__":
        from importlib.metadata import version

        return version("desaxe")
    if name in _MODULES:
        return import_module(f"{__name__}.{name}")
    if name not in _ROOMS:
        raise AttributeError(f"module 'desaxe' has no attribute {name!r}")
    from .extras import needed

    with needed(name):
        value = getattr(import_module(_ROOMS[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
