"""From a request to the loop nest that answers it: keys and their kernels."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from itertools import product
from math import nan, prod
from typing import Any, NamedTuple

from ..compiler.kernel import Kernel
from ..compiler.languages.python import compile_python
from ..compiler.lowering import Limits, guarded_for_loops, guarded_pairs, nest, nest_of_two_forms
from ..compiler.passes.guard import guard_inputs
from ..compiler.passes.trigonometry import Trigonometry
from ..compiler.program import Line, Program
from ..mechanism.constants import constants, double_constants
from ..mechanism.inputs import LEAST, SAFE
from ..mechanism.names import LENGTHS, LOADS
from ..mechanism.program import Variant
from .request import Request, check_angle
from .specialise import plain_form, specialise

# A scalar of 0 for one of these makes whole terms vanish, so it is folded into the kernel.
STRUCTURAL_ZEROS = ("ec", "alpha", *LOADS)
REACH = ("less_rounded", "less_unsure")  # BC - |u|, and what rounding may take from it
NEAR_LIMIT = 4.0  # times that: points of which some may be undecided
SPARE = 2.0  # times what rounding may take: points nearer to the limit are answered again
ASKED_AHEAD = 16  # points for each length: then designs are looked at ahead of the kernel


class KernelKey(NamedTuple):
    """The key of a kernel: outputs, variant, fixed inputs, and the axis of every other input."""

    names: tuple[str, ...]
    form: Variant
    fixed: tuple[tuple[str, float], ...]
    axis_of: tuple[tuple[str, int], ...]
    axes: int
    accuracy: str = "standard"
    far: bool = False  # angles are beyond what the written-out sine and cosine reduce exactly


def key_of(
    requested: Request,
    scalars: Mapping[str, float],
    columns: Mapping[str, Any],
    axis_of: Mapping[str, int],
    axes: int,
    keys: dict[Any, KernelKey] | None = None,
) -> KernelKey:
    """The key of a request whose scalars and columns are known; `keys` are those of the request so far."""
    theta, keys = scalars.get("theta", 0.0), {} if keys is None else keys
    check_angle(requested.accuracy, theta)
    zeros = tuple([n for n, x in scalars.items() if type(x) is float and x == 0.0 and n in STRUCTURAL_ZEROS])
    far, wide = constants().limit < abs(theta), _is_wide(requested, scalars, columns, axis_of)
    kind = tuple(axis_of.items()), axes, zeros, far, wide
    key = keys.get(kind)
    if key is None:
        fixed, form = (*requested.fixed, *((name, 0.0) for name in zeros)), requested.form
        if wide and plain_form(requested.names, form, fixed) is not None:
            form = form._replace(wide_margins=True)
        along = tuple(sorted(axis_of.items()))
        key = keys[kind] = KernelKey(requested.names, form, fixed, along, axes, requested.accuracy, far)
    return key


def _is_wide(
    requested: Request, scalars: Mapping[str, float], columns: Mapping[str, Any], axis_of: Mapping[str, int]
) -> bool:
    """True if all designs have wide margins, and they are so few that testing them in advance pays."""
    lengths = [scalars.get(name) for name in LENGTHS]
    if requested.accuracy == "extended":
        return False
    if None not in lengths:
        return bool(of_numbers(requested.form)(*lengths)[0])
    several = [columns.get(name, scalars.get(name)) for name in LENGTHS]
    if any(length is None for length in several):
        return False
    count = sum(columns[name].size for name in LENGTHS if name in columns)
    points = prod({axis: columns[name].size for name, axis in axis_of.items()}.values())
    return count * ASKED_AHEAD <= points and all_have_wide_margins(requested.form, *several)


def _is_seen(program: Program, angle: str) -> bool:
    """True if an invalid value may reach other lines than sine and cosine, which turn it into NaN."""
    types = {line.name: line.type for line in program.lines}
    message = angle in program.outputs or any(types.get(name) == "i64" for name in program.outputs)
    return message or any(angle in line.args and line.op not in ("sin", "cos") for line in program.lines)


def has_near_limit(key: KernelKey) -> bool:
    """True if the kernel counts undecided points (see `executor.settle`)."""
    return key.accuracy == "standard" and plain_of(key) is not None


def plain_of(key: KernelKey) -> Program | None:
    """The plain form of a key's program, where it has two."""
    return plain_form(key.names, key.form, key.fixed) if key.accuracy != "extended" else None


def kernel_of(key: KernelKey) -> Kernel:
    """The loop nest of a key; the tables of its loads are arguments."""
    under = key.form.under
    tables = () if under is None else (name for load in under.loads for name in load.tables)
    return _loops_of(key)._replace(given=tuple(tables))


