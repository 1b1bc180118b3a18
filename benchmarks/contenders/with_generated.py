"""The module of `desaxe.generated` that people import, on one core: the smallest that has the names."""

from collections.abc import Sequence
from importlib import import_module

from ..work import Array, Inputs, Work
from . import Run

GROUPS = ("motion", "sensitivities", "rod", "forces")


def prepare(work: Work, inputs: Inputs, out: Sequence[Array] | None, threads: int) -> Run:
    """Prepare the smallest module that has the names of the work; LookupError where there is none."""
    modules = (import_module(f"desaxe.generated.{group}") for group in GROUPS)
    module = next((m for m in modules if set(work.names) <= m.OUTPUTS.keys()), None)
    if module is None or work.kind in ("peak", "prepared"):
        raise LookupError(f"no generated module has {', '.join(work.names)}")
    shared = dict(zip(work.names, out, strict=True)) if out else {}
    kept = module.evaluate(**inputs.broadcast(), **inputs.scalars) | shared if out else None

    def values() -> Sequence[Array]:
        if work.kind == "grid":
            result = module.grid(**inputs.columns, **inputs.scalars, out=kept)
        else:
            result = module.evaluate(**inputs.broadcast(), **inputs.scalars, out=kept)
        return [result[name] for name in work.names]

    return values
