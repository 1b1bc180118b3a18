"""Offset (eccentric) slider-crank: exact kinematics and sensitivities, derived and compiled.

    import desaxe as dx

    dx.evaluate("a_C", theta=1.047, ec=0.0, AB=0.125, BC=0.350, omega0=157.08)   # -> float

SI units and radians. Nothing is imported until it is used: one point needs only `math`.
"""

from typing import TYPE_CHECKING, Any

from .support.extras import explained as _explained
from .support.forks import imported as _imported
from .support.version import version as _version

if TYPE_CHECKING:
    from .definitions.define import define as define
    from .definitions.define import undefine as undefine
    from .loads import LoadWarning as LoadWarning
    from .loads import damper as damper
    from .loads import over_stroke as over_stroke
    from .loads import over_theta as over_theta
    from .loads import over_V as over_V
    from .loads import over_Y as over_Y
    from .loads import spring as spring
    from .loads.motors import kloss as kloss
    from .loads.motors import over_omega as over_omega
    from .machine import Machine as Machine
    from .machine.crankshaft import Crankshaft as Crankshaft
    from .mechanism.catalogue import quantities as quantities
    from .mechanism.ranges import between as between
    from .mechanism.ranges import plus_minus as plus_minus
    from .mechanism.slips import UnitWarning as UnitWarning
    from .scenes.explain.explain import explain as explain
    from .scenes.export.compile import compile as compile
    from .scenes.scene import scene as scene
    from .typed import *

# Public name -> its module; `equation` is SymPy's and comes with the extra `derive`.
PUBLIC = {
    name: f"desaxe.{module}"
    for module, names in {
        "evaluation.evaluate": "evaluate",
        "evaluation.function": "function",
        "evaluation.grid": "grid",
        "peaks.peak": "peak",
        "design.inverse": "inverse",
        "enclosure.enclose": "enclose",
        "design.design_map": "design_map",
        "design.events.events": "events",
        "design.optimisation.optimize": "optimize",
        "design.synthesis.synthesize": "synthesize",
        "design.solve": "solve",
        "design.steady.steady": "steady",
        "design.tolerance.tolerance": "tolerance",
        "design.turn.harmonics": "harmonics",
        "design.turn.counterweight": "counterweight",
        "design.turn.crossings": "crossings",
        "design.drive.drive": "drive",
        "scenes.explorer.explore": "explore",
        "scenes.stores.tables": "to_excel",
        "machine.crankshaft": "Crankshaft",
        "machine.machine": "Machine",
        "mechanism.slips": "UnitWarning",
        "design.fit.fit": "fit",
        "design.feasibility.feasibility": "feasibility",
        "scenes.scene": "scene",
        "scenes.explain.explain": "explain",
        "scenes.export.compile": "compile",
        "simulation.simulate": "simulate",
        "scenes.sweep": "sweep",
        "mechanism.catalogue": "quantities",
        "loads.motors": "kloss over_omega",
        "loads": "over_theta over_Y over_stroke over_V spring damper LoadWarning",
        "definitions.define": "define undefine",
        "mechanism.ranges": "between plus_minus",
        "derive.equation": "equation",
    }.items()
    for name in names.split()
}
# Functions that take inputs: a call of a person's is looked at for slips of units, an inner one is not.
WARN_OF_SLIPS = (
    "evaluate", "function", "grid", "peak", "inverse", "enclose", "design_map", "events", "optimize",
    "steady", "tolerance", "harmonics", "counterweight", "drive", "fit", "feasibility", "simulate", "sweep",
    "synthesize", "explore", "crossings", "solve",
)  # fmt: skip
MODULES = {"plot": "desaxe.plot", "status": "desaxe.mechanism.status", "units": "desaxe.units"}

__all__ = [
    "Crankshaft", "LoadWarning", "Machine", "UnitWarning", "between", "compile", "counterweight",
    "crossings", "damper", "define", "design_map", "drive", "enclose", "equation", "evaluate", "events",
    "explain", "explore", "feasibility", "fit", "function", "grid", "harmonics", "inverse", "kloss",
    "optimize", "over_V", "over_Y", "over_omega", "over_stroke", "over_theta", "peak", "plot", "plus_minus",
    "quantities", "scene", "simulate", "solve", "spring", "steady", "sweep", "synthesize", "to_excel",
    "tolerance", "undefine",
]  # fmt: skip

# In a clone derive/ and generated/ stand beside src/; a wheel has them in this folder.
_clone = __file__.replace("\\", "/").rpartition("/src/desaxe/")[0]
if _clone:
    __path__.append(_clone)


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name == "__version__":
        return _version()
    if name in MODULES:
        return _imported(MODULES[name])
    if name not in PUBLIC:
        raise AttributeError(f"module 'desaxe' has no attribute {name!r}")
    with _explained(name):
        value = getattr(_imported(PUBLIC[name]), name)
    if name in WARN_OF_SLIPS:
        value = _imported("desaxe.mechanism.public").warning(value)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*__all__, *MODULES, "__version__"})
