"""The text form: a Program as plain, readable, straight-line Python, and back.

    def law(theta, ec, AB, BC):
        sin_theta = sin(theta)  # 1 | sine of the crank angle
        u = ec + AB * sin_theta  # m | distance of the crank pin from the slider axis | A (5)
        return u

A temporary that is used once is written inside the line that uses it; one that is used more often
keeps a line of its own (`t0`). Parentheses keep the order of the operations, so that reading the
text gives the same program. `read` takes only the lines that the wanted outputs reach: it looks
each name up in the text and never parses the rest.
"""

import ast
import re
from collections.abc import Sequence
from textwrap import wrap
from typing import NamedTuple

from .operations import CALL, OPERATIONS, result_type
from .program import Argument, Line, Note, Program, ProgramError, names_in, renamed_temporaries, type_of

INDENT = "    "
WIDTH = 100


# ---- writing ---------------------------------------------------------------------------------


def write_lines(program: Program, column: str = "text") -> list[str]:
    """The assignments as text, one a line, in the spelling of a column of the operation table."""
    inlined = _used_once(program)
    text: dict[str, tuple[str, int]] = {}
    lines = []
    for line in program.lines:
        spelled = spell(line, text, column)
        if line.name in inlined:
            text[line.name] = spelled
        else:
            note = program.notes.get(line.name)
            lines.append(f"{line.name} = {spelled[0]}{_comment(note)}")
    return lines


def write_function(program: Program, name: str, docstring: str) -> str:
    """The whole function that computes the program."""
    program = with_short_temporaries(program)
    body = [f'"""{docstring}"""', *write_lines(program), *_return(program.outputs)]
    return "\n".join([f"def {name}({', '.join(program.inputs)}):", *(INDENT + line for line in body)]) + "\n"


def _return(outputs: Sequence[str]) -> list[str]:
    """The return statement, wrapped where it is long."""
    whole = f"return {', '.join(outputs)}"
    if len(whole) <= WIDTH:
        return [whole]
    rows = wrap(", ".join(outputs) + ",", WIDTH, break_long_words=False)
    return ["return (", *(INDENT + row for row in rows), ")"]


def spell(line: Line, text: dict[str, tuple[str, int]], column: str) -> tuple[str, int]:
    """The right-hand side and its precedence; `text` has what stands inside it."""
    operation = OPERATIONS[line.op]
    template = getattr(operation, column)
    infix = template == operation.text or "(" not in template
    precedence = operation.precedence if infix else CALL
    if column == "numba" and line.op in ("and", "or"):
        precedence = 8  # & and | bind tighter than comparisons
    if line.op == "copy":
        return _inside(line.args[0], text)
    parts = []
    for position, argument in enumerate(line.args):
        part, inner = _inside(argument, text)
        parts.append(f"({part})" if _wants_parentheses(precedence, inner, position, line.op) else part)
    return template.format(*parts), precedence


def _wants_parentheses(outer: int, inner: int, position: int, op: str) -> bool:
    """True if an argument of this precedence needs parentheses."""
    if outer == CALL:
        return False
    if op in ("add", "sub", "mul", "div"):
        return inner < outer or (inner == outer and position == 1)
    return inner <= outer


def _inside(argument: Argument, text: dict[str, tuple[str, int]]) -> tuple[str, int]:
    """The text of an argument: the expression of a temporary, else the name or constant."""
    result = text.get(argument) if isinstance(argument, str) else None
    return result or _plain(argument)


def _plain(value: Argument) -> tuple[str, int]:
    """A name or a constant, and its precedence."""
    if isinstance(value, str):
        return value, CALL
    if isinstance(value, float) and value != value:
        return "nan", CALL
    text = repr(value)
    return text, OPERATIONS["neg"].precedence if text.startswith("-") else CALL


def _comment(note: Note | None) -> str:
    if note is None:
        return ""
    return "  # " + " | ".join(part for part in note if part)


def with_short_temporaries(program: Program) -> Program:
    """The program with the temporaries that keep a line of their own named t0, t1, ... first."""
    inlined = _used_once(program)
    ordered = [line.name for line in program.lines if line.name not in inlined]
    ordered += [line.name for line in program.lines if line.name in inlined]
    return renamed_temporaries(program, ordered)


def _used_once(program: Program) -> set[str]:
    """Temporaries that one other line uses once."""
    uses: dict[str, int] = {}
    for line in program.lines:
        for name in names_in(line.args):
            uses[name] = uses.get(name, 0) + 1
    keep = set(program.outputs) | set(program.notes)
    return {line.name for line in program.lines if line.name not in keep and uses.get(line.name) == 1}


# ---- reading ---------------------------------------------------------------------------------


