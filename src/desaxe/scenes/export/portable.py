"""A scene as a `Module` that any language can write: numbers folded in, lists and ranges as arguments."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from textwrap import wrap
from types import MappingProxyType
from typing import Any, NamedTuple

from ...compiler.languages.protocol import Forms, Module, Symbol
from ...compiler.passes.double_double import double_double
from ...compiler.passes.guard import guard_inputs
from ...compiler.program import Program, tables_in
from ...loads.lines import lines_of, tables_of, totals_of
from ...loads.load import Load
from ...loads.resolve import plan_of, split
from ...mechanism.catalogue import law_name, quantities, quantity
from ...mechanism.constants import constants, double_constants
from ...mechanism.inputs import INPUTS, LEAST
from ...mechanism.load_lines import Total, TurningSense, with_totals
from ...mechanism.names import LENGTHS, ORDER, sensitivity
from ...mechanism.program import digest
from ...mechanism.status import PointStatus
from ...runtime.request import Request, request
from ...runtime.specialise import plain_form, specialise
from ...support.version import version
from ...support.written import UNSEALED
from ..content import Content
from ..scene import Scene
from ..schema import SceneError
from .axes import own_axes
from .loaded import require_tables
from .motion import has_masses, motion_solver, numbers_of
from .solvers import solvers

Fixed = tuple[tuple[str, float], ...]
ANY = (1.0, 2.0)  # values of an input that stays open

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
    steps: bool = False
    status: bool = False  # whether the status is a result of every module
    lost: Callable[[Content], list[str]] | None = (
        None  # what of a scene is left out, where it is not `left_out`
    )


class PortableRequest(NamedTuple):
    """A request of a scene, its fixed inputs, and its loads that vary with the motion.

    shown   the names whose values are wanted; the request has what their totals are made of, too
    """

    request: Request
    fixed: Fixed
    shown: tuple[str, ...]
    loads: Mapping[str, Load] = MappingProxyType({})
    totals: tuple[Total, ...] = ()
    way: TurningSense = TurningSense(1.0)

    def stable(self, accuracy: str) -> Program:
        """The Program of the shown names that is right everywhere."""
        result = self.program(accuracy)
        assert result is not None
        return result

    def program(self, accuracy: str, plain: bool = False) -> Program | None:
        """The Program of the shown names; `plain` in plain forms, None where these are the stable ones."""
        own = self.request
        program = (plain_form if plain else specialise)(own.names, own.form, self.fixed, accuracy)
        if program is None or not self.loads:
            return program
        names = dict(zip(own.shown, program.outputs, strict=True))
        lines = [lines_of(n, load) for n, load in self.loads.items()]
        return with_totals(program, names, lines, self.totals, self.way)


def module_of(scene: Scene, order: Order, more: Sequence[str] = (), opened: Sequence[str] = ()) -> Module:
    """The module of a scene's outputs; SceneError where it has none.

    more     further results of its Programs, behind the status
    opened   inputs that its Programs take besides those that the scene leaves open
    """
    content = scene.content
    require_outputs(scene)
    loads = split(content.inputs)[1]
    require_tables(scene.name or "scene", loads)
    results = tuple(dict.fromkeys((*content.outputs, *(["status"] if order.status else []))))
    wider = replace(content, inputs={**content.inputs, **dict.fromkeys(opened, ANY)})
    asked = asked_of(wider, (*results, "status", *more))
    fixed, state = asked.fixed, asked.request.form.state
    arguments = [n for n in ORDER if isinstance(content.inputs.get(n), tuple)]
    forms = _forms(asked)
    inputs = tuple(Symbol(n, INPUTS[n].unit, INPUTS[n].meaning) for n in arguments)
    outputs = tuple(Symbol(*quantity(name, state)) for name in results)
    derivatives, values = _derivatives(content, arguments) if order.second_order else ({}, {})
    lost = (order.lost or left_out)(content)
    own = own_axes(content, results)
    given = content.inputs | {n: value for n, value in fixed if n in content.inputs}
    moves = motion_solver(given, content.branch, loads) if order.steps and has_masses(given) else None
    folded = dict(fixed) | (numbers_of(given) if moves else {})
    head = (*heading(scene, order.command), *_facts(content, asked, folded, lost))
    needed = [name for item in asked.loads.items() for name in tables_of(*item)]
    used = {*needed, *(tables_in(moves.solve) if moves else ())}
    every = {name: table for item in loads.items() for name, table in tables_of(*item).items()}
    tables = {n: table.arrays() for n, table in every.items() if n in used}
    message = (derivatives, values, solvers(dict(fixed)), own, moves, tables)
    return Module(order.name, head, inputs, outputs, forms, constants(), *message)


def require_outputs(scene: Scene) -> None:
    """SceneError if the scene has no outputs."""
    if scene.content.outputs:
        return
    peaks = ", ".join(peak.quantity for peak in scene.content.peaks)
    reason = f"; [[peak]] {peaks} is searched for by `desaxe run`" if peaks else ""
    raise SceneError(f"{scene.name or 'scene'}: nothing to compile, give outputs = [...]{reason}")


def left_out(content: Content, reduction: bool = True) -> list[str]:
    """The parts of a scene that a compiled module leaves out, by name."""
    result = [f"[[peak]] {peak.quantity}" for peak in content.peaks]
    if content.reduction is not None and (reduction or content.fused is None):
        result.append(f"[reduce] over {', '.join(content.reduction.axes)}")
    return list(dict.fromkeys(result))


def heading(scene: Scene, command: str) -> tuple[str, ...]:
    """The head comment of a module: its contents, and the command that made it."""
    return (
        f"{scene.title or 'An offset slider-crank'}: {', '.join(scene.content.outputs)}.",
        "",
        f"Generated by `{command}`; write it again instead of editing it.",
        f"desaxe {version()}, derivation {digest()[:16]}, scene {scene.content.digest[:16]}, {UNSEALED}.",
    )


def _facts(
    content: Content, asked: PortableRequest, folded: Mapping[str, float], lost: list[str]
) -> tuple[str, ...]:
    """Accuracy, frame, what is folded in and what is left out."""
    fixed = {n: folded[n] for n in ORDER if n in folded}
    numbers = [f"{n} = {value!r} {INPUTS[n].unit}".removesuffix(" 1") for n, value in fixed.items()]
    tables = [f"{n}, a {load.told().strip('<>')}" for n, load in asked.loads.items()]
    numbers += tables
    branch = dict(asked.fixed)["branch"]
    motion = "A given state" if asked.request.form.state else "Constant alpha"
    lines = [
        f"Accuracy {content.accuracy}; SI units and radians. "
        "Y points along the slider axis towards the slider,",
        f"theta turns from +Y towards +X. {motion}; branch {branch:+.0f}.",
    ]
    lines += [f"Folded in: {', '.join(numbers)}."] if numbers else []
    lines += [f"Not in here (`desaxe run` has it): {', '.join(lost)}."] if lost else []
    return ("", *lines, "", *WITHOUT_VALUE)


def asked_of(content: Content, names: Iterable[str]) -> PortableRequest:
    """The request of a scene for names; an absent input without effect is 0."""
    shown = tuple(dict.fromkeys(names))
    given, loads = split(content.inputs)
    if "omega0" not in given and "omega" not in given:
        given["omega0"] = 0.0  # no requested name needs a speed
    plan = plan_of(shown, loads, "omega" in given, "mu" in given)
    every = tuple(dict.fromkeys((*plan.names, *plan.motion, *plan.of_motion)))
    asked = request(every, {**given, **dict.fromkeys(loads, 1.0)}, content.branch, content.accuracy)
    values = {n: given.get(n, 0.0) for n in asked.inputs if n not in plan.loads}
    fixed = dict(asked.fixed) | {n: value for n, value in values.items() if not isinstance(value, tuple)}
    if not plan.loads:
        return PortableRequest(asked, tuple(fixed.items()), shown)
    totals = totals_of(plan)
    return PortableRequest(asked, tuple(fixed.items()), shown, plan.loads, totals, _way(given))


def _way(inputs: Mapping[str, Any]) -> TurningSense:
    """The speed that tells the way of turning: numbers as they are, open inputs by their names."""
    own = {n: n if isinstance(value, tuple) else value for n, value in inputs.items()}
    if "omega" in own:
        return TurningSense(own["omega"], own.get("alpha", 0.0))
    return TurningSense(own["omega0"])


def _forms(asked: PortableRequest) -> Forms:
    """The Programs of the names, the status among them, in the forms that the accuracy has."""
    kept = asked.request.accuracy
    status = asked.shown.index("status")
    largest = {"theta": double_constants().limit} if kept == "extended" else {}
    stable = asked.stable(kept)
    guarded = guard_inputs(stable, stable.inputs, LEAST, largest)
    if kept == "extended":
        return Forms(status, double_double(guarded, double_constants()), rounded=True)
    plain = asked.program(kept, plain=True)
    if plain is None:
        return Forms(status, guarded)
    test = specialise(("wide_margins",), asked.request.form, asked.fixed, kept)
    # The test implies valid lengths.
    own = [name for name in plain.inputs if name not in LENGTHS]
    bare = guard_inputs(plain, own, LEAST, largest)
    if test.lines[-1].args == (True,):
        return Forms(status, bare)
    return Forms(status, guarded, bare, test) if test.inputs else Forms(status, guarded)


def _derivatives(
    content: Content, arguments: list[str]
) -> tuple[Mapping[str, Mapping[str, str]], Mapping[str, Program]]:
    """Derivatives by name of all outputs, of those in turn, and a Program for each."""
    state = "omega" in content.inputs
    known = quantities()

    def exists(name: str) -> bool:
        if law_name(name) not in known or (state and "omega0" in name):
            return False
        try:
            asked_of(content, (name,))
        except ValueError:  # of second order under a load
            return False
        return True

    result: dict[str, dict[str, str]] = {}
    stack = list(content.outputs)
    while stack:
        name = stack.pop()
        if name not in result:
            by = {p: sensitivity(name, p) for p in arguments if p in ORDER}
            result[name] = {p: each for p, each in by.items() if exists(each)}
            stack += result[name].values()
    values = {}
    for name in result:
        program = asked_of(content, (name,)).stable("standard")
        values[name] = guard_inputs(program, program.inputs, LEAST, {})
    return result, values
