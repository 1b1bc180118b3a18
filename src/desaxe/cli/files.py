"""`desaxe run`, `scene`, `sweep`, `explain`, `compile`, `explore`, `derive`: the commands on files."""

import argparse
import io
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, redirect_stdout
from importlib import import_module
from pathlib import Path
from typing import Any

from ..mechanism.inputs import names_in
from ..support.extras import explained, needed
from ..support.shown import in_brief, printable
from .parser import FLAG, JSON, OVERWRITE, Command, Option, Parser
from .words import UsageError

SCENE = Option("scene", "path of a TOML file", {"metavar": "SCENE"})


def _run(options: argparse.Namespace) -> int:
    from ..scenes.command import run_scene
    from ..scenes.reading.read import plain_data

    pairs = [one.partition("=") for one in options.tolerance]
    for name, equals, half in pairs:
        if not (name.strip() and equals and half.strip()):
            raise UsageError(f'--tolerance {printable(name)}: expected INPUT=HALF, such as "ec=0.1 mm"')
    if pairs and options.report is None:
        raise UsageError("--tolerance is for the report: give --report FILE")
    tolerances = {name.strip(): half.strip() for name, _, half in pairs}
    if "crankshaft" in plain_data(options.scene):
        return _run_shaft(options, tolerances)
    return run_scene(options.scene, options.overwrite, options.report, tolerances)


def _run_shaft(options: argparse.Namespace, tolerances: Mapping[str, str]) -> int:
    """Several sliders on one crankshaft."""
    if tolerances:
        raise UsageError("--tolerance: a report of one slider has tolerances; see desaxe tolerance --machine")
    text = _shaft_of(options.scene).run(options.overwrite, options.report and Path(options.report))
    print(text)  # last: its reader may be gone
    return 0


def _shaft_of(path: str) -> Any:
    """The requests of a scene file with [crankshaft]."""
    from ..machine.crankshaft import content_of_shaft, shaft_of
    from ..machine.crankshaft_report import requested
    from ..support.toml import read_toml

    content, table = content_of_shaft(path)
    return requested(shaft_of(content, table), content, read_toml(Path(path)))


def _sections() -> dict[str, str]:
    return {section.upper(): ", ".join(names_in(section)) for section in ("masses", "loads")}


def _scene(options: argparse.Namespace) -> int:
    if options.schema == (options.scene is not None):
        raise UsageError("which scene? give the path of a file, or --schema")
    if options.schema:
        from ..scenes.schema import json_schema_text

        print(json_schema_text(), end="")
        return 0
    from ..scenes.reading.read import plain_data
    from ..scenes.scene import scene

    read: Any = _shaft_of if "crankshaft" in plain_data(options.scene) else scene
    outputs = ", ".join(read(options.scene).outputs)
    print(f"{printable(options.scene)}: OK" + (f" (outputs: {outputs})" if outputs else ""))
    return 0


def _explain(options: argparse.Namespace) -> int:
    from ..scenes.explain.explain import explain

    plan = explain(options.scene)
    print(plan.to_json() if options.json else plan)
    return 0


def _languages() -> dict[str, list[str]]:
    from ..compiler.languages import languages

    return {"LANGUAGES": [f"{one.name:11} {one.about}" for one in languages()]}


def _compile(options: argparse.Namespace) -> int:
    from ..scenes.export.command import run_compile
    from ..scenes.reading.read import plain_data

    if "crankshaft" in plain_data(options.scene):
        return _compile_shaft(options)
    place, language = options.place, options.to
    return run_compile(options.scene, place, language, options.check, options.overwrite, options.input)


def _compile_shaft(options: argparse.Namespace) -> int:
    """Several sliders on one crankshaft."""
    from ..machine.crankshaft import OF_SHAFT, Crankshaft, files_of
    from ..scenes.export.command import write_files
    from ..support.toml import read_toml

    outputs = read_toml(Path(options.scene)).get("outputs", OF_SHAFT)
    source = Path(options.scene).name
    made = files_of(Crankshaft.read(options.scene), Path(options.place), outputs, options.to, source)
    return write_files(made, options.scene, options.place, options.check, options.overwrite)


