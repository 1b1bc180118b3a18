"""Forks while another thread is at work: the child is usable, and the fork does not wait in vain."""

import subprocess
import sys
import time

import pytest

FORK = """
import os, threading, time
{work}
began = threading.Event()
def work():
{body}
threading.Thread(target=work).start()
began.wait()
number = os.fork()
if not number:
{child}
    os._exit(0)
raise SystemExit(os.waitstatus_to_exitcode(os.waitpid(number, 0)[1]))
"""
CASES = {
    "who imports needs logging, whose lock a fork acquires before ours": (
        "from desaxe.support.forks import IMPORTS\nimport logging",
        "    with IMPORTS:\n        began.set()\n        time.sleep(0.5)\n        logging.getLogger('a')",
        "    with IMPORTS:\n        logging.getLogger('b')",
    ),
    "a property is being computed": (
        "from desaxe.support.computed import computed_once\n"
        "class Thing:\n    @computed_once\n    def slow(self):\n        began.set()\n        time.sleep(0.5)",
        "    Thing().slow",
        "    Thing().slow",
    ),
    "llvmlite is half imported": (
        "import sys, types\nfrom desaxe.compiler.llvm.machine import lanes\n"
        "from desaxe.support.forks import IMPORTS",
        "    sys.modules['llvmlite.binding.ffi'] = types.ModuleType('half')\n"
        "    with IMPORTS:\n        began.set()\n        time.sleep(0.5)\n"
        "        del sys.modules['llvmlite.binding.ffi']\n        import llvmlite.binding\n    lanes()",
        "    lanes()",
    ),
    "definitions are being replaced": (
        "from desaxe.mechanism import own\n"
        "def slow(known):\n    began.set()\n    time.sleep(0.5)\n    return known",
        "    own.change(slow)",
        "    own.change(dict)",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_a_child_of_a_process_at_work(case):
    work, body, child = CASES[case]
    begun = time.monotonic()
    subprocess.run(
        [sys.executable, "-c", FORK.format(work=work, body=body, child=child)], check=True, timeout=60
    )
    assert time.monotonic() - begun < 15.0


IMPORTED_MEANWHILE = """
import os, sys, threading, time
from desaxe.support import forks

holds = threading.Event()

def imports():
    with forks.IMPORTS:
        holds.set()
        time.sleep(0.3)
        import concurrent.futures.thread
        import logging

assert not {"logging", "concurrent.futures.thread"} & set(sys.modules)
threading.Thread(target=imports).start()
holds.wait()
child = os.fork()
import concurrent.futures.thread, logging
with concurrent.futures.thread._global_shutdown_lock, logging._lock:
    pass
if child:
    print(os.waitpid(child, 0)[1])
"""


def test_a_module_with_a_lock_of_its_own_that_is_imported_while_a_fork_waits():
    """What it releases after the fork has been acquired, in the parent and in the child."""
    done = subprocess.run(
        [sys.executable, "-c", IMPORTED_MEANWHILE], capture_output=True, text=True, timeout=60, check=False
    )
    assert (done.stdout, done.stderr, done.returncode) == ("0\n", "", 0)
