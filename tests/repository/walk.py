"""The functions that one call may reach, by a static walk over the source of the library.

Rule: a function is reached if a reached body names it, through imports at the top of a file or inside of a
function, whatever the branch; annotations do not count. A class is reached like a function, with its special
methods; of its other methods those whose name some reached body takes as an attribute. A file is passed if
one of its functions or methods is reached: constants alone do not count.
"""

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

Place = tuple[str, str]  # a module and a name in it


class Module(NamedTuple):
    """A file: the statements that define its names, and what its imports name."""

    defined: dict[str, ast.stmt]
    imported: dict[str, Place]


def modules_of(package: Path) -> dict[str, Module]:
    """Every module of a package by its name."""
    result = {}
    for path in sorted(package.rglob("*.py")):
        parts = (package.name, *path.relative_to(package).with_suffix("").parts)
        room = parts[:-1]
        name = ".".join(room if parts[-1] == "__init__" else parts)
        result[name] = _module(ast.parse(path.read_text(encoding="utf-8")), room)
    return result


def _module(tree: ast.Module, room: tuple[str, ...]) -> Module:
    defined: dict[str, ast.stmt] = {}
    for statement in tree.body:
        if isinstance(statement, ast.FunctionDef | ast.ClassDef):
            defined[statement.name] = statement
        elif isinstance(statement, ast.Assign | ast.AnnAssign):
            stored = (n for n in ast.walk(statement) if isinstance(n, ast.Name))
            defined |= {n.id: statement for n in stored if isinstance(n.ctx, ast.Store)}
    imported: dict[str, Place] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            above = room[: len(room) - node.level + 1] if node.level else ()
            source = ".".join((*above, *filter(None, [node.module])))
            imported |= {alias.asname or alias.name: (source, alias.name) for alias in node.names}
    return Module(defined, imported)


class Walk:
    """The walk from one function."""

    def __init__(self, modules: dict[str, Module], start: Place) -> None:
        self.modules, self.left = modules, [start]
        self.seen: set[Place] = set()
        self.classes: list[tuple[str, ast.ClassDef]] = []
        self.attributes: set[str] = set()
        self.passed: set[str] = set()
        while self.left:
            while self.left:
                self._visit(*self.left.pop())
            self._methods()

    def _visit(self, module: str, name: str) -> None:
        if (module, name) in self.seen:
            return
        self.seen.add((module, name))
        node = self.modules[module].defined[name]
        if isinstance(node, ast.ClassDef):
            self.classes.append((module, node))
            for part in (*node.bases, *node.decorator_list):
                self._read(module, part)
        else:
            if isinstance(node, ast.FunctionDef):
                self.passed.add(module)
            self._read(module, node)

    def _methods(self) -> None:
        for module, node in self.classes:
            for method in node.body:
                if isinstance(method, ast.FunctionDef) and (
                    method.name.startswith("__") or method.name in self.attributes
                ):
                    place = module, f"{node.name}.{method.name}"
                    if place not in self.seen:
                        self.seen.add(place)
                        self.passed.add(module)
                        self._read(module, method)

    def _read(self, module: str, node: ast.AST) -> None:
        """Follow what a body names."""
        for part in _without_annotations(node):
            if isinstance(part, ast.Name):
                self._follow(module, part.id)
            elif isinstance(part, ast.Attribute):
                self.attributes.add(part.attr)
                whole = self._resolved(module, part.value.id) if isinstance(part.value, ast.Name) else None
                if whole is not None and not whole[1]:
                    self._follow(whole[0], part.attr)

    def _follow(self, module: str, name: str) -> None:
        result = self._resolved(module, name)
        if result is not None and result[1]:
            self.left.append(result)

    def _resolved(self, module: str, name: str) -> Place | None:
        """The place of a name's definition; a module has the name ""."""
        while module in self.modules:
            if name in self.modules[module].defined:
                return module, name
            if f"{module}.{name}" in self.modules:
                return f"{module}.{name}", ""
            if name not in self.modules[module].imported:
                return None
            module, name = self.modules[module].imported[name]
        return None


def _without_annotations(node: ast.AST) -> Iterator[ast.AST]:
    """A node and all that it holds."""
    yield node
    for field, value in ast.iter_fields(node):
        if field not in ("annotation", "returns"):
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    yield from _without_annotations(child)


def files_passed(modules: dict[str, Module], start: Place) -> list[str]:
    """The modules that a call of a function passes."""
    return sorted(Walk(modules, start).passed)
