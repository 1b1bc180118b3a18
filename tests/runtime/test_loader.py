"""Machine code is the same function through llvmlite's binding and without it."""

import subprocess
import sys
from ctypes import CFUNCTYPE, c_int64

import pytest

from desaxe.runtime.native.compiled_text import compile_text
from desaxe.runtime.native.loader import KNOWN, _Binding, _Direct
from desaxe.runtime.native.machine_code import ENTRY, outside

TEXT = """
from numba import njit, types

@njit
def twice(n):
    return 2 * n

def function(n):
    return twice(n) + 1

signature = types.int64(types.int64)
"""


@pytest.fixture(scope="module")
def code():
    return compile_text(TEXT, "a test", {}).machine


def test_both_ways_load_the_same_function(code):
    for way in (_Binding(), _Direct()):
        address, keeper = way.load(code, ENTRY, outside())
        assert CFUNCTYPE(c_int64, c_int64)(address)(20) == 41
        del keeper
    assert _Binding().host() == _Direct().host()


def test_a_process_that_loads_imports_no_compiler(code, tmp_path):
    (tmp_path / "code").write_bytes(code)
    script = (
        "import sys; from ctypes import CFUNCTYPE, c_int64\n"
        "from desaxe.runtime.native.machine_code import StoredCode, load, machine\n"
        f"loaded = load(StoredCode((-2,), (8,), open({str(tmp_path / 'code')!r}, 'rb').read()))\n"
        "print(CFUNCTYPE(c_int64, c_int64)(loaded.address)(20), machine().startswith('llvmlite'))\n"
        "print(*(name for name in ('numba', 'numpy', 'llvmlite.binding') if name in sys.modules))\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["41", "True"]


def test_an_unknown_llvmlite_is_used_through_its_binding(monkeypatch):
    import llvmlite

    monkeypatch.setattr(llvmlite, "__version__", "999.0")
    assert not llvmlite.__version__.startswith(KNOWN)
    with pytest.raises(ImportError, match="prototypes are not known"):
        _Direct()
