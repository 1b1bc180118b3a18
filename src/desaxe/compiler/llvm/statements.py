"""One Python function as LLVM's text: its statements (see `loops`)."""

import ast
from collections.abc import Sequence
from types import FunctionType
from typing import Any

from .expressions import Array, Expressions, Kind, LoopValue, Tuple, joined, parts_of
from .ir import WIDE

SHORT = 50  # instructions: longer functions are not inlined, which would make LLVM slow


class LoopFunction(Expressions):
    """The text of a function for some types of its arguments; variables keep the types known so far."""

    def __init__(
        self,
        module: Any,
        function: FunctionType,
        tree: ast.FunctionDef,
        kinds: Sequence[Kind],
        variables: dict[str, Kind],
    ) -> None:
        super().__init__(module, function, variables)
        self.tree, self.kinds = tree, kinds
        self._loops: list[tuple[str, str]] = []  # where `continue` and `break` go

    def text(self, symbol: str) -> str:
        """The function."""
        apart = any(isinstance(n, ast.Name) and n.id == "apart" for n in ast.walk(self.tree))
        parameters = []
        for argument, kind in zip(self.tree.args.args, self.kinds, strict=True):
            value = LoopValue(kind, tuple(f"%arg.{argument.arg}.{k}" for k in range(len(parts_of(kind)))))
            parameters += [
                f"{part}{' noalias' * (apart and part == 'ptr')} {name}"
                for part, name in zip(parts_of(kind), value.parts, strict=True)
            ]
            self.assign(argument.arg, value)
        self.variables.setdefault("return", "none")
        self.block(self.tree.body)
        result = LoopValue.llvm(self.variables["return"])
        self.do("ret void" if result == "void" else f"ret {result} zeroinitializer")
        inlined = "noinline " * (len(self.rows) > SHORT)
        head = f"define internal {result} @{symbol}({', '.join(parameters)}) {inlined}{WIDE} {{"
        return "\n".join([head, *self.allocas, *self.rows, "}"])

    def block(self, statements: Sequence[ast.stmt]) -> None:
        """Statements in their order."""
        for statement in statements:
            getattr(self, f"_do_{type(statement).__name__}", self.unknown)(statement)

    def _do_Expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):
            self.value(node.value)

    def _do_Pass(self, node: ast.Pass) -> None:
        pass

    def _do_Assign(self, node: ast.Assign) -> None:
        value = self.value(node.value)
        for target in node.targets:
            self.put(target, value)

    def _do_AnnAssign(self, node: ast.AnnAssign) -> None:
        assert node.value is not None
        self.put(node.target, self.value(node.value))

    def _do_AugAssign(self, node: ast.AugAssign) -> None:
        self.put(node.target, self.binary(node, self.value(node.target), self.value(node.value)))

    def put(self, target: ast.expr, value: LoopValue) -> None:
        """Assign to a name, to names, or to elements of an array."""
        if isinstance(target, ast.Name):
            self.assign(target.id, value)
        elif isinstance(target, ast.Tuple):
            for one, part in zip(target.elts, value.items(), strict=True):
                self.put(one, part)
        else:
            assert isinstance(target, ast.Subscript)
            place = self.element(target)
            if isinstance(place.kind, Array):
                self.fill(place, value)
            else:
                self.store(place, value)

    def fill(self, array: LoopValue, value: LoopValue) -> None:
        """Every element of an array."""
        pointer, count, *lengths = array.parts
        assert isinstance(array.kind, Array)
        for length in lengths:
            count = self.emit(f"mul nsw i64 {count}, {length}")
        index = self.counted("0", count, "1")
        self.store(self.pointed(array.kind.item, pointer, index), value)
        self.end_loop()

    def _do_Return(self, node: ast.Return) -> None:
        kind = self.variables["return"]
        if node.value is not None:
            value = self.value(node.value)
            kind = value.kind if kind == "none" else joined(kind, value.kind)
            self.variables["return"] = kind
            value, whole = self.converted(value, kind), "poison"
            if isinstance(kind, Tuple):
                for k, (part, text) in enumerate(zip(parts_of(kind), value.parts, strict=True)):
                    whole = self.emit(f"insertvalue {LoopValue.llvm(kind)} {whole}, {part} {text}, {k}")
            else:
                whole = value.parts[0]
            self.do(f"ret {LoopValue.llvm(kind)} {whole}")
        else:
            self.do("ret void")
        self.label(self.new("dead"))

    def _do_If(self, node: ast.If) -> None:
        then, other, end = (self.new(name) for name in ("then", "else", "end"))
        self.branch(node.test, then, other)
        self.label(then)
        self.block(node.body)
        self.jump(end)
        self.label(other)
        self.block(node.orelse)
        self.jump(end)
        self.label(end)

    def _do_While(self, node: ast.While) -> None:
        test, body, end = (self.new(name) for name in ("test", "body", "end"))
        self.jump(test)
        self.label(test)
        self.branch(node.test, body, end)
        self.label(body)
        self._loops.append((test, end))
        self.block(node.body)
        self._loops.pop()
        self.jump(test)
        self.label(end)

    def _do_For(self, node: ast.For) -> None:
        call, target = node.iter, node.target
        if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "range"):
            self.unknown(node)
        assert isinstance(target, ast.Name)
        bounds = [self.converted(self.value(argument), "i64").parts[0] for argument in call.args]
        first, last, step = (["0", *bounds, "1"] if len(bounds) == 1 else [*bounds, "1"])[:3]
        self.assign(target.id, LoopValue("i64", (self.counted(first, last, step),)))
        self._loops.append(self._ends[-1][:2])
        self.block(node.body)
        self._loops.pop()
        self.end_loop()

    def counted(self, first: str, last: str, step: str) -> str:
        """Begin a loop; its number."""
        again, body, more, end = (self.new(name) for name in ("again", "body", "more", "end"))
        room = self.alloca("i64")
        self.do(f"store i64 {first}, ptr {room}")
        self.jump(again)
        self.label(again)
        index = self.emit(f"load i64, ptr {room}")
        test = "sgt" if step.startswith("-") else "slt"
        self.do(f"br i1 {self.emit(f'icmp {test} i64 {index}, {last}')}, label %{body}, label %{end}")
        self.label(body)
        self._ends.append((more, end, again, room, step))
        return index

    def end_loop(self) -> None:
        """The end of the loop that was begun last."""
        more, end, again, room, step = self._ends.pop()
        self.jump(more)
        self.label(more)
        index = self.emit(f"load i64, ptr {room}")
        self.do(f"store i64 {self.emit(f'add nsw i64 {index}, {step}')}, ptr {room}")
        self.jump(again)
        self.label(end)

    def _do_Break(self, node: ast.Break) -> None:
        self.jump(self._loops[-1][1])
        self.label(self.new("dead"))

    def _do_Continue(self, node: ast.Continue) -> None:
        self.jump(self._loops[-1][0])
        self.label(self.new("dead"))


__all__ = ["Array", "Kind", "LoopFunction", "LoopValue", "Tuple", "parts_of"]
