"""`desaxe run`, `scene`, `explain`, `compile`, `explore`: the commands on a scene file."""

import argparse
import sys
from pathlib import Path
from typing import Any

from ..mechanism.inputs import names_in
from ..support.shown import printable
from .parser import add_command
from .words import UsageError

_RUN = """\
A scene is a TOML file. It is data only: nothing in it is executed. Its keys:

  title, accuracy, threads, outputs = ["V_C", "a_C"] (over the grid of all lists and ranges)
  [units]         length = "mm", angle = "deg", ...: of plain numbers, report, pictures and files;
                  or units = "mm, deg, rpm"
  [reduce]        theta = "absmax" (max, min, absmax, mean, rms, or a list of these): of each output
                  over this axis, without storing the grid
  [mechanism]     AB, BC, ec, branch
  [motion]        theta, omega0 or omega, alpha
  [masses]        MASSES
  [loads]         LOADS
                  each a number (SI), "125 mm", a list, or { start = , stop = , num = or step = }
  [[check]]       printed = { a_C = "-994 m/s2" }, at = { theta = "60 deg" }, source, title, digits
  [[peak]]        quantity, kind (absmax, max or min), over = { ec = [0, "50 mm"] },
                  theta = [from, to], baseline = { ec = 0 }, sensitivities = ["ec", "m_rod"], title
  [[peak.claim]]  at = { ec = "150 mm" }, increase = "33 %", source
  [[picture]]     file, quantity, over = "theta", family = { ec = [0, "50 mm"] }, at, title
  [results]       data = "out/values.nc" (NetCDF; the peaks are groups in it), .zarr, .csv,
                  .xlsx (Excel) or .npz;
                  or store = "press.zarr" with chunks = { theta = 1000 }, memory = "200 MB";
                  order = "smallest" or "largest": the best of `desaxe sweep --best`

`desaxe scene --schema > scene.schema.json` and a first line `#:schema scene.schema.json` let
editors complete and check these keys. Files are written relative to the current directory; what
desaxe wrote itself is replaced, another file only with --overwrite. All places are looked at before
anything is computed. Pictures and values need the extras `plot` and `labelled`.

examples:
  desaxe run examples/compactor.toml
  desaxe run examples/feeder.toml
  desaxe run my_press.toml > report.txt
  desaxe run my_press.toml --report press.html --tolerance ec=0.1mm""".replace(
    "MASSES", ", ".join(names_in("masses"))
).replace("LOADS", ", ".join(names_in("loads")))


def add_run(commands: Any) -> None:
    """Add `desaxe run`."""
    parser = add_command(commands, "run", "run a scene: values, peaks, checks, pictures", _RUN, _scene)
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


_SCENE = """\
examples:
  desaxe scene my_press.toml                     prints what is wrong with it, or nothing
  desaxe scene --schema > scene.schema.json      for editors: #:schema scene.schema.json"""


def add_scene(commands: Any) -> None:
    """Add `desaxe scene`."""
    parser = add_command(commands, "scene", "check a scene file without running it", _SCENE, _check_scene)
    parser.add_argument("scene", metavar="SCENE", nargs="?", help="path of a TOML file")
    parser.add_argument("--schema", action="store_true", help="print the JSON schema of scene files")


def _check_scene(options: argparse.Namespace) -> int:
    if options.schema == (options.scene is not None):
        raise UsageError("which scene? give the path of a file, or --schema")
    if options.schema:
        from ..scenes.json_schema import json_schema_text

        print(json_schema_text(), end="")
        return 0
    from ..scenes.scene import scene

    found = scene(options.scene)
    print(f"{printable(options.scene)}: fine" + (f", {', '.join(found.outputs)}" if found.outputs else ""))
    return 0


_EXPLAIN = """\
What a run will do, without doing it: what is skipped and why, operations at each point after each
pass, what runs in which loop, whether it is compiled, expected time and memory.

examples:
  desaxe explain examples/compactor.toml
  desaxe explain my_press.toml --json"""


def add_explain(commands: Any) -> None:
    """Add `desaxe explain`."""
    parser = add_command(
        commands, "explain", "the plan of a scene, as a database explains a query", _EXPLAIN, _explain
    )
    parser.add_argument("scene", metavar="SCENE", help="path of a TOML file")
    parser.add_argument("--json", action="store_true", help="print JSON")


