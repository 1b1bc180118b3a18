"""Many designs at once in NumPy: what plain loops find, without a compiler."""

import numpy as np
import pytest

import desaxe as dx
from desaxe.peaks import compiled
from desaxe.peaks import designs as plans
from desaxe.runtime import cache
from desaxe.support.recent import Recent
from tests.effort import cases
from tests.ways import take_way

BODIES = {"m_slider": 1.0, "m_rod": 0.6, "I_rod": 0.004, "r_rod": 0.03, "g_Y": 9.81}


@pytest.fixture(autouse=True)
def cold(monkeypatch):
    """No search in memory or on disk, and no compiler."""

    def refuse(search):
        raise AssertionError(f"the search for {search.name} is compiled")

    monkeypatch.setattr(compiled.STORE, "_loaded", Recent(compiled.MOST_LOADED))
    monkeypatch.setattr(compiled, "_on_disk", lambda search: False)
    monkeypatch.setattr(compiled.STORE, "load", refuse)


def designs(size, seed, narrowest=1e-9):
    rng = np.random.default_rng(seed)
    AB = rng.uniform(0.02, 0.06, size)
    ec = rng.uniform(-1.0, 1.0, size) * AB * rng.integers(0, 2, size)
    margin = AB * np.exp(rng.uniform(np.log(narrowest), 1.0, size))
    return {"ec": ec, "AB": AB, "BC": AB + np.abs(ec) + margin, "omega0": 7.0}


@pytest.mark.sampled
@pytest.mark.parametrize("kind", ["absmax", "max", "min"])
@pytest.mark.parametrize(("name", "more"), [("a_C", {}), ("V_C", {}), ("T_in", BODIES)])
def test_many_designs_are_those_of_loops_in_plain_python(name, kind, more, monkeypatch):
    given = designs(cases(40, 300, 2_000), 1) | more
    arrays = dx.peak(name, kind=kind, **given)
    take_way(monkeypatch, "plain")
    loops = dx.peak(name, kind=kind, **given)
    np.testing.assert_allclose(arrays["value"], loops["value"], rtol=1e-13)
    apart = np.abs(arrays["theta"] - loops["theta"]) > 1e-6  # of two that are equal but for rounding, either
    other = dx.evaluate(name, **{**given, "theta": arrays["theta"]})
    score = {"absmax": np.abs(other), "max": other, "min": other}[kind]
    np.testing.assert_allclose(score, loops["value"], rtol=1e-12)
    for parameter, slope in loops["gradient"].items():
        found = arrays["gradient"][parameter]
        scale = np.abs(slope) + np.abs(loops["value"])
        assert (np.abs(found - slope) <= 1e-7 * scale)[~apart].all(), parameter


def test_no_number_of_calls_waits_for_a_compiler():
    given = designs(1_000, 2, narrowest=0.3)
    first = dx.peak("a_C", **given)
    for _ in range(19):  # 20,000 designs
        found = dx.peak("a_C", **given)
    np.testing.assert_array_equal(found["value"], first["value"])


def test_where_no_search_is_stored_no_text_of_one_is_written(tmp_path, monkeypatch):
    """The text is what a stored search is looked up by: it takes as long as half of the call."""
    monkeypatch.setattr(cache, "folder", lambda: cache.Folder(tmp_path, lasting=True))
    monkeypatch.setattr(compiled, "_on_disk", compiled.STORE.is_on_disk)
    monkeypatch.setattr(compiled.STORE, "_text", lambda search: pytest.fail("a text is written"))
    assert (dx.peak("V_C", **designs(100, 6, narrowest=0.3))["status"] == 0).all()


def test_designs_far_from_any_change_point_are_searched_at_few_angles():
    given = designs(500, 7, narrowest=1.0)
    some = np.flatnonzero(given["BC"] - given["AB"] - np.abs(given["ec"]) > 0.5 * given["AB"])
    plan = plans.SearchedDesigns(given | {"omega0": np.full(500, 7.0)}, 1, (0.0, 2 * np.pi), False)
    starts = np.diff(plans._classed(plan, some, coarse=True).node_starts)
    assert starts.size == 1
    assert starts.max() < 32


def test_a_call_that_takes_longer_than_compiling_compiles():
    with pytest.raises(AssertionError, match="the search for a_C is compiled"):
        dx.peak("a_C", **designs(800_000, 3, narrowest=0.3))


def test_designs_in_any_company_have_the_same_peaks():
    """Groups and blocks of other designs change no more than the last digits."""
    given = designs(2_500, 4)
    whole = dx.peak("a_C", **given)["value"]
    for part in (slice(0, 5), slice(900, 1_200), slice(2_499, None)):
        some = {n: v[part] if np.ndim(v) else v for n, v in given.items()}
        np.testing.assert_allclose(dx.peak("a_C", **some)["value"], whole[part], rtol=1e-13)


def test_nan_and_designs_that_cannot_turn_are_told_among_many():
    given = designs(50, 5, narrowest=0.3)
    given["ec"][3], given["BC"][7] = np.nan, 0.01
    found = dx.peak("V_C", **given)
    assert found["status"][3] == 4
    assert np.isnan(found["value"][3])
    assert found["status"][7] != 0
    assert np.isfinite(np.delete(found["value"], [3, 7])).all()
