"""Compiled kernels of a test run live in a folder of their own, shared by its workers, gone at its end."""

import os
import shutil
import tempfile

VARIABLE = "DESAXE_CACHE_DIR"


def pytest_configure(config):
    if not hasattr(config, "workerinput"):
        config.kernel_folder = os.environ[VARIABLE] = tempfile.mkdtemp(prefix="desaxe-tests-")


def pytest_unconfigure(config):
    if hasattr(config, "kernel_folder"):
        shutil.rmtree(config.kernel_folder, ignore_errors=True)
