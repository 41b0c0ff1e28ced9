"""A real browser for the tests of pages."""

import os
import shutil
from contextlib import contextmanager

import pytest

from tests.viz.browsing import PATIENCE_S

FLAGS = (
    "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-gpu-compositing",
)  # fmt: skip
"""The 3-D view alone is drawn by the graphics software, and the page around it without."""

SLOW_DRAWING = """
window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 250);
window.cancelAnimationFrame = clearTimeout;
"""
"""Pages draw four times a second, on a screen of coarse pixels: without a graphics card each picture costs 0.05 s."""


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


def forgotten(page):
    """Leaves a page for an empty one, and nothing that it kept is there for the next."""
    page.evaluate(
        "(() => { try { localStorage.clear(); } catch { /* a page of the browser keeps nothing */ } })()"
    )
    page.context.clear_cookies()
    page.goto("about:blank")


@pytest.fixture(scope="module")
def tab(browser):
    """The page that the tests of a file open one after the other: a new one would compile every script again."""
    made = browser.new_page(device_scale_factor=0.25)
    made.add_init_script(SLOW_DRAWING)
    made.set_default_timeout(1e3 * PATIENCE_S)
    return made


@pytest.fixture
def opened(tab):
    """Opens one address at a time; afterwards the page must have reported no error."""
    errors = []
    heard = {
        "request": lambda request: tab.requested.append(request.url),
        "pageerror": lambda error: errors.append(str(error)),
        "console": lambda said: errors.append(said.text) if said.type == "error" else None,
    }

    @contextmanager
    def open_(url):
        tab.requested = []
        tab.set_viewport_size({"width": 920, "height": 420})
        for event, hear in heard.items():
            tab.on(event, hear)
        try:
            tab.answer = tab.goto(url)
            yield tab
        finally:
            for event, hear in heard.items():
                tab.remove_listener(event, hear)
            forgotten(tab)

    open_.errors = errors
    yield open_
    # A browser reports a refusal or a conflict, which some tests ask for, as an error of the page.
    meant = ("403 (Forbidden)", "409 (Conflict)")
    assert [error for error in errors if not any(one in error for one in meant)] == []
