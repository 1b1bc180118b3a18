"""A scene as a `Module` that any language can write: numbers folded in, lists and ranges as arguments."""

import hashlib
from collections.abc import Iterable, Mapping
from math import isinf
from textwrap import wrap
from typing import Any, NamedTuple

from ...compiler.interpret import to_single
from ...compiler.languages.protocol import Forms, Module, Symbol
from ...compiler.passes.double_double import double_double
from ...compiler.passes.guard import guard_inputs
from ...compiler.program import Program
from ...mechanism.catalogue import law_name, quantities, quantity
from ...mechanism.constants import constants, double_constants, single_constants
from ...mechanism.inputs import INPUTS, LEAST
from ...mechanism.names import LENGTHS, ORDER, STATUSES, sensitivity
from ...mechanism.program import digest
from ...mechanism.status import PointStatus
from ...runtime.request import Request, request
from ...runtime.specialise import plain_form, specialise
from ...runtime.written import UNSEALED
from ...support.version import version
from ..content import Content
from ..kernel import own_axes
from ..scene import Scene
from ..schema import SceneError
from .motion import has_masses, motion_solver
from .solvers import solvers

Fixed = tuple[tuple[str, float], ...]


# In the head of every module: what a status means, and which results it leaves alone.
_REASONS = ", ".join(f"{one.value} {one.words}" for one in PointStatus)
WITHOUT_VALUE = (
    "A result that has no value is NaN, and the status says why; a result that does not depend on it keeps",
    "its value: positions where the motion stalls, the motion where forces are bad or have no balance.",
    *wrap(f"Status: {_REASONS}.", 96),
)


class Order(NamedTuple):
    """A request for another language than Python."""

    language: str
    name: str
    command: str
    second_order: bool = False
    freestanding: bool = False
    single: bool = False


def module_of(scene: Scene, order: Order) -> Module:
    """The module of a scene's outputs; SceneError where it has none."""
    content = scene.content
    require_outputs(scene)
    varying = [name for name, value in scene.content.inputs.items() if callable(value)]
    if varying:
        raise SceneError(
            f"{scene.name or 'scene'}: loads.{varying[0]} varies with the motion, which a module in "
            "this language cannot: leave it open as a list of values, and give it at each angle"
        )
    asked, fixed = _asked(content, (*content.outputs, "status"))
    if order.single:
        fixed = _in_single(scene, fixed)
    results = asked.names[: len(content.outputs)]
    state = asked.form.state
    arguments = [n for n in ORDER if isinstance(content.inputs.get(n), tuple)]
    forms = _forms(asked, results, fixed, order)
    inputs = tuple(Symbol(n, INPUTS[n].unit, INPUTS[n].meaning) for n in arguments)
    outputs = tuple(Symbol(*quantity(name, state)) for name in content.outputs)
    derivatives, values = _derivatives(content, arguments) if order.second_order else ({}, {})
    head = (*heading(scene, order.command), *_facts(content, asked, fixed, arguments, order))
    own = own_axes(content, content.outputs)
    given = content.inputs | {n: value for n, value in fixed if n in content.inputs}
    moves = motion_solver(given, content.branch, order.single) if has_masses(given) else None
    told = (derivatives, values, solvers(dict(fixed), order.single), own, moves, order.single)
    turning = single_constants() if order.single else constants()
    return Module(order.name, head, inputs, outputs, forms, turning, *told)


def _in_single(scene: Scene, fixed: Fixed) -> Fixed:
    """The fixed inputs in single precision; SceneError for one beyond it."""
    rounded = {name: to_single(value) for name, value in fixed}
    for name, value in fixed:
        if isinf(rounded[name]) or (rounded[name] == 0.0 != value):
            raise SceneError(
                f"{scene.name or 'scene'}: {name} = {value!r}: in single precision numbers lie between "
                "1.4e-45 and 3.4e38"
            )
    return tuple(rounded.items())


def require_outputs(scene: Scene) -> None:
    """SceneError if the scene has no outputs."""
    if scene.content.outputs:
        return
    peaks = ", ".join(peak.quantity for peak in scene.content.peaks)
    reason = f"; [[peak]] {peaks} is searched for by `desaxe run`" if peaks else ""
    raise SceneError(f"{scene.name or 'scene'}: nothing to compile, give outputs = [...]{reason}")


def left_out(content: Content, reduction: bool = True) -> list[str]:
    """The parts of a scene that a compiled module leaves out, by name."""
    found = [f"[[peak]] {peak.quantity}" for peak in content.peaks]
    if content.reduction is not None and (reduction or content.fused is None):
        found.append(f"[reduce] over {', '.join(content.reduction.axes)}")
    return list(dict.fromkeys(found))


