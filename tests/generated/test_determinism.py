"""Determinism: the generated files do not depend on the hash seed."""

import pytest
import os
import subprocess
import sys

from desaxe.derive.write import render

from tests.derive.derived import derivation

SEEDS = ("0", "4242")


def start(seed, folder):
    command = [sys.executable, "-m", "desaxe.derive", "-o", str(folder)]
    return subprocess.Popen(command, env=os.environ | {"PYTHONHASHSEED": seed}, stderr=subprocess.DEVNULL)


@pytest.mark.thorough
def test_every_hash_seed_writes_the_same_bytes(tmp_path):
    running = [start(seed, tmp_path / seed) for seed in SEEDS]
    assert [process.wait() for process in running] == [0] * len(SEEDS)
    wanted = {name: text.encode() for name, text in render(derivation()).items()}
    for seed in SEEDS:
        assert {path.name: path.read_bytes() for path in (tmp_path / seed).iterdir()} == wanted
