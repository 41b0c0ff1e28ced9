"""Every page of the laboratory's page, one after the other, for checks that hold for all."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from benchmarks.app.visit import Visit


def every_page(user: Visit) -> Iterator[tuple[str, list[Any]]]:
    """Opens each page of a session that was run; yields its name and its frames, the outer one first.

    Args:
        user: A visit that shows a session with results.
    """
    yield "session", [user.page.main_frame]
    for button in _dialogs(user):
        name = button.inner_text()
        button.click()
        user.page.locator("dialog[open]").wait_for()
        user.page.wait_for_timeout(1500)
        yield name, list(user.page.frames)
        user.page.locator("dialog .bar button", has_text="Close").last.click()
        user.page.locator("dialog").wait_for(state="detached")


def _dialogs(user: Visit) -> list[Any]:
    """Buttons of the session, and of the first trial that was run, which open something."""
    of_session = ("#session-report", "button.live", "button.marker-set")
    of_trial = user.page.locator("td .buttons").first.locator("button").all()
    return [*(user.page.locator(one).first for one in of_session), *of_trial]
