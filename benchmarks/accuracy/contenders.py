"""The contenders: every accuracy of desaxe, and other tools on the textbook's closed form.

All do the same work: NAMES from INPUTS, every input an array, one branch. The closed form is that of
`desaxe.equation`, with common subexpressions shared.
"""

from collections.abc import Callable, Iterable
from importlib import import_module
from importlib.util import find_spec
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from desaxe.evaluation.evaluate import evaluate
from desaxe.runtime.request import ACCURACIES

NAMES = ("V_C", "a_C", "a_C_wrt_ec")
INPUTS = ("theta", "ec", "AB", "BC", "omega0", "alpha")
MPMATH_DIGITS = 50

Array = NDArray[np.float64]
# Rows of inputs, rows to write answers to -> the answers, there or elsewhere.
Run = Callable[[Array, Array], Iterable[Array]]


class Contender(NamedTuple):
    """A way to compute NAMES, made for a branch."""

    name: str
    make: Callable[[int], Run]
    kind: str = "textbook"  # or "desaxe" or "digits"
    few: bool = False  # so slow that few points must do


def contenders() -> list[Contender]:
    """The contenders available here; heyoka only if it is installed."""
    result = [Contender(f"desaxe {tier}", _desaxe(tier), "desaxe") for tier in ACCURACIES]
    result += [Contender("NumPy lambdify", _numpy), Contender("numba", _numba)]
    if find_spec("heyoka") is not None:
        result.append(Contender("heyoka", _heyoka(fast_math=False)))
        result.append(Contender("heyoka fast math", _heyoka(fast_math=True)))
    return [*result, Contender(f"mpmath {MPMATH_DIGITS} digits", _mpmath, "digits", few=True)]


def _textbook() -> Any:
    return import_module("desaxe.derive.textbook")


def _desaxe(tier: str) -> Callable[[int], Run]:
    def make(branch: int) -> Run:
        def run(inputs: Array, outputs: Array) -> Iterable[Array]:
            columns, out = dict(zip(INPUTS, inputs, strict=True)), dict(zip(NAMES, outputs, strict=True))
            evaluate(list(NAMES), **columns, branch=branch, accuracy=tier, threads=1, out=out)
            return outputs

        return run

    return make


def _numpy(branch: int) -> Run:
    plain = _textbook().function(NAMES, branch)

    def run(inputs: Array, _: Array) -> Iterable[Array]:
        with np.errstate(all="ignore"):
            answers: Iterable[Array] = plain(*inputs)
        return answers

    return run


def _numba(branch: int) -> Run:
    from numba import njit

    plain = njit(error_model="numpy")(_textbook().function(NAMES, branch))

    def loop(
        theta: Array, ec: Array, AB: Array, BC: Array, omega0: Array, alpha: Array,
        V_C: Array, a_C: Array, a_C_wrt_ec: Array,
    ) -> None:  # fmt: skip
        for i in range(theta.size):
            V_C[i], a_C[i], a_C_wrt_ec[i] = plain(theta[i], ec[i], AB[i], BC[i], omega0[i], alpha[i])

    compiled = njit(error_model="numpy")(loop)

    def run(inputs: Array, outputs: Array) -> Iterable[Array]:
        compiled(*inputs, *outputs)
        return outputs

    return run


def _heyoka(fast_math: bool) -> Callable[[int], Run]:
    def make(branch: int) -> Run:
        heyoka, textbook = import_module("heyoka"), _textbook()
        variables = [heyoka.expression(name) for name in INPUTS]
        backwards = heyoka.lt(variables[INPUTS.index("omega0")], heyoka.expression(0.0))
        turning = heyoka.select(backwards, heyoka.expression(-1.0), heyoka.expression(1.0))
        forms = [
            heyoka.from_sympy(form, {textbook.TURNING: turning})
            for form in textbook.expressions(NAMES, branch)
        ]
        compiled = heyoka.cfunc(forms, variables, fast_math=fast_math)

        def run(inputs: Array, outputs: Array) -> Iterable[Array]:
            threads = heyoka.get_nthreads()
            heyoka.set_nthreads(1)
            try:
                answers: Array = compiled(inputs, outputs=outputs)
            finally:
                heyoka.set_nthreads(threads)
            return answers

        return run

    return make


def _mpmath(branch: int) -> Run:
    import mpmath

    own = {"copysign": lambda one, x: -one if x < 0 else one}
    plain = _textbook().function(NAMES, branch, [own, "mpmath"])

    def run(inputs: Array, outputs: Array) -> Iterable[Array]:
        with mpmath.workdps(MPMATH_DIGITS):
            for index, column in enumerate(inputs.T.tolist()):
                try:
                    answer = plain(*map(mpmath.mpf, column))
                except ZeroDivisionError:
                    answer = (mpmath.nan,) * len(NAMES)
                outputs[:, index] = [float(x) if mpmath.im(x) == 0 else np.nan for x in answer]
        return outputs

    return run
