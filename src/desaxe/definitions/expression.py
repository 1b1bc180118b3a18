"""The text of an expression as a tree of Python's `ast`; nothing is ever evaluated as Python.

A scan lets numbers, names, operators and calls of FUNCTIONS pass, with operands and operators in turn and
parentheses in pairs, within limits of size and depth. Python's parser then sees x for every name and 1 for
every digit: what a name is, whether a word of Python or not, is read from the text.
"""

import ast
import re
from itertools import pairwise
from typing import NamedTuple, NoReturn

LONGEST = 4_000  # characters
MOST = 400  # numbers, names and signs
DEEPEST = 40  # parentheses and calls within each other

FUNCTIONS: dict[str, tuple[int, int]] = {  # the least and most arguments
    **dict.fromkeys(("sqrt", "abs", "sin", "cos", "tan", "exp", "log"), (1, 1)),
    **dict.fromkeys(("atan2", "hypot"), (2, 2)),
    **dict.fromkeys(("min", "max"), (2, 8)),
    "where": (3, 3),
}
_TOKEN = re.compile(
    r"[ \t\r\n]+"
    r"|(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*)"
    r"|(?P<sign>\*\*|<=|>=|==|!=|[-+*/()<>,])"
    r"|(?P<other>.)",
    re.ASCII | re.DOTALL,
)
_HINTS = {
    **{".": ": there are no attributes", "^": "; a power is **", "=": "; equality is =="},
    **{"%": "; there is no remainder", "[": "; there are no lists"},
    **dict.fromkeys("&|", "; use where(...) within where(...)"),
    **dict.fromkeys("'\"", "; there is no text"),
}
_WINDOW = 72  # characters of a long text that a message shows
Token = re.Match[str]


class ExpressionText(NamedTuple):
    """The text of an expression and the name that it defines, for messages."""

    name: str
    text: str

    def refuse(self, start: int, end: int, problem: str) -> NoReturn:
        """Raise ValueError with the problem, the text, and a mark below these characters."""
        first = max(0, min(start - _WINDOW // 3, len(self.text) - _WINDOW))
        window = "".join(c if c.isprintable() else " " for c in self.text[first : first + _WINDOW])
        stop = max(start + 1, min(end, first + len(window)))
        mark = " " * (start - first) + "^" * (stop - start)
        raise ValueError(f"{self.name}: {problem}\n    {window}\n    {mark}")

    def refuse_all(self, problem: str) -> NoReturn:
        """Raise ValueError that marks the whole text."""
        self.refuse(0, len(self.text), problem)

    def refuse_node(self, node: ast.expr, problem: str) -> NoReturn:
        """Raise ValueError that marks a part, with the parentheses around it."""
        self.refuse(*self._span(node), problem)

    def quote(self, node: ast.expr) -> str:
        """The text of a part with its parentheses, shortened."""
        start, end = self._span(node)
        text = " ".join(self.text[start:end].split())
        return text if len(text) <= 40 else f"{text[:37]}..."

    def atom(self, node: ast.expr) -> str:
        """The text of a number or a name."""
        return self.text[node.col_offset - 1 : (node.end_col_offset or 0) - 1]

    def _span(self, node: ast.expr) -> tuple[int, int]:
        before, after = self.text[: node.col_offset - 1], self.text[(node.end_col_offset or 0) - 1 :]
        while True:
            left, right = before.rstrip(), after.lstrip()
            # The parenthesis of a call has a name before it.
            if not (left.endswith("(") and right.startswith(")")) or re.search(r"\w\s*\($", left):
                return len(before), len(self.text) - len(after)
            before, after = left[:-1], right[1:]


def parse(source: ExpressionText) -> tuple[ast.expr, list[Token]]:
    """The tree of an expression, and its names from left to right; ValueError marks a syntax error."""
    tokens = _tokens(source)
    _check_order(source, tokens)
    names = []
    for token, after in pairwise([*tokens, None]):
        if token is None or token.lastgroup != "name":
            continue
        if after is None or after[0] != "(":
            names.append(token)
        elif token[0] not in FUNCTIONS:
            problem = f"unknown function {token[0]!r}; there are {', '.join(FUNCTIONS)}"
            source.refuse(*token.span(), problem)
    return ast.parse(f"({_TOKEN.sub(_masked, source.text)})", mode="eval").body, names


def _masked(token: Token) -> str:
    letter = {"number": "1", "name": "x", None: " "}.get(token.lastgroup)
    return token[0] if letter is None else letter * len(token[0])


def _tokens(source: ExpressionText) -> list[Token]:
    if len(source.text) > LONGEST:
        problem = f"{len(source.text)} characters; an expression has at most {LONGEST}"
        source.refuse(LONGEST, LONGEST + 1, problem)
    tokens: list[Token] = []
    for token in _TOKEN.finditer(source.text):
        if token.lastgroup == "other":
            source.refuse(*token.span(), f"{token[0]!r} has no meaning here{_HINTS.get(token[0], '')}")
        if token.lastgroup is not None:
            tokens.append(token)
        if len(tokens) > MOST:
            source.refuse(*token.span(), f"more than {MOST} numbers, names and signs")
    if not tokens:
        source.refuse(0, 1, "an empty expression")
    return tokens


def _check_order(source: ExpressionText, tokens: list[Token]) -> None:
    """ValueError unless operands and operators take turns, parentheses close and commas stand in calls."""
    calls: list[bool] = []  # for each open parenthesis: whether it is that of a call
    operand_next, is_name = True, False
    for token in tokens:
        is_sign, text = token.lastgroup == "sign", token[0]
        if operand_next:
            fits = not is_sign or text in ("(", "+", "-")
        else:
            brackets = {"(": is_name, ")": bool(calls), ",": calls[-1:] == [True]}
            fits = brackets.get(text, is_sign)
        if not fits:
            sign = "a sign such as + or )" if calls else "a sign such as +"
            expected = "a number, a name or (" if operand_next else sign
            source.refuse(*token.span(), f"unexpected {text!r}: expected {expected}")
        if text == "(":
            calls.append(is_name)
            if len(calls) > DEEPEST:
                source.refuse(*token.span(), f"more than {DEEPEST} parentheses within each other")
        elif text == ")":
            calls.pop()
        operand_next, is_name = is_sign and text != ")", token.lastgroup == "name"
    if operand_next or calls:
        end = len(source.text)
        source.refuse(end - 1, end, "the expression ends too early")
