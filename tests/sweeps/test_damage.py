"""Stores whose attributes are damaged are refused in a line; a second writer learns of the first."""

import json
import os
import time
from itertools import product
from shutil import copytree
from threading import Thread

import numpy as np
import pytest

import desaxe as dx
from desaxe.support.files import locked
from tests.effort import first

INPUTS = {
    "theta": np.linspace(0.0, 6.0, 20), "ec": [-0.05, 0.9], "AB": 0.2, "BC": [0.1, 0.5], "omega0": 3.0,
}  # fmt: skip
GRID = {"names": ["V_C", "a_C"], "chunks": {"theta": 8}}
REDUCED = {"names": "a_C", "reduce": {"theta": "absmax"}, "peaks": "a_C"}


def sweep(root, kind, **more):
    return dx.sweep(store=root, **kind, **INPUTS, **more).load(scheduler="synchronous")


@pytest.fixture(scope="module")
def stores(tmp_path_factory):
    result = {}
    for name, kind in (("grid", GRID), ("reduced", REDUCED)):
        result[name] = tmp_path_factory.mktemp("whole") / f"{name}.zarr", kind
        sweep(*result[name])
    return result


def with_attribute(whole, root, name, value):
    copytree(whole, root)
    table = json.loads((root / "zarr.json").read_text())
    table["attributes"][name] = value
    (root / "zarr.json").write_text(json.dumps(table))


BAD = [None, "", "{", '{"theta": 8}', '{"theta": 0, "ec": 2}']


@pytest.mark.parametrize(("value", "kind"), first(3, product(BAD, ["reduced", "grid"])))
def test_chunks_that_are_none_are_refused_in_a_line(stores, kind, value, tmp_path):
    whole, kind = stores[kind]
    root = tmp_path / "press.zarr"
    with_attribute(whole, root, "chunks", value)
    with pytest.raises(
        FileExistsError, match=r"press\.zarr: .*its chunks are .*--overwrite .overwrite=True. replaces it"
    ) as message:
        sweep(root, kind)
    assert "\n" not in str(message.value)
    assert sweep(root, kind, overwrite=True).identical(sweep(whole, kind))
    assert os.listdir(tmp_path) == [root.name]


@pytest.mark.parametrize(
    "value", first(2, ["[" * 10**5, None, "{", '{"inputs": 3}', '{"inputs": {"theta": {"sha256": 1}}}'])
)
def test_of_a_damaged_request_the_differences_are_told(stores, value, tmp_path):
    whole, kind = stores["grid"]
    with_attribute(whole, tmp_path / "press.zarr", "request", value)
    with pytest.raises(FileExistsError, match="a store of another sweep: names is not given there"):
        sweep(tmp_path / "press.zarr", kind)


def test_a_pipe_in_a_store_is_not_waited_for(stores, tmp_path):
    whole, kind = stores["grid"]
    for number, file in enumerate(("zarr.json", "a_C/zarr.json", "theta/c/0", "a_C/c/0/0/0")):
        root = tmp_path / f"{number}.zarr"
        copytree(whole, root)
        (root / file).unlink()
        os.mkfifo(root / file)
        if number == 3:
            assert sweep(root, kind).identical(sweep(whole, kind))
            continue
        with pytest.raises(
            FileExistsError, match="this is no Zarr store" if not number else f"{file} is a pipe"
        ):
            sweep(root, kind)


def test_of_two_sweeps_one_makes_the_store_and_the_other_waits_or_refuses(stores, tmp_path):
    """While one holds the folder to make its store, another sweep waits, and then goes on with that store."""
    whole, kind = stores["grid"]
    root = tmp_path / "press.zarr"
    with locked(tmp_path):
        other = Thread(target=sweep, args=(root, kind))
        other.start()
        time.sleep(0.3)
        assert not root.exists()
        copytree(whole, root)
        before = os.stat(root / "zarr.json").st_mtime_ns
    other.join()
    assert os.stat(root / "zarr.json").st_mtime_ns == before
    assert os.listdir(tmp_path) == [root.name]
