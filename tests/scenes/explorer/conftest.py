"""The browser, pages of it, and the files that they are open on."""

from contextlib import contextmanager

import pytest
from plotly.offline import get_plotlyjs

import desaxe as dx
from tests.scenes.explorer.browser import started

COMPACTOR = {"AB": "125 mm", "BC": "350 mm", "omega0": "1500 rpm"}
# In the place of the plotting library, which takes most of the time of a page: it checks what it is to draw.
DRAWS_NOTHING = """window.Plotly = {
  relayout() {},
  react(plot, traces) {
    plot.on = () => {};
    const whole = ({ x, y }) => x.length > 1 && x.length === y.length && x.every(Number.isFinite);
    if (!traces.length || !traces.every(whole)) console.error("a curve that cannot be drawn");
  },
};"""


@pytest.fixture(scope="session")
def browser():
    with started() as browser:
        yield browser


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("explorer")


@pytest.fixture(scope="session")
def one_design(folder):
    return dx.explore(path=folder / "one.html", ec=0.0, **COMPACTOR)


@pytest.fixture(scope="session")
def several_designs(folder):
    return dx.explore(path=folder / "several.html", ec=["0 mm", "100 mm", "230 mm"], **COMPACTOR)


@pytest.fixture
def visit(browser):
    """Open a file in a page of some size; at the end of the test it must not have complained."""
    with visiting(browser) as visit:
        yield visit


@pytest.fixture(scope="session")
def standing(browser, one_design):
    """A page of the one design that stays open, for tests that change nothing on it."""
    with visiting(browser) as visit:
        yield visit(one_design)


@pytest.fixture
def numbers_of(visit):
    """Open a page for its numbers alone: with all of its scripts but the plotting library."""

    def numbers_of(path):
        text = path.read_text(encoding="utf-8")
        assert get_plotlyjs() in text
        path = path.with_name(f"numbers_of_{path.name}")
        path.write_text(text.replace(get_plotlyjs(), DRAWS_NOTHING), encoding="utf-8")
        return visit(path, selector="#mechanism svg")

    return numbers_of


@contextmanager
def visiting(browser):
    """A function that opens pages, which are closed after the test."""
    contexts, complaints = [], []

    def visit(path, width=1360, height=900, selector="#plot-1 .main-svg", **options):
        context = browser.new_context(viewport={"width": width, "height": height}, **options)
        context.set_offline(True)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: complaints.extend(_foreign(request.url)))
        page.goto(path.as_uri())
        page.wait_for_selector(selector)
        return page

    yield visit
    for context in contexts:
        context.close()
    assert complaints == []


def _foreign(url):
    """The page makes no request to any server."""
    return [] if url.startswith(("file:", "data:", "blob:")) else [url]