class ProgramText:
    """A text form whose lines are parsed only when they are needed."""

    def __init__(self, text: str) -> None:
        """Find the signature of the last function; its lines are found by name, later."""
        start = f"\n{text}".rindex("\ndef ") + len("def ")
        end = text.index("):", start)
        self.name, _, inputs = text[start:end].partition("(")
        self.inputs = tuple(name.strip() for name in inputs.split(",") if name.strip())
        self._text = text[end:]
        self._parsed: dict[str, _Parsed] = {}
        self._read: dict[str, list[Line]] = {}  # name -> the operations of its line
        self._types: dict[str, str] = dict.fromkeys(self.inputs, "f64")

    def outputs(self) -> tuple[str, ...]:
        """The names that the function returns, in order."""
        _, _, names = self._text.rpartition(f"\n{INDENT}return ")
        return tuple(name.strip() for name in names.strip("()\n ").split(",") if name.strip())

    def line(self, name: str) -> tuple[str, int]:
        """The right-hand side and note of a name, and where the line stands; KeyError without one."""
        mark = f"\n{INDENT}{name} = "
        at = self._text.find(mark)
        if at < 0:
            raise KeyError(name)
        end = self._text.find("\n", at + 1)
        return self._text[at + len(mark) : end if end >= 0 else None], at

    def read(self, outputs: Sequence[str] | None = None) -> Program:
        """The program of these outputs (all without): only what they reach is parsed."""
        requested = list(self.outputs() if outputs is None else outputs)
        result: dict[str, _Parsed] = {}
        stack = [name for name in requested if name not in self.inputs]
        while stack:
            name = stack.pop()
            if name in result:
                continue
            result[name] = self._line_of(name)
            stack += [used for used in result[name].names if used not in result and used not in self.inputs]
        ordered = sorted(result.items(), key=lambda item: item[1].place)
        lines: list[Line] = []
        used = set(requested)
        for name, parsed in ordered:
            if name not in self._read:
                self._read[name] = _Reader(name, self._types).lines_of(parsed.tree)
            lines += self._read[name]
            used.update(parsed.names)
        notes = {name: line.note for name, line in ordered if line.note is not None}
        inputs = tuple(name for name in self.inputs if name in used)
        return Program(inputs, tuple(lines), tuple(requested), notes)

    def _line_of(self, name: str) -> "_Parsed":
        """The line of a name, parsed when it is first asked for."""
        line = self._parsed.get(name)
        if line is None:
            right, place = self.line(name)
            expression, _, comment = right.partition("  # ")
            names = tuple(n for n in _NAMES.findall(expression) if n not in _WORDS)
            tree = ast.parse(expression, mode="eval").body
            line = self._parsed[name] = _Parsed(place, tree, _note(comment), names)
        return line


class _Parsed(NamedTuple):
    """A line of the text: where it stands, its right-hand side, its note, and the names that it uses."""

    place: int
    tree: ast.expr
    note: Note | None
    names: tuple[str, ...]


def read_function(text: str) -> Program:
    """The program of a text form, whole."""
    return ProgramText(text).read()


def _note(comment: str) -> Note | None:
    """The note of a comment; one without a unit has its meaning alone."""
    parts = comment.split(" | ")
    return None if not comment else Note(*parts) if len(parts) > 1 else Note("", comment)


_NAMES = re.compile(r"\b[^\W\d]\w*\b(?!\()")  # what is called is no name of a line
_WORDS = {"and", "else", "if", "inf", "nan", "not", "or", "False", "True"}
_BINARY = {ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.Div: "div"}
_COMPARE = {ast.Lt: "lt", ast.LtE: "le", ast.Eq: "eq"}
_BOOLEAN = {ast.And: "and", ast.Or: "or"}
_CALLS = {
    operation.text.partition("(")[0]: name
    for name, operation in OPERATIONS.items()
    if operation.precedence == CALL
}


class _Reader:
    """Turns the expression of a line back into lines of one operation each."""

    def __init__(self, name: str, types: dict[str, str]) -> None:
        self.name, self.types = name, types
        self.lines: list[Line] = []

    def lines_of(self, tree: ast.expr) -> list[Line]:
        """The lines of the assignment; ProgramError where they are no operations."""
        try:
            op, args = self._operation(tree)
            self._append(self.name, op, args)
        except (KeyError, TypeError) as error:
            raise ProgramError(f"cannot read {self.name} = {ast.unparse(tree)}: {error}") from None
        return self.lines

    def _append(self, name: str, op: str, args: tuple[Argument, ...]) -> None:
        types = tuple(type_of(argument, self.types) for argument in args)
        line = Line(name, op, args, result_type(OPERATIONS[op], types))
        self.types[name] = line.type
        self.lines.append(line)

    def _argument(self, tree: ast.expr) -> Argument:
        """A name, a constant, or a new temporary that holds the expression."""
        if isinstance(tree, ast.Name):
            return float(tree.id) if tree.id in ("nan", "inf") else tree.id
        if isinstance(tree, ast.Constant) and isinstance(tree.value, (bool, int, float)):
            return tree.value
        match tree:
            case ast.UnaryOp(ast.USub(), ast.Constant(int() | float() as value)):
                return -value
        op, args = self._operation(tree)
        name = f"_{self.name}_{len(self.lines)}"
        self._append(name, op, args)
        return name

    def _operation(self, tree: ast.expr) -> tuple[str, tuple[Argument, ...]]:
        match tree:
            case ast.Name() | ast.Constant() | ast.UnaryOp(ast.USub(), ast.Constant()):
                return "copy", (self._argument(tree),)
            case ast.BinOp(left, op, right):
                return _BINARY[type(op)], (self._argument(left), self._argument(right))
            case ast.UnaryOp(ast.USub(), operand):
                return "neg", (self._argument(operand),)
            case ast.UnaryOp(ast.Not(), operand):
                return "not", (self._argument(operand),)
            case ast.Compare(left, [op], [right]):
                return _COMPARE[type(op)], (self._argument(left), self._argument(right))
            case ast.BoolOp(op, [first, second]):
                return _BOOLEAN[type(op)], (self._argument(first), self._argument(second))
            case ast.IfExp(test, body, orelse):
                return "select", (self._argument(test), self._argument(body), self._argument(orelse))
            case ast.Call(ast.Name(name), args):
                return _CALLS[name], tuple(self._argument(argument) for argument in args)
        raise ProgramError(f"cannot read {ast.unparse(tree)!r}")
