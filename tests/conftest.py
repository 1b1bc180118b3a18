"""Options and fixtures of all tests.

The workers of a run share a folder, $DESAXE_TESTS_FOLDER, which is gone at its end.

By default random tests draw few cases and tests marked `thorough` are left out; `--thorough` runs just
those two kinds, with many cases: `.ci/run` does both. Files, and the tests of each, run as they stand;
`--shuffle=any` draws their order: no test may need another one, or what another one left behind.
"""

import gc
import os
import random
import shutil
import sys
import tempfile
from functools import cache

import pytest

from desaxe.mechanism import own
from desaxe.runtime import executor
from desaxe.support.recent import Recent
from tests.effort import VARIABLE as THOROUGH

VARIABLE = "DESAXE_TESTS_FOLDER"


def pytest_addoption(parser):
    parser.addoption("--thorough", action="store_true", help="run tests marked thorough or sampled, in full")
    text = "draw the order of files, and of the tests in each; SEED is a number, or `any`, which is printed"
    parser.addoption("--shuffle", metavar="SEED", help=text)


def pytest_configure(config):
    config.seed = _seed(config)
    if config.seed is not None:
        config.option.loadscopereorder = False  # xdist's own order: the largest file first
    if config.getoption("--thorough"):
        os.environ.setdefault(THOROUGH, "1")
    if hasattr(config, "workerinput"):
        return
    # Hundreds of processes import the same sources.
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    sys.dont_write_bytecode = False
    config.shared_folder = os.environ[VARIABLE] = tempfile.mkdtemp(prefix="desaxe-tests-")


def pytest_unconfigure(config):
    if hasattr(config, "shared_folder"):
        shutil.rmtree(config.shared_folder, ignore_errors=True)


def _seed(config):
    """The seed of the order, the same in all workers; None for files and tests as they stand."""
    if hasattr(config, "workerinput"):
        return config.workerinput["seed"]
    given = config.option.shuffle
    return random.SystemRandom().randrange(1_000_000) if given == "any" else given and int(given)


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node):
    node.workerinput["seed"] = node.config.seed


def pytest_report_header(config):
    return None if config.seed is None else f"order: random, again by --shuffle={config.seed}"


@cache
def _derives(path):
    return "import derivation" in path.read_text(encoding="utf-8")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Files go to the workers whole; those that need the derivation all to one, which derives once."""
    from xdist.scheduler import LoadFileScheduling

    class Scheduling(LoadFileScheduling):
        def _split_scope(self, nodeid):
            file = super()._split_scope(nodeid)
            return "derivation" if _derives(config.rootpath / file) else file

    return Scheduling(config, log) if config.getvalue("dist") == "loadfile" else None


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config, items):
    """Keep what belongs to this kind of run, in its order."""
    _select(config, items)
    if config.seed is not None:
        files = {}
        for item in items:
            files.setdefault(item.path, []).append(item)
        draw = random.Random(config.seed)
        groups = list(files.values())
        draw.shuffle(groups)
        for group in groups:
            draw.shuffle(group)
        items[:] = [item for group in groups for item in group]


@pytest.hookimpl(tryfirst=True)
def pytest_collection(session):
    if not session.config.pluginmanager.hasplugin("dsession"):  # which collects nothing itself
        gc.disable()  # until all is collected


def pytest_collection_finish():
    """Freeze what is there by now: half a million objects, which take 0.3 s to look through each time."""
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)
    gc.enable()


def _select(config, items):

    def belongs(item):
        thorough = item.get_closest_marker("thorough") is not None
        if config.getoption("--thorough"):
            return thorough or item.get_closest_marker("sampled") is not None
        return not thorough

    left_out = [item for item in items if not belongs(item)]
    if left_out:
        items[:] = [item for item in items if belongs(item)]
        config.hook.pytest_deselected(items=left_out)


@pytest.fixture(autouse=True)
def nothing_left_behind():
    """Forget what a test defined."""
    yield
    own.change(lambda _: {})


@pytest.fixture
def cold(monkeypatch):
    """A process that has no kernel, whatever other tests compiled."""
    monkeypatch.setattr(executor, "_KEPT", Recent(executor.MOST_KEPT))
