"""Machine code: of other processors, in forked children, refused by the system, freed with its owner."""

import gc
import os
import struct
import subprocess
import sys
import weakref
from ctypes import CFUNCTYPE, c_double

import numpy as np
import pytest

import desaxe as dx
from desaxe.compiler.llvm import machine
from desaxe.compiler.llvm.nest import Entry, module_text
from desaxe.mechanism.program import Variant
from desaxe.oracle.families import FAMILIES, points
from desaxe.runtime import executor
from desaxe.runtime.kernels import KernelKey, kernel_of
from tests.evaluation.test_stress import is_kept, sensitivity_in

INPUTS = ("AB", "BC", "alpha", "ec", "omega0", "theta")
NAMES = ("V_C", "a_C", "a_C_wrt_ec")
TRIPLES = ("x86_64-unknown-linux-gnu", "aarch64-unknown-linux-gnu", "x86_64-pc-windows-msvc-elf")


def key_of(accuracy="standard", far=False, names=NAMES):
    axes = tuple((name, 0) for name in INPUTS)
    return KernelKey(names, Variant(own=()), (("branch", 1.0),), axes, 1, accuracy, far)


def text_of(key, lanes=4):
    return module_text(Entry(kernel_of(key), INPUTS, "theta", 1e6), lanes)


def undefined(data):
    """The names that an ELF object takes from elsewhere."""
    start, size, count = (struct.unpack_from("<Q", data, 40)[0], *struct.unpack_from("<HH", data, 58))
    sections = [struct.unpack_from("<IIQQQQIIQQ", data, start + size * k) for k in range(count)]
    (symbols,) = (section for section in sections if section[1] == 2)
    names = sections[symbols[6]][4]
    result = set()
    for at in range(symbols[4] + 24, symbols[4] + symbols[5], 24):
        name, _, _, section = struct.unpack_from("<IBBH", data, at)
        if section == 0:
            result.add(data[names + name : data.index(b"\0", names + name)].decode())
    return result


@pytest.mark.parametrize("triple", TRIPLES)
@pytest.mark.parametrize("key", [key_of(), key_of(far=True), key_of("extended", names=("V_C",))], ids=str)
def test_objects_for_other_systems_take_nothing_but_what_is_provided(triple, key):
    taken = undefined(machine.emitted(text_of(key), machine.target_machine(triple)))
    assert taken <= {*machine.outside(), "__chkstk"}
    assert ("sin" in taken) == key.far  # else the sine is written out
    assert "fma" in taken if triple.startswith("x86_64") and key.accuracy == "extended" else True


PROCESSORS = {"plainest": ("x86-64", 4), "AVX2": ("x86-64-v3", 4), "this": (None, None)}


def words(numbers):
    """Whole numbers as a call takes them."""
    return struct.pack(f"{len(numbers)}q", *numbers)


@pytest.mark.parametrize("processor", PROCESSORS)
@pytest.mark.parametrize("family", FAMILIES)
def test_the_promise_holds_on_other_processors(family, processor):
    """With no fused multiplication, and with vectors of four."""
    cpu, lanes = PROCESSORS[processor]
    if cpu and "x86_64" not in machine._triple():
        pytest.skip("of another kind")
    call = _call_for(cpu, lanes)
    rows = [{**row, "branch": 1} for row in points(family, 12, 3) if abs(row["theta"]) < 1e6]
    arrays = [np.array([row[name] for row in rows]) for name in INPUTS]
    outs = [np.empty(len(rows)) for _ in NAMES]
    addresses = words([a.__array_interface__["data"][0] for a in (*arrays, *outs)])
    left = call(addresses, words([len(rows)]), words([8] * (len(arrays) + len(outs))), words([0, 0]))
    if left:  # to be decided with twice the digits
        return
    for name, out in zip(NAMES, outs, strict=True):
        for row, value in zip(rows, out.tolist(), strict=True):
            assert is_kept(name, value, row, sensitivity=sensitivity_in(family)), row


CODES = {}


def _call_for(cpu, lanes):
    if cpu not in CODES:
        target = machine.target_machine(machine._triple(), cpu) if cpu else None
        with machine.LOCK:
            CODES[cpu] = machine._linked(
                machine.emitted(text_of(key_of(), lanes or machine.lanes()), target), "kernel"
            )
    return executor._CALL(CODES[cpu].address)


def simple(number):
    return f"define double @value() {{\n  ret double {float(number)!r}\n}}"


