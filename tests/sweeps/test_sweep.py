"""`sweep`: a grid in a Zarr store, gone on with after a stop, with the same values."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import warnings
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
import zarr

import desaxe as dx
from desaxe.support.files import locked
from tests.effort import cases

THETA = np.linspace(0.0, 2.0 * np.pi, 40)
INPUTS = {"theta": THETA, "ec": [-0.05, 0.0, 0.9], "AB": 0.2, "BC": [0.1, 0.5], "omega0": 3.0}
NAMES = ["V_C", "a_C"]
CHUNKS = {"theta": 16}


def states(root):
    """Every file of a store with the time of its last change."""
    return {path: path.stat().st_mtime_ns for path in root.rglob("*")}


def same(root, other):
    """True if two stores are complete and hold the same values, bit for bit, with nothing left behind."""
    one, two = (xr.open_zarr(path).load() for path in (root, other))
    bits = all(one[name].values.tobytes() == two[name].values.tobytes() for name in two.variables)
    return bits and one.identical(two) and not [*root.rglob("*.partial")] and one.state == "complete"


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """An undisturbed run."""
    root = tmp_path_factory.mktemp("sweep") / "whole.zarr"
    dx.sweep(NAMES, store=root, chunks=CHUNKS, **INPUTS).close()
    return root


def test_the_store_is_the_grid(whole):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        stored = xr.open_zarr(whole)
    grid = dx.grid(NAMES, **INPUTS)
    for name in grid.variables:
        assert stored[name].dims == grid[name].dims
        assert stored[name].dtype == grid[name].dtype
        np.testing.assert_array_equal(stored[name], grid[name])
        assert stored[name].attrs.get("units") == grid[name].attrs.get("units")
    assert stored["a_C"].chunks == ((16, 16, 8), (3,), (2,))
    assert set(grid.attrs.items()) <= set(stored.attrs.items())
    assert stored.attrs["state"] == "complete"
    assert {"request", "version", "digest"} <= set(stored.attrs)
    assert "ancillary_variables" in stored["a_C"].attrs


def test_a_finished_store_is_left_as_it_is(whole):
    before = states(whole)
    dx.sweep(NAMES, store=whole, **INPUTS)  # takes the chunks of the store
    assert states(whole) == before
    assert os.listdir(whole.parent) == [whole.name]


def test_what_is_absent_or_damaged_is_computed_again(whole, tmp_path):
    root = tmp_path / "again.zarr"
    dx.sweep(NAMES, store=root, chunks=CHUNKS, **INPUTS)
    before = states(root)
    (root / "a_C" / "c" / "1" / "0" / "0").unlink()
    damaged = root / "V_C" / "c" / "0" / "0" / "0"
    damaged.write_bytes(flipped(damaged.read_bytes(), 77))
    (root / "status" / "c" / "2" / "0" / "0").write_bytes(b"")
    (root / "margin" / "c" / "0" / "0").unlink()
    (root / "a_C" / "c" / "0" / "0" / "0.77.partial").write_bytes(b"left behind")
    dx.sweep(NAMES, store=root, **INPUTS)
    assert same(root, whole)
    changed = {str(p.relative_to(root)) for p, t in states(root).items() if p.is_file() and before[p] != t}
    assert changed == {"a_C/c/1/0/0", "V_C/c/0/0/0", "status/c/2/0/0", "margin/c/0/0"}


DISTURBED = {
    "deleted": lambda data, rng: None,
    "cut off": lambda data, rng: data[: int(rng.integers(len(data)))],
    "a bit flipped": lambda data, rng: flipped(data, int(rng.integers(8 * len(data)))),
}


def flipped(data, bit):
    changed = bytearray(data)
    changed[bit // 8] ^= 1 << bit % 8
    return bytes(changed)


@pytest.mark.sampled
@pytest.mark.parametrize("how", DISTURBED)
def test_any_file_disturbed_is_made_again_or_refused(how, whole, tmp_path):
    """Every file of a store, coordinates and metadata too: the same values again, or a refusal by name."""
    rng = np.random.default_rng(26)
    for trial in range(cases(1, 3, 20)):
        for path in [p for p in sorted(whole.rglob("*")) if p.is_file()][:: cases(3, 1)]:
            root = tmp_path / f"{trial}.zarr"
            shutil.copytree(whole, root)
            disturbed = root / path.relative_to(whole)
            data = DISTURBED[how](path.read_bytes(), rng)
            disturbed.unlink() if data is None else disturbed.write_bytes(data)
            if refused(root):
                assert path.name == "zarr.json" or path.relative_to(whole).parts[0] in INPUTS
            else:
                assert same(root, whole), path
            shutil.rmtree(root)


def refused(root):
    """True if the sweep refuses its store by name."""
    try:
        dx.sweep(NAMES, store=root, **INPUTS).close()
    except FileExistsError as error:
        return str(root) in str(error)
    return False


CHANGES = {
    "a type": ("a_C", {"data_type": "float32"}),
    "a unit": ("V_C", {"attributes": {"units": "mm/s"}}),
    "a factor": ("Y", {"attributes": {"scale_factor": 2.0}}),
    "a shape": ("margin", {"shape": [3, 3]}),
    "a coordinate": ("theta", {"attributes": {"units": "deg"}}),
}


@pytest.mark.thorough
@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("copy", ["the array's", "the group's"])
def test_changed_metadata_are_refused_by_name(change, copy, tmp_path):
    """Those of an array, and their copy in the group, which is what xarray reads."""
    name, other = CHANGES[change]
    root = tmp_path / "changed.zarr"
    dx.sweep(["Y", *NAMES], store=root, chunks=CHUNKS, **INPUTS).close()
    path = root / name / "zarr.json" if copy == "the array's" else root / "zarr.json"
    metadata = json.loads(path.read_text())
    array = metadata if copy == "the array's" else metadata["consolidated_metadata"]["metadata"][name]
    for key, value in other.items():
        array[key] = {**array[key], **value} if isinstance(value, dict) else value
    path.write_text(json.dumps(metadata))
    changed = states(root)
    with pytest.raises(FileExistsError, match=re.escape(f"{root}: changed since a sweep wrote it: {name}.")):
        dx.sweep(["Y", *NAMES], store=root, **INPUTS)
    assert states(root) == changed
    dx.sweep(["Y", *NAMES], store=root, chunks=CHUNKS, overwrite=True, **INPUTS)
    dx.sweep(["Y", *NAMES], store=tmp_path / "new.zarr", chunks=CHUNKS, **INPUTS)
    assert same(root, tmp_path / "new.zarr")


def test_changed_coordinates_are_refused_by_name(whole, tmp_path):
    root = tmp_path / "changed.zarr"
    shutil.copytree(whole, root)
    zarr.open_array(str(root), path="BC", mode="r+")[0] = 0.2
    with pytest.raises(FileExistsError, match="changed since a sweep wrote it: BC"):
        dx.sweep(NAMES, store=root, **INPUTS)


def test_what_others_add_to_a_store_is_left(whole, tmp_path):
    root = tmp_path / "more.zarr"
    shutil.copytree(whole, root)
    group = zarr.open_group(str(root), mode="r+")
    group.attrs["comment"] = "for the review"
    group.create_array("mine", data=np.arange(3.0))
    dx.sweep(NAMES, store=root, **INPUTS)
    assert zarr.open_group(str(root), mode="r").attrs["comment"] == "for the review"
    assert zarr.open_array(str(root / "mine"), mode="r")[1] == 1.0


def test_chunks_without_a_value_are_written(tmp_path):
    stored = dx.sweep(NAMES, store=tmp_path / "empty.zarr", chunks={"ec": 1}, **INPUTS)
    assert np.isnan(stored["a_C"].sel(ec=0.9)).all()
    assert (tmp_path / "empty.zarr" / "a_C" / "c" / "0" / "2" / "0").is_file()


KILLED = """
import sys, numpy as np
import desaxe as dx
theta = np.linspace(0.0, 2.0 * np.pi, 40)
dx.sweep(["V_C", "a_C"], store=sys.argv[1], chunks={"theta": 2}, theta=theta, ec=[-0.05, 0.0, 0.9],
         AB=0.2, BC=[0.1, 0.5], omega0=3.0)
