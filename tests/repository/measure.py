"""The size of the source, and of a stranger's way through it: `python -m tests.repository.measure`.

Rules, one for each row that is printed:

code lines       lines with a token that is no comment and no docstring; of .js the lines that are no comment
long files       those of `src` and `derive` with more than LONG lines, all lines counted
files passed     see `walk`; "middle" are those that are left without LOWER, the half that every call shares
numba text       files in which a string that is no docstring has a word of TEXT
strippers        functions with a string such as ": Any" or " -> int", which take annotations out of a text
naming X         files where X stands as a word: what adding such an input, option or language touches

                                              e3c2201       1f1810a       40d5a93         df265d9
code lines of src and derive; of .js   30,809; 923   32,421; 923   33,440; 920      42,889; 1,066
files of more than 300 lines                15            14            13                     18
grid(reduce=): passed, of the middle    93; 38       104; 44       110; 47                120; 51
a scene's run                          154; 87       168; 96      174; 100               208; 124
peak                                    98; 37       111; 45       110; 47                120; 49
evaluate                                77; 25        84; 29        89; 31                101; 36
numba text; stubs.py; strippers       11; 2; 2      12; 2; 2       7; 0; 0                6; 0; 0
an input; an option; a language      14; 5; 11     14; 5; 14      9; 5; 16              11; 4; 17

New features lie between the columns, too.
"""

import argparse
import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

from tests.repository.walk import files_passed, modules_of

ROOT = Path(__file__).resolve().parents[2]
LONG = 300
TEXT = re.compile(r"\bnjit\b|@intrinsic|from numba\b")
STRIPPED = re.compile(r"[\"']\)?\s*(->|:) (Any|int|float|None)\W?[\"']")
CALLS = {
    "grid(reduce=)": ("desaxe.evaluation.grid", "grid"),
    "a scene's run": ("desaxe.scenes.command", "run_scene"),
    "peak": ("desaxe.peaks.peak", "peak"),
    "evaluate": ("desaxe.evaluation.evaluate", "evaluate"),
}
# The lower half: the rooms under `loads`, own quantities, and the loader of machine code.
LOWER = re.compile(
    r"desaxe\.(support|compiler|oracle|mechanism|definitions"
    r"|runtime\.(cache|native))\b"
)
NAMED = {  # a word that nothing else is called -> where it counts
    "an input": ("I_crank", ("src", "derive")),
    "an option of sweep": ("client", ("src", "derive")),
    "a language": ("octave", ("src", "derive", "docs", "tests")),
}


def sources(root: Path, suffix: str = ".py") -> dict[str, str]:
    """Path -> text of the files of `src` and `derive`."""
    result = (path for room in ("src", "derive") for path in sorted((root / room).rglob(f"*{suffix}")))
    return {path.relative_to(root).as_posix(): path.read_text(encoding="utf-8") for path in result}


def code_lines(text: str) -> int:
    """The number of lines of a Python file that are code."""
    lines: set[int] = set()
    statement: list[tokenize.TokenInfo] = []
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.NEWLINE:
            if [one.type for one in statement] != [tokenize.STRING]:
                lines.update(*(range(one.start[0], one.end[0] + 1) for one in statement))
            statement = []
        elif token.type not in SILENT:
            statement.append(token)
    return len(lines)


SILENT = {tokenize.COMMENT, tokenize.NL, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}


def docstrings(tree: ast.AST) -> Iterator[ast.Constant]:
    """The docstrings of a file, a class or a function, and of all that it holds."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and node.body:
            first = node.body[0]
            if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
                yield first.value


def strings(node: ast.AST) -> list[str]:
    """The texts in a file or a function, docstrings aside."""
    aside = {id(one) for one in docstrings(node)}
    texts = (one for one in ast.walk(node) if isinstance(one, ast.Constant) and id(one) not in aside)
    return [one.value for one in texts if isinstance(one.value, str)]


def writes_numba(text: str) -> bool:
    """True for a file that holds text of numba modules."""
    return bool(TEXT.search(text)) and any(TEXT.search(string) for string in strings(ast.parse(text)))


def strippers(text: str) -> list[str]:
    """The functions of a file that take annotations out of a text."""
    if not STRIPPED.search(text):
        return []
    result = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef))
    return [
        node.name for node in result if any(STRIPPED.fullmatch(f"'{string}'") for string in strings(node))
    ]


def naming(root: Path, word: str, rooms: tuple[str, ...]) -> list[str]:
    """The files of some rooms in which a word stands."""
    paths = [path for room in rooms for path in sorted((root / room).rglob("*")) if path.suffix in READ]
    pattern = re.compile(rf"\b{word}\b")
    texts = ((path, path.read_text(encoding="utf-8")) for path in paths if path.name != "measure.py")
    return [path.relative_to(root).as_posix() for path, text in texts if pattern.search(text)]


READ = (".py", ".md", ".js", ".txt")


def measure(root: Path) -> Iterator[tuple[str, int, list[str]]]:
    """Each count with its name, and what was counted."""
    python = sources(root)
    counts = {path: code_lines(text) for path, text in python.items()}
    yield "code lines of src and derive", sum(counts.values()), []
    script = [line.strip() for text in sources(root, ".js").values() for line in text.splitlines()]
    yield "code lines of .js", len([line for line in script if line and not line.startswith("//")]), []
    long = [f"{path} {len(text.splitlines())}" for path, text in python.items()]
    long = [row for row in long if int(row.split()[1]) > LONG]
    yield f"files of more than {LONG} lines", len(long), long
    modules = modules_of(root / "src" / "desaxe")
    for call, start in CALLS.items():
        passed = files_passed(modules, start)
        middle = [name for name in passed if not LOWER.match(name)]
        yield f"files that {call} passes", len(passed), []
        yield "  of the middle", len(middle), middle
    yield "files that hold numba text", *_counted([path for path in python if writes_numba(python[path])])
    yield "stubs.py", *_counted([path for path in python if path.endswith("/stubs.py")])
    result = [f"{path}: {name}" for path, text in python.items() for name in strippers(text)]
    yield "annotation strippers", *_counted(result)
    for what, (word, rooms) in NAMED.items():
        yield f"files naming {what}, `{word}`", *_counted(naming(root, word, rooms))


def _counted(result: list[str]) -> tuple[int, list[str]]:
    return len(result), result


def main() -> None:
    parser = argparse.ArgumentParser(description="How large the house is, in counts.")
    parser.add_argument("root", nargs="?", type=Path, default=ROOT, help="a clone (default: this one)")
    parser.add_argument("--files", action="store_true", help="name the files, too")
    options = parser.parse_args()
    for what, count, result in measure(options.root.resolve()):
        print(f"{count:7,}  {what}")
        for name in result if options.files else ():
            print(f"{'':11}{name}")


if __name__ == "__main__":
    main()
