"""Emitted JavaScript, run by the node that comes with Playwright: no browser is needed for it."""

import json
import math
import subprocess
from tempfile import NamedTemporaryFile

from playwright._impl._driver import compute_driver_executable

from desaxe.compiler.languages.javascript import HEADER, emit_javascript

# NaN, infinities and the sign of a zero have no place in JSON: they travel as text.
RUN = """
const { inputs, cases } = JSON.parse(require("fs").readFileSync(0, "utf8"));
const number = (x) => (typeof x === "string" ? Number(x) : x);
const text = (x) => (Object.is(x, -0) ? "-0" : String(Number(x)));
console.log(JSON.stringify(cases.map((one) => point(...inputs.map((n) => number(one[n]))).map(text))));
"""


def run_node(source, data):
    """Run a script by node with data as JSON on its input; return the JSON that it prints."""
    node = compute_driver_executable()[0]
    with NamedTemporaryFile("w", suffix=".cjs", encoding="utf-8") as script:  # longer than an argument may be
        script.write(f'"use strict";\n{source}')
        script.flush()
        command = [node, script.name]
        done = subprocess.run(command, input=json.dumps(data), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def in_javascript(program, points):
    """The outputs of a program at each of these points, by name."""
    cases = [{name: _sendable(value) for name, value in at.items()} for at in points]
    source = f"{HEADER}\n{emit_javascript(program)}\n{RUN}"
    answers = run_node(source, {"inputs": program.inputs, "cases": cases})
    return [dict(zip(program.outputs, map(_number, row), strict=True)) for row in answers]


def _sendable(value):
    known = {"inf": "Infinity", "-inf": "-Infinity", "nan": "NaN", "-0.0": "-0"}
    return known.get(repr(float(value)), float(value))


def _number(text):
    return math.nan if text == "NaN" else float(text.replace("Infinity", "inf"))
