"""`desaxe run`, `scene`, `explain`, `compile`, `explore`: the commands on a scene file."""

import argparse
import sys
from pathlib import Path
from typing import Any

from ..mechanism.inputs import names_in
from ..support.shown import printable
from .parser import add_command
from .words import UsageError


def add_run(commands: Any) -> None:
    """Add `desaxe run`."""
    parser = add_command(commands, "run", "run a scene: values, peaks, checks, pictures", _scene, _inputs)
    parser.add_argument("scene", metavar="SCENE", help="path of a TOML file")
    parser.add_argument(
        "--report", metavar="FILE", dest="page", help="write a report to hand on: one page, .html or .md"
    )
    parser.add_argument(
        "--tolerance",
        metavar="INPUT=HALF",
        action="append",
        default=[],
        help='a tolerance for the report, such as "ec=0.1 mm"; as often as needed',
    )
    add_overwrite(parser)


def _inputs() -> dict[str, str]:
    return {section.upper(): ", ".join(names_in(section)) for section in ("masses", "loads")}


def add_overwrite(parser: argparse.ArgumentParser) -> None:
    """Add --overwrite, the leave to replace what desaxe did not write."""
    parser.add_argument(
        "--overwrite", action="store_true", help="replace files that desaxe did not write, or others changed"
    )


def _scene(options: argparse.Namespace) -> int:
    from ..scenes.command import run_scene

    pairs = [one.partition("=") for one in options.tolerance]
    for name, equals, half in pairs:
        if not (name.strip() and equals and half.strip()):
            raise UsageError(f'--tolerance {printable(name)}: expected INPUT=HALF, such as "ec=0.1 mm"')
    if pairs and options.page is None:
        raise UsageError("--tolerance is for the report: give --report FILE")
    tolerances = {name.strip(): half.strip() for name, _, half in pairs}
    return run_scene(options.scene, options.overwrite, options.page, tolerances)


def add_scene(commands: Any) -> None:
    """Add `desaxe scene`."""
    parser = add_command(commands, "scene", "check a scene file without running it", _check_scene)
    parser.add_argument("scene", metavar="SCENE", nargs="?", help="path of a TOML file")
    parser.add_argument("--schema", action="store_true", help="print the JSON schema of scene files")


def _check_scene(options: argparse.Namespace) -> int:
    if options.schema == (options.scene is not None):
        raise UsageError("which scene? give the path of a file, or --schema")
    if options.schema:
        from ..scenes.schema import json_schema_text

        print(json_schema_text(), end="")
        return 0
    from ..scenes.scene import scene

    found = scene(options.scene)
    outputs = f" (outputs: {', '.join(found.outputs)})" if found.outputs else ""
    print(f"{printable(options.scene)}: OK{outputs}")
    return 0


def add_explain(commands: Any) -> None:
    """Add `desaxe explain`."""
    parser = add_command(commands, "explain", "the plan of a scene, as a database explains a query", _explain)
    parser.add_argument("scene", metavar="SCENE", help="path of a TOML file")
    parser.add_argument("--json", action="store_true", help="print JSON")


def _explain(options: argparse.Namespace) -> int:
    from ..scenes.explain.explain import explain

    plan = explain(options.scene)
    print(plan.to_json() if options.json else plan)
    return 0


def add_compile(commands: Any) -> None:
    """Add `desaxe compile`."""
    parser = add_command(commands, "compile", "write a scene as source code of its own", _compile, _languages)
    parser.add_argument("scene", metavar="SCENE", help="path of a TOML file")
    parser.add_argument("-o", metavar="PLACE", dest="place", required=True, help="the file, or its folder")
    parser.add_argument("--to", metavar="LANGUAGE", default="numba", help="language (default: numba)")
    parser.add_argument(
        "--input", choices=("torque", "omega"), default="torque", help="what drives an FMU (default: torque)"
    )
    parser.add_argument(
        "--check", action="store_true", help="write nothing; exit 1 and show a diff if files are not fresh"
    )
    add_overwrite(parser)


def _languages() -> dict[str, list[str]]:
    from ..compiler.languages import languages

    return {"LANGUAGES": [f"{one.name:11} {one.about}" for one in languages()]}


def _compile(options: argparse.Namespace) -> int:
    from ..scenes.export.command import run_compile

    return run_compile(
        options.scene, options.place, options.to, options.check, options.overwrite, options.input
    )


def add_explore(commands: Any) -> None:
    """Add `desaxe explore`."""
    what = "write an interactive HTML page of the designs of a scene"
    parser = add_command(commands, "explore", what, _explore)
    parser.add_argument("scene", metavar="SCENE", help="path of a TOML file")
    parser.add_argument(
        "-o", metavar="FILE", dest="file", default="explorer.html", help="the page (default: explorer.html)"
    )
    parser.add_argument(
        "--names", metavar="NAMES", help="further quantities of the page, separated by commas"
    )
    add_overwrite(parser)


def _explore(options: argparse.Namespace) -> int:
    from ..scenes.explorer.content import left_out_text
    from ..scenes.explorer.explore import content_of
    from ..scenes.explorer.write import write_page
    from ..support.written import require_path

    place = Path(options.file)
    require_path(place, options.overwrite)
    found = content_of(options.scene, options.names.split(",") if options.names else None)
    print(printable(write_page(found, place, options.overwrite)))
    left = left_out_text(found)
    if left:
        print(f"desaxe: not shown on the page: {left}", file=sys.stderr)
    return 0
