"""Single points in plain Python: a function of floats, cut to what is asked for, nothing compiled."""

from collections.abc import Callable, Mapping
from functools import cache, lru_cache
from typing import Any, NamedTuple

from ._accuracy import check_angle
from ._constants import double_constants
from ._program import Form, program_of
from .compiler.emit_python import compile_python
from .compiler.forms import in_two_forms
from .compiler.passes.pipeline import optimise
from .compiler.passes.slicing import keep_outputs
from .compiler.program import Line, Program, names_in, renamed

# What an output may lose when inputs are fixed -> the line that is 0 where there is such a thing, else NaN.
KEPT = {"D": "no_effect_on_rod", "omega2_law": "not_stalled"}


Function = Callable[..., tuple[Any, ...]]


class Point(NamedTuple):
    """A request ready for single points: its function and the inputs that it takes, in order."""

    function: Function
    inputs: tuple[str, ...]

    def run(self, values: Mapping[str, float]) -> tuple[Any, ...]:
        """The outputs at one point."""
        return self.function(*(values[name] for name in self.inputs))


@lru_cache(maxsize=1024)
def cut(
    names: tuple[str, ...], form: Form, fixed: tuple[tuple[str, float], ...], accuracy: str = "standard"
) -> Program:
    """The program of these names with some inputs fixed, after all passes.

    A value that loses what it depended on (V_C by alpha for a given state, the torque of a massless
    rod) is still NaN where the mechanism cannot be assembled, or has stalled.
    """
    program = _finer(program_of(names, form), accuracy)
    result = optimise(program, dict(fixed))[0]
    before, after = _needs(program), _needs(result)
    kept = {"D"} if dict(fixed).get("alpha") == 0.0 else set(KEPT)  # a crank at constant speed never stalls
    lost = {name: (before[name] & kept) - after[name] for name in names}
    if not any(lost.values()):
        return result
    wide = _finer(program_of((*names, *KEPT.values()), form), accuracy)
    wide = renamed(wide, {name: f"{name}_alone" for name in names if lost[name]})
    lines = list(wide.lines)
    for name in names:
        value = f"{name}_alone"
        for need in sorted(lost[name]):
            lines.append(Line(f"{value}_{need}", "add", (value, KEPT[need])))
            value = lines[-1].name
        if lost[name]:
            lines.append(Line(name, "copy", (value,)))
    return optimise(keep_outputs(wide._replace(lines=tuple(lines)), names), dict(fixed))[0]


@lru_cache(maxsize=1024)
def plain_form(names: tuple[str, ...], form: Form, fixed: tuple[tuple[str, float], ...]) -> Program | None:
    """The program in plain forms, for roomy designs; None where it is no other than `cut` gives."""
    plain = cut(names, form._replace(roomy=True), fixed)
    same = repr(plain.lines) == repr(cut(names, form, fixed).lines)  # by their text: NaN is NaN there
    return None if same else plain


def _finer(program: Program, accuracy: str) -> Program:
    if accuracy != "extended":
        return program
    from .compiler.passes.double_double import with_finer_forms

    return with_finer_forms(program)


def _needs(program: Program) -> dict[str, frozenset[str]]:
    """Which of the names in KEPT each line depends on."""
    needs: dict[str, frozenset[str]] = dict.fromkeys(program.inputs, frozenset())
    for line in program.lines:
        own = frozenset({line.name} & set(KEPT))
        needs[line.name] = own.union(*(needs[name] for name in names_in(line.args)))
    return needs


@lru_cache(maxsize=1024)
def point_of(
    names: tuple[str, ...], form: Form, fixed: tuple[tuple[str, float], ...], accuracy: str = "standard"
) -> Point:
    """The function that computes them."""
    program = cut(names, form, fixed, accuracy)
    if accuracy != "extended":
        return Point(_by_room(names, form, fixed), program.inputs)
    from .compiler.passes.double_double import double_digits

    program = double_digits(program, double_constants())
    function = compile_python(program)
    if "theta" not in program.inputs:
        return Point(function, program.inputs)
    place = program.inputs.index("theta")

    def checked(*values: float) -> tuple[Any, ...]:
        check_angle(accuracy, values[place])
        return function(*values)

    return Point(checked, program.inputs)


def _by_room(names: tuple[str, ...], form: Form, fixed: tuple[tuple[str, float], ...]) -> Function:
    """The function that goes by what a point needs.

    That is the plain form in a roomy design, the stable one elsewhere, and twice the digits where
    rounding decides whether the rod reaches. The latter two are made when the first point needs them.
    """
    plain, stable = plain_form(names, form, fixed), cut(names, form, fixed)
    if plain is None:
        return compile_python(stable)
    inputs = stable.inputs
    tested = in_two_forms(plain, plain._replace(lines=(), outputs=()), cut(("roomy",), form, fixed))
    first = compile_python(tested._replace(inputs=inputs))
    second = cache(lambda: compile_python(cut((*names, "undecided"), form, fixed)._replace(inputs=inputs)))
    third = cache(lambda: point_of(names, form, fixed, "extended"))

    def function(*values: float) -> tuple[Any, ...]:
        answers = first(*values)
        if not answers[-1]:
            answers = second()(*values)
            if answers[-1]:
                given = dict(zip(inputs, values, strict=True))
                if abs(given["theta"]) <= double_constants().limit:
                    return third().run(given)
        return answers[:-1]

    return function
