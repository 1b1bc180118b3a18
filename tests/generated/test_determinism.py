"""Determinism: the generated files do not depend on the hash seed."""

import os
import subprocess
import sys
from pathlib import Path

import desaxe.generated
import pytest


@pytest.mark.thorough
def test_another_hash_seed_writes_the_same_bytes(tmp_path):
    """That of this process, a random one, writes them too (`test_fresh`)."""
    subprocess.run(
        [sys.executable, "-m", "desaxe.derive", "-o", str(tmp_path)],
        env=os.environ | {"PYTHONHASHSEED": "4242"},
        stderr=subprocess.DEVNULL,
        check=True,
    )
    folder = Path(desaxe.generated.__file__).parent
    expected = {path.name: path.read_bytes() for path in folder.glob("*.py")}
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == expected
