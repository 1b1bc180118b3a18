"""Paper B's ledger: every equation, every table entry and every number of the text is in it."""

import re
from collections import Counter

import pytest

from desaxe.errata.ledger import entries

ENTRIES = entries("B")
TWICE = {2: "ab", 5: "ab", 37: "ab", 42: "ab", 46: "ab"}  # equations with two labels
LABELS = [f"{number}{letter}" for number in range(1, 54) for letter in TWICE.get(number, [""])]

TABLE_1 = """\
Angular Velocity [omega] 251 Rad/s
Frequency [N] 2400 Rev/min
Maximum Stroke [S] 80 Mm
Crank Length [k] 40 Mm
Crank Mass [M_k] 0.2 Kg
Length of Connecting Rod [c] 64 Mm
Mass of Connecting Rod [M_c] 0.5 Kg
Offset distance [e] 20 Mm
Mass of Slider [M_s] 0.8 Kg
Time range (t) 0.01 - 0.06 S""".splitlines()
TABLE_2 = """\
Average Angular Velocity [omega] 20.994 Rad/s
Average Revolution [N] 200 Rev/min
Crank Length [k] 38.1 Mm
Equivalent Rotating Mass [M_2] 7 Kg
Length of Connecting Rod [c] 152.4 Mm
Equivalent Reciprocating Mass [M_3] 1.543 Kg
Offset distance [e] 0 Mm
Time range (t) 0.01 - 0.6 S""".splitlines()
TABLE_3 = """\
Maximum Acceleration, Experiment: 19.56 m/s2
Maximum Acceleration, This model: 13.58 m/s2
Maximum Acceleration, Existing model: 12.59 m/s2
Minimum Acceleration, Experiment: -13.97 m/s2
Minimum Acceleration, This model: -19.98 m/s2
Minimum Acceleration, Existing model: -20.99 m/s2
Maximum Error, This model: 16.24 m/s2
Maximum Error, Existing model: 16.30 m/s2
Minimum Error, This model: 0.3678 m/s2
Minimum Error, Existing model: 0.3715 m/s2""".splitlines()

# Numbers of the abstract, the text and the captions, besides those of the tables.
TIMES_AND_ANGLES = ["0.12", "0.13", "0.025", "1.08", "172.57", "186.96", "359.53", "360", "2400", "251"]
LENGTHS_AND_TORQUES = ["0.08", "80mm", "20mm", "10mm", "250Nm", "50Nm", "80Nm", "120Nm"]


def test_every_equation_once():
    equations = Counter(entry.id for entry in ENTRIES if re.fullmatch(r"B-eq\w+", entry.id))
    assert equations == {f"B-eq{label}": 1 for label in LABELS}
    assert len(LABELS) == 58


def test_equations_stand_where_they_say():
    for label in LABELS:
        entry = next(entry for entry in ENTRIES if entry.id == f"B-eq{label}")
        assert re.match(rf"Eq\. {label}\b", entry.where)
        assert entry.test.endswith(f"::test_eq{label}")


@pytest.mark.parametrize(("number", "rows"), [(1, TABLE_1), (2, TABLE_2), (3, TABLE_3)])
def test_every_row_of_a_table_once(number, rows):
    found = Counter(entry.printed for entry in ENTRIES if entry.id.startswith(f"B-table{number}-"))
    assert found == dict.fromkeys(rows, 1)
    assert all(
        entry.where.startswith(f"Table {number}")
        for entry in ENTRIES
        if entry.id.startswith(f"B-table{number}-")
    )


@pytest.mark.parametrize("number", TIMES_AND_ANGLES + LENGTHS_AND_TORQUES)
def test_every_number_of_the_text(number):
    text = [entry for entry in ENTRIES if not entry.where.startswith("Table")]
    assert [entry.id for entry in text if re.search(rf"(?<![\d.]){re.escape(number)}(?!\d)", entry.printed)]


def test_every_proof_of_an_error_is_its_own():
    """No equation that is not right leans on the proof of another; a claim may share one."""
    wrong = Counter(entry.test for entry in ENTRIES if entry.verdict != "correct" and "-eq" in entry.id)
    assert set(wrong.values()) == {1}


def test_known_errors():
    """The equations with an error, so that none is lost or added unseen."""
    verdicts = {entry.id[4:]: entry.verdict for entry in ENTRIES if re.fullmatch(r"B-eq\w+", entry.id)}
    wrong = {label: verdict for label, verdict in verdicts.items() if verdict != "correct"}
    assert wrong == {
        "2b": "typo",
        **dict.fromkeys(["10", "17", "29", "30", "52"], "sign"),
        **dict.fromkeys(["18", "20"], "sign and exponent"),
        "42b": "sign and missing factor",
        **dict.fromkeys(["38", "39", "40", "41", "45", "47", "48", "49", "50"], "wrong claim"),
    }
