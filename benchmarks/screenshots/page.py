"""Pictures of the laboratory's page: folder, run, session, visit, laboratory, rename, bin, viewer, video, reports."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from benchmarks.app.visit import Visit, browser, served, visit
from benchmarks.screenshots.lab import FILMED, OTHERS, VISITS, WAITING, film, laboratory
from benchmarks.screenshots.picture import Taken, Taking, stacked, still

TALL, WIDE = {"width": 1280, "height": 900}, {"width": 1280, "height": 720}
WHOLE = {"width": 1280, "height": 1140}
PRINTED = {"width": 703, "height": 1000}
"""Printed area of A4 less margins, CSS pixels."""

BEFORE, AFTER, LATER = VISITS
OTHER = next(iter(OTHERS))
FRAME_OF_VIEW = 200
"""Frame that the pictures of the viewer show."""


def page_pictures(scratch: Path) -> Taking:
    """Takes them.

    Args:
        scratch: An empty folder.
    """
    lab = laboratory(scratch / "study")
    with browser() as made, served(lab) as server:
        user = visit(made, server.url)
        for session in (*VISITS, *OTHERS):
            _shown(user, server.url.split("?")[0], session)
            user.click("button.main")
            user.wait("text=/Done in|Ended/")
    film(lab)
    with browser() as made, served(lab) as server:
        user, address = visit(made, server.url), server.url.split("?")[0]
        for pictures in (_session, _viewer, _reports, _sheet, _arranged, _running):
            yield from pictures(user, address)


def _shown(user: Visit, address: str, session: str, size: dict[str, int] = WIDE) -> Any:
    """The page of a session, in a window of a size."""
    user.page.set_viewport_size(size)
    user.page.goto(address + "?" + urlencode({"session": session}))
    user.wait("tbody tr")
    return user.page


@contextmanager
def _dialog(user: Visit) -> Iterator[Any]:
    """The open dialog; closes it."""
    yield user.page.locator("dialog")
    user.page.locator("dialog .bar button", has_text="Close").last.click()
    user.page.locator("dialog").wait_for(state="detached")


def _session(user: Visit, address: str) -> Taking:
    yield Taken("screenshot_app_folder", still(_shown(user, address, WAITING)))
    page = _shown(user, address, AFTER, WHOLE)
    yield Taken("screenshot_app", still(page))
    for part in page.locator("#visit > details > summary").all():
        part.click()
    page.locator("#visit details details > summary").last.click()
    page.locator("input[name=laboratory]").wait_for()
    yield Taken("screenshot_app_visit", still(page.locator("#visit")))
    page.locator("button.marker-set").click()
    page.set_viewport_size(TALL)
    editor = page.frame_locator("dialog iframe")
    editor.locator(".item", has_text="RKNE").first.click()
    with _dialog(user) as dialog:
        yield Taken("screenshot_app_markers", still(dialog))


def _viewer(user: Visit, address: str) -> Taking:
    for name, session in (("screenshot_app_look", BEFORE), ("screenshot_app_video", FILMED[0])):
        page = _shown(user, address, session, TALL)
        page.get_by_role("row", name=FILMED[1]).get_by_role("button", name="3-D").click()
        view = page.frame_locator("dialog iframe")
        view.locator("#scrub").wait_for()
        page.wait_for_timeout(3000)
        view.locator("#scrub").evaluate(
            f"(one) => {{ one.value = {FRAME_OF_VIEW}; one.dispatchEvent(new Event('input')); }}"
        )
        with _dialog(user) as dialog:
            yield Taken(name, still(dialog, 700.0))


def _reports(user: Visit, address: str) -> Taking:
    page = _shown(user, address, AFTER, TALL)
    page.on("dialog", lambda asked: asked.accept())
    page.locator("#session-report").click()
    with _dialog(user) as dialog:
        dialog.locator("select").first.select_option(BEFORE)
        _to(page, "section[id^=gait-walk] h3 >> nth=1")
        yield Taken("screenshot_session_report", still(dialog))
        _to(page, '#change svg[aria-label="Knee flexion, right"]')
        yield Taken("screenshot_comparison", still(dialog))
        _to(page, "#conditions")
        yield Taken("screenshot_conditions", still(dialog))
        dialog.get_by_role("button", name="Build norms").click()
        page.locator("#told", has_text="norms").wait_for()
        _to(page, "svg.profile")
        yield Taken("screenshot_app_norms", still(dialog))
    page = _shown(user, address, LATER, TALL)
    page.get_by_role("row", name=FILMED[1]).get_by_role("button", name="Report").click()
    with _dialog(user) as dialog:
        _to(page, "#emg")
        yield Taken("screenshot_trial_emg", still(dialog))


def _to(page: Any, selector: str) -> None:
    """Moves the report in the dialog so that an element is at the top."""
    page.wait_for_timeout(2000)
    page.frame_locator("dialog iframe").locator(selector).first.evaluate(
        "(e) => window.scrollTo(0, window.scrollY + e.getBoundingClientRect().top - 56)"
    )


def _sheet(user: Visit, address: str) -> Taking:
    """The two pages of the sheet as they are printed, and the trend, with the norms that were built."""
    choices = {"session": LATER, "norms": "norms.toml", "trend": 1, "language": "en"}
    user.page.goto(address + "report?" + urlencode(choices))
    user.page.set_viewport_size(TALL)
    user.page.add_style_tag(content="nav { display: none !important }")
    yield Taken("screenshot_trend", still(user.page.locator("#trend")))
    user.page.emulate_media(media="print")
    user.page.set_viewport_size(PRINTED)
    leaves = [one.screenshot() for one in user.page.locator(".leaf").all()]
    user.page.emulate_media(media="screen")
    yield Taken("screenshot_summary", stacked(leaves, 24, beside=True))


def _arranged(user: Visit, address: str) -> Taking:
    page = _shown(user, address, OTHER)
    page.locator("[data-key='menu More for walk1']").click()
    page.locator("details[open] button", has_text="Rename").click()
    page.locator("dialog input[name=name]").fill("walk barefoot")
    yield Taken("screenshot_app_arrange", still(page))
    page.locator("dialog .bar button", has_text="Close").last.click()
    page.locator("[data-key='menu More for walk1']").click()
    page.locator("details[open] button", has_text="Delete").click()
    page.locator("#told button", has_text="Undo").wait_for()
    page.locator("details.bin summary").click()
    yield Taken("screenshot_app_bin", still(page))


def _running(user: Visit, address: str) -> Taking:
    """A run under way; it is cancelled once the picture is taken."""
    page = _shown(user, address, WAITING, TALL)
    page.locator("button.main").first.click()
    page.locator(".under-way", has_text="Filtering").first.wait_for()
    yield Taken("screenshot_app_running", page.screenshot())
    page.get_by_role("button", name="Cancel").click()
    page.locator("button.main:enabled").first.wait_for()
