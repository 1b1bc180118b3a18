"""Status: one enumeration a call; the numbers are those that the calls have always had."""

import pytest

import desaxe as dx
from desaxe.mechanism.catalogue import quantity
from desaxe.mechanism.status import TABLES, PeakStatus, PointStatus, TurnStatus

SIZES = {"ec": 0.0, "AB": 0.125, "BC": 0.35}


def test_every_code_is_told_once():
    for table in TABLES:
        assert len({int(status) for status in table}) == len(table)
        assert all(status.words for status in table)
        assert dx.status.__dict__[table.__name__] is table


def test_the_words_of_a_point_are_those_of_the_catalogue():
    message = ", ".join(f"{status:d} {status.words}" for status in PointStatus)
    assert quantity("status").meaning == message


@pytest.mark.parametrize(
    ("result", "expected"),
    [
        (dx.evaluate("status", theta=1.6, **{**SIZES, "ec": 0.24}), PointStatus.CANNOT_BE_ASSEMBLED),
        (dx.feasibility(**{**SIZES, "ec": 0.24})["status"], TurnStatus.CANNOT_TURN),
        (dx.events(ec=0.125, AB=0.125, BC=0.25)["status"], TurnStatus.CHANGE_POINT),
        (dx.peak("a_C", omega0=1.0, **{**SIZES, "ec": 1.0})["status"], PeakStatus.CANNOT_BE_ASSEMBLED),
    ],
)
def test_a_status_compares_with_its_members(result, expected):
    assert result == expected
