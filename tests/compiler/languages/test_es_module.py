"""The module around the emitted JavaScript, whose operations `test_emit_javascript` holds."""

import re

from desaxe.compiler.languages.es_module import JavaScript
from desaxe.compiler.program import Line, Program
from tests.compiler.coverage_set import NAMES, POINTS, coverage
from tests.compiler.languages.modules import module, written
from tests.compiler.languages.tools import es_module, node, run


def test_points_have_the_answers_of_arrays(tmp_path):
    place = written(JavaScript(), coverage(), tmp_path)
    columns = {name: [point[name] for point in POINTS] for name in coverage().inputs}
    *ones, together = es_module(place, [["evaluate", given] for given in (*POINTS, columns)])
    for index, answers in enumerate(ones):
        assert answers == {name: together[name][index] for name in NAMES}


def test_groups_have_the_answers_of_all_together(tmp_path):
    """Results that a function of their group computes, from the arguments that these take."""
    made = module(coverage())
    halves = made.outputs[::2], made.outputs[1::2]
    groups = [[symbol.name for symbol in half] for half in halves]
    outputs = tuple(symbol.name for half in halves for symbol in half)
    program = made.forms.stable._replace(outputs=(*outputs, "zero_status"))
    forms = made.forms._replace(stable=program)
    grouped = made._replace(name="grouped", outputs=(*halves[0], *halves[1]), groups=groups, forms=forms)
    asked = [["evaluate", given] for given in POINTS]
    asked += [[name, *(POINTS[0][n] for n in coverage().inputs)] for name in NAMES]
    answers = (es_module(written(JavaScript(), one, tmp_path), asked) for one in (grouped, made))
    assert next(answers) == next(answers)


GIVEN = ['"1"', "true", "null", "[1]", "{}", "new String('1')", "1n", "Symbol('x')"]
REFUSED = """
import {{ evaluate, twice }} from "./made.mjs";
const said = (call) => {{ try {{ return String(call()); }} catch (error) {{ return String(error); }} }};
for (const given of [{given}]) {{
  console.log(said(() => twice(given)));
  console.log(said(() => evaluate({{ x: Array.isArray(given) ? [given] : given }})));
  console.log(said(() => evaluate({{ x: [1, given] }})));
}}
console.log(said(() => evaluate({{ x: new Int8Array([4]) }}).twice[0] + evaluate({{ x: [] }}).twice.length));
"""


def test_what_is_no_number_is_refused_by_name(tmp_path):
    """JavaScript reads text, null and arrays of one number as numbers where it multiplies."""
    program = Program(("x",), (Line("twice", "mul", ("x", 2.0)),), ("twice",), {})
    (tmp_path / "made.mjs").write_text(JavaScript().files(module(program))["made.js"], encoding="utf-8")
    (tmp_path / "main.mjs").write_text(REFUSED.format(given=", ".join(GIVEN)), encoding="utf-8")
    *refused, taken = run(node(), "main.mjs", cwd=tmp_path).splitlines()
    assert len(refused) == 3 * len(GIVEN)
    assert all(re.fullmatch(r"TypeError: x = .*: expected numbers in SI units", line) for line in refused)
    assert taken == "8"
