"""Growth of the cost of a sweep: `python -m benchmarks.scale --write` writes docs/scale.md.

Every row is a process of its own, whose peak memory is the system's figure for it. Kernels are compiled
before they are timed. A sweep of ten times the points follows while the disk has room for it, and it takes
`--seconds` at most at the rate of the last one; what was not run is told as extrapolated.
"""

import argparse
import json
import os
import platform
import resource
import shutil
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from .rig import timed

PAGE = Path(__file__).resolve().parents[1] / "docs" / "scale.md"
NAMES = ["V_C", "a_C"]
SENSITIVE = [
    "a_C",
    "a_C_wrt_ec",
    "a_C_wrt_AB",
    "a_C_wrt_BC",
    "a_C_wrt_ec_ec",
    "a_C_wrt_ec_BC",
    "a_C_wrt_BC_BC",
]
BEGIN, END = "<!-- written by `python -m benchmarks.scale --write`: begin -->", "<!-- end -->"
WORKERS_POINTS = 4 * 10**8
FEW_CHUNKS, MANY_CHUNKS = 10, 400  # of the same million points


def inputs(points: int) -> dict[str, Any]:
    """A grid of about `points` points over theta, ec and BC, some of which cannot be assembled."""
    side = max(2, round((points / 1000) ** 0.5)) if points < 10**7 else 100
    theta = max(2, points // side**2)
    return {
        "theta": np.linspace(0.0, 2.0 * np.pi, theta), "ec": np.linspace(-0.15, 0.15, side), "AB": 0.125,
        "BC": np.linspace(0.25, 0.5, side), "omega0": 157.08,
    }  # fmt: skip


def designs(points: int) -> dict[str, Any]:
    """About `points` points as 720 angles of many designs, for reductions over theta."""
    side = max(2, round((points / 720) ** 0.5))
    return {
        "theta": np.linspace(0.0, 2.0 * np.pi, 720), "ec": np.linspace(-0.15, 0.15, side), "AB": 0.125,
        "BC": np.linspace(0.25, 0.5, side), "omega0": 157.08,
    }  # fmt: skip


def job(spec: dict[str, Any]) -> dict[str, float]:
    """One measurement, in the process that it is measured in."""
    import desaxe as dx

    kind, points = spec["kind"], int(spec["points"])
    if kind == "workers":
        return {"seconds": _on_workers(points, spec["workers"]), "points": _size(designs(points))}
    given = inputs(points) if kind == "stored" else designs(points)
    options: dict[str, Any] = {"threads": spec.get("threads")}
    if kind == "stored":
        options["store"] = os.path.join(spec["folder"], "sweep.zarr")
        if "chunk" in spec:
            options["chunks"] = {"theta": spec["chunk"]}
        warm = {**options, "store": os.path.join(spec["folder"], "warm.zarr"), "overwrite": True}
        dx.sweep(NAMES, **warm, **inputs(10_000))
    else:
        options["reduce"] = {"theta": "absmax"}
        dx.sweep(NAMES, **options, **designs(10_000))
    seconds, _ = timed(partial(dx.sweep, NAMES, **options, **given))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    disk = sum(p.stat().st_size for p in Path(options["store"]).rglob("*")) if kind == "stored" else 0
    return {"seconds": seconds, "memory": memory, "disk": disk, "points": _size(given)}


def _size(given: dict[str, Any]) -> int:
    return int(np.prod([np.size(value) for value in given.values()]))


def _on_workers(points: int, workers: int) -> float:
    from distributed import Client, LocalCluster

    import desaxe as dx

    with (
        LocalCluster(
            n_workers=workers, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as cluster,
        Client(cluster) as client,
    ):
        way: dict[str, Any] = {"reduce": {"theta": ["absmax", "rms"]}, "client": client}
        for _ in range(workers):  # each worker loads the kernel
            dx.sweep(SENSITIVE, **way, **designs(points // 8))
        run = partial(dx.sweep, SENSITIVE, **way, **designs(points))
        return min(timed(run)[0] for _ in range(3))


def measured(spec: dict[str, Any]) -> dict[str, float]:
    """The result of a measurement in a fresh process, its files in a folder that is removed."""
    with tempfile.TemporaryDirectory(dir=spec.pop("at", None)) as folder:
        command = [sys.executable, "-m", "benchmarks.scale", "--job", json.dumps({**spec, "folder": folder})]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr)
    result: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return result


def all_measured(seconds: float, at: str) -> dict[str, Any]:
    """Every table of the page."""
    result: dict[str, Any] = {"load": os.getloadavg()[0], "free": shutil.disk_usage(at).free}
    result["stored"] = _grown("stored", 10**6, 10**9, seconds, at)
    result["reduced"] = _grown("reduced", 10**7, 10**10, seconds, at)
    theta = inputs(10**6)["theta"].size
    times = []
    for count in (FEW_CHUNKS, MANY_CHUNKS):
        spec = {"kind": "stored", "points": 10**6, "chunk": -(-theta // count), "threads": 1, "at": at}
        times.append(min(measured(dict(spec))["seconds"] for _ in range(3)))
    result["chunk"] = (times[1] - times[0]) / (MANY_CHUNKS - FEW_CHUNKS)
    result["workers"] = {}
    for workers in (1, 2):
        spec = {"kind": "workers", "points": WORKERS_POINTS, "workers": workers}
        result["workers"][workers] = measured(spec)
        print("workers", result["workers"][workers], file=sys.stderr)
    return result


def _grown(kind: str, points: int, most: int, seconds: float, at: str) -> list[dict[str, float]]:
    """Measurements of ten times as many points each, up to `most`, while time and disk allow."""
    rows = [measured({"kind": kind, "points": points, "at": at})]
    while rows[-1]["points"] < 0.5 * most and _is_affordable(rows[-1], seconds, at):
        rows.append(measured({"kind": kind, "points": points * 10 ** len(rows), "at": at}))
        print(kind, rows[-1], file=sys.stderr)
    return rows


def _is_affordable(row: dict[str, float], seconds: float, at: str) -> bool:
    """True if ten times a measurement fits into the time and, with a third to spare, on the disk."""
    return 10 * row["seconds"] <= seconds and 13 * row["disk"] <= shutil.disk_usage(at).free


def _minutes(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"


def _lookout(rows: list[dict[str, float]], points: float, stored: bool) -> str:
    """Time, and disk if there is any, of a number of points: as measured, or extrapolated."""
    last = rows[-1]
    share = points / last["points"]
    time = _minutes(share * last["seconds"])
    disk = f" and {share * last['disk'] / 1e9:.0f} GB" if stored else ""
    return f"{points:.0e} points {time}{disk} ({'measured' if share < 1.1 else 'extrapolated'})"


def text_of(result: dict[str, Any]) -> str:
    """The measured part of the page."""
    one, two = (result["workers"][k]["seconds"] for k in (1, 2))
    last = result["stored"][-1]
    rate, chunk = last["points"] / last["seconds"], result["chunk"]
    quiet = result["load"] < 0.7
    state = (
        "with nothing else to do" if quiet else f"while it had other work (a load of {result['load']:.1f})"
    )
    noise = "" if quiet else ": times vary by half between runs, memory and disk do not"
    stored = [_lookout(result["stored"], points, True) for points in (1e9, 1e10)]
    return "\n".join([
        BEGIN,
        "",
        f"Measured on {platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}, "
        f"{state}{noise}.",
        "",
        f"Stored: {', '.join(f'`{name}`' for name in NAMES)}, `status` and `margin` over theta, ec and BC.",
        "",
        "| points | time | points a second | peak memory of the process | disk |",
        "|---|---|---|---|---|",
        *(
            f"| {row['points']:.0e} | {row['seconds']:.1f} s | {row['points'] / row['seconds']:.1e} | "
            f"{row['memory'] / 1e6:.0f} MB | {row['disk'] / 1e6:,.0f} MB |"
            for row in result["stored"]
        ),
        "",
        "Reduced: the largest magnitude over 720 angles of each design, its angle, and what was skipped.",
        "",
        "| points | time | points a second | peak memory of the process |",
        "|---|---|---|---|",
        *(
            f"| {row['points']:.0e} | {row['seconds']:.1f} s | {row['points'] / row['seconds']:.1e} | "
            f"{row['memory'] / 1e6:.0f} MB |"
            for row in result["reduced"]
        ),
        "",
        f"Workers: {len(SENSITIVE)} names, first and second sensitivities among them, reduced over "
        f"{result['workers'][1]['points']:.0e} points: {one:.1f} s on one Dask worker, {two:.1f} s on two, "
        f"{one / two:.2f} times as fast.",
        "",
        f"A chunk costs {1e3 * chunk:.0f} ms besides its points: to hand it out, look whether it is "
        f"there, and write {len(NAMES) + 1} files that survive a power failure.",
        "",
        "What follows, at these rates:",
        "",
        f"* Stored: {', '.join(stored)}; {result['free'] / 1e9:.0f} GB were free here. "
        "Memory does not grow with the points.",
        f"* Reduced: {_lookout(result['reduced'], 1e10, False)}, and next to no disk: reduce, or ask for the "
        "best designs, unless every point is wanted.",
        f"* The cost of chunks is {_share(chunk, 1e6, rate)} of a stored sweep with a million points a "
        f"chunk, {_share(chunk, 1e4, rate)} with ten thousand.",
        "* More workers pay while each has a core of its own and the disk keeps up: a stored sweep is bound "
        "by compressing and writing, a reduced one by the cores.",
        "",
        END,
    ])  # fmt: skip


def _share(chunk: float, points: float, rate: float) -> str:
    return f"{100 * chunk / (chunk + points / rate):.0f} %"


def main(arguments: list[str] | None = None) -> int:
    """Measure, print the text, and write it into the page if asked to."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.scale", description=__doc__)
    parser.add_argument("--seconds", type=float, default=270.0, help="the longest of the sweeps (270)")
    parser.add_argument(
        "--at", default=tempfile.gettempdir(), help="the folder for stores, removed afterwards"
    )
    parser.add_argument("--write", action="store_true", help="write docs/scale.md")
    parser.add_argument("--job", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.job:
        print(json.dumps(job(json.loads(options.job))))
        return 0
    text = text_of(all_measured(options.seconds, options.at))
    print(text)
    if options.write:
        page = PAGE.read_text(encoding="utf-8")
        before, _, rest = page.partition(BEGIN)
        PAGE.write_text(before + text + rest.partition(END)[2], encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
