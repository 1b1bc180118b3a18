"""Peaks of thousands of designs tell how far they are."""

from contextlib import contextmanager

import numpy as np
import pytest

import desaxe as dx
from desaxe.support import progress
from desaxe.support.progress import Portions, progress_bar

GIVEN = {"ec": np.linspace(0.0, 0.02, 24), "AB": 0.04, "BC": 0.1, "omega0": 30.0, "m_slider": 0.4}
KINDS = {
    "friction": {"mu": 0.1, "F_X": 5.0},
    "load": {"F_Y": dx.over_theta([0.0, 2.0, 4.0], [0.0, -50.0, 0.0], kind="linear")},
}


@pytest.mark.parametrize("kind", KINDS)
def test_long_peaks_tell_what_is_done_and_left(kind, monkeypatch):
    seen = []

    @contextmanager
    def recorded(**options):
        assert options == {"unit": "designs"}
        yield lambda *message: seen.append(message)

    monkeypatch.setattr("desaxe.peaks.designs.progress_bar", recorded)
    monkeypatch.setattr("desaxe.peaks.designs.LARGE", 20)
    for parts in ("USUAL_PART", "COSTLY_PART"):
        monkeypatch.setattr(f"desaxe.peaks.designs.{parts}", (8, 8))
    expected = dx.peak("T_in", **GIVEN, **KINDS[kind])
    assert seen[0] == (0, 24, "peaks of T_in")
    done = [message[0] for message in seen]
    assert len(done) > (3 if kind == "friction" else 1)
    assert done == sorted(done)
    assert done[-1] == 24
    assert seen[-1][2] == "peaks of T_in, about 0 s left"
    seen.clear()
    few = {**GIVEN, "ec": GIVEN["ec"][:10]}
    assert dx.peak("T_in", **few, **KINDS[kind])["value"] == pytest.approx(expected["value"][:10], rel=1e-12)
    assert not seen


def test_what_is_left_follows_from_what_is_done(monkeypatch):
    seen, clock = [], iter([100.0, 101.0, 104.0])
    monkeypatch.setattr(progress, "monotonic", lambda: next(clock))
    portions = Portions(10, "peaks", lambda *message: seen.append(message))
    portions.add(2)
    portions.add(6)
    assert seen == [(0, 10, "peaks"), (2, 10, "peaks, about 4 s left"), (8, 10, "peaks, about 1 s left")]


def test_one_bar_at_a_time(monkeypatch):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    with progress_bar() as outer, progress_bar() as inner:
        assert outer is not None
        assert inner is None
    with progress_bar() as again:
        assert again is not None