def _explore(options: argparse.Namespace) -> int:
    from ..scenes.explorer.content import left_out_text
    from ..scenes.explorer.explore import content_of
    from ..scenes.explorer.write import write_page
    from ..support.written import require_path

    file = Path(options.file)
    require_path(file, options.overwrite)
    content = content_of(options.scene, options.names.split(",") if options.names else None)
    print(printable(write_page(content, file, options.overwrite)))
    if left := left_out_text(content):
        print(f"desaxe: not shown on the page: {left}", file=sys.stderr)
    return 0


# ---- sweeps --------------------------------------------------------------------------------------


def _sweep(options: argparse.Namespace) -> int:
    from ..scenes.parts.grid import sweep_content
    from ..scenes.scene import scene
    from ..scenes.stores.files import write
    from ..support.memory import require
    from ..support.written import require_path
    from ..sweeps.sweep import VersionError

    content = scene(options.scene).content
    store, netcdf = options.store or content.store, options.netcdf and Path(options.netcdf)
    if store is None:
        raise UsageError("where to? give -o STORE.zarr, or [results] store in the scene")
    if netcdf is not None:
        if netcdf.suffix != ".nc":
            raise UsageError(f"--netcdf {printable(netcdf)}: its name must end in .nc")
        require_path(netcdf, options.overwrite)
    chunks = _chunks(options.chunks)
    try:
        with _client(options) as client:
            run = {"store": options.store, "overwrite": options.overwrite, "client": client}
            dataset = sweep_content(content, chunks=chunks, memory=options.memory, tell=print, **run)
    except VersionError as error:
        raise UsageError(str(error)) from None
    shape = " x ".join(f"{name} ({size})" for name, size in dataset.sizes.items())
    print(f"{printable(store)}: {', '.join(map(str, dataset.data_vars))} over {shape or 'one point'}")
    if netcdf is not None:
        require(2 * dataset.nbytes, f"--netcdf {printable(netcdf)}")
        write(netcdf, dataset.load(), {}, options.overwrite)
        print(f"{printable(netcdf)}: the same as NetCDF")
    return 0


def _chunks(text: str | None) -> Any:
    """`auto`, a number, or `theta=1000,ec=10`."""
    pairs = [part.rpartition("=") for part in (text or "auto").split(",")]
    try:
        lengths = {name.strip(): n if n == "auto" else int(n) for name, _, n in pairs}
    except ValueError:
        raise UsageError(f"--chunks {text}: auto, a number, or pairs such as theta=1000,ec=10") from None
    return lengths[""] if [*lengths] == [""] else lengths


@contextmanager
def _client(options: argparse.Namespace) -> Iterator[Any]:
    """A client of the cluster that is named, or of processes here; None for threads."""
    if options.workers is None and options.scheduler is None:
        yield None
        return
    if options.scheduler is not None and options.workers is not None:
        raise UsageError("--workers: processes of a scheduler are its own; give one of the two")
    if options.workers is not None and options.workers < 1:
        raise UsageError(f"--workers {options.workers}: at least 1")
    with needed("a Dask cluster"):
        from distributed import Client
    here = {"n_workers": options.workers, "threads_per_worker": 1, "dashboard_address": None}
    with Client(options.scheduler, timeout="30s", **({} if options.scheduler else here)) as client:
        yield client


# ---- derivation ----------------------------------------------------------------------------------


def derive(words: list[str]) -> int:
    """Run the derivation's own command line, under the name `desaxe derive`."""
    if any(word.partition("=")[0] == "--quantities" for word in words):
        return _package(words)
    run = import_module("desaxe.derive.__main__").main
    if not {"-h", "--help"} & set(words):
        with explained("desaxe derive"):
            code: int = run(words)
            return code
    text = io.StringIO()
    try:
        with redirect_stdout(text):
            run(words)
    finally:  # it calls itself as one calls it there
        print(text.getvalue().replace("python -m derive", "desaxe derive"), end="")
    return 0


