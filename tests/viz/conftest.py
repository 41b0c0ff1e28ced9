"""A real browser for the tests of pages."""

import os
import shutil
from contextlib import contextmanager

import pytest

from tests.viz.browsing import PATIENCE_S

FLAGS = (
    "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
)  # fmt: skip


@pytest.fixture(scope="module")
def browser():
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if chromium is None:
        message = "no chromium on this machine; install it (Debian: apt-get install chromium)"
        (pytest.fail if os.environ.get("CI") else pytest.skip)(message)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        yield made
        made.close()


@pytest.fixture
def opened(browser):
    """Opens an address; afterwards the page must have reported no error."""
    errors, pages = [], []

    @contextmanager
    def open_(url):
        page = browser.new_page(viewport={"width": 920, "height": 420})
        page.set_default_timeout(1e3 * PATIENCE_S)
        page.requested = []
        page.on("request", lambda request: page.requested.append(request.url))
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda m: errors.append(m.text) if m.type == "error" else None)
        page.answer = page.goto(url)
        pages.append(page)
        yield page
        page.close()

    open_.errors = errors
    yield open_
    # A browser reports a refusal or a conflict, which some tests ask for, as an error of the page.
    meant = ("403 (Forbidden)", "409 (Conflict)")
    assert [error for error in errors if not any(one in error for one in meant)] == []
