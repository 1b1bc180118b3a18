"""Stores whose attributes are damaged are refused in a line; a second writer learns of the first."""

import json
import os
import time
from shutil import copytree

import numpy as np
import pytest
import xarray as xr

import desaxe as dx
from desaxe.scenes.stores import quiet_store
from desaxe.sweeps import place, store

INPUTS = {
    "theta": np.linspace(0.0, 6.0, 20), "ec": [-0.05, 0.9], "AB": 0.2, "BC": [0.1, 0.5], "omega0": 3.0,
}  # fmt: skip
GRID = {"names": ["V_C", "a_C"], "chunks": {"theta": 8}}
REDUCED = {"names": "a_C", "reduce": {"theta": "absmax"}, "peaks": "a_C"}


def sweep(root, kind, **more):
    return dx.sweep(store=root, **kind, **INPUTS, **more).load(scheduler="synchronous")


@pytest.fixture(scope="module")
def stores(tmp_path_factory):
    found = {}
    for name, kind in (("grid", GRID), ("reduced", REDUCED)):
        found[name] = tmp_path_factory.mktemp("whole") / f"{name}.zarr", kind
        sweep(*found[name])
    return found


def with_attribute(whole, root, name, value):
    copytree(whole, root)
    table = json.loads((root / "zarr.json").read_text())
    table["attributes"][name] = value
    (root / "zarr.json").write_text(json.dumps(table))


BAD = [None, "", "{", '{"theta": 8}', '{"theta": 0, "ec": 2}']


@pytest.mark.parametrize("kind", ["grid", "reduced"])
@pytest.mark.parametrize("value", BAD)
def test_chunks_that_are_none_are_refused_in_a_line(stores, kind, value, tmp_path):
    whole, kind = stores[kind]
    root = tmp_path / "press.zarr"
    with_attribute(whole, root, "chunks", value)
    with pytest.raises(
        FileExistsError, match=r"press\.zarr: .*its chunks are .*overwrite=True replaces it"
    ) as told:
        sweep(root, kind)
    assert "\n" not in str(told.value)
    assert sweep(root, kind, overwrite=True).identical(sweep(whole, kind))
    assert os.listdir(tmp_path) == [root.name]


@pytest.mark.parametrize(
    "value", [None, "{", '{"inputs": 3}', '{"inputs": {"theta": {"sha256": 1}}}', "[" * 10**5]
)
def test_of_a_damaged_request_the_differences_are_told(stores, value, tmp_path):
    whole, kind = stores["grid"]
    with_attribute(whole, tmp_path / "press.zarr", "request", value)
    with pytest.raises(FileExistsError, match="a store of another sweep: names is not given there"):
        sweep(tmp_path / "press.zarr", kind)


def test_a_pipe_in_the_place_of_a_store_s_files_is_not_waited_for(stores, tmp_path):
    whole, kind = stores["grid"]
    for number, file in enumerate(("zarr.json", "a_C/zarr.json", "a_C/c/0/0/0", "theta/c/0")):
        root = tmp_path / f"{number}.zarr"
        copytree(whole, root)
        (root / file).unlink()
        os.mkfifo(root / file)
        if file == "zarr.json":
            with pytest.raises(FileExistsError, match="this is no Zarr store"):
                sweep(root, kind)
        else:
            assert sweep(root, kind).identical(sweep(whole, kind))


@pytest.mark.parametrize("kind", ["grid", "reduced"])
def test_a_store_that_another_sweep_has_made_meanwhile(stores, kind, tmp_path, monkeypatch):
    whole, kind = stores[kind]
    root = tmp_path / "press.zarr"

    def appears(path):
        if not root.exists():
            copytree(whole, root)

    monkeypatch.setattr("desaxe.sweeps.store.sync_folders", appears)  # just before it is put in its place
    with pytest.raises(BlockingIOError, match=r"press\.zarr: another sweep is writing this store"):
        sweep(root, kind)
    assert os.listdir(tmp_path) == [root.name]


@pytest.mark.parametrize("kind", ["grid", "reduced"])
@pytest.mark.parametrize("empty", [False, True])
@pytest.mark.parametrize("looks", [1, 2])
def test_a_store_that_appears_between_two_looks(stores, kind, empty, looks, tmp_path, monkeypatch):
    """Whenever another sweep puts its store into the place, this one goes on with it or says so."""
    whole, kind = stores[kind]
    root = tmp_path / "press.zarr"
    if empty:
        root.mkdir()
    seen = []

    def look(path, real=place.attributes):
        found = real(path)
        seen.append(path)
        if len(seen) == looks:
            copytree(whole, root, dirs_exist_ok=True)
        return found

    monkeypatch.setattr(place, "attributes", look)
    monkeypatch.setattr(store, "attributes", look)
    try:
        told = str(sweep(root, kind).identical(sweep(whole, kind)))
    except BlockingIOError as error:
        told = str(error)
    assert len(seen) >= looks
    assert told in ("True", f"{root}: another sweep is writing this store")
    assert os.listdir(tmp_path) == [root.name]


def test_nothing_is_written_after_an_error(tmp_path, monkeypatch):
    begun = []

    def full(path, data):
        begun.append(path)
        time.sleep(0.01)
        if len(begun) == 4:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(quiet_store, "write", full)
    many = xr.Dataset({f"v{k}": (("x", "y"), np.ones((40, 40))) for k in range(9)})
    chunks = {name: {"chunks": (5, 5)} for name in many}
    with pytest.raises(OSError, match="No space left"), quiet_store.quiet_store(tmp_path / "a.zarr") as store:
        many.to_zarr(store, mode="w", encoding=chunks, consolidated=False, zarr_format=3)
    time.sleep(0.1)
    assert len(begun) == 4