def _loops_of(key: KernelKey) -> Kernel:
    program = specialise(key.names, key.form, key.fixed, key.accuracy)
    axes = dict(key.axis_of)
    varying = [name for name in program.inputs if name in axes]
    if key.accuracy == "extended":
        limits = _limits(varying, theta=double_constants().limit)
        return nest(guarded_pairs(program, varying, limits, double_constants()), axes, key.axes)
    if key.form.wide_margins:
        return nest(_lowered_plain(program, varying, key), axes, key.axes)
    stable = counting(key) if has_near_limit(key) else program
    checked = [name for name in varying if name != "theta" or _is_seen(stable, name)]
    stable = guarded_for_loops(stable, checked, _limits(checked), _trigonometry(key))
    plain = plain_of(key)
    if plain is None:
        return nest(stable, axes, key.axes)
    test = wide_margins_test(key.form, key.fixed, varying)
    first = _lowered_plain(plain, varying, key)
    return nest_of_two_forms(first, stable, test, len(key.names), axes, key.axes)


def counting(key: KernelKey) -> Program:
    """The program of a key with one more output, a flag: the point may need a repair.

    It holds for more points than `executor.settle` selects, by whatever the two round differently: then the
    points that are answered again do not depend on which others are in the same call.
    """
    program = specialise((*key.names, *REACH), key.form, key.fixed)
    reach, unsure = REACH
    lines = (
        Line("reach_size", "abs", (reach,)),
        Line("reach_band", "mul", (NEAR_LIMIT, unsure)),
        Line("near_limit", "lt", ("reach_size", "reach_band"), "bool"),
    )
    outputs = *program.outputs[: len(key.names)], "near_limit"
    return program._replace(lines=(*program.lines, *lines), outputs=outputs)


def _limits(varying: Iterable[str], **angle: float) -> Limits:
    """The valid values of inputs: beyond them products overflow, or vanish (see `mechanism.inputs.SAFE`)."""
    least, most = SAFE
    return Limits({**LEAST, "BC": least}, {**{n: most for n in varying if n != "theta"}, **angle})


def _lowered_plain(program: Program, varying: Sequence[str], key: KernelKey) -> Program:
    """Lower the plain form. The wide-margin test implies valid lengths: only other inputs are guarded."""
    own = seen_inputs(program, varying)
    return guarded_for_loops(program, own, _limits(own), _trigonometry(key), plain=True)


def seen_inputs(program: Program, varying: Sequence[str]) -> list[str]:
    """The inputs whose invalid values a plain form must be guarded from."""
    return [name for name in varying if name not in LENGTHS and _is_seen(program, name)]


def _trigonometry(key: KernelKey) -> Trigonometry | None:
    """The coefficients of a kernel's sine and cosine; None if angles exceed their range."""
    return None if key.far else constants()


# ---- wide margins: designs so far from every change point that plain forms do not cancel ---------------


def all_have_wide_margins(form: Variant, ec: Any, AB: Any, BC: Any) -> bool:
    """True if every combination of these lengths (numbers or arrays) has wide margins.

    The test says no more of all of them than of their extremes.
    """
    test = of_numbers(form)
    return all(test(*corner)[0] for corner in product(_extremes(ec), _extremes(AB), _extremes(BC)))


def _extremes(values: Any) -> tuple[float, ...]:
    """The smallest and the largest element; NaN if one is NaN, or there is none."""
    if not getattr(values, "size", 1):
        return (nan,)
    return (values,) if isinstance(values, float) else (float(values.min()), float(values.max()))


@lru_cache(maxsize=1024)
def of_numbers(form: Variant) -> Callable[..., Any]:
    """The test as a function of three numbers."""
    return compile_python(wide_margins_test(form, (), LENGTHS), LENGTHS)


def wide_margins_test(form: Variant, fixed: tuple[tuple[str, float], ...], varying: Sequence[str]) -> Program:
    """The test for wide margins, which fails where BC is invalid; AB and |ec| are less than that."""
    names, form, _ = wide_margins_of(form)
    checked = [name for name in varying if name == "BC"]
    return guard_inputs(specialise(names, form, fixed), checked, *_limits(checked))


def wide_margins_of(form: Variant) -> tuple[tuple[str, ...], Variant, tuple[tuple[str, float], ...]]:
    """The names, variant and fixed inputs of the test."""
    return ("wide_margins",), form._replace(wide_margins=False, under=None), ()
