"""The ledgers' ASCII mathematics: parsed into Python syntax trees, and written as LaTeX.

`v_2 = omega*k*cos(theta) / [c^2 - e^2]^(1/2); T = 0` is two statements of two sides each. A blank between two
names multiplies, as papers write it; `dv_1/dtheta` is one name; `(a, b)` a vector; `f(...)` a call whose
arguments the ledger leaves out. Nothing is evaluated here.
"""

import ast
import re

GREEK = ("alpha", "gamma", "delta", "theta", "phi", "omega", "mu")
FUNCTIONS = {"sin": r"\sin", "cos": r"\cos", "tan": r"\tan", "asin": r"\arcsin", "acos": r"\arccos"}

_ALLOWED = (ast.BinOp, ast.UnaryOp, ast.Call, ast.Name, ast.Constant, ast.Tuple, ast.operator, ast.unaryop)
_CONTEXT = (ast.Load,)
_NAME = re.compile(r"([A-Za-z]+)_?(.*)")


def parse(text: str) -> list[list[ast.expr]]:
    """The sides of each statement of a formula; ValueError where the text is none."""
    statements = re.split(r";\s*|\s+and\s+", text.strip().rstrip(";"))
    return [[_side(side) for side in re.split(r":?=", statement)] for statement in statements]


def latex(text: str) -> str:
    """A formula as LaTeX, without dollar signs; ValueError where the text is none."""
    return r",\quad ".join(" = ".join(_tex(side, 0) for side in sides) for sides in parse(text))


def derivative(name: str) -> str:
    """The single name that stands for a derivative such as dv_1/dtheta."""
    return re.sub(r"\bd([A-Za-z]\w*)/d(theta|t)\b", r"d__\1__\2", name)


def _side(text: str) -> ast.expr:
    """One side of an equation as a syntax tree of arithmetic only."""
    source = derivative(text.strip())
    source = re.sub(r"\((\w+)\)_([nt])\b", r"\1_\2", source)
    source = re.sub(r"\|([^|]+)\|", r"abs(\1)", source)
    source = source.replace("^", "**").replace("[", "(").replace("]", ")")
    source = re.sub(r"(?<=[\w)])\s+(?=[A-Za-z(])", "*", source)
    try:
        tree = ast.parse(source, mode="eval").body
    except SyntaxError:
        raise ValueError(f"no formula: {text.strip()!r}") from None
    for node in ast.walk(tree):
        is_text = isinstance(node, ast.Constant) and not isinstance(node.value, (int, float, type(...)))
        if is_text or not isinstance(node, (*_ALLOWED, *_CONTEXT)):
            raise ValueError(f"no formula: {text.strip()!r}")
    return tree


_LEVELS: dict[type[ast.operator], tuple[int, str]] = {
    ast.Add: (1, " + "),
    ast.Sub: (1, " - "),
    ast.Mult: (2, r" \, "),
}


def _tex(node: ast.expr, level: int) -> str:
    """A syntax tree as LaTeX, in parentheses where it binds less than `level`."""
    if isinstance(node, ast.Constant):
        return r"\ldots" if node.value is ... else str(node.value)
    if isinstance(node, ast.Name):
        return _symbol(node.id)
    if isinstance(node, ast.Tuple):
        return r"\begin{pmatrix}" + r" \\ ".join(_tex(part, 0) for part in node.elts) + r"\end{pmatrix}"
    if isinstance(node, ast.UnaryOp):
        sign = "-" if isinstance(node.op, ast.USub) else "+"
        return _bracketed(sign + _tex(node.operand, 2), level > 2)
    if isinstance(node, ast.Call):
        return _call(node)
    assert isinstance(node, ast.BinOp)
    if isinstance(node.op, ast.Pow):
        return _power(node)
    if isinstance(node.op, ast.Div):
        return rf"\frac{{{_tex(node.left, 0)}}}{{{_tex(node.right, 0)}}}"
    own, sign = _LEVELS[type(node.op)]
    right = own + 1 if isinstance(node.op, ast.Sub) else own
    return _bracketed(_tex(node.left, own) + sign + _tex(node.right, right), level > own)


def _call(node: ast.Call) -> str:
    """A function call as LaTeX; roots and absolute values in their own notation."""
    name = node.func.id if isinstance(node.func, ast.Name) else ""
    arguments = ", ".join(_tex(argument, 0) for argument in node.args)
    if name == "sqrt":
        return rf"\sqrt{{{arguments}}}"
    if name == "abs":
        return rf"\left|{arguments}\right|"
    return FUNCTIONS.get(name, _symbol(name)) + _bracketed(arguments, True)


def _power(node: ast.BinOp) -> str:
    """A power as LaTeX: sqrt for 1/2, and sin^n for a power of a sine."""
    if ast.unparse(node.right) == "1 / 2":
        return rf"\sqrt{{{_tex(node.left, 0)}}}"
    exponent = ast.unparse(node.right).replace(" ", "")
    if isinstance(node.left, ast.Call) and ast.unparse(node.left.func) in FUNCTIONS:
        name = ast.unparse(node.left.func)
        return _call(node.left).replace(FUNCTIONS[name], rf"{FUNCTIONS[name]}^{{{exponent}}}", 1)
    return rf"{_tex(node.left, 4)}^{{{exponent}}}"


def _symbol(name: str) -> str:
    """A letter with its index (alpha_BC1, R12x); a derivative such as dv_1/dtheta as a fraction."""
    if name.startswith("d__"):
        above, below = name.split("__")[1:]
        return rf"\frac{{d {_symbol(above)}}}{{d {_symbol(below)}}}"
    if name in ("AB", "BC", "ec"):
        return rf"\mathit{{{name}}}"
    if name in ("i", "j"):
        return rf"\hat{{\mathbf{{{name}}}}}"
    result = _NAME.fullmatch(name)
    letter, index = result.groups() if result else (name, "")
    if letter not in GREEK and len(letter) > 1:  # aG2x, FPx, IG2: the first letter carries the rest
        letter, index = letter[0], letter[1:] + index
    written = "\\" + letter if letter in GREEK else letter
    if len(index) > 1:
        index = f"{{{index}}}"
    return f"{written}_{index}" if index else written


def _bracketed(text: str, needed: bool) -> str:
    """Text in parentheses, which grow with a fraction or a root."""
    if not needed:
        return text
    return rf"\left({text}\right)" if r"\frac" in text or r"\sqrt" in text else f"({text})"
