"""Wrong programs that the tests should notice: `python -m tests.repository.mutants --count 100 -o ends`.

A mutant is the committed tree with one expression of `src` changed: an operator, a comparison, a condition,
a number. The draw takes those with the least digest of seed, file, function and expression, so that the same
ones are drawn after other code has moved. Each meets the test files nearest to it: those that name its
function or file, of its own room first. It is killed by a failing test; where processor time ends first,
nothing is known.
"""

import argparse
import ast
import copy
import hashlib
import json
import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[2]
NEAREST = 5  # test files that a mutant meets
SECONDS = 150  # of processor time, for all of them
PATIENCE = 10.0  # wall time over processor time, on a busy machine
OTHER: dict[type[ast.AST], type[ast.AST]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult, ast.Pow: ast.Mult, ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq, ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn,
    ast.NotIn: ast.In, ast.And: ast.Or, ast.Or: ast.And,
}  # fmt: skip


class Mutant(NamedTuple):
    """A change of one expression, which stands between two places of a file's text."""

    path: str
    function: str
    line: int
    old: str
    new: str
    start: int
    end: int

    def digest(self, seed: int) -> str:
        text = f"{seed} {self.path} {self.function} {self.old} {self.new}"
        return hashlib.sha256(text.encode()).hexdigest()


def changed(node: ast.AST) -> ast.AST | None:
    """The node with its own part changed; None for one that has no such part."""
    new: Any = copy.deepcopy(node)
    if isinstance(new, ast.BinOp | ast.BoolOp) and type(new.op) in OTHER:
        new.op = OTHER[type(new.op)]()
    elif isinstance(new, ast.Compare) and type(new.ops[0]) in OTHER:
        new.ops[0] = OTHER[type(new.ops[0])]()
    elif isinstance(new, ast.UnaryOp) and isinstance(new.op, ast.Not | ast.USub):
        return new.operand
    elif isinstance(new, ast.IfExp):
        new.body, new.orelse = new.orelse, new.body
    elif isinstance(new, ast.Constant) and isinstance(new.value, bool):
        new.value = not new.value
    elif isinstance(new, ast.Constant) and isinstance(new.value, int | float):
        new.value += 1
    else:
        return None
    return new


def mutants_of(path: str, text: str) -> Iterator[Mutant]:
    """Yield those inside of functions; annotations and texts stay."""
    starts = [0]
    for line in text.encode().splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def visit(node: ast.AST, names: tuple[str, ...]) -> Iterator[Mutant]:
        if isinstance(node, ast.JoinedStr):
            return
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names = (*names, node.name)
        if names and isinstance(node, ast.expr) and (new := changed(node)) is not None:
            place = [
                starts[node.lineno - 1] + node.col_offset,
                starts[node.end_lineno - 1] + node.end_col_offset,
            ]
            yield Mutant(
                path, ".".join(names), node.lineno, ast.unparse(node), f"({ast.unparse(new)})", *place
            )
        for field, value in ast.iter_fields(node):
            if field in ("annotation", "returns", "decorator_list"):
                continue
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    yield from visit(child, names)

    return visit(ast.parse(text), ())


def drawn(root: Path, seed: int, count: int) -> list[Mutant]:
    """The mutants of a seed; more of them begin with the same ones."""
    result = []
    for path in sorted((root / "src").rglob("*.py")):
        result += mutants_of(path.relative_to(root).as_posix(), path.read_text(encoding="utf-8"))
    return sorted(result, key=lambda one: one.digest(seed))[:count]


def nearest(root: Path, mutant: Mutant) -> list[str]:
    """Return its test files, the nearest first."""
    path = Path(mutant.path)
    room = path.parts[2:-1]
    words = {w for w in [*mutant.function.split("."), path.stem] if not re.fullmatch(r"__\w+__", w)}
    ranks = []
    for test in sorted((root / "tests").rglob("test_*.py")):
        parts = test.relative_to(root / "tests").parts[:-1]
        known = set(re.findall(r"\w+", test.read_text(encoding="utf-8")))
        same_room = sum(a == b for a, b in zip(room, parts, strict=False))
        file = test.stem == f"test_{path.stem.strip('_')}"
        score = 6 * file + 3 * same_room + len(words & known)
        ranks.append((-score, test.relative_to(root).as_posix()))
    return [name for score, name in sorted(ranks)[:NEAREST] if score]


def meets(root: Path, mutant: Mutant, tests: list[str], seconds: int) -> tuple[str, str]:
    """Tell how the tests end, `killed`, `time` or `survived`, and the test that failed."""
    file = root / mutant.path
    text = file.read_bytes()
    file.write_bytes(text[: mutant.start] + mutant.new.encode() + text[mutant.end :])
    options = ["-n", "0", "-x", "-q", "-p", "no:cacheprovider"]
    pytest = shlex.join([sys.executable, "-m", "pytest", *options, *tests])
    command = f"ulimit -t {seconds}; exec {pytest}"
    known = os.environ | {"PYTHONPATH": str(root / "src"), "PYTHONDONTWRITEBYTECODE": "1"}
    running = subprocess.Popen(
        command, cwd=root, env=known, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        start_new_session=True, shell=True,
    )  # fmt: skip
    try:
        said, _ = running.communicate(timeout=PATIENCE * seconds)
    except subprocess.TimeoutExpired:
        os.killpg(running.pid, signal.SIGKILL)
        running.communicate()
        return "time", ""
    finally:
        file.write_bytes(text)
    if running.returncode < 0:
        return "time", ""
    failed = re.search(r"^(?:FAILED|ERROR) ([^\n]*?)(?: - |$)", said, re.M)
    return ("survived" if running.returncode == 0 else "killed"), failed[1] if failed else ""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, help="leave out so many")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=int, default=SECONDS)
    parser.add_argument("-o", "--output", type=Path, required=True, help="a line of JSON for each, added")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, asked.output.open("a", encoding="utf-8") as output:
        tree = Path(folder) / "tree"
        subprocess.run(["git", "clone", "-q", "--shared", str(ROOT), str(tree)], check=True)
        ends: list[str] = []
        for mutant in drawn(tree, asked.seed, asked.count)[asked.first :]:
            tests = nearest(tree, mutant)
            end, by = meets(tree, mutant, tests, asked.seconds) if tests else ("survived", "")
            ends.append(end)
            output.write(json.dumps(mutant._asdict() | {"end": end, "by": by, "tests": tests}) + "\n")
            output.flush()
        print(f"{len(ends)} mutants: " + ", ".join(f"{ends.count(e)} {e}" for e in sorted(set(ends))))


if __name__ == "__main__":
    main()
