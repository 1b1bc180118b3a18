"""Peaks under tables by machine code: those of the search by NumPy, for any table, cut and threads."""

import numpy as np
import pytest

import desaxe as dx
from desaxe.evaluation.under_loads.arcs import arcs_of
from desaxe.loads.pieces import Place, first_doubles, piece_at, settled_pieces
from desaxe.peaks import compiled
from tests.effort import cases
from tests.ways import take_way

TURN = 2.0 * np.pi
RANGES = [(0.0, TURN), (-3.0, 9.5), (0.4, 1.9)]


def tables(rng, over, kind, both_ways):
    """A random load."""
    size = int(rng.integers(3, 9))
    value, back = 300.0 * rng.normal(size=(2, size))
    if over == "theta":
        period = TURN * rng.choice([1.0, 2.0])
        size, value = 3 * size, 300.0 * rng.normal(size=3 * size)
        angles = period * (np.arange(size) + rng.uniform(0.2, 0.8, size)) / size
        return dx.over_theta(angles, value, kind=kind, period=period)
    ways = (value, back) if both_ways else (value,)
    if over == "Y":
        return dx.over_Y(np.sort(rng.uniform(0.02, 0.25, size)), *ways, kind=kind)
    places = np.sort(rng.uniform(0.0, 0.15, size))
    return dx.over_stroke(places, *ways, kind=kind, dead_centre=over)


def designs(rng, size):
    """Random designs that turn fully, some next to their change point."""
    AB = rng.uniform(0.03, 0.07, size)
    ec = rng.uniform(-0.5, 0.5, size) * AB
    margin = AB * np.exp(rng.uniform(-12.0, 1.0, size))
    margin[::3] = 0.01 * AB[::3]  # some of any four are close: one form of the search serves all
    return {"ec": ec, "AB": AB, "BC": AB + np.abs(ec) + margin}


def peaks(monkeypatch, tier, name, given):
    take_way(monkeypatch, tier)
    return dx.peak(name, **given)


def require_equal(one, other, scale):
    np.testing.assert_array_equal(one["status"], other["status"])
    np.testing.assert_allclose(one["value"], other["value"], rtol=1e-12, atol=1e-14 * scale + 1e-13)
    near = np.abs(one["theta"] - other["theta"]) < 1e-6  # of extrema that are equal but for rounding, either
    np.testing.assert_array_equal(one["side"][near], other["side"][near])
    for parameter, slope in other["gradient"].items():
        found = one["gradient"][parameter]
        size = np.abs(slope) + np.abs(other["value"]) / (1.0 if parameter in ("F_X", "F_Y") else 0.05)
        size += 0.3  # of loads of 300 N: at a dead centre the value is 0 but for rounding
        good = (np.abs(found - slope) <= 1e-7 * size) | (np.isnan(found) & np.isnan(slope))
        assert good[near].all(), parameter
    return near


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("over", "kind", "both_ways"),
    [
        ("theta", "linear", False),
        pytest.param("theta", "cubic", False, marks=pytest.mark.thorough),
        pytest.param("Y", "linear", False, marks=pytest.mark.thorough),
        pytest.param("inner", "step", True, marks=pytest.mark.thorough),
    ],
)
def test_machine_code_finds_what_numpy_finds_for_any_table(over, kind, both_ways, monkeypatch):
    """One search, compiled once, serves all tables of a kind: of any size, for any range of angles."""
    rng = np.random.default_rng([3, len(over), len(kind)])
    kept, alike = set(), 0
    for _ in range(cases(3, 8, 400)):
        given = designs(rng, 24) | {"F_Y": tables(rng, over, kind, both_ways)}
        given |= {"kind": rng.choice(["absmax", "max", "min"]).item(), "theta": RANGES[rng.integers(3)]}
        by_numpy = peaks(monkeypatch, "numpy", "T_in", given)
        found = peaks(monkeypatch, "compiled", "T_in", given)
        kept.add(len(compiled.STORE))
        alike += require_equal(found, by_numpy, np.nanmax(np.abs(by_numpy["value"]))).sum()
        part = {n: v[5:9] if isinstance(v, np.ndarray) else v for n, v in given.items()}
        again = peaks(monkeypatch, "compiled", "T_in", {**part, "threads": 1})
        for key in ("value", "theta", "side", "status"):
            np.testing.assert_array_equal(again[key], found[key][5:9], err_msg=key)
    assert len(kept) == 1
    assert alike


