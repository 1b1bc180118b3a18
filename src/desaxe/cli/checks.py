"""`desaxe derive`, `doctor`: the derivation, this installation."""

import argparse
import io
import sys
from contextlib import redirect_stdout
from importlib import import_module
from pathlib import Path
from typing import Any

from ..support.extras import explained
from ..support.shown import in_brief, printable
from .parser import Parser, add_command


def add_derive(commands: Any) -> None:
    """Add `desaxe derive`."""
    add_command(commands, "derive", "derive the formulas again with SymPy and write generated/", lambda _: 0)


def derive(words: list[str]) -> int:
    """Run the derivation's own command line, under the name `desaxe derive`."""
    if any(word.partition("=")[0] == "--quantities" for word in words):
        return _own(words)
    run = import_module("desaxe.derive.__main__").main
    if not {"-h", "--help"} & set(words):
        with explained("desaxe derive"):
            code: int = run(words)
            return code
    shown = io.StringIO()
    try:
        with redirect_stdout(shown):
            run(words)
    finally:  # it calls itself as one calls it there
        print(shown.getvalue().replace("python -m derive", "desaxe derive"), end="")
    return 0


def _own(words: list[str]) -> int:
    """Write, or check, the package of a file's own quantities: no SymPy is needed."""
    from ..scenes.export.package import write_package

    parser = Parser(prog="desaxe derive", description="a package of quantities of your own")
    parser.add_argument("--quantities", type=Path, required=True, help="a TOML file with [quantities.NAME]")
    parser.add_argument("-o", "--output", type=Path, required=True, help="the folder of the package")
    parser.add_argument("--check", action="store_true", help="compare, exit 1 on a difference")
    parser.add_argument("--overwrite", action="store_true", help="replace files that were edited")
    options = parser.parse_args(words)
    try:
        found = write_package(options.quantities, options.output, options.check, options.overwrite)
    except (ValueError, TypeError, OSError) as error:
        print(f"desaxe derive: {printable(error)}", file=sys.stderr)
        return 2
    remedy = f"run desaxe derive --quantities {printable(options.quantities)} -o {printable(options.output)}"
    if options.check:
        print(f"{printable(options.output.name)}/ is {'stale: ' + remedy if found else 'fresh'}")
        print("".join(f"{printable(line)}\n" for line in in_brief(found).splitlines()), end="")
        return 1 if found else 0
    print(f"wrote {printable(options.output)}")
    return 0


def add_doctor(commands: Any) -> None:
    """Add `desaxe doctor`."""
    what = "versions, cache, threads, and whether arrays and points agree on this computer"
    parser = add_command(commands, "doctor", what, _doctor)
    parser.add_argument("--accuracy", action="store_true", help="compare with 200 frozen truths")


def _doctor(options: argparse.Namespace) -> int:
    from .doctor import examine

    found = examine(options.accuracy)
    print(found.text)
    return 0 if found.usable else 1
