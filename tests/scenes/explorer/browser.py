"""A real browser for the tests of the page: a Chromium, which pip alone cannot bring."""

import os
import shutil
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import sync_playwright

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
MISSING = (
    "the tests of the explorer page drive a Chromium, and there is none: "
    "`python -m playwright install chromium`, or a system's package `chromium`, or name one in DESAXE_BROWSER"
)


def browser_path(own):
    """The browser to drive: that of DESAXE_BROWSER, of the system, or Playwright's own.

    Where there is none the test is skipped with what to install, or fails where `CI` is set: there the
    page must not go untested.
    """
    named = os.environ.get("DESAXE_BROWSER")
    result = [named] if named else [*filter(None, map(shutil.which, NAMES)), own]
    path = next((path for path in result if Path(path).exists()), None)
    if path is None and os.environ.get("CI"):
        pytest.fail(MISSING, pytrace=False)
    return path or pytest.skip(MISSING)


@contextmanager
def started():
    """A browser that is running."""
    with sync_playwright() as playwright:
        path = browser_path(playwright.chromium.executable_path)
        # A container's user may not be allowed to make a sandbox; the page is our own.
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield browser
        browser.close()
