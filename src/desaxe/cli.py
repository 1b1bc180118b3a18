"""The command `desaxe`: one function for each sub-command.

Start-up is light: what a command needs is imported when it runs. A complaint is one line on stderr
with exit code 2.
"""

import argparse
import io
import json
import os
import sys
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout
from importlib import import_module
from math import isfinite
from pathlib import Path
from typing import Any, NoReturn

from ._words import UsageError, names_and_inputs
from .extras import MissingExtraError, needed

SIGNS = """\
signs: Y points along the slider axis towards the slider, theta turns from +Y towards +X;
       V_C and a_C are positive along +Y (away from the crank), the slider axis is at X = -ec;
       forces are positive along +X and +Y, torques like theta."""

INTERRUPTED = 130  # as a shell reports it


class _Parser(argparse.ArgumentParser):
    """A parser whose complaints are one line, like all others."""

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message} (see {self.prog} --help)")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; the exit code: 0 done, 1 a check failed, 2 a complaint."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        code = _run(words)
        sys.stdout.flush()
        return code
    except SystemExit as done:  # --help and --version
        return int(done.code or 0)
    except BrokenPipeError:  # whoever read our output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        print("desaxe: interrupted", file=sys.stderr)
        return INTERRUPTED
    except (UsageError, MissingExtraError, ValueError, TypeError, OSError, MemoryError) as error:
        print(f"desaxe: error: {_one_line(error)}", file=sys.stderr)
        return 2


def _run(words: list[str]) -> int:
    if words[:1] == ["derive"]:  # its options are its own
        return _derive(words[1:])
    if words[:1] == ["point"]:  # options may stand anywhere among its words
        words = ["point", *sorted(words[1:], key=lambda word: not word.startswith("--"))]
    parser = _parser()
    options = parser.parse_args(words)
    run: Callable[[argparse.Namespace], int] | None = getattr(options, "run", None)
    if run is None:
        parser.print_help()
        return 0
    with needed(f"desaxe {words[0]}"):
        return run(options)


def _one_line(error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return " ".join(str(error).split())


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="desaxe",
        description="Offset slider-crank: kinematics with exact sensitivities.",
        epilog=f"{SIGNS}\n\n`desaxe COMMAND --help` explains a command and gives examples.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action=_Version, help="print the version and leave")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", parser_class=_Parser)
    for add in (
        _add_point,
        _add_scene,
        _add_run,
        _add_explain,
        _add_compile,
        _add_explore,
        _add_derive,
        _add_errata,
        _add_audit,
        _add_doctor,
    ):
        add(commands)
    return parser


class _Version(argparse.Action):
    """Looks the version up only when it is asked for."""

    def __init__(self, option_strings: Sequence[str], dest: str, **options: Any) -> None:
        super().__init__(option_strings, argparse.SUPPRESS, nargs=0, **options)

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from . import __version__

        print(f"desaxe {__version__}")
        parser.exit()


