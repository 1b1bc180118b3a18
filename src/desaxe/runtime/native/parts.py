"""numba's target for the functions of a text: less search and less code for each, one optimisation for all.

By itself numba optimises and translates each function, and again in every one that calls it. For each
operation it tries all that might serve, and where a number of an array is read it makes a view.
"""

import operator
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from llvmlite import ir
from numba.core import errors, types
from numba.core.cgutils import get_item_pointer2, unpack_tuple
from numba.core.codegen import CPUCodeLibrary, JITCPUCodegen
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.cpu import CPUContext
from numba.core.runtime.context import NRTContext
from numba.np.arrayobj import fix_integer_index, load_item, store_item

# numba's passes for closures, comprehensions, generators, literals of the user's, array expressions, and for
# variables of more than one type.
UNUSED = {
    "WithLifting", "InlineClosureLikes", "RewriteDynamicRaises", "MakeFunctionToJitFunction", "LiteralUnroll",
    "LiteralPropagationSubPipelinePass", "FindLiterallyCalls", "InlineInlinables", "InlineOverloads",
    "NopythonRewrites", "DumpParforDiagnostics", "ReconstructSSA", "PreLowerStripPhis",
}  # fmt: skip


class PartTarget:
    """numba's target, but for what is defined here."""

    def __init__(self, target: Any) -> None:
        codegen = _Codegen.__new__(_Codegen)
        vars(codegen).update(vars(target.target_context.codegen()))
        self.options, self.typing_context = target.options, target.typing_context
        self.target_context = target.target_context.subtarget(_internal_codegen=codegen)
        self.target_context.__class__ = _Context
        self.pipeline = _Pipeline


class _Part(CPUCodeLibrary):
    """The code of a function, which is linked once, by `link_parts`, and never called by itself."""

    def _optimize_functions(self, module: Any) -> None: ...

    def finalize(self) -> None:
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        return 0


class _Codegen(JITCPUCodegen):
    _library_class: Any = _Part

    def set_env(self, name: str, env: Any) -> None: ...


class _Pipeline(CompilerBase):
    """numba's passes but for those that look for what no text of ours has."""

    def define_pipelines(self) -> list[Any]:
        every = DefaultPassBuilder.define_nopython_pipeline(self.state)
        every.passes = [one for one in every.passes if one[0].__name__ not in UNUSED]
        every.finalize()
        return [every]


class _Counts(NRTContext):
    """References to memory, without looking for any in the shape of an array."""

    def get_meminfos(self, builder: Any, kind: Any, value: Any) -> Any:
        if isinstance(kind, types.Array):
            return [(kind, self._context.data_model_manager[kind].get(builder, value, "meminfo"))]
        return super().get_meminfos(builder, kind, value)


class _Context(CPUContext):
    @property
    def nrt(self) -> Any:
        return _Counts(self, self.enable_nrt)

    def get_function(self, fn: Any, sig: Any, _firstcall: bool = True) -> Any:
        what = getattr(fn, "typing_key", fn)
        own = self._item(sig) if what in (operator.getitem, operator.setitem) else None
        return own or super().get_function(fn, sig, _firstcall)

    def _item(self, signature: Any) -> Callable[..., Any] | None:
        """Return what reads or writes a number of an array; None for a part of it."""
        array, index = signature.args[:2]
        kinds: Any = index if isinstance(index, types.BaseTuple) else (index,)
        whole = isinstance(array, types.Array) and len(kinds) == array.ndim
        if not whole or not all(isinstance(kind, types.Integer) for kind in kinds):
            return None
        layout, model = array.layout, self.data_model_manager[array]

        def item(builder: Any, values: Any, loc: Any = None) -> Any:
            data, shape, strides = (model.get(builder, values[0], n) for n in ("data", "shape", "strides"))
            lengths = unpack_tuple(builder, shape)
            steps = unpack_tuple(builder, strides) if layout == "A" else ()
            given = unpack_tuple(builder, values[1]) if kinds is index else values[1:2]
            places = [
                i if _is_from_start(i) else fix_integer_index(self, builder, kind, i, length)
                for kind, i, length in zip(kinds, given, lengths, strict=True)
            ]
            place = get_item_pointer2(self, builder, data, lengths, steps, layout, places)
            if len(values) == 2:
                return load_item(self, builder, array, place)
            number = self.cast(builder, values[2], signature.args[2], array.dtype)
            return store_item(self, builder, array, number, place)

        return item


def _is_from_start(index: Any) -> bool:
    """True for a constant that does not count from the end."""
    return isinstance(index, ir.Constant) and isinstance(index.constant, int) and index.constant >= 0


@contextmanager
def searched_once() -> Iterator[None]:
    """Let numba search for the type of a call once for all that are alike; its lock is held."""
    found: dict[Any, Any] = {}
    calls: Any = types.BaseFunction
    search = calls.get_call_type

    def get_call_type(self: Any, context: Any, args: Any, kws: Any) -> Any:
        key = self, tuple(args), tuple(kws.items())
        if key not in found:
            try:
                found[key] = search(self, context, args, kws)
            except errors.TypingError as error:
                found[key] = error
        if isinstance(found[key], Exception):
            raise found[key]
        return found[key]

    calls.get_call_type = get_call_type
    try:
        yield
    finally:
        calls.get_call_type = search


def link_parts(library: Any) -> None:
    """Link everything that a part calls, directly or not, into its module."""
    met, left = {library}, [library]
    while left:
        for other in left.pop()._linking_libraries:
            if other not in met:
                met.add(other)
                part = other.codegen is library.codegen
                module = other._final_module if part else other._get_module_for_linking()
                library._final_module.link_in(module, preserve=not part)
                left += [other] if part else []
