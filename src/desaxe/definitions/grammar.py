"""The grammar of expressions: parses a text into a tree, or marks the error in the text.

    comparison  sum [("<" | "<=" | ">" | ">=" | "==" | "!=") sum]     the first argument of `where` alone
    sum         product {("+" | "-") product}
    product     sign {("*" | "/") sign}
    sign        "-" sign | power
    power       atom ["**" sign]
    atom        number | name | name "(" comparison {"," comparison} ")" | "(" comparison ")"

Size and depth are limited before anything is done with the text, so that no text takes long.
"""

import re
from collections.abc import Sequence
from math import isfinite
from typing import NamedTuple, NoReturn

LONGEST = 4_000  # characters
MOST = 400  # numbers, names and signs
DEEPEST = 40  # parentheses, calls and powers within each other

ARITY: dict[str, tuple[int, int]] = {
    **dict.fromkeys(("sqrt", "abs", "sin", "cos", "tan", "exp", "log"), (1, 1)),
    **dict.fromkeys(("atan2", "hypot"), (2, 2)),
    **dict.fromkeys(("min", "max"), (2, 8)),
    "where": (3, 3),
}
COMPARISONS = ("<=", ">=", "==", "!=", "<", ">")
_TOKEN = re.compile(
    r"(?P<space>[ \t\r\n]+)"
    r"|(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*)"
    r"|(?P<sign>\*\*|<=|>=|==|!=|[-+*/()<>,])",
    re.ASCII,
)
_WINDOW = 72  # characters of a long text that an error shows


class Node(NamedTuple):
    """A part of an expression, from `at` to `end`: `op` is number, name, a sign or a function."""

    op: str
    parts: tuple["Node", ...]
    at: int
    end: int
    name: str = ""
    number: float = 0.0


class Token(NamedTuple):
    """A number, a name or a sign of the text; the last one is empty."""

    kind: str
    text: str
    at: int

    @property
    def end(self) -> int:
        """The position after the last character."""
        return self.at + len(self.text)


