"""A browser without a window or network that shows one page."""

from __future__ import annotations

import importlib
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, TypeAlias

from mbkf.errors import InvalidInput
from mbkf.stream.libraries import library

BrowserPage: TypeAlias = Any
"""A page as playwright holds it, which may not be installed."""

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "microsoft-edge")
"""Names of Chromium and its relatives."""

FLAGS = (
    "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run", "--disable-sync",
    "--disable-background-networking", "--disable-component-update", "--hide-scrollbars",
)  # fmt: skip
"""The processor draws WebGL, so that pictures do not depend on a graphics card; nothing is fetched."""


@contextmanager
def shown_page(text: str, width: int, height: int) -> Iterator[BrowserPage]:
    """A page in an invisible window.

    Args:
        text: The page.
        width: Of the window, pixels.
        height: Of the window, pixels.

    Yields:
        The page, loaded.

    Raises:
        MissingDependency: playwright is not installed.
        InvalidInput: No browser starts, or it cannot draw the page.
    """
    library("playwright", "a film", "film")
    playwright = importlib.import_module("playwright.sync_api")
    with playwright.sync_playwright() as driver:
        browser = _started(driver, playwright.Error)
        try:
            context = browser.new_context(viewport={"width": width, "height": height}, offline=True)
            page = context.new_page()
            page.set_content(text, wait_until="load")
            yield page
        except playwright.Error as error:
            raise InvalidInput(f"the browser cannot draw the page ({_first_line(error)})") from error
        finally:
            browser.close()


def ways_to_start() -> list[dict[str, str]]:
    """Places of browsers: on the path, playwright's own, or the usual folders of Chrome and Edge."""
    found = [{"executable_path": path} for name in NAMES if (path := shutil.which(name))]
    return [*found[:1], {}, {"channel": "chrome"}, {"channel": "msedge"}]


def _started(driver: Any, error: type[Exception]) -> Any:
    """The first browser that starts.

    Raises:
        InvalidInput: No browser starts.
    """
    sandbox = not (hasattr(os, "geteuid") and os.geteuid() == 0)  # Chromium has no sandbox for root
    why = ""
    for way in ways_to_start():
        try:
            return driver.chromium.launch(args=list(FLAGS), chromium_sandbox=sandbox, **way)
        except error as refused:
            why = why or _first_line(refused)
    raise InvalidInput(
        f"a film needs Chromium, Chrome or Edge, but no browser starts here ({why}); install one, for example by: "
        "playwright install chromium"
    )


def _first_line(error: Exception) -> str:
    return next(iter(str(error).splitlines()), type(error).__name__)
