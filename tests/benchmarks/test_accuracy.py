"""`python -m benchmarks --accuracy`: every row, the truth about standard, its files."""

import math
import re
from itertools import islice

import numpy as np
import pytest

from benchmarks.__main__ import main
from benchmarks.accuracy import contenders as contenders_module
from benchmarks.accuracy.command import text, write
from benchmarks.accuracy.contenders import INPUTS, NAMES, contenders
from benchmarks.accuracy.errors import TOP, ULPS, Judge, Statistics, cases
from benchmarks.accuracy.report import beaten_by, measures, number, report, table
from benchmarks.accuracy.run import GENERIC, QUICK, Audit, audit
from benchmarks.accuracy.times import times
from desaxe.oracle.families import FAMILIES, points

ALWAYS = ("desaxe standard", "desaxe extended", "NumPy lambdify", "numba", "mpmath 50 digits")


def found_without(name):
    """A stand-in for `find_spec` that hides one package."""
    return lambda asked: None if asked == name else object()


@pytest.fixture(scope="module")
def result():
    """A quick audit, as where heyoka is not installed: what it says does not depend on the machine."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(contenders_module, "find_spec", found_without("heyoka"))
        return audit(QUICK._replace(points=6, timed=4000, rounds=1))


@pytest.mark.thorough
def test_everyone_is_measured_in_every_family(result):
    assert tuple(one.name for one in result.who) == tuple(result.ratios) == tuple(result.errors) == ALWAYS
    assert all(list(families) == list(FAMILIES) for families in result.errors.values())
    assert result.ratios["desaxe standard"] == 1.0
    assert all(0 < ratio < math.inf for ratio in result.ratios.values())


@pytest.mark.thorough
def test_standard_keeps_its_promise_at_generic_points(result):
    generic = result.errors["desaxe standard"][GENERIC]
    assert 0 < generic.median <= generic.worst <= 1
    assert generic.values == 6 * len(NAMES)


@pytest.mark.thorough
def test_extended_keeps_its_promise_at_generic_points(result):
    assert result.errors["desaxe extended"][GENERIC].worst_ulp <= 2


@pytest.mark.thorough
def test_the_textbook_loses_its_digits_at_the_change_point(result):
    textbook, ours = (result.errors[name]["change_point"] for name in ("NumPy lambdify", "desaxe standard"))
    assert ours.worst <= 1 < 1e6 < textbook.worst


@pytest.mark.thorough
def test_the_tables_have_all_rows(result):
    page, shown = report(result), text(result)
    for name in ALWAYS:
        assert f"\n| {name} " in page
        assert f"\n| {name} " in shown
    for family in FAMILIES:
        assert len(re.findall(rf"^\| {family.replace('_', ' ')} +\|", page, re.M)) == 2
        assert f"* **{family.replace('_', ' ')}**: " in page
    assert "heyoka is not installed here" in page
    assert "CPU " in result.machine
    assert "numba 0." in result.machine


@pytest.mark.thorough
def test_the_files_are_written(result, tmp_path):
    page, picture = write(result, tmp_path / "new" / "folder")
    assert (page.name, picture.name) == ("accuracy.md", "accuracy.png")
    assert page.read_text(encoding="utf-8") == report(result)
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert sorted(path.name for path in page.parent.iterdir()) == ["accuracy.md", "accuracy.png"]


@pytest.mark.thorough
def test_the_command(monkeypatch, capsys, tmp_path, result):
    asked = []
    monkeypatch.setattr(
        "benchmarks.accuracy.command.audit", lambda effort, watch: asked.append(effort) or result
    )
    monkeypatch.setattr("benchmarks.__main__.DOCS", tmp_path)
    monkeypatch.setattr("sys.argv", ["benchmarks", "--accuracy", "--quick", "--write"])
    main()
    assert asked == [QUICK]
    assert capsys.readouterr().out.startswith(text(result))
    assert (tmp_path / "accuracy.png").is_file()


@pytest.mark.parametrize("family", FAMILIES)
def test_points_are_the_same_every_time(family):
    assert list(points(family, 3, seed=7)) == list(points(family, 3, seed=7)) != list(points(family, 3))


@pytest.mark.thorough
def test_all_contenders_compute_the_same():
    """At generic points of the other branch, to float32; heyoka too where it is installed."""
    at = list(islice((point for point in points(GENERIC, 400) if point["branch"] == -1), 40))
    inputs = np.tile([[point[name] for point in at] for name in INPUTS], 60)
    rows = {}
    for one in contenders():
        some = inputs[:, :40].copy() if one.few else inputs
        answers = one.make(-1)(some, np.empty((len(NAMES), some.shape[1])))
        rows[one.name] = np.array(list(answers))[:, :40]
    scale = np.abs(rows["desaxe extended"]).max(axis=1, keepdims=True)
    for name, values in rows.items():
        assert np.abs(values - rows["desaxe extended"]).max() < np.inf, name
        assert (np.abs(values - rows["desaxe extended"]) / scale).max() < 1e-4, name


def test_an_exact_answer_has_no_error_and_none_is_the_top():
    some = cases(GENERIC, 2, 0, (1,))
    judge = Judge(contenders()[1])
    judge.runs[1] = lambda inputs, _: exactly(some, inputs)
    assert judge.statistics(some).worst <= 0.5 / ULPS
    for value in (math.nan, math.inf, 1e300):
        judge.runs[1] = lambda inputs, _, value=value: np.full((len(NAMES), inputs.shape[1]), value)
        assert judge.statistics(some).worst == TOP / ULPS


def exactly(some, inputs):
    rows = np.array([[float(case.exact[name]) for case in some] for name in NAMES])
    return np.tile(rows, inputs.shape[1] // len(some))


def test_a_promise_counts_conditions():
    """At a dead centre V_C is nothing but the last digits of the inputs; a_C is not."""
    result = cases("dead_centre", 12, 0, (1, -1))
    assert sum(case.bounds["V_C"] > 1e9 * case.bounds["a_C"] for case in result) > 6


def test_cases_stay_on_the_branches_wanted():
    assert {case.point["branch"] for case in cases(GENERIC, 12, 0, (1,))} == {1}
    assert {case.point["branch"] for case in cases(GENERIC, 12, 0, (1, -1))} == {1, -1}


def test_times_are_of_everyone():
    who = [one for one in contenders() if one.name in ("NumPy lambdify", "mpmath 50 digits")]
    taken = times(who, 3000, 1, 0)
    assert taken["mpmath 50 digits"] > taken["NumPy lambdify"] > 0


def made_up(errors):
    """An audit of three, with these times and errors."""
    who = tuple(one._replace(name=name) for one, name in zip(contenders(), errors, strict=False))
    statistics = {
        name: {GENERIC: Statistics(e, e, e, e, 1), "dead_centre": Statistics(2 * e, e, e, e, 1)}
        for name, (_, e) in errors.items()
    }
    return Audit(QUICK, "machine", who, {name: time for name, (time, _) in errors.items()}, statistics)


def test_who_is_beaten_by_whom():
    result = made_up({"quick": (1.0, 5.0), "slow": (2.0, 5.0), "exact": (9.0, 0.5), "noise": (0.99, 7.0)})
    assert measures(result, "exact") == {
        "at generic points": 0.5, "in the hardest family": 1.0, "in plain ulp": 0.5
    }  # fmt: skip
    beaten = {name: beaten_by(result, name, "in plain ulp") for name in result.ratios}
    assert beaten == {"quick": [], "slow": ["quick"], "exact": [], "noise": []}


@pytest.mark.parametrize(
    ("x", "shown"),
    [
        (0.0, "<0.001"),
        (0.0123, "0.012"),
        (0.5, "0.5"),
        (1.0, "1.0"),
        (14.2, "14"),
        (2.4e7, "2e7"),
        (9e15, "none"),
    ],
)
def test_numbers_are_short(x, shown):
    assert number(x, 1e15) == shown


def test_a_table_is_even():
    assert table(["", "b"], [["aaa", "1"], ["c", "22"]]) == (
        "|     | b  |\n|-----|----|\n| aaa | 1  |\n| c   | 22 |"
    )
