"""The module around the emitted JavaScript, whose operations `test_emit_javascript` holds."""

from desaxe.compiler.languages.es_module import JavaScript
from tests.compiler.coverage_set import NAMES, POINTS, coverage
from tests.compiler.languages.modules import module, wrong_names
from tests.compiler.languages.tools import es_module


def test_the_coverage_set_against_exact(tmp_path):
    for file, text in JavaScript().files(module(coverage())).items():
        (tmp_path / file).write_text(text, encoding="utf-8")
    calls = [["evaluate", point] for point in POINTS]
    calls += [["evaluate", {name: [point[name] for point in POINTS] for name in coverage().inputs}]]
    *ones, together = es_module(tmp_path / "made.js", calls)
    for place, (point, answers) in enumerate(zip(POINTS, ones, strict=True)):
        assert not wrong_names(answers, point), point
        assert answers == {name: together[name][place] for name in NAMES}
