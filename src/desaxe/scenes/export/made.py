"""The Programs and loop nests that a module of numba is made of: of numbers alone, or under loads.

Under loads a Program looks its forces up, and its derivatives are total ones (`mechanism/load_lines`).
"""

from typing import NamedTuple

from ...compiler.kernel import Kernel
from ...compiler.lowering import Limits, guarded_for_loops, guarded_pairs, nest, nest_of_two_forms
from ...compiler.passes.double_double import double_double
from ...compiler.passes.guard import guard_inputs
from ...compiler.program import Program
from ...mechanism.constants import constants, double_constants
from ...mechanism.inputs import LEAST
from ...mechanism.names import LENGTHS
from ...runtime.kernels import KernelKey, kernel_of
from ...runtime.specialise import specialise
from ..content import Content
from .portable import PortableRequest, asked_of


class Made(NamedTuple):
    """A request of a scene as Programs and loop nests."""

    content: Content
    asked: PortableRequest

    def guarded(self, key: KernelKey, names: tuple[str, ...]) -> Program:
        """The program of names of a point, which says what of its inputs is bad, as array kernels do."""
        asked = self.asked if names == self.asked.shown else asked_of(self.content, names)
        return _guarded(asked.stable(key.accuracy), key)

    def kernel(self, key: KernelKey) -> Kernel:
        """The loop nest of a key."""
        if not self.asked.loads:
            return kernel_of(key._replace(names=self.asked.request.names))
        stable, axes = self.asked.stable(key.accuracy), dict(key.axis_of)
        varying = [name for name in stable.inputs if name in axes]
        if key.accuracy == "extended":
            limits = Limits(LEAST, {"theta": limit_of(key)})
            pairs = guarded_pairs(stable, varying, limits, double_constants())
            return nest(pairs, axes, key.axes)
        turning = None if key.far else constants()
        whole = guarded_for_loops(stable, varying, Limits(LEAST), turning)
        plain = self.asked.program(key.accuracy, plain=True)
        if plain is None:
            return nest(whole, axes, key.axes)
        test = specialise(("wide_margins",), self.asked.request.form, self.asked.fixed)
        own = [name for name in varying if name not in LENGTHS]  # the test implies valid lengths
        first = guarded_for_loops(plain, own, Limits(LEAST), turning, plain=True)
        return nest_of_two_forms(first, whole, test, len(self.asked.shown), axes, key.axes)


def limit_of(key: KernelKey) -> float:
    """The largest angle that the written-out sine and cosine reduce exactly."""
    return double_constants().limit if key.accuracy == "extended" else constants().limit


def _guarded(program: Program, key: KernelKey) -> Program:
    if key.accuracy != "extended":
        return guard_inputs(program, program.inputs, LEAST, {})
    far = {"theta": limit_of(key)}
    return double_double(guard_inputs(program, program.inputs, LEAST, far), double_constants())
