"""A page has the table of the stored data, a page tells everything, a race runs and says who refused."""

import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.__main__ import MEASURED, PAGE, RESULTS
from benchmarks.contenders import BY_NAME, CONTENDERS, STANDARD
from benchmarks.measure import Effort, measure
from benchmarks.picture import errors_over_time, time_over_points
from benchmarks.race import Found, race, racers
from benchmarks.report import BEGIN, END, digits, page, ratio, short_table, terminal, with_table
from benchmarks.work import BY_KEY, WORKS

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def stored():
    return json.loads(RESULTS.read_text(encoding="utf-8"))


def test_the_short_table_is_that_of_the_stored_data(stored):
    text = MEASURED.read_text(encoding="utf-8")
    assert with_table(text, stored) == text, "python -m benchmarks --again"


def test_the_page_is_that_of_the_stored_data(stored):
    assert page(stored) == PAGE.read_text(encoding="utf-8"), "python -m benchmarks --again"


def test_the_stored_run_has_every_work_and_contender(stored):
    assert list(stored["one core"]) == [work.key for work in WORKS]
    assert stored["who"] == [one.name for one in CONTENDERS]
    assert not stored["absent"]
    assert set(stored["errors"]) == set(stored["starts"]) == set(stored["who"])


def test_the_table_has_ratios_of_the_data(stored):
    row = next(line for line in short_table(stored).splitlines() if "NumPy" in line)
    raced = stored["one core"]["point"]
    assert digits(raced["NumPy lambdify"]["seconds"] / raced[STANDARD]["seconds"]) in row
    assert ratio(raced, STANDARD) == 1.0
    assert math.isnan(ratio(raced, "nobody"))


def test_a_page_without_markers_is_refused(stored):
    with pytest.raises(ValueError, match="begin"):
        with_table("no table here", stored)
    written = with_table(f"before\n{BEGIN}\nold\n{END}\nafter\n", stored)
    assert written.startswith("before\n")
    assert written.endswith("after\n")
    assert "old" not in written


def test_the_pictures_show_every_contender(stored):
    for figure in (errors_over_time(stored), time_over_points(stored)):
        words = {text.get_text() for ax in figure.axes for text in ax.texts}
        words |= {
            text.get_text() for ax in figure.axes if ax.get_legend() for text in ax.get_legend().get_texts()
        }
        assert {name.removeprefix("desaxe ") for name in stored["who"]} <= {
            w.removeprefix("desaxe ") for w in words
        }


@pytest.mark.thorough
def test_a_small_run_measures_and_tells():
    data = measure([BY_KEY["point"]], Effort(quick=True, rounds=1, points=3000, judged=2))
    text = terminal(data)
    assert data["points"] == {"point": 3000}
    for name in data["who"]:
        assert name in text
        assert data["one core"]["point"][name]["seconds"] > 0
    assert (
        data["errors"][STANDARD]["change_point"][0] <= 1 < data["errors"]["NumPy lambdify"]["change_point"][0]
    )


@pytest.mark.thorough
def test_a_refusal_is_told_and_the_others_go_on():
    with racers([BY_NAME["NumPy lambdify"], BY_NAME[STANDARD]], [0]) as who:
        result = race(who, BY_KEY["point"], -1, 1)
        assert all("ValueError" in one for one in result.values())
        assert all(isinstance(one, Found) for one in race(who, BY_KEY["point"], 3000, 1).values())


def run(*options):
    command = [sys.executable, "-m", "benchmarks", *options]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def test_the_list_names_works_and_contenders():
    shown = run("--list").stdout
    assert all(work.key in shown for work in WORKS)
    assert all(one.name in shown for one in CONTENDERS)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--only", "nothing"], "invalid choice: 'nothing'"),
        (["--points", "0"], "at least 1"),
        (["--write", "--quick"], "--write stores works in full"),
    ],
)
def test_a_bad_option_is_one_clear_line(options, message):
    done = run(*options)
    assert done.returncode
    assert message in done.stderr
    assert "Traceback" not in done.stderr