def heading(scene: Scene, command: str) -> tuple[str, ...]:
    """The head comment of a module: its contents, and the command that made it."""
    said = hashlib.sha256(repr(scene.content).encode()).hexdigest()[:16]
    return (
        f"{scene.title or 'An offset slider-crank'}: {', '.join(scene.content.outputs)}.",
        "",
        f"Generated by `{command}`; write it again instead of editing it.",
        f"desaxe {version()}, derivation {digest()[:16]}, scene {said}, {UNSEALED}.",
    )


def _facts(
    content: Content, asked: Request, fixed: Fixed, arguments: Iterable[str], order: Order
) -> tuple[str, ...]:
    """Accuracy, frame, what is folded in and what is left out."""
    numbers = [f"{n} = {value!r} {INPUTS[n].unit}".removesuffix(" 1") for n, value in fixed if n in INPUTS]
    branch = dict(fixed)["branch"]
    lines = [
        f"Accuracy {content.accuracy}; SI units and radians. "
        "Y points along the slider axis towards the slider,",
        f"theta turns from +Y towards +X. {'A given state' if asked.form.state else 'Constant alpha'}; "
        f"branch {branch:+.0f}.",
    ]
    if order.single:
        lines.append("Single precision: inputs are rounded to float, values are those of the rounded inputs.")
    if order.freestanding:
        lines.append(
            f"Without libm: |theta| is at most {_reach(asked, order):.0f} rad, else the status is 4."
        )
    lines += [f"Folded in: {', '.join(numbers)}."] if numbers else []
    lost = left_out(content)
    lines += [f"Not in here (`desaxe run` has it): {', '.join(lost)}."] if lost else []
    return ("", *lines, "", *WITHOUT_VALUE)


def _reach(asked: Request, order: Order) -> float:
    if order.single:
        return single_constants().limit
    return double_constants().limit if asked.accuracy == "extended" else constants().limit


def _asked(content: Content, names: Iterable[str]) -> tuple[Request, Fixed]:
    """The request of a scene, and its fixed inputs; an absent input without effect is 0."""
    given: dict[str, Any] = dict(content.inputs)
    if "omega0" not in given and "omega" not in given:
        given["omega0"] = 0.0  # no requested name needs a speed
    asked = request(list(dict.fromkeys(names)), given, content.branch, content.accuracy)
    values = {n: given.get(n, 0.0) for n in asked.inputs}
    fixed = dict(asked.fixed) | {n: value for n, value in values.items() if not isinstance(value, tuple)}
    return asked, tuple(fixed.items())


def _forms(asked: Request, names: tuple[str, ...], fixed: Fixed, order: Order) -> Forms:
    """The Programs of these names and of the status, in the forms that the accuracy has."""
    names = tuple(dict.fromkeys((*names, _status_of(asked))))
    status = names.index(_status_of(asked))
    bounded = order.freestanding or asked.accuracy == "extended"
    largest = {"theta": _reach(asked, order)} if bounded else {}
    accuracy = "single" if order.single else "standard"
    if asked.accuracy == "extended":
        program = specialise(names, asked.form, fixed, "extended")
        guarded = guard_inputs(program, program.inputs, LEAST, largest)
        return Forms(status, double_double(guarded, double_constants()))
    stable = specialise(names, asked.form, fixed, accuracy)
    plain = plain_form(names, asked.form, fixed, accuracy)
    forms = Forms(status, guard_inputs(stable, stable.inputs, LEAST, largest))
    if plain is None:
        return forms
    test = specialise(("wide_margins",), asked.form, fixed, accuracy)
    # The test implies valid lengths.
    own = [name for name in plain.inputs if name not in LENGTHS]
    guarded = guard_inputs(plain, own, LEAST, largest)
    if test.lines[-1].args == (True,):
        return Forms(status, guarded)
    return forms._replace(plain=guarded, test=test) if test.inputs else forms


def _status_of(asked: Request) -> str:
    return next(name for name in asked.names if name in STATUSES)


def _derivatives(
    content: Content, arguments: list[str]
) -> tuple[Mapping[str, Mapping[str, str]], Mapping[str, Program]]:
    """Derivatives by name of all outputs, of those in turn, and a Program for each."""
    state = "omega" in content.inputs
    known = quantities()

    def exists(name: str) -> bool:
        return law_name(name) in known and not (state and "omega0" in name)

    found: dict[str, dict[str, str]] = {}
    stack = list(content.outputs)
    while stack:
        name = stack.pop()
        if name not in found:
            by = {p: sensitivity(name, p) for p in arguments if p in ORDER}
            found[name] = {p: each for p, each in by.items() if exists(each)}
            stack += found[name].values()
    values = {}
    for name in found:
        asked, fixed = _asked(content, (name,))
        program = specialise(asked.names, asked.form, fixed)
        values[name] = guard_inputs(program, program.inputs, LEAST, {})
    return found, values
