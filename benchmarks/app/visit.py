"""The laboratory's page in a real browser: its server as a process of its own, and clicks that are counted."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mbkf.errors import InvalidInput, MissingDependency

SIZE = {"width": 1280, "height": 720}
"""The smallest screen that the page is made for."""

FLAGS = ("--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
"""Options of a browser without a graphics card."""

PATIENCE_S = 180.0


@dataclass
class Visit:
    """A page of the browser, and how often a person would have clicked.

    Attributes:
        page: The browser's page.
        clicks: Clicks until now; one in the system's own dialog included.
    """

    page: Any
    clicks: int = 0
    troubles: list[str] = field(default_factory=list)

    def click(self, selector: str) -> None:
        """Clicks what a selector finds."""
        self.page.locator(selector).first.click()
        self.clicks += 1

    def choose_folder(self, folder: Path) -> None:
        """Gives a folder through the page's button and the system's dialog: two clicks."""
        self.page.locator("input[type=file]").first.set_input_files(folder)
        self.clicks += 2

    def wait(self, selector: str) -> None:
        """Waits until something is there."""
        self.page.wait_for_selector(selector, timeout=1e3 * PATIENCE_S)


@contextmanager
def browser() -> Iterator[Any]:
    """A headless browser.

    Raises:
        MissingDependency: The package or the browser is missing.
    """
    try:
        from playwright.sync_api import sync_playwright
    except ImportError as error:
        raise MissingDependency("playwright", "drives the page in a browser", "test") from error
    program = shutil.which("chromium") or shutil.which("google-chrome")
    if program is None:
        raise InvalidInput("no browser is here: install chromium")
    with sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=program, args=list(FLAGS))
        try:
            yield made
        finally:
            made.close()


class Server:
    """`mbkf app` as a process."""

    def __init__(self, folder: Path) -> None:
        """Starts it on a folder."""
        words = [sys.executable, "-m", "mbkf", "app", str(folder), "--no-browser"]
        root = str(Path(__file__).resolve().parents[2])
        path = os.pathsep.join(filter(None, (root, os.environ.get("PYTHONPATH"))))
        self._process = subprocess.Popen(
            words, stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": path}
        )
        assert self._process.stdout is not None
        self.pid = self._process.pid
        self.url = self._process.stdout.readline().strip()
        if not self.url:
            raise InvalidInput("mbkf app did not start")

    def stop(self) -> None:
        """Ends it as Ctrl-C does."""
        self._process.send_signal(signal.SIGINT)
        self._process.wait(60.0)

    def kill(self) -> None:
        """Kills it at once."""
        self._process.kill()
        self._process.wait(60.0)


@contextmanager
def served(folder: Path) -> Iterator[Server]:
    """The page's server on a folder, until the block ends."""
    server = Server(folder)
    try:
        yield server
    finally:
        server.stop()


def visit(made: Any, url: str) -> Visit:
    """A new page at an address; what goes wrong in it is noted."""
    page = made.new_context(viewport=SIZE).new_page()
    found = Visit(page)
    page.on("pageerror", lambda error: found.troubles.append(str(error)))
    page.goto(url)
    return found


def until(condition: Any, patience_s: float = PATIENCE_S) -> float:
    """Waits until a function says yes; returns the seconds that it took.

    Args:
        condition: The function.
        patience_s: How long to wait.

    Raises:
        InvalidInput: It never does.
    """
    begin = time.perf_counter()
    while not condition():
        if time.perf_counter() - begin > patience_s:
            raise InvalidInput("the page did not get there")
        time.sleep(0.02)
    return time.perf_counter() - begin
