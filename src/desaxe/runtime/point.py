"""Single points in plain Python: a function of floats for the requested names, nothing compiled."""

from collections.abc import Callable, Mapping
from functools import cache, lru_cache
from typing import Any, NamedTuple

from ..compiler.forms import in_two_forms
from ..compiler.languages.python import compile_python
from ..compiler.program import tables_in
from ..mechanism.constants import double_constants
from ..mechanism.own_lines import not_extended
from ..mechanism.program import Variant
from ..support.forks import IMPORTS
from .request import check_angle
from .specialise import plain_form, specialise

Function = Callable[..., tuple[Any, ...]]


class PointFunction(NamedTuple):
    """A request ready for single points: its function and the inputs that it takes, in order."""

    function: Function
    inputs: tuple[str, ...]

    def run(self, values: Mapping[str, Any]) -> tuple[Any, ...]:
        """The outputs at one point."""
        return self.function(*[values[name] for name in self.inputs])


@lru_cache(maxsize=1024)
def point_of(
    names: tuple[str, ...], form: Variant, fixed: tuple[tuple[str, float], ...], accuracy: str = "standard"
) -> PointFunction:
    """The function of a request at single points, with its inputs in order: tables of loads are the last."""
    program = specialise(names, form, fixed, accuracy)
    inputs = *program.inputs, *(f"{table}_{end}" for table in tables_in(program) for end in "xc")
    if accuracy != "extended":
        return PointFunction(_by_margin(names, form, fixed, inputs), inputs)
    with IMPORTS:
        from ..compiler.passes.double_double import double_double

    function = compile_python(double_double(program, double_constants()), inputs)
    if "theta" not in program.inputs:
        return PointFunction(function, inputs)
    index = program.inputs.index("theta")

    def checked(*values: float) -> tuple[Any, ...]:
        check_angle(accuracy, values[index])
        return function(*values)

    return PointFunction(checked, inputs)


def _by_margin(
    names: tuple[str, ...], form: Variant, fixed: tuple[tuple[str, float], ...], inputs: tuple[str, ...]
) -> Function:
    """A function that picks the plain or the stable form for each point.

    That is the plain form in a design with wide margins, the stable one elsewhere, and twice the digits where
    rounding decides whether the rod reaches. The latter two are made when the first point needs them.
    """
    plain, stable = plain_form(names, form, fixed), specialise(names, form, fixed)
    if plain is None:
        return compile_python(stable, inputs)
    test = specialise(("wide_margins",), form._replace(under=None), fixed)
    first = compile_python(in_two_forms(plain, plain._replace(lines=(), outputs=()), test), inputs)
    second = cache(lambda: compile_python(specialise((*names, "undecided"), form, fixed), inputs))
    third = cache(lambda: point_of(names, form, fixed, "extended"))

    def function(*values: float) -> tuple[Any, ...]:
        answers = first(*values)
        if not answers[-1]:
            answers = second()(*values)
            if answers[-1]:
                given = dict(zip(inputs, values, strict=True))
                if abs(given["theta"]) <= double_constants().limit and not not_extended(form.own):
                    return third().run(given)
        return answers[:-1]

    return function
