"""Compilers and interpreters of other languages: found, or the test is skipped; where CI is set, it fails."""

import ctypes
import os
import shutil
import subprocess

import numpy as np
import pytest

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror")
POINTER = ctypes.POINTER(ctypes.c_double)


def tool(name):
    """The path of a program."""
    found = shutil.which(name)
    if found is None and os.environ.get("CI"):
        pytest.fail(f"{name} is not installed")
    if found is None:
        pytest.skip(f"{name} is not installed")
    return found


def run(*command, **more):
    """What a command prints; a test fails where the command does."""
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, **more)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def library(source, compiler="gcc", options=("-O0",), libm=True):
    """A C source as a loaded library; no warning is let pass."""
    place = source.with_name(f"{source.stem}_{compiler}{''.join(options)}{libm}.so")
    last = ["-lm"] if libm else ["-nostdlib"]
    run(tool(compiler), *STRICT, *options, "-shared", "-fPIC", source, "-o", place, *last)
    return ctypes.CDLL(str(place))


def pointer(array):
    """A C pointer to an array's numbers."""
    return array.ctypes.data_as(POINTER)


def array_values(loaded, name, columns, count):
    """The outputs of `name_array`."""
    size = columns[0].size
    outs = [np.full(size, 7.0) for _ in range(count)]
    ins = (POINTER * len(columns))(*map(pointer, columns))
    getattr(loaded, f"{name}_array")(ctypes.c_size_t(size), ins, (POINTER * count)(*map(pointer, outs)))
    return outs


def point_values(loaded, name, row, count):
    """The status and the outputs of `name_point`."""
    given, out = np.array(row, float), np.full(max(count, 1), 7.0)
    status = getattr(loaded, f"{name}_point")(pointer(given), pointer(out))
    return status, out[:count].tolist()
