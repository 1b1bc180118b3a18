"""The savings of a scene: fixed inputs, vanished lines, and operations saved by each pass."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Any, NamedTuple

from ...compiler.cost import cost_of
from ...compiler.passes.pipeline import optimise_in_steps
from ...mechanism.inputs import INPUTS
from ...mechanism.program import program_of, whole_program
from ...runtime.kernels import KernelKey
from ...runtime.request import Request
from ...runtime.specialise import specialise


class LoweringStep(NamedTuple):
    """A pass: operations at each point after it, and what it saved (below 0: what it added)."""

    name: str
    what: str
    operations: int
    saved: int


class Skipped(NamedTuple):
    """A skipped part: its name, the reason, and the operations saved at each point."""

    what: str
    why: str
    saved: int


WHAT = {
    "slice": "only the lines that the requested names need",
    "fold": "fixed inputs folded in; terms with a factor 0 vanish",
    "number": "what is computed twice is computed once",
    "unused": "lines that nothing needs any more",
    "keep": "NaN is kept where the mechanism cannot be assembled",
    "plain": "every design has wide margins: shorter forms",
    "write out": "sine, cosine and checks as arithmetic: loops vectorise",
}


def steps_of(key: KernelKey, request: Request, inside: int) -> list[LoweringStep]:
    """From the whole derivation to the kernel, in operations at each point; `inside` is the kernel's."""
    fixed = key.fixed
    whole = len(whole_program().lines)
    program = program_of(request.names, request.form)
    _, costs = optimise_in_steps(program, dict(fixed))
    counts = [("derivation", whole), ("slice", costs[0].cost.operations)]
    names = {"fold": "fold", "number": "number", "slice": "unused"}
    counts += [(names.get(step.name, step.name), step.cost.operations) for step in costs[1:]]
    counts.append(("keep", cost_of(specialise(request.names, request.form, fixed)).operations))
    if key.form.wide_margins:
        counts.append(("plain", cost_of(specialise(key.names, key.form, fixed)).operations))
    if inside != counts[-1][1]:
        counts.append(("write out", inside))
    steps = [LoweringStep("derivation", "every line of the derivation", whole, 0)]
    for (_, before), (name, after) in pairwise(counts):
        if before != after or name in ("slice", "fold"):
            steps.append(LoweringStep(name, WHAT.get(name, f"the pass {name}"), after, before - after))
    return steps


def skipped_of(key: KernelKey, request: Request, given: Mapping[str, Any]) -> list[Skipped]:
    """Skipped lines, and what each fixed input saves on its own."""
    fixed = key.fixed
    least = _operations(key, fixed)
    found = []
    absent = [name for name, value in fixed if name not in given and name in INPUTS and name != "alpha"]
    groups: list[tuple[tuple[str, ...], str, str]] = []
    for name, value in fixed:
        if name == "branch":
            groups.append(((name,), f"branch = {value:+.0f}", "one way to assemble it: no sign at run time"))
        elif name == "alpha":
            why = "constant speed: the law of the crank and the test whether it stalls vanish"
            groups.append(((name,), "alpha = 0", why))
        elif name == "ec":
            groups.append(((name,), "ec = 0", "concentric: the slider's axis meets the crank's centre"))
        elif name not in absent:
            groups.append(((name,), f"{name} = 0", _without(name)))
    for names, what, why in groups:
        free = tuple(pair for pair in fixed if pair[0] not in names)
        found.append(Skipped(what, why, _operations(key, free) - least))
    if absent:
        free = tuple(pair for pair in fixed if pair[0] not in absent)
        what = ", ".join(absent) + " = 0"
        found.append(Skipped(what, "not given: their terms vanish", _operations(key, free) - least))
    for name in request.form.default_centres:
        length = "AB" if name == "r_crank" else "BC"
        found.append(Skipped(name, f"not given: half of {length}, moving with it", 0))
    useless = [n for n in given if n in INPUTS and n not in request.inputs and n not in dict(fixed)]
    return found + [Skipped(n, "given, but no requested name depends on it", 0) for n in useless]


def _without(name: str) -> str:
    meanings = {"m_crank": "a massless crank", "m_rod": "a massless rod", "m_slider": "a massless slider"}
    return meanings.get(name, f"no {INPUTS[name].meaning}") + ": its terms vanish"


def _operations(key: KernelKey, fixed: tuple[tuple[str, float], ...]) -> int:
    return cost_of(specialise(key.names, key.form, fixed)).operations
