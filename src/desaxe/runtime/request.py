"""The check of a request: names, inputs, accuracy, once, with errors that name the wrong one."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, lru_cache, wraps
from typing import Any, NamedTuple, ParamSpec, TypeVar

from ..mechanism.catalogue import law_name, of_design, quantity
from ..mechanism.constants import double_constants
from ..mechanism.inputs import INPUTS
from ..mechanism.keywords import keywords_of, unknown_input
from ..mechanism.messages import amount, named
from ..mechanism.names import CENTRES, FORCE_STATUS, LENGTHS, LOADS, STATUS, STATUSES, TURN_STATUS, parts
from ..mechanism.own import Definition, Register, register, used_by
from ..mechanism.own_lines import not_extended
from ..mechanism.program import Variant, program_of
from ..mechanism.read import is_numpy_number, number_of
from ..support.forks import IMPORTS
from ..support.shown import shown
from .specialise import specialise

P = ParamSpec("P")
T = TypeVar("T")


ACCURACIES = ("standard", "extended")
# Accuracy -> the error that it keeps everywhere; the cheaper one first.
BOUNDS = {"standard": 8 * 2.0**-52, "extended": 2 * 2.0**-52}
OF_NO_EFFECT = (*LOADS, *LENGTHS, "branch")


class MachineSpeed(float):
    """A speed or acceleration of a Machine, which functions without that input ignore."""

    __slots__ = ()


class Request(NamedTuple):
    """A checked request: names as the user wrote them, names of the Program, its variant, fixed inputs."""

    shown: tuple[str, ...]
    names: tuple[str, ...]
    form: Variant
    fixed: tuple[tuple[str, float], ...]
    accuracy: str = "standard"

    @property
    def inputs(self) -> tuple[str, ...]:
        """The inputs that it needs."""
        return _inputs(self.names, self.form, self.fixed)

    @property
    def key(self) -> tuple[tuple[str, ...], Variant, tuple[tuple[str, float], ...], str]:
        """The key of its Program."""
        return self[1:]


@lru_cache(maxsize=1024)
def _inputs(names: tuple[str, ...], form: Variant, fixed: tuple[tuple[str, float], ...]) -> tuple[str, ...]:
    return specialise(names, form, fixed).inputs


def check_common(given: Mapping[str, Any], branch: Any, threads: int | None = None) -> None:
    """Reject omega together with omega0, a branch other than 1 or -1, and threads < 1."""
    if given.get("omega") is not None and given.get("omega0") is not None:
        raise ValueError("give omega0= (the law) or omega= (a state), not both")
    number = isinstance(branch, (int, float)) or is_numpy_number(branch)
    if isinstance(branch, bool) or not number or branch not in (1, -1):
        raise ValueError(f"branch = {shown(branch)}: it is +1 or -1")
    if threads is not None and (isinstance(threads, bool) or not isinstance(threads, int) or threads < 1):
        raise ValueError(f"threads = {shown(threads)}: a whole number, at least 1")


def request(
    names: Iterable[str],
    given: Mapping[str, Any],
    branch: Any,
    accuracy: Any,
    known: Register | None = None,
) -> Request:
    """Check a request. Absent inputs whose default has no effect are fixed and folded away.

    known   the definitions that names have; those of this process at this moment without
    """
    if not names:
        raise ValueError(f"names = {names!r}: name at least one quantity, such as 'a_C'")
    check_common(given, branch)
    names = tuple(names)
    for name in names:
        if not isinstance(name, str):
            raise TypeError(f"the name of a quantity is a str, got {shown(name)}")
    present = frozenset(name for name, value in given.items() if value is not None)
    sort = float(branch), accuracy_of(accuracy), known or register()
    return _request(names, present, is_steady(given.get("alpha")), *sort)


@lru_cache(maxsize=1024)
def _request(
    shown: tuple[str, ...],
    present: frozenset[str],
    steady: bool,
    branch: float,
    accuracy: str,
    known: Register,
) -> Request:
    """The request of names where these inputs are present; `steady`: alpha is a plain 0, if it is."""
    state = "omega" in present
    for name in shown:
        quantity(name, state, known)
    own = tuple(law_name(name) if state else name for name in shown)
    others = [name for name in own if name != STATUS]
    if others != list(own) and "theta" not in present and all(of_design(n, known) for n in others):
        own = tuple(TURN_STATUS if name == STATUS else name for name in own)
    defined = used_by(own, known)
    law = Variant(own=defined)
    inputs = program_of(own, law).inputs
    if STATUS in own and ("mu" in inputs or "mu" in present):
        own = tuple(FORCE_STATUS if name == STATUS else name for name in own)
        inputs = program_of(own, law).inputs
    absent = [name for name in inputs if name in LOADS and name not in present]
    zeros = [(name, 0.0) for name in absent if name not in CENTRES]
    if "alpha" in inputs and steady:
        zeros.append(("alpha", 0.0))
    default_centres = tuple(name for name in CENTRES if name not in present and _moves(name, own, defined))
    if accuracy == "extended":
        check_extended(defined)
    variant = Variant(state, default_centres, own=defined)
    if "omega0" in inputs and not state and "omega0" not in present:
        moving = tuple(name for name in own if name not in STATUSES and not of_design(name, known))
        if not moving or "omega0" not in specialise(moving, variant, (("branch", branch), *zeros)).inputs:
            zeros.append(("omega0", 0.0))
    return Request(shown, own, variant, (("branch", branch), *zeros), accuracy)


def needs_no_speed(names: Iterable[str], known: Register | None = None) -> bool:
    """True if quantities of the whole design alone depend on the speed: on its sign, forwards by default."""
    moving = tuple(name for name in names if name not in STATUSES and not of_design(name, known))
    return "omega0" not in program_of(moving, Variant(own=used_by(moving, known))).inputs


def check_extended(own: tuple[Definition, ...]) -> None:
    """Reject `accuracy="extended"` for operations without double-double."""
    problem = not_extended(own)
    if problem is not None:
        raise ValueError(f"accuracy='extended' is not available for {problem[0]}: it uses {problem[1]}")


@lru_cache(maxsize=1024)
def _moves(centre: str, names: tuple[str, ...], own: tuple[Definition, ...]) -> bool:
    """True if these names depend on a centre of mass or on how it moves with the length of its link."""
    program = program_of(names, Variant(own=own))
    lines = (line.name for line in program.lines)
    return centre in program.inputs or any(parts(name)[0] == centre for name in lines)


def check_sliders(sliders: Any) -> None:
    """TypeError for what is not the `sliders` of a crankshaft; None is no crankshaft."""
    if not (sliders is None or hasattr(sliders, "members")):
        raise TypeError(f"sliders = {shown(sliders)}: those of a desaxe.Crankshaft are expected")


def is_steady(alpha: Any) -> bool:
    """True if alpha is absent or a plain 0."""
    return alpha is None or (type(alpha) is float and alpha == 0.0)


def with_known_inputs(function: Callable[P, T]) -> Callable[P, T]:
    """Decorate a function to refuse unknown inputs as `check_inputs` does.

    Masses and loads that have no effect on it are let through, and so are the speeds of a machine:
    `**machine` works everywhere. A motion starts at the speed of the machine unless `omega_start` is given.
    """
    known = cache(lambda: keywords_of(function))

    @wraps(function)
    def checked(*args: P.args, **inputs: P.kwargs) -> T:
        own: Any = {name: value for name, value in inputs.items() if name in known()}
        for name in (name for name in inputs if name not in own):
            if not (name in OF_NO_EFFECT or isinstance(inputs[name], MachineSpeed)):
                raise unknown_input(function.__name__, name, known())
        speed = inputs.get("omega0", inputs.get("omega"))
        if speed is not None and "omega_start" in known():
            own.setdefault("omega_start", speed)
        return function(*args, **own)

    return checked


def with_named_inputs(function: Callable[P, T]) -> Callable[P, T]:
    """Decorate a function of names to have every input in its signature; `**inputs` keeps their order."""
    with IMPORTS:
        from inspect import Parameter, signature

    given = signature(function)
    names, *options = [p for p in given.parameters.values() if p.kind is not Parameter.VAR_KEYWORD]
    inputs = [Parameter(name, Parameter.KEYWORD_ONLY, default=None, annotation=Any) for name in INPUTS]
    function.__dict__["__signature__"] = given.replace(parameters=[names, *inputs, *options])
    return function


def several(names: Any) -> tuple[str, ...]:
    """The names of an iterable, without duplicates."""
    try:
        return tuple(dict.fromkeys(names))
    except TypeError:
        raise TypeError(
            f"names = {shown(names)}: expected the name of a quantity or a list of names"
        ) from None


def as_number(name: str, value: Any, inputs: Sequence[str], names: Sequence[str]) -> float | None:
    """The input as a float, None if it is an array; an error that names it if it is bad or missing."""
    if value is None:
        raise TypeError(f"{', '.join(names)}: {name} is missing (needed: {', '.join(inputs)})")
    return number_of(INPUTS[name], value)


def accuracy_of(asked: Any) -> str:
    """The accuracy of this name, or the cheapest one that keeps a given error everywhere."""
    if isinstance(asked, str) and asked in ACCURACIES:
        return asked
    if not isinstance(asked, (int, float)) or isinstance(asked, bool):
        known = ", ".join(ACCURACIES)
        raise ValueError(f"accuracy = {shown(asked)}: it is one of {known}, or an error such as 1e-9")
    kept = next((name for name, bound in BOUNDS.items() if bound <= asked), "")
    if not kept:
        raise ValueError(f"accuracy = {shown(asked)}: the smallest error is {BOUNDS['extended']:.2g}")
    return kept


def check_angle(accuracy: str, theta: float) -> None:
    """Refuse an angle that the accuracy cannot reduce exactly."""
    if accuracy == "extended" and abs(theta) > double_constants().limit:
        reach = amount("theta", double_constants().limit, ".0f", says_unit=True)
        raise ValueError(named("theta", theta) + ": accuracy='extended' reaches |theta| <= " + reach)
