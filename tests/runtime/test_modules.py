"""Machine code from disk without numba: the same bits; what is damaged or foreign is made anew."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from desaxe.runtime.native import modules

ANSWERS = """
import sys
if sys.argv[1] == "blocked":
    sys.modules["numba"] = None
import numpy as np
import desaxe as dx
theta = np.linspace(-7.0, 7.0, 100_001)
theta[5] = np.nan
ec = np.linspace(-0.3, 0.3, theta.size)
machine = {"AB": 0.125, "BC": 0.35, "omega0": 157.08}
for accuracy in ("standard", "extended"):
    for inputs in ({"theta": theta, "ec": ec}, {"theta": theta, "ec": 0.01, "alpha": 2.0}):
        found = dx.evaluate(["a_C", "status"], **inputs, **machine, accuracy=accuracy, threads=2)
        print(found["a_C"].view(np.int64).sum(), np.nansum(found["a_C"]).hex(), found["status"].sum())
ecs = np.linspace(-0.05, 0.05, 900)
peak = dx.peak("a_C", ec=ecs, **machine)
print(peak["value"].view(np.int64).sum(), peak["theta"].view(np.int64).sum())
rows = {"theta": np.linspace(0.0, 6.0, 100), "ec": ecs, "AB": 0.125, "BC": 0.35, "omega0": 157.08}
reduced = dx.grid("a_C", **rows, reduce={"theta": ["absmax", "rms", "mean"]})
print(*(reduced[name].values.view(np.int64).sum() for name in ("a_C_absmax", "a_C_rms", "a_C_mean")))
motion = dx.simulate(torque=[0.0, 0.2], t_end=0.2, ec=0.01, AB=0.125, BC=0.35, m_slider=1.0, I_crank=0.1)
print(motion["theta"].view(np.int64).sum())
far = dx.evaluate("V_C", theta=1e9 + theta, ec=ec, **machine)
print(far.view(np.int64).sum(), np.nansum(far).hex())
print("numba" in sys.modules and sys.modules["numba"] is not None, file=sys.stderr)
"""


def answers(folder, numba, program=ANSWERS):
    command = [sys.executable, "-c", program, numba]
    environment = {**os.environ, "DESAXE_CACHE_DIR": str(folder)}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout, done.stderr.strip()


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A cache folder with compiled kernels, and what they answered."""
    folder = tmp_path_factory.mktemp("cache")
    return folder, *answers(folder, "there")


@pytest.mark.thorough
def test_the_same_bits_without_numba(kept):
    folder, found, numba = kept
    assert numba == "True"
    files = {path.suffix for path in folder.iterdir()}
    assert files == {".code", ".lock"}
    assert any(folder.glob("*.code"))
    assert answers(folder, "blocked") == (found, "False")


ADD = """
from numba import njit, types

def function(x, y, out):
    for i in range(out.shape[0]):
        out[i] = x[i, 0] + y
    return 7

signature = types.int64(types.float64[:, ::1], types.float64, types.float64[:])
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(modules._cache, "folder", lambda: modules._cache.Folder(tmp_path, True))
    return tmp_path


def added():
    """The result of the text for arrays of any stride and a number."""
    out = np.zeros(6)
    answer = modules.native("add", ADD)(np.arange(6.0).reshape(3, 2), 0.5, out[::2])
    return answer, out.tolist()


RIGHT = 7, [0.5, 0.0, 2.5, 0.0, 4.5, 0.0]


def test_a_text_becomes_a_function_and_a_file(folder):
    assert added() == RIGHT
    (path,) = folder.glob("*.code")
    assert path == modules.path_of("add", ADD)
    before = path.read_bytes()
    assert added() == RIGHT
    assert path.read_bytes() == before


def test_a_damaged_or_foreign_file_is_made_anew(folder, monkeypatch):
    added()
    path = modules.path_of("add", ADD)
    whole = path.read_bytes()
    head, _, code = whole.partition(b"\n")
    told = json.loads(head)
    bad = [b"", b"{}", b"[]", b"no json\n" + code, head + b"\n" + code[:-1], head]
    bad += [json.dumps({**told, key: "another"}).encode() + b"\n" + code for key in ("machine", "sha256")]
    bad += [json.dumps({**told, "ranks": ranks}).encode() + b"\n" + code for ranks in ([-1], "x", 3)]
    for data in bad:
        path.write_bytes(data)
        assert modules._from_disk(path) is None
    assert added() == RIGHT
    assert modules._from_disk(path) is not None
    monkeypatch.setattr(modules, "machine", lambda: "another")
    assert modules.path_of("add", ADD) != path


NO_ROOM = """
from numba import njit, types
from numpy import empty

def function(n, out):
    room = empty(n)
    room[0] = 1.0
    out[0] = room[0]

signature = types.void(types.int64, types.float64[::1])
"""


def test_no_memory_is_an_error(folder):
    function = modules.native("room", NO_ROOM)
    out = np.zeros(1)
    assert function(3, out) == 0
    assert out[0] == 1.0
    with pytest.raises(MemoryError, match="no memory for the tables of a kernel"):
        function(2**58, out)


@pytest.mark.thorough
def test_a_text_that_calls_what_only_numba_can_give_runs_in_this_process(folder):
    text = """
from numba import types

def function(x, out):
    out[0] = given(x)

signature = types.void(types.float64, types.float64[::1])
"""
    from numba import njit

    out = np.zeros(1)
    modules.native_here(text, {"given": njit(lambda x: 1.0 if str(int(x)) == "3" else 0.0)})(3.0, out)
    assert out[0] == 1.0
    assert list(folder.iterdir()) == []


ALL = """
import sys
if sys.argv[1] == "blocked":
    sys.modules["numba"] = None
import numpy as np
import desaxe as dx
names = list(dx.quantities())
theta = np.linspace(0.0, 6.0, 2500)
loads = {"m_rod": 1.0, "m_slider": 2.0, "mu": 0.1, "g_Y": -9.81}
sums = []


def bits(array):
    return int(np.ascontiguousarray(array).view(np.uint8).astype(np.int64).sum())


for again in (1, 2):
    found = dx.evaluate(names, theta=theta, ec=0.01, AB=0.125, BC=0.35, omega0=157.08, **loads)
    sums.append(sum(map(bits, found.values())))
print(len(found) > 500, sums[0] == sums[1], sums[0])
print("numba" in sys.modules and sys.modules["numba"] is not None, file=sys.stderr)
"""


@pytest.mark.thorough
def test_no_request_is_too_wide(tmp_path):
    """All names at once, twice, in two processes without numba."""
    found, numba = answers(tmp_path, "there", ALL)
    assert found.startswith("True True")
    assert answers(tmp_path, "blocked", ALL) == (found, numba) == (found, "False")
