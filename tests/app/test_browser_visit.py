"""The visit on the page: entries of a clinician stand in the session's file, the laboratory's in its own."""

import pytest

from mbkf.app.server import AppServer
from mbkf.io.laboratory import LABORATORY_FILE, read_laboratory
from mbkf.io.session import SESSION_FILE, read_session
from tests.studies import runs_here, study
from tests.viz.browsing import until


@pytest.fixture
def lab(tmp_path):
    study(tmp_path / "lab", persons=1, trials=1)
    with runs_here():
        server = AppServer(tmp_path / "lab", workers=1)
        yield server
        server.close()


def test_visit_conditions_and_laboratory_are_kept(lab, opened):
    file, laboratory = lab.workspace.root / "P1" / SESSION_FILE, lab.workspace.root / LABORATORY_FILE
    entries = {"date": "2025-03-31", "diagnosis": "Hemiparesis", "condition": "Barefoot"}
    with opened(lab.url) as page:

        def enter(place, value):
            page.locator(place).fill(value)
            with page.expect_response(lambda one: one.request.method == "POST"):
                page.locator(place).dispatch_event("change", {"bubbles": True})

        page.locator("#visit > details > summary").click()
        for name, value in entries.items():
            enter(f"form.visit [name={name}]", value)
        page.locator("#visit details details summary").first.click()
        enter("#visit details details [name=condition]", "AFO")
        page.locator("#visit details details summary").last.click()
        enter("[name=laboratory]", "Gait laboratory")
    found = read_session(file)
    assert (found.visit.date, found.visit.diagnosis, found.visit.condition) == (
        "2025-03-31",
        "Hemiparesis",
        "barefoot",
    )
    assert [one.condition for one in found.trials.values()] == ["AFO"]
    assert read_laboratory(laboratory).name == "Gait laboratory"


def test_click_focus_and_open_parts_outlast_the_page_being_drawn_anew(lab, opened):
    with opened(lab.url) as page:

        def drawn_anew(height_m):
            page.evaluate(f"act.person(shown, {{ height_m: {height_m} }})")

        summary = page.locator("#visit > details > summary")
        page.locator("[name=height_m]").focus()  # the press takes the focus from it
        summary.hover()
        page.mouse.down()
        drawn_anew(1.71)
        page.mouse.up()
        page.locator("#visit > details[open]").wait_for()
        page.locator("form.visit [name=diagnosis]").fill("Hemiparesis")
        page.keyboard.press("Tab")
        until(page, "shown.notes.visit !== undefined")
        assert page.evaluate("document.activeElement.name") == "notes"
        summary.focus()
        page.keyboard.down(" ")
        drawn_anew(1.72)
        page.keyboard.up(" ")
        until(page, "waiting === null")
        assert page.locator("#visit > details:not([open])").count() == 1
