"""Design maps: contours of what is feasible, the rest hatched up to the exact edge."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import desaxe as dx
from desaxe.plot import design_map

ECS, RODS = np.linspace(-0.1, 0.3, 21), np.linspace(0.2, 0.5, 16)


@pytest.fixture(scope="module")
def plane():
    return dx.design_map(["stroke", ("absmax", "a_C")], ec=ECS, BC=RODS, AB=0.125, omega0=157.08)


def edge_of(axes):
    """The points of the line between feasible and not."""
    (line,) = (c for c in axes.collections if c.get_linewidth().tolist() == [1.2])
    return np.concatenate([path.vertices for path in line.get_paths()])


def hatched(axes):
    return [c for c in axes.collections if getattr(c, "hatches", [None])[0]]


def test_labels_and_axes(plane):
    axes = design_map(plane, "stroke").axes
    assert axes.get_xlabel() == "eccentricity, ec [m]"
    assert axes.get_ylabel() == "length of the connecting rod, BC [m]"
    assert axes.get_xlim() == pytest.approx((-0.1, 0.3))
    assert axes.get_title(loc="left") == "AB\u00a0=\u00a00.125\u00a0m, omega0\u00a0=\u00a0157.08\u00a0rad/s"
    assert [other.get_ylabel() for other in axes.figure.axes[1:]] == ["stroke [m]"]
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["infeasible"]


def test_the_edge_is_where_the_margin_is_nought(plane):
    x, y = edge_of(design_map(plane, "stroke").axes).T
    np.testing.assert_allclose(y - 0.125 - np.abs(x), 0.0, atol=0.5 * (ECS[1] - ECS[0]))
    away = np.abs(x) > 0.03  # from the kink at ec = 0, which lies between samples
    np.testing.assert_allclose((y - 0.125 - np.abs(x))[away], 0.0, atol=1e-12)


def test_over_the_crank_angle_the_edge_is_where_the_rod_ends():
    theta = np.linspace(0, 2 * np.pi, 361)
    result = dx.grid("a_C", theta=theta, ec=np.linspace(0, 0.4, 41), AB=0.125, BC=0.35, omega0=157.08)
    axes = design_map(result, "a_C").axes
    x, y = edge_of(axes).T
    np.testing.assert_allclose(y + 0.125 * np.sin(np.radians(x)), 0.35, atol=1e-4)
    assert set(np.diff(axes.get_xticks())) == {45.0}


def test_friction_that_jams_is_hatched_too():
    """The edge runs between a point with a balance of forces and one without."""
    press = {"ec": 0.02, "AB": 0.04, "BC": 0.064, "omega0": 251.0, "m_slider": 0.8}
    theta, mu = np.linspace(0, 6, 61), np.linspace(0, 2, 21)
    result = dx.grid("T_in", theta=theta, mu=mu, **press)
    edge = edge_of(design_map(result, "T_in").axes)
    assert len(edge) > 20
    for x, y in edge:
        near = result.status.sel(theta=slice(np.radians(x) - 0.101, np.radians(x) + 0.101))
        near = near.sel(mu=slice(y - 0.101, y + 0.101)).values
        assert (near == 0).any()
        assert (near >= 5).any()


def test_what_grows_without_bound_does_not_squash_the_rest(plane):
    steep = dx.design_map(
        ("absmax", "a_C"), ec=np.linspace(0.0, 0.2249, 31), AB=0.125, BC=[0.35, 0.4], omega0=1.0
    )
    drawn = design_map(steep, "absmax_a_C")
    assert drawn.extend == "max"
    assert drawn.levels[-1] < 0.6 * float(steep.absmax_a_C.max())
    assert design_map(plane, "stroke").extend == "neither"


def test_swapped_and_on_given_axes(plane):
    axes = Figure().add_subplot()
    drawn = design_map(plane, "stroke", x="BC", ax=axes)
    assert drawn.axes is axes
    assert axes.get_ylabel().startswith("eccentricity")
    assert axes.get_title(loc="left") == ""


def test_all_or_nothing_feasible():
    wide = {"AB": 0.1, "BC": [0.5, 0.6, 0.7]}
    every = design_map(dx.design_map("stroke", ec=[0.0, 0.1], **wide), "stroke")
    assert not hatched(every.axes)
    assert every.axes.get_legend() is None
    none = design_map(dx.design_map("stroke", ec=[0.7, 0.8], **wide), "stroke")
    assert len(hatched(none.axes)) == 1
    none.axes.figure.canvas.draw()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"name": "V_C"}, "no 'V_C' in this dataset"),
        ({"name": "stroke", "x": "theta"}, "stroke has no dimension 'theta'"),
        ({"name": "stroke", "x": "ec", "y": "ec"}, "expected two dimensions"),
    ],
)
def test_complaints(plane, options, words):
    with pytest.raises(ValueError, match=words):
        design_map(plane, **options)
    with pytest.raises(ValueError, match="stroke has no dimension"):
        design_map(plane.isel(ec=0), "stroke")


def test_labels_of_levels_do_not_crowd():
    """Next to a limit angle all levels meet."""
    theta, ec = np.linspace(0, 2 * np.pi, 361), np.linspace(-0.3, 0.3, 61)
    grid = dx.grid("a_C", theta=theta, ec=ec, AB=0.125, BC=0.35, omega0=157.08)
    axes = dx.plot.design_map(grid, "a_C").axes
    places = np.array([text.get_position() for text in axes.texts]) / [360.0, 0.6]
    assert len(places) > 3
    apart = np.linalg.norm(places[:, None] - places[None], axis=-1)
    assert apart[np.triu_indices(len(places), 1)].min() > 0.07
    inside = places - [0.0, -0.5]
    assert inside.min() > 0.05  # none is cut by the frame
    assert inside.max() < 0.95
