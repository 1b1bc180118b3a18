"""The sketch to scale, and its animation."""

from itertools import pairwise

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

import desaxe as dx
from desaxe.plot import animate, mechanism, save

DESIGN = {"ec": 0.05, "AB": 0.125, "BC": 0.35}
GRID = {"theta": np.linspace(0, 2 * np.pi, 73), "omega0": 157.08}


@pytest.mark.parametrize("branch", [1, -1])
def test_links_have_their_lengths_wherever_they_are(branch):
    sketch = mechanism(theta="60 deg", branch=branch, **DESIGN)
    for theta in (0.0, 1.0, 2.5, 4.0, -1.0, 9.0):
        sketch.turn(theta)
        (crank, rod), centre = sketch.links, np.array(sketch.slider.get_center())
        assert np.hypot(*np.ptp(crank.get_xydata(), axis=0)) == pytest.approx(0.125, rel=1e-14)
        assert np.hypot(*np.ptp(rod.get_xydata(), axis=0)) == pytest.approx(0.35, rel=1e-14)
        np.testing.assert_array_equal(crank.get_xydata()[1], rod.get_xydata()[0])
        np.testing.assert_allclose(rod.get_xydata()[1], centre, atol=1e-15)
        np.testing.assert_allclose(crank.get_xydata()[1], [0.125 * np.sin(theta), 0.125 * np.cos(theta)])
        assert centre[0] == pytest.approx(-0.05)
        assert np.sign(centre[1]) == branch


def test_to_scale_and_told():
    sketch = mechanism(theta="60 deg", ec="50 mm", AB="125 mm", BC="350 mm")
    assert sketch.axes.get_aspect() == 1.0
    assert sketch.note.get_text() == "theta = 60 deg"
    assert sketch.axes.get_xlabel() == "X [m]"
    assert "ec = 0.05 m" in [text.get_text() for text in sketch.axes.texts]
    names = {text.get_text(): text for text in sketch.names}
    assert list(names) == ["A", "B", "C", "AB", "BC", "theta"]
    crank, rod = (np.array(link.get_data()).mean(axis=1) for link in sketch.links)
    np.testing.assert_allclose(names["AB"].xy, crank)
    np.testing.assert_allclose(names["BC"].xy, rod)
    sketch.turn(0.0)
    assert not names["theta"].get_visible()


def test_everything_stays_in_sight():
    sketch = mechanism(theta=0.0, **DESIGN)
    (left, right), (low, high) = sketch.axes.get_xlim(), sketch.axes.get_ylim()
    for theta in np.linspace(0, 6.3, 40):
        sketch.turn(theta)
        block = sketch.slider.get_bbox()
        assert left < block.x0 < block.x1 < right
        assert low < block.y0 < block.y1 < high


def test_what_cannot_be_assembled():
    sketch = mechanism(theta="90 deg", ec=0.3, AB=0.125, BC=0.35)
    assert sketch.note.get_text() == "theta = 90 deg, cannot be assembled"
    assert not sketch.slider.get_visible()
    sketch.turn("200 deg")
    assert sketch.slider.get_visible()
    never = mechanism(theta=0.0, ec=1.0, AB=0.125, BC=0.35)
    never.axes.figure.canvas.draw()


def test_sketch_on_given_axes_and_complaints():
    axes = Figure().add_subplot()
    assert mechanism(theta=0, ax=axes, **DESIGN).axes is axes
    with pytest.raises(TypeError, match=r"theta = .*: a sketch shows one design at one angle"):
        mechanism(theta=[0.0, 1.0], **DESIGN)
    with pytest.raises(ValueError, match="BC = -1"):
        mechanism(theta=0.0, ec=0, AB=0.1, BC=-1)


# ---- animations ------------------------------------------------------------------------------------


def test_gif(tmp_path):
    path = save(
        animate(dx.grid("a_C", **GRID, **DESIGN), "a_C", frames=4), tmp_path / "new" / "a.gif", dpi=40
    )
    with Image.open(path) as picture:
        assert picture.n_frames == 4
        assert picture.info["duration"] == 750
        frames = []
        for k in range(4):
            picture.seek(k)
            frames.append(np.asarray(picture.convert("L"), int))
    assert all(np.abs(a - b).max() > 100 for a, b in pairwise(frames))
    assert [other.name for other in path.parent.iterdir()] == ["a.gif"]


def test_html(tmp_path):
    path = save(animate(dx.grid("Y", theta=GRID["theta"], **DESIGN), frames=3), tmp_path / "a.html", dpi=40)
    assert path.read_text(encoding="utf-8").count("data:image/png;base64") == 3


def test_frames_are_points_of_the_dataset(tmp_path):
    """Evenly over the turn, whose last angle is its first; the dot is on the curve."""
    dataset = dx.grid("a_C", **GRID, **DESIGN)
    axes = Figure().subplots(1, 2)
    movie = animate(dataset, "a_C", frames=4, ax=axes)
    seen = []
    for place in movie.new_frame_seq():
        *_, dot = movie._func(place)
        seen.append((dot.get_xdata()[0], dot.get_ydata()[0]))
    np.testing.assert_allclose([x for x, _ in seen], [0.0, 90.0, 180.0, 270.0])
    np.testing.assert_array_equal([y for _, y in seen], dataset.a_C.values[[0, 18, 36, 54]])
    movie.save(tmp_path / "a.gif", dpi=20)


def test_complaints(tmp_path):
    dataset = dx.grid("a_C", **{**GRID, **DESIGN, "ec": [0.0, 0.1]})
    with pytest.raises(ValueError, match=r"a_C varies with ec too: choose .*sel\(ec=\.\.\.\)"):
        animate(dataset)
    with pytest.raises(ValueError, match="a_C has no dimension 'theta'"):
        animate(dataset.isel(theta=0, ec=0))
    with pytest.raises(ValueError, match="the dataset has no BC"):
        animate(dataset.isel(ec=0).drop_vars("BC"))
    with pytest.raises(ValueError, match="expected two Axes"):
        animate(dataset.isel(ec=0), "a_C", ax=Figure().add_subplot())
    movie = animate(dataset.isel(ec=0), frames=2)
    with pytest.raises(ValueError, match=r"written as \.gif or \.html"):
        save(movie, tmp_path / "a.xyz")
    save(movie, tmp_path / "a.gif", dpi=30)


def test_names_of_joints_are_beside_the_links():
    """Crank and rod in line: a name along them would be on the rod."""
    sketch = dx.plot.mechanism(theta=0.0, ec=0.0, AB=0.125, BC=0.35)
    for name in sketch.names[:5]:
        across, up = name.get_position()
        assert abs(across) > 2 * abs(up)
