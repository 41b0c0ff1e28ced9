"""Every page of the laboratory's page, one after the other, for checks that hold for all."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from benchmarks.app.visit import Visit

STILL_MS = 400.0
"""Time between two looks that see the same, ms."""


def every_page(
    user: Visit, every_trial: bool = False, close: str = "Close"
) -> Iterator[tuple[str, list[Any]]]:
    """Opens each page of a session that was run; yields its name and its frames, the outer one first.

    Args:
        user: A visit that shows a session with results.
        every_trial: Whether to open the pages of all trials that were run, not of the first alone.
        close: Text of the button that closes a page.
    """
    yield "session", [user.page.main_frame]
    for button in _dialogs(user, every_trial):
        name = button.inner_text()
        button.click()
        user.page.locator("dialog[open]").wait_for()
        _wait_until_still(user.page)
        yield name, list(user.page.frames)
        user.page.locator("dialog .bar button", has_text=close).last.click()
        user.page.locator("dialog").wait_for(state="detached")


def _wait_until_still(page: Any) -> None:
    """Waits until all frames are loaded and two looks see the same number of elements."""
    before, now = None, _elements(page)
    while now != before:
        page.wait_for_timeout(STILL_MS)
        before, now = now, _elements(page)


def _elements(page: Any) -> list[int]:
    """The number of elements of each frame, once it is loaded."""
    for frame in page.frames:
        frame.wait_for_load_state()
    return [frame.evaluate("document.getElementsByTagName('*').length") for frame in page.frames]


def _dialogs(user: Visit, every_trial: bool) -> list[Any]:
    """Buttons of the session, and of its trials that were run, which open something."""
    of_session = ("#session-report", "button.live", "button.marker-set")
    trials = user.page.locator("td .buttons")
    of_trials = (trials if every_trial else trials.first).locator(":scope > button").all()
    return [*(user.page.locator(one).first for one in of_session), *of_trials]
