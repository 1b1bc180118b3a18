"""Compilers and interpreters of other languages: found, or the test is skipped; where CI is set, it fails."""

import ctypes
import importlib.util
import json
import os
import shutil
import subprocess
from contextlib import contextmanager

import numpy as np
import pytest
from playwright._impl._driver import compute_driver_executable

WARNINGS = (
    "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wdouble-promotion", "-Wfloat-conversion",
    "-Werror",
)  # fmt: skip
STRICT = ("-std=c99", *WARNINGS)
CPLUSPLUS = ("-x", "c++", "-std=c++17", *WARNINGS)
POINTER = ctypes.POINTER(ctypes.c_double)


def tool(name):
    """The path of a program."""
    result = shutil.which(name)
    if result is None and os.environ.get("CI"):
        pytest.fail(f"{name} is not installed")
    if result is None:
        pytest.skip(f"{name} is not installed")
    return result


def run(*command, **more):
    """Run a command and return its output; the test fails if the command does."""
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, **more)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def library(source, compiler="gcc", options=("-O0",)):
    """A C source as a loaded library; no warning is let pass."""
    place = source.with_name(f"{source.stem}_{compiler}{''.join(options)}.so")
    run(tool(compiler), *STRICT, *options, "-shared", "-fPIC", source, "-o", place, "-lm")
    return ctypes.CDLL(str(place))


def pointer(array):
    """A C pointer to an array's numbers, doubles or floats."""
    return array.ctypes.data_as(ctypes.POINTER(np.ctypeslib.as_ctypes_type(array.dtype)))


def array_values(loaded, name, columns, count):
    """The outputs of `name_array`."""
    outs = [np.full_like(columns[0], 7.0) for _ in range(count)]
    groups = [(type(pointer(group[0])) * len(group))(*map(pointer, group)) for group in (columns, outs)]
    getattr(loaded, f"{name}_array")(ctypes.c_size_t(columns[0].size), *groups)
    return outs


def point_values(loaded, name, row, count, kind=float):
    """The status and the outputs of `name_point`."""
    given, out = np.array(row, kind), np.full(max(count, 1), 7.0, kind)
    status = getattr(loaded, f"{name}_point")(pointer(given), pointer(out))
    return status, out[:count].tolist()


def imported(place):
    """A Python file as a module."""
    spec = importlib.util.spec_from_file_location(place.stem, place)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@contextmanager
def jax_in_doubles():
    """Doubles in jax, for a while; skipped without jax, a failure where CI is set."""
    if not os.environ.get("CI"):
        pytest.importorskip("jax")
    import jax

    before = jax.config.jax_enable_x64
    jax.config.update("jax_enable_x64", True)
    try:
        yield
    finally:
        jax.config.update("jax_enable_x64", before)


OCTAVE = """
f = fopen("in.bin"); in = cell(1, {given});
for k = 1:{given} n = fread(f, 1, "double"); in{{k}} = fread(f, [1, n], "double"); end
fclose(f); out = cell(1, {count}); [out{{:}}] = {name}(in{{:}});
f = fopen("out.bin", "w"); for k = 1:{count} fwrite(f, real(out{{k}}), "double"); end
fclose(f); if (! all(cellfun(@isreal, out))) error("complex"); end
printf("done");
"""


def octave(file, columns, count):
    """The outputs of a function file, run by GNU Octave; its arguments are rows."""
    folder = file.parent
    given = [part for column in columns for part in (np.array([float(column.size)]), column)]
    np.concatenate(given).tofile(folder / "in.bin")
    code = OCTAVE.format(given=len(columns), count=count, name=file.stem)
    assert run(tool("octave-cli"), "--norc", "--quiet", "--eval", code, cwd=folder) == "done"
    return np.fromfile(folder / "out.bin").reshape(count, -1)


NODE = """
import * as module from "./{name}.mjs";
import {{ readFileSync }} from "fs";
const plain = (x) => typeof x === "number" ? String(x) : ArrayBuffer.isView(x) ? Array.from(x, plain)
  : Object.fromEntries(Object.entries(x).map(([key, value]) => [key, plain(value)]));
const special = {{ nan: NaN, inf: Infinity, "-inf": -Infinity }};
const calls = JSON.parse(readFileSync("calls.json", "utf8"), (key, x) => x?.special ? special[x.special] : x);
console.log(JSON.stringify(calls.map(([name, ...given]) => plain(module[name](...given)))));
"""


def node():
    """The path of a JavaScript engine, which playwright brings."""
    return compute_driver_executable()[0]


def es_module(file, calls):
    """The answers of a module's functions, each called as (name, *arguments), by node."""
    folder = file.parent
    (folder / f"{file.stem}.mjs").write_text(file.read_text(encoding="utf-8"), encoding="utf-8")
    (folder / "calls.json").write_text(json.dumps(_sent(calls)), encoding="utf-8")
    (folder / "main.mjs").write_text(NODE.format(name=file.stem), encoding="utf-8")
    result = json.loads(run(node(), "main.mjs", cwd=folder))
    return [_numbers(each) for each in result]


def _sent(value):
    """The value as JSON can carry it."""
    if isinstance(value, dict):
        return {name: _sent(each) for name, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [*map(_sent, value)]
    return {"special": str(value)} if isinstance(value, float) and not np.isfinite(value) else value


def _numbers(value):
    if isinstance(value, dict):
        return {name: _numbers(each) for name, each in value.items()}
    return [*map(_numbers, value)] if isinstance(value, list) else float(value.replace("Infinity", "inf"))