def _explain(options: argparse.Namespace) -> int:
    from ..scenes.explain.explain import explain

    plan = explain(options.scene)
    print(plan.to_json() if options.json else plan)
    return 0


_COMPILE = """\
Writes source code of its own, which needs nothing of desaxe. What the scene gives as a number
is folded in; its lists and ranges are the arguments.

  numba       FILE.py: `point(...)`, `evaluate(...)`, `run()`; it needs NumPy and numba
  c           FOLDER/name.h and name.c, C99, named as the folder
  octave      name.m, for GNU Octave and MATLAB
  jax         a Python module over jax.numpy, with exact derivatives
  javascript  an ES module and its types
  fmu         NAME.fmu, a Functional Mock-up Unit with its sources (extra fmu)

examples:
  desaxe compile my_press.toml -o my_kernels.py
  desaxe compile my_press.toml --to fmu -o press.fmu
  desaxe compile my_press.toml --to c -o press
  desaxe compile my_press.toml --to c -o press --check"""


def add_compile(commands: Any) -> None:
    """Add `desaxe compile`."""
    parser = add_command(commands, "compile", "write a scene as source code of its own", _COMPILE, _compile)
    parser.add_argument("scene", metavar="SCENE", help="path of a TOML file")
    parser.add_argument("-o", metavar="PLACE", dest="place", required=True, help="the file, or its folder")
    parser.add_argument("--to", metavar="LANGUAGE", default="numba", help="language (default: numba)")
    parser.add_argument(
        "--no-libm",
        action="store_true",
        help="C without libm: elementary functions of its own, for bare metal",
    )
    parser.add_argument(
        "--float", action="store_true", help="C in single precision, for a processor without doubles"
    )
    parser.add_argument(
        "--tables", choices=("frozen", "arguments"), default="frozen",
        help="tables of loads: in the text, or knots and coefficients as arguments (default: frozen)",
    )  # fmt: skip
    parser.add_argument("--fmi", type=int, choices=(3, 2), default=3, help="version of an FMU (default: 3)")
    parser.add_argument(
        "--input", choices=("torque", "omega"), default="torque", help="what drives an FMU (default: torque)"
    )
    parser.add_argument(
        "--check", action="store_true", help="write nothing; exit 1 and show a diff if files are not fresh"
    )
    add_overwrite(parser)


def _compile(options: argparse.Namespace) -> int:
    from ..scenes.export.command import run_compile
    from ..scenes.export.portable import Form

    form = Form(options.no_libm, options.float, options.tables == "arguments")
    return run_compile(
        options.scene, options.place, options.to, form, options.check, options.overwrite,
        options.fmi, options.input,
    )  # fmt: skip


_EXPLORE = """\
One HTML file that needs no network: open it in a browser, or send it to somebody.
Needs the extra `explore`.

examples:
  desaxe explore examples/compactor.toml
  desaxe explore examples/feeder.toml -o feeder.html --names T_in,F_shaking_Y"""


def add_explore(commands: Any) -> None:
    """Add `desaxe explore`."""
    what = "write an interactive HTML page of the designs of a scene"
    parser = add_command(commands, "explore", what, _EXPLORE, _explore)
    parser.add_argument("scene", metavar="SCENE", help="path of a TOML file")
    parser.add_argument(
        "-o", metavar="FILE", dest="file", default="explorer.html", help="the page (default: explorer.html)"
    )
    parser.add_argument(
        "--names", metavar="NAMES", help="further quantities of the page, separated by commas"
    )
    add_overwrite(parser)


def _explore(options: argparse.Namespace) -> int:
    from ..runtime.written import require_place
    from ..scenes.explorer.content import left_out_text
    from ..scenes.explorer.explore import content_of
    from ..scenes.explorer.write import write_page

    place = Path(options.file)
    require_place(place, options.overwrite)
    found = content_of(options.scene, options.names.split(",") if options.names else None)
    print(printable(write_page(found, place, options.overwrite)))
    left = left_out_text(found)
    if left:
        print(f"desaxe: not shown on the page: {left}", file=sys.stderr)
    return 0