def test_jumps_are_settled_as_integers_settle_them():
    """A step in long doubles tells the double behind nearly every jump, and never another one."""
    rng, settled, every = np.random.default_rng(8), 0, 0
    for _ in range(cases(20, 60, 2000)):
        one = {name: float(column[0]) for name, column in designs(rng, 1).items()}
        load = tables(rng, rng.choice(["Y", "inner", "outer"]), rng.choice(["step", "linear"]), True)
        columns = {name: np.array([side]) for name, side in one.items()} | {"omega0": np.array([1.0])}
        arcs = arcs_of(load, columns, 1, (-7.0, 7.0))
        numbers = np.flatnonzero(arcs.leaps[0])
        lengths = [np.full(numbers.size, one[name]) for name in ("ec", "AB", "BC")]
        near = arcs.starts[0, numbers]
        near = near + rng.integers(-3, 4, near.size) * np.spacing(near)
        found, sure = first_doubles(load, Place(near, lengths, 1.0, 1), arcs.turns[0, numbers])
        place = Place(0.0, [one[name] for name in ("ec", "AB", "BC")], 1.0, 1)
        for angle, known, number in zip(found.tolist(), sure.tolist(), numbers.tolist(), strict=True):
            exact = arcs.first_angle(place, 0, number)
            assert np.isnan(angle) or angle == exact or (not known and exact == np.nextafter(angle, np.inf))
            settled += known
            every += 1
    assert settled > 0.9 * every > 50 or np.finfo(np.longdouble).eps > 2.0**-60


def test_places_next_to_jumps_are_settled_as_integers_settle_them():
    """Long doubles tell the piece of nearly every double there, and never another one."""
    rng, settled = np.random.default_rng(8), 0
    for _ in range(20):
        one = {name: float(column[0]) for name, column in designs(rng, 1).items()}
        load = tables(rng, rng.choice(["Y", "inner", "outer"]), "step", bool(rng.integers(2)))
        from_centre = 0.0 if load.over == "Y" else dx.events(**one)[load.centre]
        position = load.positions(smooth=True)[1]
        places = [from_centre + side * position for side in (1.0, -1.0)]
        angles = np.concatenate([np.ravel(dx.inverse(Y=Y, **one)["theta"]) for Y in places])
        near = angles[np.isfinite(angles)]
        theta = (near + np.arange(-3.0, 4.0)[:, None] * np.spacing(near)).reshape(-1)
        lengths = [np.full(theta.size, one[name]) for name in ("ec", "AB", "BC")]
        found = settled_pieces(load, Place(theta, lengths, np.full(theta.size, -1.0), 1))
        for angle, piece in zip(theta.tolist(), found.tolist(), strict=True):
            exact = piece_at(load, Place(angle, [one[name] for name in ("ec", "AB", "BC")], -1.0, 1))
            assert piece in (-1, exact)
            settled += piece >= 0
    assert settled > 50 or np.finfo(np.longdouble).eps > 2.0**-60


def test_machine_code_of_another_form_does_not_serve(monkeypatch):
    """A store that has the search of narrow margins alone: a design with wide ones goes by NumPy."""
    given = {
        "ec": 0.01,
        "AB": 0.04,
        "BC": 0.2,
        "F_Y": dx.over_theta([0.0, 2.0, 5.0], [1.0, -5.0, 2.0], period=TURN),
    }
    wanted = peaks(monkeypatch, "numpy", "T_in", given)
    take_way(monkeypatch, None)
    monkeypatch.setattr(type(compiled.STORE), "is_ready", lambda _, search: not search.form.wide_margins)
    monkeypatch.setattr(compiled, "_on_disk", lambda _: False)
    assert dx.peak("T_in", **given) == wanted
