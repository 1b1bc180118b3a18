"""Imports inside functions hold the lock of imports, so that a fork waits for them.

A module that another thread has imported halfway stays locked for ever in a child.
"""

import ast
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import desaxe
from tests.effort import first
from tests.reliability.forks import FIRST_CALLS, START

ROOT = Path(desaxe.__file__).parent
# Rooms of a command's own process, which makes no threads that import.
OF_COMMANDS = ("cli",)
GUARDS = ("IMPORTS", "needed(")
BY_NAME = {"import_module", "__import__"}
DEFINES_THE_LOCK = ROOT / "support" / "forks.py"


def places(tree):
    """Each import of a text: (line, whether it is inside a function, whether in a block with the lock)."""

    def walk(node, inside, held):
        for child in ast.iter_child_nodes(node):
            within = inside or isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda))
            has = held
            if isinstance(child, ast.With):
                texts = [ast.unparse(item.context_expr) for item in child.items]
                has = held or any(text.startswith(GUARDS) for text in texts)
                if has and not inside:  # a module's body waits for the lock while it has its own: a circle
                    yield child.lineno, True, False
            called = isinstance(child, ast.Call) and ast.unparse(child.func).rpartition(".")[2] in BY_NAME
            if isinstance(child, (ast.Import, ast.ImportFrom)) or called:
                yield child.lineno, within, has
            yield from walk(child, within, has)

    yield from walk(tree, False, False)


def unguarded(text):
    return [line for line, inside, held in places(ast.parse(text)) if inside and not held]


def test_every_import_inside_a_function_holds_the_lock():
    result = {}
    for path in sorted(ROOT.rglob("*.py")):
        if path.relative_to(ROOT).parts[0] not in OF_COMMANDS and path != DEFINES_THE_LOCK:
            lines = unguarded(path.read_text(encoding="utf-8"))
            if lines:
                result[str(path.relative_to(ROOT))] = lines
    assert not result


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("import x", []),
        ("def f():\n    import x", [2]),
        ("def f():\n    with IMPORTS:\n        from . import x\n    import y", [4]),
        ("def f():\n    with needed('f'), other:\n        import x", []),
        ("def f():\n    return import_module('x')", [2]),
        ("with needed('f'):\n    import x", [1]),
    ],
)
def test_the_list_sees_an_import(text, lines):
    assert unguarded(text) == lines


# A finder that finds nothing, and says who imports a module without any of the locks that a fork waits for.
SPY = """
from desaxe.support import forks

class Spy:
    def find_spec(self, name, path=None, target=None):
        frames, frame = [], sys._getframe(1)
        while frame:
            frames.append(f"{frame.f_code.co_filename}:{frame.f_code.co_name}")
            frame = frame.f_back
        imports = any(text.endswith("_find_and_load") for text in frames)  # others only look for it
        if imports and not any(getattr(lock, "is_mine", False) for lock in forks._LOCKS):
            print(name, "for", *[text for text in frames if "importlib" not in text])

sys.meta_path.insert(0, Spy())
"""


@pytest.mark.thorough
def test_first_calls_import_nothing_without_the_lock():
    """What libraries import inside their functions is seen, too."""
    program = "\n".join([START, SPY, *FIRST_CALLS.values()])
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert not done.stdout


# An alarm in a first call, at the first call of a function of a file; then the call again, which would not
# return where a lock stayed locked.
ALARMED = """
import faulthandler
faulthandler.dump_traceback_later(60.0, exit=True)
class Alarm(Exception):
    pass
def ring(number, frame):
    raise Alarm
signal.signal(signal.SIGALRM, ring)
def trace(frame, event, argument):
    if frame.f_code.co_name == {function!r} and frame.f_code.co_filename.endswith({file!r}):
        sys.settrace(None)
        signal.raise_signal(signal.SIGALRM)
call = lambda: {call}
sys.settrace(trace)
try:
    call()
except Alarm:
    print(call() == call(), np.isfinite(dx.peak("a_C", **others, ec=0.0)["value"]))
"""
RPM = 'dx.evaluate("a_C", theta=1.0, AB=0.125, BC=0.35, ec=0.0, omega0="1 rpm")'
LOADED = 'dx.evaluate("T_in", theta=1.0, m_slider=1.0, F_Y=dx.over_Y([0.2, 0.5], [0.0, 9.0]), **design)'
INTERRUPTED = [
    ('dx.evaluate("a_C", theta=1.0, **design)', "__exit__", "importlib._bootstrap>"),
    ('dx.evaluate("a_C", theta=theta[:700], **design).sum()', "__exit__", "importlib._bootstrap>"),
    (LOADED, "<module>", "loads/resolve.py"),
    (LOADED, "__exit__", "importlib._bootstrap>"),
    (RPM, "__exit__", "importlib._bootstrap>"),
]


@pytest.mark.skipif(not hasattr(signal, "SIGALRM"), reason="alarms")
@pytest.mark.parametrize(("call", "function", "file"), first(3, INTERRUPTED))
def test_what_a_handler_raises_leaves_imports_finished(call, function, file):
    program = START + ALARMED.format(call=call, function=function, file=file)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "True True\n"


def test_no_property_has_a_lock_that_a_fork_does_not_wait_for():
    texts = {path: path.read_text(encoding="utf-8") for path in ROOT.rglob("*.py")}
    assert not [path for path, text in texts.items() if "import cached_property" in text]