def _package(words: list[str]) -> int:
    """Write, or check, the package of a file's own quantities: no SymPy is needed."""
    from ..scenes.export.package import write_package

    parser = Parser(prog="desaxe derive", description="a package of quantities of your own")
    for option in QUANTITIES:
        parser.add_argument(option.name, help=option.help, **option.more)
    options = parser.parse_args(words)
    source, folder = options.quantities, options.o
    try:
        differences = write_package(source, folder, options.check, options.overwrite)
    except (ValueError, TypeError, OSError) as error:
        print(f"desaxe derive: {printable(error)}", file=sys.stderr)
        return 2
    if not options.check:
        print(f"wrote {printable(folder)}")
        return 0
    remedy = f"run desaxe derive --quantities {printable(source)} -o {printable(folder)}"
    print(f"{printable(folder.name)}/ is {'stale: ' + remedy if differences else 'fresh'}")
    print("".join(f"{printable(line)}\n" for line in in_brief(differences).splitlines()), end="")
    return 1 if differences else 0


PLACE = {"metavar": "PLACE", "dest": "place"}
FILE, CHECK = {"metavar": "FILE"}, "write nothing; exit 1 and show a diff if files are not fresh"
REQUIRED: Any = {"type": Path, "required": True}
QUANTITIES = (
    Option("--quantities", "a TOML file with [quantities.NAME]", REQUIRED),
    Option("-o", "the folder of the package", REQUIRED),
    Option("--check", "compare, exit 1 on a difference", FLAG), OVERWRITE,
)  # fmt: skip
FILES = (
    Command("scene", "check a scene file without running it", _scene, (
        Option("scene", "path of a TOML file", {"metavar": "SCENE", "nargs": "?"}),
        Option("--schema", "print the JSON schema of scene files", FLAG),
    )),
    Command("run", "run a scene: values, peaks, checks, pictures", _run, (
        SCENE, Option("--report", "write a report to hand on: one page, .html or .md", FILE),
        Option("--tolerance", 'a tolerance for the report, such as "ec=0.1 mm"; as often as needed',
               {"metavar": "INPUT=HALF", "action": "append", "default": []}), OVERWRITE,
    ), _sections),
    Command("sweep", "a grid of any size into a Zarr store, resumable", _sweep, (
        SCENE, Option("-o", "path of the store (default: that of [results])", {"dest": "store"}),
        Option("--chunks", "auto, a number, or theta=1000,ec=10"),
        Option("--memory", 'memory for the chunks in flight, such as "200 MB"', {"metavar": "SIZE"}),
        Option("--netcdf", "write it as NetCDF too, if it fits into memory", FILE),
        Option("--workers", "processes on this machine", {"metavar": "N", "type": int}),
        Option("--scheduler", "address of a Dask scheduler", {"metavar": "ADDRESS"}), OVERWRITE,
    )),
    Command("explain", "the plan of a scene, as a database explains a query", _explain, (SCENE, JSON)),
    Command("compile", "write a scene as source code of its own", _compile, (
        SCENE, Option("-o", "the file, or its folder", {**PLACE, "required": True}),
        Option("--to", "language (default: numba)", {"metavar": "LANGUAGE", "default": "numba"}),
        Option("--input", "what drives an FMU (default: torque)",
               {"choices": ("torque", "omega"), "default": "torque"}),
        Option("--check", CHECK, FLAG), OVERWRITE,
    ), _languages),
    Command("explore", "write an interactive HTML page of the designs of a scene", _explore, (
        SCENE, Option("-o", "the page (default: explorer.html)", {**FILE, "dest": "file",
                                                                  "default": "explorer.html"}),
        Option("--names", "further quantities of the page, separated by commas"), OVERWRITE,
    )),
    Command("derive", "derive the formulas again with SymPy and write generated/", lambda _: 0),
)  # fmt: skip
