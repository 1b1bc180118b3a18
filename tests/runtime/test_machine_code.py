"""Kernels from disk without numba: the same bits, and the ordinary way wherever something differs."""

import json
import os
import subprocess
import sys

import pytest

from desaxe.runtime import machine_code as _machine_code

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
for accuracy in ("standard", "extended", "fast"):
    for inputs in ({"theta": theta, "ec": ec}, {"theta": theta, "ec": 0.01, "alpha": 2.0}):
        found = dx.evaluate(["a_C", "status"], **inputs, **machine, accuracy=accuracy, threads=2)
        print(found["a_C"].view(np.int64).sum(), np.nansum(found["a_C"]).hex(), found["status"].sum())
far = dx.evaluate("V_C", theta=1e9 + theta, ec=ec, **machine)
print(far.view(np.int64).sum(), np.nansum(far).hex())
print("numba" in sys.modules and sys.modules["numba"] is not None, file=sys.stderr)
"""


def answers(folder, numba):
    command = [sys.executable, "-c", ANSWERS, numba]
    environment = {**os.environ, "DESAXE_CACHE_DIR": str(folder)}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout, done.stderr.strip()


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A cache folder with compiled kernels, and what they answered."""
    folder = tmp_path_factory.mktemp("cache")
    return folder, *answers(folder, "there")


def test_the_same_bits_without_numba(kept):
    folder, found, numba = kept
    assert numba == "True"
    assert len(list(folder.glob("*.code"))) == 7
    assert answers(folder, "blocked") == (found, "False")


def test_another_machine_or_a_broken_file_goes_the_ordinary_way(kept, tmp_path):
    source = min(kept[0].glob("*.code"))
    head, _, code = source.read_bytes().partition(b"\n")
    module = tmp_path / "kernel.py"
    place = module.with_suffix(".code")
    assert _machine_code.load(module) is None
    place.write_bytes(head + b"\n" + code)
    assert _machine_code.load(module) is not None
    told = json.loads(head)
    for key in told["machine"]:
        other = {**told, "machine": {**told["machine"], key: "another"}}
        place.write_bytes(json.dumps(other).encode() + b"\n" + code)
        assert _machine_code.load(module) is None
    for broken in (b"", b"{}", b"no json\n" + code, head + b"\n" + code[:-1], head):
        place.write_bytes(broken)
        assert _machine_code.load(module) is None
