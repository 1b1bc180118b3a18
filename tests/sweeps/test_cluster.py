"""Sweeps on a Dask cluster: the same values, also when a worker is killed."""

import os
import signal
from threading import Thread
from time import sleep

import numpy as np
import pytest
import xarray as xr

import desaxe as dx
from desaxe.sweeps.sweep import VersionError, check_version, run_all

INPUTS = {"theta": np.linspace(0.0, 6.0, 60), "ec": np.linspace(-0.1, 0.3, 20), "AB": 0.1, "omega0": 3.0}
NAMES = ["V_C", "a_C"]
CHUNKS = {"theta": 2}


@pytest.mark.thorough
@pytest.mark.filterwarnings("ignore")  # of a cluster whose worker dies
def test_a_killed_worker_costs_its_chunks_only(tmp_path):
    from distributed import Client, LocalCluster

    inputs = {**INPUTS, "BC": np.linspace(0.2, 0.4, 10)}
    dx.sweep(NAMES, store=tmp_path / "alone.zarr", chunks=CHUNKS, **inputs)
    together = tmp_path / "together.zarr"
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster,
        Client(cluster) as client,
    ):
        victim = next(iter(client.run(os.getpid).values()))

        def kill():
            while len(list(together.glob("a_C/c/*"))) < 4:
                sleep(0.002)
            os.kill(victim, signal.SIGKILL)

        killer = Thread(target=kill)
        killer.start()
        dx.sweep(NAMES, store=together, client=client, chunks=CHUNKS, **inputs)
        killer.join()
        reduced = dx.sweep(NAMES, reduce={"theta": "absmax"}, client=client, **inputs)
    assert xr.open_zarr(together).load().identical(xr.open_zarr(tmp_path / "alone.zarr").load())
    own = dx.grid(NAMES, reduce={"theta": "absmax"}, **inputs)
    np.testing.assert_allclose(reduced["a_C_absmax"], own["a_C_absmax"], rtol=1e-14)


def test_another_version_is_refused_by_name():
    with pytest.raises(VersionError, match=r"this worker has desaxe .*; the sweep is of desaxe 99\.0"):
        check_version("99.0", "0123")


def test_after_an_error_no_further_task_begins():
    from concurrent.futures import ThreadPoolExecutor

    begun = []

    def work(number):
        begun.append(number)
        if number == 3:
            raise OSError("no space left")
        return number

    with ThreadPoolExecutor(1) as executor, pytest.raises(OSError, match="no space left"):
        list(run_all(executor, work, range(100), 2))
    assert begun[-1] <= 4
