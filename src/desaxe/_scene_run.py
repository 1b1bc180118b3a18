"""Running a scene: values over the grid, peaks, checks, feasibility, files."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, NamedTuple

from ._scene_read import Check, Claim, Content, Peak
from .extras import needed

if TYPE_CHECKING:
    import xarray as xr

# How far a run is: steps done, steps in all, what comes next.
Progress = Callable[[int, int, str], None]

BLOCK = 5_000_000  # points of the grid between two reports of progress
MOST_DESIGNS = 1_000_000  # that are looked at one by one for feasibility


class CheckResult(NamedTuple):
    """A printed value and the computed one, in SI units."""

    check: Check
    computed: float
    agrees: bool


class ClaimResult(NamedTuple):
    """A claimed increase of a peak over its baseline and the computed one, in percent."""

    claim: Claim
    computed: float
    agrees: bool


class PeakResult(NamedTuple):
    """The peaks of all designs, labelled, and what was claimed about some of them.

    `dataset` has over the designs' dimensions: `value`, `theta`, `status`, `value_wrt_<parameter>`
    and, where there is a baseline, `increase` (in percent).
    """

    peak: Peak
    dataset: "xr.Dataset"
    claims: tuple[ClaimResult, ...]


class Infeasible(NamedTuple):
    """A design that cannot turn fully, and the ranges of crank angles [rad] that it cannot reach."""

    design: dict[str, float]
    gaps: tuple[tuple[float, float], ...]


class FeasibilityResult(NamedTuple):
    """How many of the designs turn fully, up to where, and those that do not.

    `limit` is the largest |ec| with which the crank turns fully [m], where AB and BC are numbers.
    """

    designs: int
    infeasible: tuple[Infeasible, ...]
    limit: float | None


class Steps:
    """Counts the steps of a run for whoever watches."""

    def __init__(self, total: int, watch: Progress | None) -> None:
        self.done, self.total, self.watch = 0, total, watch

    @contextmanager
    def step(self, what: str) -> Iterator[None]:
        """One step, announced before it is taken."""
        self.tell(what)
        yield
        self.done += 1
        self.tell("")

    def tell(self, what: str) -> None:
        """Say how far the run is."""
        if self.watch is not None:
            self.watch(self.done, self.total, what)


def require_rooms(content: Content) -> None:
    """Fail at the start, not at the end, where an optional dependency is missing."""
    with needed("a scene's labelled results"):
        import xarray  # noqa: F401
    if content.data is not None:
        with needed("results.data"):
            import h5netcdf  # noqa: F401
    if content.pictures:
        with needed("[[picture]]"):
            import matplotlib  # noqa: F401
