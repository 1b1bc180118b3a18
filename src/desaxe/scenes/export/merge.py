"""Several generated modules merged into one: shared imports and functions once, others renamed."""

import ast
import re
from collections.abc import Iterable, Mapping, Sequence
from textwrap import wrap


def pieces(source: str) -> tuple[dict[str, set[str]], list[str]]:
    """A module's imports (module -> names) and its other statements as text, docstring left out."""
    tree = ast.parse(source)
    lines = source.splitlines()
    imports: dict[str, set[str]] = {}
    found = []
    end = 0
    for index, node in enumerate(tree.body):
        first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", []))])
        text = "\n".join(lines[end : node.end_lineno]).strip("\n")
        end = node.end_lineno or first
        if isinstance(node, ast.ImportFrom):
            imports.setdefault(str(node.module), set()).update(alias.name for alias in node.names)
        elif index or not isinstance(node, ast.Expr):  # the docstring comes first
            found.append(text)
    return imports, found


def renamed(source: str, names: Mapping[str, str], called: bool = False) -> str:
    """Replace whole words in a text; with `called` only where a call follows."""
    words = "|".join(sorted(map(re.escape, names), key=len, reverse=True))
    pattern = re.compile(rf"\b({words})\b" + (r"(?=\()" if called else ""))
    return pattern.sub(lambda match: names[match[1]], source)


def merged(sources: Iterable[str]) -> tuple[dict[str, set[str]], list[str]]:
    """The imports of all, and their statements; one that stands in several stands once."""
    imports: dict[str, set[str]] = {}
    found: dict[str, None] = {}
    for source in sources:
        more, texts = pieces(source)
        for module, names in more.items():
            imports.setdefault(module, set()).update(names)
        found.update(dict.fromkeys(texts))
    return imports, list(found)


def import_lines(imports: Mapping[str, set[str]]) -> list[str]:
    """`from module import names`, the standard library first."""
    standard = [module for module in imports if module in ("concurrent.futures", "math", "os", "threading")]
    others = [module for module in imports if module not in standard]
    blocks = [
        [_import(module, sorted(imports[module])) for module in sorted(part)] for part in (standard, others)
    ]
    return "\n\n".join("\n".join(block) for block in blocks if block).splitlines()


def _import(module: str, names: Sequence[str]) -> str:
    line = f"from {module} import {', '.join(names)}"
    if len(line) <= 100:
        return line
    rows = wrap(", ".join(names) + ",", 96)
    return "\n".join([f"from {module} import (", *(f"    {row}" for row in rows), ")"])