def test_code_lives_as_long_as_its_owner():
    code = machine.compiled(simple(2.5), "value")
    assert CFUNCTYPE(c_double)(code.address)() == 2.5
    kept = weakref.ref(code)
    del code
    gc.collect()
    assert kept() is None
    assert machine._UNUSED
    other = machine.compiled(simple(3.5), "value")
    assert other.address
    assert not machine._UNUSED


OUTLIVES = """
from desaxe.compiler.llvm import machine
code = machine.compiled("define double @value() { ret double 1.0 }", "value")
names = vars(machine)
names.update(dict.fromkeys(name for name in names if name[:2] != "__"))  # as the exit leaves a module
del code
"""


def test_code_that_outlives_its_module_is_silent():
    done = subprocess.run([sys.executable, "-c", OUTLIVES], capture_output=True, text=True, check=True)
    assert done.stderr == ""


MEMORY = f"""
import os, psutil
from desaxe.compiler.llvm import machine
{simple.__name__} = lambda number: "define double @value() {{ ret double " + repr(float(number)) + " }}"
def run(count):
    for number in range(count):
        machine.compiled(simple(number), "value")
    return psutil.Process().memory_info().rss
run(50)
before = run(50)
print((run(200) - before) / 200)
"""


def test_forgotten_code_takes_no_memory():
    done = subprocess.run([sys.executable, "-c", MEMORY], capture_output=True, text=True, check=True)
    assert float(done.stdout) < 16_384  # bytes


def test_requests_are_bounded(monkeypatch):
    monkeypatch.setattr(executor, "_KEPT", executor.Recent(2))
    inputs = {"theta": np.linspace(0, 6, 50), "ec": 0.01, "AB": 0.1, "BC": 0.3, "omega0": 2.0}
    for name in ("Y", "V_C", "a_C", "phi"):
        dx.evaluate(name, **inputs)
    assert len(executor._KEPT) <= 2


@pytest.mark.thorough
def test_forgotten_code_is_freed(monkeypatch):
    monkeypatch.setattr(executor, "_KEPT", executor.Recent(2))
    inputs = {"theta": np.linspace(0, 6, 50), "ec": 0.01, "AB": 0.1, "BC": 0.3, "omega0": 2.0}
    codes = []
    for name in ("Y", "V_C", "a_C", "phi"):
        for _ in range(2):
            dx.evaluate(name, **inputs)
        codes.append(weakref.ref([*executor._KEPT.values()][-1].code))
    gc.collect()
    assert [code() is None for code in codes] == [True, True, False, False]


FORKS = """
import os, signal, sys, threading
import numba, numpy as np, desaxe as dx
inputs = {"ec": 0.01, "AB": 0.1, "BC": 0.3, "omega0": 2.0}
theta = np.linspace(0.0, 6.0, 5000)
names = [name for name in dx.quantities() if "_wrt_" in name and name.count("_") < 5][:60]
done = threading.Event()
def compile_ever():
    number = 0
    while not done.is_set():
        number += 1
        dx.evaluate(names[number % len(names)], theta=theta, m_rod=number % 7 + 1.0, **inputs)
        numba.njit(lambda x, number=number: x + number)(1.0)
thread = threading.Thread(target=compile_ever, daemon=True)
thread.start()
failed = 0
for number in range(20):
    child = os.fork()
    if not child:
        signal.alarm(60)
        slope = f"V_C_wrt_{('ec', 'AB', 'BC', 'theta')[number % 4]}"
        found = dx.evaluate(["Y", slope], theta=theta, **inputs)
        os._exit(0 if np.isfinite(found["Y"]).all() else 1)
    failed += os.waitpid(child, 0)[1] != 0
done.set()
print(failed)
os._exit(0)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_children_compile_whatever_a_thread_was_compiling():
    command = [sys.executable, "-W", "ignore", "-c", FORKS]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.stdout.split() == ["0"], done.stderr[-2000:]


REFUSED = """
import ctypes, sys
if ctypes.CDLL(None).prctl(65, 1, 0, 0, 0):  # PR_SET_MDWE: no memory is made executable
    sys.exit(77)
import numpy as np, desaxe as dx
dx.evaluate("V_C", theta=np.linspace(0, 6, 5000), ec=0.01, AB=0.1, BC=0.3, omega0=2.0)
dx.function("V_C", ec=0.01, AB=0.1, BC=0.3, omega0=2.0)
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="a call of Linux")
def test_refused_executable_memory_is_one_clear_error():
    done = subprocess.run([sys.executable, "-c", REFUSED], capture_output=True, text=True, check=False)
    if done.returncode == 77:
        pytest.skip("this kernel cannot refuse it")
    assert "machine code cannot be loaded" in done.stderr.splitlines()[-1], done.stderr