def _add(commands: Any, name: str, what: str, more: str, run: Callable[[argparse.Namespace], int]) -> Any:
    """A sub-command: one line about it, and a longer text with examples."""
    parser = commands.add_parser(
        name,
        help=what,
        description=f"{what[0].upper()}{what[1:]}.",
        epilog=more,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    return parser


# ---- point ---------------------------------------------------------------------------------------

_POINT = f"""\
inputs (SI units and radians, or any unit written behind the number):
  theta    crank angle            theta=60deg  theta=1.047
  ec       eccentricity           ec=10mm      either sign
  AB, BC   crank, connecting rod  AB=125mm     BC=0.35
  omega0   crank speed at theta=0 omega0=1500rpm; omega^2 = omega0^2 + 2 alpha theta
  alpha    crank acceleration     alpha=10     0 by default
  omega    speed at this instant, instead of omega0
  branch   1 (default) or -1: on which side of the crank pin the slider is

masses and loads, for forces, torques and energies (0 by default):
  m_crank, m_rod, m_slider  masses                      m_rod=0.5kg
  I_crank, I_rod            about the centre of mass    I_rod="80.6 kg mm2"
  r_crank, r_rod            centre of mass, from A towards B and from B towards C;
                            half of AB and of BC by default
  F_X, F_Y                  force on the slider         F_Y=-50N
  g_X, g_Y                  gravity                     g_X=-9.81m/s2
  mu                        friction of the guide       mu=0.1

Where a value is NaN the status says why: 1 cannot be assembled here, 2 change point, 3 stalled,
5 friction jams (no balance of forces), 6 friction has two balances of forces.

{SIGNS}

examples:
  desaxe point a_C theta=60deg ec=10mm AB=125mm BC=300mm omega0=1500rpm
  desaxe point V_C,a_C,a_C_wrt_ec theta=60deg ec=0 AB=.125 BC=.35 omega0=157.08
  desaxe point T_in,N_C theta=60deg ec=10mm AB=125mm BC=0.3 omega0=0 F_Y=-50N
  desaxe point margin ec=220mm AB=125mm BC=350mm --json
  desaxe point V_C theta=1 ec=0 AB=.125 BC=.35 omega0=157 --quality     with conditions and digits
  desaxe point --list                        all names, with units and meanings"""


def _add_point(commands: Any) -> None:
    parser = _add(commands, "point", "values at one crank angle of one design", _POINT, _point)
    parser.add_argument(
        "words", nargs="*", metavar="NAME | INPUT=VALUE", help="quantities (V_C a_C, or V_C,a_C) and inputs"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--list", action="store_true", help="print the quantities that can be asked for")
    parser.add_argument("--quality", action="store_true", help="print conditions and digits as well")


def _point(options: argparse.Namespace) -> int:
    if options.list:
        return _list()
    from . import evaluate
    from .catalogue import quantity

    names, inputs = names_and_inputs(options.words)
    values: dict[str, Any] = evaluate(names, **inputs)
    rows = {name: quantity(name, "omega" in inputs) for name in names}
    status = _status(values, inputs)
    worth = _qualities(names, inputs) if options.quality else {}
    if options.json:
        found: dict[str, Any] = {
            name: {"value": _json_number(values[name]), "unit": row.unit, "meaning": row.meaning}
            | (_json_quality(worth[name]) if name in worth else {})
            for name, row in rows.items()
        }
        print(json.dumps({**found, **({"status": _status_words()[status]} if status else {})}, indent=2))
        return 0
    texts = [
        f"{name} = {values[name]!r} {'' if row.unit == '1' else row.unit}".rstrip()
        for name, row in rows.items()
    ]
    width = max(map(len, texts))
    for text, row in zip(texts, rows.values(), strict=True):
        print(f"{text:{width}}   {row.meaning}")
    if status:
        print(f"status {status}: {_status_words()[status]}")
    for name, its in worth.items():
        print(f"\n{name}: {its.digits:.1f} digits, rounding error at most {its.error_bound:.1e}")
        for parameter, condition in its.conditions.items():
            print(f"  1 % of {parameter:8} changes it by {condition:.3g} %")
    return 0


def _qualities(names: list[str], inputs: dict[str, Any]) -> dict[str, Any]:
    """What each number is worth."""
    from . import evaluate

    found: dict[str, Any] = evaluate([n for n in names if n != "status"], **inputs, quality=True)
    return found


def _list() -> int:
    from .catalogue import quantities

    rows = quantities().values()
    wide = [max(len(getattr(row, field)) for row in rows) for field in ("name", "unit")]
    for row in rows:
        source = f" ({row.source})" if row.source else ""
        print(f"{row.name:{wide[0]}}  {row.unit:{wide[1]}}  {row.meaning}{source}")
    return 0


def _status(values: dict[str, Any], inputs: dict[str, Any]) -> int:
    """The status at the point; 0 also where too few inputs are given to know."""
    from . import evaluate

    if "status" in values:
        return int(values["status"])
    try:
        return int(evaluate("status", **inputs))
    except TypeError:
        return 0


def _status_words() -> dict[int, str]:
    """Code -> words, from the meaning of `status` in the catalogue."""
    from .catalogue import quantity

    parts = (part.split(" ", 1) for part in quantity("status").meaning.split(", "))
    return {int(code): words for code, words in parts}


def _json_quality(its: Any) -> dict[str, Any]:
    conditions = {parameter: _json_number(condition) for parameter, condition in its.conditions.items()}
    numbers = {"error_bound": _json_number(its.error_bound), "digits": _json_number(its.digits)}
    return {"conditions": conditions, **numbers}


def _json_number(value: float) -> float | None:
    """JSON has no NaN."""
    return value if isfinite(value) else None


# ---- run -----------------------------------------------------------------------------------------

_RUN = """\
A scene is a TOML file. It is data only: nothing in it is executed. Its keys:

  title, accuracy, threads, outputs = ["V_C", "a_C"] (over the grid of all lists and ranges)
  [reduce]        theta = "absmax" (max, min, absmax, mean, rms, or a list of these): of each output
                  over this axis, without storing the grid
  [mechanism]     AB, BC, ec, branch
  [motion]        theta, omega0 or omega, alpha
  [masses]        m_crank, m_rod, m_slider, I_crank, I_rod, r_crank, r_rod
  [loads]         F_X, F_Y, g_X, g_Y, mu
                  each a number (SI), "125 mm", a list, or { start = , stop = , num = or step = }
  [[check]]       printed = { a_C = "-994 m/s2" }, at = { theta = "60 deg" }, source, title, digits
  [[peak]]        quantity, kind (absmax, max or min), over = { ec = [0, "50 mm"] },
                  theta = [from, to], baseline = { ec = 0 }, sensitivities = ["ec", "m_rod"], title
  [[peak.claim]]  at = { ec = "150 mm" }, increase = "33 %", source
  [[picture]]     file, quantity, over = "theta", family = { ec = [0, "50 mm"] }, at, title
  [results]       data = "out/values.nc" (NetCDF; the peaks are groups in it), .zarr, .csv or .npz

`desaxe scene --schema > scene.schema.json` and a first line `#:schema scene.schema.json` let
editors complete and check these keys. Files are written relative to the current directory. Pictures
and values need the extras `plot` and `labelled`.

examples:
  desaxe run examples/compactor.toml
  desaxe run examples/feeder.toml
  desaxe run my_press.toml > report.txt"""


_SCENE = """\
examples:
  desaxe scene my_press.toml                     says what is wrong with it, or nothing
  desaxe scene --schema > scene.schema.json      for editors: #:schema scene.schema.json"""


def _add_scene(commands: Any) -> None:
    parser = _add(commands, "scene", "check a scene file without running it", _SCENE, _check_scene)
    parser.add_argument("scene", metavar="SCENE", nargs="?", help="path of a TOML file")
    parser.add_argument("--schema", action="store_true", help="print the JSON schema of scene files")


def _check_scene(options: argparse.Namespace) -> int:
    if options.schema == (options.scene is not None):
        raise UsageError("which scene? give the path of a file, or --schema")
    if options.schema:
        from ._scene.json_schema import json_schema_text

        print(json_schema_text(), end="")
        return 0
    from . import scene

    found = scene(options.scene)
    print(f"{options.scene}: fine" + (f", {', '.join(found.outputs)}" if found.outputs else ""))
    return 0


_EXPLAIN = """\
What a run will do, without doing it: what is skipped and why, operations at each point after each
pass, what runs in which loop, whether it is compiled, expected time and memory.

examples:
  desaxe explain examples/compactor.toml
  desaxe explain my_press.toml --json"""


def _add_explain(commands: Any) -> None:
    parser = _add(
        commands, "explain", "the plan of a scene, as a database explains a query", _EXPLAIN, _explain
    )
    parser.add_argument("scene", metavar="SCENE", help="path of a TOML file")
    parser.add_argument("--json", action="store_true", help="print JSON")


def _explain(options: argparse.Namespace) -> int:
    from . import explain

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

examples:
  desaxe compile my_press.toml -o my_kernels.py
  desaxe compile my_press.toml --to c -o press
  desaxe compile my_press.toml --to c -o press --check"""


def _add_compile(commands: Any) -> None:
    parser = _add(commands, "compile", "write a scene as source code of its own", _COMPILE, _compile)
    parser.add_argument("scene", metavar="SCENE", help="path of a TOML file")
    parser.add_argument("-o", metavar="PLACE", dest="place", required=True, help="the file, or its folder")
    parser.add_argument("--to", metavar="LANGUAGE", default="numba", help="by default numba")
    parser.add_argument(
        "--no-libm", action="store_true", help="c: with elementary functions of its own, for bare metal"
    )
    parser.add_argument(
        "--check", action="store_true", help="write nothing; exit 1 and show a diff if files are not fresh"
    )


def _compile(options: argparse.Namespace) -> int:
    from ._compile import run_compile

    return run_compile(options.scene, options.place, options.to, not options.no_libm, options.check)


def _add_run(commands: Any) -> None:
    parser = _add(commands, "run", "run a scene: values, peaks, checks, pictures", _RUN, _scene)
    parser.add_argument("scene", metavar="SCENE", help="path of a TOML file")


def _scene(options: argparse.Namespace) -> int:
    from . import scene
    from ._scene.progress import progress_bar

    wanted = scene(options.scene)
    with progress_bar() as progress:
        result = wanted.run(progress)
    print(result)
    return 0


# ---- explore -------------------------------------------------------------------------------------

_EXPLORE = """\
One HTML file that needs no network: open it in a browser, or send it to somebody.
Needs the extra `explore`.

examples:
  desaxe explore examples/compactor.toml
  desaxe explore examples/feeder.toml -o feeder.html --names T_in,F_shaking_Y"""


def _add_explore(commands: Any) -> None:
    what = "write a page on which the designs of a scene can be looked at and changed"
    parser = _add(commands, "explore", what, _EXPLORE, _explore)
    parser.add_argument("scene", metavar="SCENE", help="path of a TOML file")
    parser.add_argument(
        "-o", metavar="FILE", dest="file", default="explorer.html", help="explorer.html without"
    )
    parser.add_argument(
        "--names", metavar="NAMES", help="the quantities that the page knows, beside the scene's"
    )


def _explore(options: argparse.Namespace) -> int:
    from ._explore.call import content_of
    from ._explore.content import left_out_text
    from ._explore.write import write_page

    found = content_of(options.scene, options.names.split(",") if options.names else None)
    print(write_page(found, Path(options.file)))
    left = left_out_text(found)
    if left:
        print(f"desaxe: not shown on the page: {left}", file=sys.stderr)
    return 0


# ---- derive, errata, audit, doctor ---------------------------------------------------------------

_DERIVE = """\
The same command as `python -m derive` from the repository root.

examples:
  desaxe derive --check      is generated/ fresh?
  desaxe derive --report     operations before and after each pass, per quantity"""


def _add_derive(commands: Any) -> None:
    _add(
        commands, "derive", "derive the formulas again with SymPy and write generated/", _DERIVE, lambda _: 0
    )


def _derive(words: list[str]) -> int:
    run = import_module("desaxe.derive.__main__").main
    if not {"-h", "--help"} & set(words):
        with needed("desaxe derive"):
            code: int = run(words)
            return code
    shown = io.StringIO()
    try:
        with redirect_stdout(shown):
            run(words)
    finally:  # it calls itself as one calls it there
        print(shown.getvalue().replace("python -m derive", "desaxe derive"), end="")
    return 0


_ERRATA = """\
examples:
  desaxe errata                       every equation, listing line and claim that was looked at
  desaxe errata --document A          of one paper
  desaxe errata --verdict sign        those with a wrong sign
  desaxe errata --markdown            everything as a page in Markdown"""


def _add_errata(commands: Any) -> None:
    parser = _add(commands, "errata", "what the papers print, and what of it is right", _ERRATA, _errata)
    parser.add_argument("--document", metavar="LETTER", type=str.upper, help="the paper: A, B or C")
    parser.add_argument(
        "--verdict", metavar="WORD", help="correct, typo, sign, wrong claim, not reproducible"
    )
    form = parser.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="print JSON")
    form.add_argument("--markdown", action="store_true", help="print all entries as a page in Markdown")


def _errata(options: argparse.Namespace) -> int:
    from ._errata import entries, markdown, table

    if options.markdown:
        if options.document is not None or options.verdict is not None:
            raise UsageError("--markdown prints all entries: leave --document and --verdict out")
        print(markdown())
        return 0
    found = entries(document=options.document, verdict=options.verdict)
    print(json.dumps([entry._asdict() for entry in found], indent=2) if options.json else table(found))
    return 0


_AUDIT = """\
Every accuracy of desaxe beside NumPy, numba, mpmath and (if installed) heyoka on the textbook's
formula, at generic points and in families of points where formulas lose their digits. The truth is
the loop closure in ball arithmetic. It takes a minute or two; the points are the same every time.
Needs the extras `rigorous`, `derive` and, for the picture, `plot`.

examples:
  desaxe audit --quick        fewer points, half a minute at most
  desaxe audit -o report      writes report/accuracy.md and report/accuracy.png too"""


def _add_audit(commands: Any) -> None:
    parser = _add(commands, "audit", "time and error of every accuracy, measured here", _AUDIT, _audit)
    parser.add_argument("--quick", action="store_true", help="fewer points")
    parser.add_argument(
        "-o", metavar="FOLDER", dest="folder", help="write accuracy.md and accuracy.png there"
    )


def _audit(options: argparse.Namespace) -> int:
    from .audit.command import command

    return command(options.quick, options.folder)


_DOCTOR = """\
Exit code 0 where desaxe can be used, 1 where not. Compiles one small kernel, which takes a second.

example:
  desaxe doctor"""


def _add_doctor(commands: Any) -> None:
    _add(
        commands,
        "doctor",
        "versions, cache, threads, and whether loops vectorise on this CPU",
        _DOCTOR,
        _doctor,
    )


def _doctor(_: argparse.Namespace) -> int:
    from .doctor import examine

    found = examine()
    print(found.text)
    return 0 if found.usable else 1


if __name__ == "__main__":
    sys.exit(main())