class DefinitionText(NamedTuple):
    """The name that is defined and its text, for errors."""

    name: str
    text: str

    def refuse(self, at: int, end: int, problem: str) -> NoReturn:
        """Raise ValueError with the problem, the text, and a mark below the position."""
        start = max(0, min(at - _WINDOW // 3, len(self.text) - _WINDOW))
        shown = "".join(c if c.isprintable() else " " for c in self.text[start : start + _WINDOW])
        stop = max(at + 1, min(end, start + len(shown)))
        mark = " " * (at - start) + "^" * (stop - at)
        raise ValueError(f"{self.name}: {problem}\n    {shown}\n    {mark}")

    def shown(self, node: Node) -> str:
        """The text of a part, shortened."""
        text = " ".join(self.text[node.at : node.end].split())
        return text if len(text) <= 40 else f"{text[:37]}..."


def parse(source: DefinitionText) -> Node:
    """Parse a text; ValueError that marks the position of a syntax error."""
    return _Parser(source, _tokens(source)).whole()


def _tokens(source: DefinitionText) -> list[Token]:
    text = source.text
    if len(text) > LONGEST:
        source.refuse(LONGEST, LONGEST + 1, f"{len(text)} characters; an expression has at most {LONGEST}")
    found: list[Token] = []
    at = 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            hint = _HINTS.get(text[at], "")
            source.refuse(at, at + 1, f"{text[at]!r} has no meaning here{hint}")
        if match.lastgroup != "space":
            found.append(Token(str(match.lastgroup), match[0], at))
        at = match.end()
        if len(found) > MOST:
            source.refuse(found[-1].at, found[-1].end, f"more than {MOST} numbers, names and signs")
    return [*found, Token("end", "", len(text))]


_HINTS = {
    ".": ": there are no attributes",
    "^": "; a power is **",
    "=": "; equality is ==",
    "&": "; use where(...) within where(...)",
    "|": "; use where(...) within where(...)",
    "%": "; there is no remainder",
    "[": "; there are no lists",
    "'": "; there is no text",
    '"': "; there is no text",
}


class _Parser:
    """Reads the tokens from left to right."""

    def __init__(self, source: DefinitionText, tokens: Sequence[Token]) -> None:
        self.source = source
        self.tokens = tokens
        self.place = 0
        self.depth = 0

    @property
    def here(self) -> Token:
        return self.tokens[self.place]

    def whole(self) -> Node:
        """The only expression of the text."""
        if self.here.kind == "end":
            self.source.refuse(0, 1, "an empty expression")
        tree = self.comparison()
        if self.here.kind != "end":
            self._unexpected()
        return tree

    def comparison(self) -> Node:
        """Two sums compared, or one sum."""
        left = self.sum()
        if self.here.text not in COMPARISONS:
            return left
        op = self._next().text
        right = self.sum()
        if self.here.text in COMPARISONS:
            self.source.refuse(self.here.at, self.here.end, "a comparison has two sides, no more")
        return _joined(op, left, right)

    def sum(self) -> Node:
        """Products added."""
        tree = self.product()
        while self.here.text in ("+", "-"):
            op = self._next().text
            tree = _joined(op, tree, self.product())
        return tree

    def product(self) -> Node:
        """Factors multiplied."""
        tree = self.signed()
        while self.here.text in ("*", "/"):
            op = self._next().text
            tree = _joined(op, tree, self.signed())
        return tree

    def signed(self) -> Node:
        """A power, maybe with signs before it."""
        first = self.here
        minus = 0
        while self.here.text in ("-", "+"):
            minus += self._next().text == "-"
        tree = self.power()
        return Node("neg", (tree,), first.at, tree.end) if minus % 2 else tree

    def power(self) -> Node:
        """An atom, maybe to a power."""
        base = self.atom()
        if self.here.text != "**":
            return base
        self._deeper(self._next())
        exponent = self.signed()
        self.depth -= 1
        return _joined("**", base, exponent)

    def atom(self) -> Node:
        """A number, a name, a call, or an expression in parentheses."""
        token = self.here
        if token.kind == "number":
            return self._number(self._next())
        if token.kind == "name":
            self._next()
            return (
                self._call(token)
                if self.here.text == "("
                else Node("name", (), token.at, token.end, token.text)
            )
        if token.text != "(":
            self._unexpected()
        self._deeper(self._next())
        tree = self.comparison()
        end = self._close()
        return tree._replace(at=token.at, end=end)

    def _number(self, token: Token) -> Node:
        number = float(token.text)
        if not isfinite(number):
            self.source.refuse(token.at, token.end, "the number is too large")
        return Node("number", (), token.at, token.end, "", number)

    def _call(self, name: Token) -> Node:
        if name.text not in ARITY:
            known = ", ".join(ARITY)
            self.source.refuse(name.at, name.end, f"unknown function {name.text!r}; there are {known}")
        self._deeper(self._next())
        arguments = [self.comparison()]
        while self.here.text == ",":
            self._next()
            arguments.append(self.comparison())
        end = self._close()
        least, most = ARITY[name.text]
        if not least <= len(arguments) <= most:
            wanted = f"{least}" if least == most else f"{least} to {most}"
            problem = f"{name.text} takes {wanted} argument{'s' * (most > 1)}, got {len(arguments)}"
            self.source.refuse(name.at, end, problem)
        return Node(name.text, tuple(arguments), name.at, end)

    def _deeper(self, token: Token) -> None:
        self.depth += 1
        if self.depth > DEEPEST:
            self.source.refuse(token.at, token.end, f"more than {DEEPEST} parentheses within each other")

    def _close(self) -> int:
        if self.here.text != ")":
            self._unexpected(" or )")
        self.depth -= 1
        return self._next().end

    def _next(self) -> Token:
        self.place += 1
        return self.tokens[self.place - 1]

    def _unexpected(self, other: str = "") -> NoReturn:
        token = self.here
        if token.kind == "end":
            self.source.refuse(max(0, token.at - 1), token.at, "the expression ends too early")
        before = self.tokens[self.place - 1].kind if self.place else ""
        wanted = "a sign such as +" if before in ("number", "name") or other else "a number, a name or ("
        self.source.refuse(token.at, token.end, f"unexpected {token.text!r}: expected {wanted}{other}")


def _joined(op: str, left: Node, right: Node) -> Node:
    return Node(op, (left, right), left.at, right.end)