"""


def count(folder):
    return sum(len(files) for _, _, files in os.walk(folder))


@pytest.mark.sampled
def test_killed_at_any_file_it_goes_on(whole, tmp_path):
    """SIGKILL while the store is made, and at any number of its files."""
    root, kills, killed = tmp_path / "killed.zarr", cases(2, 25), 0
    for kill in range(kills):
        process = subprocess.Popen([sys.executable, "-c", KILLED, str(root)], stderr=subprocess.DEVNULL)
        while process.poll() is None and count(tmp_path) <= kill * 80 // kills:
            time.sleep(0.001)
        process.send_signal(signal.SIGKILL)
        killed += process.wait() == -signal.SIGKILL
    assert killed >= kills // 2
    dx.sweep(NAMES, store=root, **INPUTS)
    assert xr.open_zarr(root).a_C.chunks[0] == (2,) * 20
    del (left := xr.open_zarr(root).load()).attrs["chunks"]
    del (right := xr.open_zarr(whole).load()).attrs["chunks"]
    assert left.identical(right)
    assert os.listdir(tmp_path) == [root.name]
    assert not [*root.rglob("*.partial")]


def test_an_interrupt_before_the_first_chunk_says_so_too(tmp_path, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("desaxe.sweeps.sweep.require_disk", interrupt)
    with pytest.raises(KeyboardInterrupt, match=r"early\.zarr: 0 of 3 chunks are kept"):
        dx.sweep(NAMES, store=tmp_path / "early.zarr", chunks=CHUNKS, **INPUTS)


def test_an_interrupt_says_what_is_kept_and_how_to_go_on(whole, tmp_path):
    root = tmp_path / "stopped.zarr"

    def interrupt(done, points, what):
        if done > points // 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as stopped:
        dx.sweep(NAMES, store=root, chunks=CHUNKS, threads=1, progress=interrupt, **INPUTS)
    kept = len(list(root.glob("a_C/c/*/*/*")))
    assert str(stopped.value) == f"{root}: {kept} of 3 chunks are kept; the same sweep goes on from there"
    assert kept
    dx.sweep(NAMES, store=root, **INPUTS)
    assert same(root, whole)


def test_a_store_of_another_sweep_is_refused_with_what_differs(whole):
    before = states(whole)
    with pytest.raises(FileExistsError, match=r"AB is 0\.2 there and 0\.3 here"):
        dx.sweep(NAMES, store=whole, **{**INPUTS, "AB": 0.3})
    with pytest.raises(FileExistsError, match=r"theta is 40 values from 0\.0 .* there and 39 values"):
        dx.sweep(NAMES, store=whole, **{**INPUTS, "theta": THETA[:39]})
    with pytest.raises(FileExistsError, match=r'names is \["V_C", "a_C"\] there'):
        dx.sweep("V_C", store=whole, **INPUTS)
    assert states(whole) == before


def test_of_another_version_too(whole, monkeypatch):
    monkeypatch.setattr("desaxe.sweeps.request.desaxe_version", lambda: "0.0.9")
    with pytest.raises(FileExistsError, match=r"version is .* there and 0\.0\.9 here"):
        dx.sweep(NAMES, store=whole, **INPUTS)


def test_overwrite_replaces_a_store_and_nothing_else(whole, tmp_path):
    root = tmp_path / "other.zarr"
    dx.sweep(NAMES, store=root, **{**INPUTS, "omega0": 4.0})
    dx.sweep(NAMES, store=root, chunks=CHUNKS, overwrite=True, **INPUTS)
    assert same(root, whole)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("years of work")
    with pytest.raises(FileExistsError, match="this is no Zarr store"):
        dx.sweep(NAMES, store=tmp_path / "mine", overwrite=True, **INPUTS)
    assert (tmp_path / "mine" / "thesis.txt").read_text() == "years of work"


def test_a_second_sweep_refuses(whole):
    with locked(whole), pytest.raises(BlockingIOError, match="another sweep is writing this store"):
        dx.sweep(NAMES, store=whole, **INPUTS)


def test_the_margin_comes_beside_a_reduction():
    result = dx.sweep("a_C", reduce={"theta": "absmax"}, **INPUTS)
    np.testing.assert_array_equal(result["margin"], dx.grid(NAMES, **INPUTS)["margin"])


def test_a_sweep_of_numbers_alone_is_one_point(tmp_path):
    one = dx.sweep("a_C", store=tmp_path / "one.zarr", **{**INPUTS, "theta": 1.0, "ec": 0.0, "BC": 0.5})
    assert float(one["a_C"]) == dx.evaluate("a_C", theta=1.0, ec=0.0, AB=0.2, BC=0.5, omega0=3.0)


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        *(({"memory": m}, ValueError, f"memory = '{m}': a number of bytes") for m in ("10 parsec", ". MB")),
        (
            {"memory": np.int64(100_000), "chunks": {"theta": 400}},
            MemoryError,
            r"takes 1\d\d kB .* 100 kB are allowed",
        ),
        (
            {"memory": "200", "theta": np.linspace(0.0, 6.0, 100_000)},
            MemoryError,
            "200 bytes make .* chunks of . points",
        ),
        ({"theta": []}, ValueError, "theta: a sweep needs at least one value"),
        ({"chunks": {"omega0": 2}}, ValueError, "'omega0' is not a dimension"),
        ({"client": "tcp://nowhere"}, TypeError, "expected a distributed.Client"),
    ],
)
def test_what_cannot_be_is_refused_and_nothing_is_written(tmp_path, options, error, words):
    inputs = {**INPUTS, "theta": np.linspace(0.0, 6.0, 400), "store": tmp_path / "no.zarr", **options}
    with pytest.raises(error, match=words):
        dx.sweep(NAMES, **inputs)
    assert not list(tmp_path.iterdir())


def test_what_the_disk_has_no_room_for_is_refused_with_figures(tmp_path, monkeypatch):
    monkeypatch.setattr("shutil.disk_usage", lambda path: SimpleNamespace(free=1000))
    with pytest.raises(OSError, match=r"up to 4\.\d* kB \(240 points, 4 variables\), 1 kB are free"):
        dx.sweep(NAMES, store=tmp_path / "full.zarr", **INPUTS)
    assert not list(tmp_path.iterdir())


def test_progress_counts_points(tmp_path):
    seen = []
    how = {"store": tmp_path / "p.zarr", "chunks": CHUNKS, "progress": lambda *step: seen.append(step)}
    dx.sweep(NAMES, **how, **INPUTS)
    done = [step[0] for step in seen]
    assert (done[0], len(done), done) == (0, 4, sorted(done))
    assert seen[-1] == (240, 240, "sweep, about 0 s left")
