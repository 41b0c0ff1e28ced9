"""The marker editor inside the page: over the server, and in a real browser."""

import json
import re

import pytest

from mbkf.app.marker_sets import SET_FILE, file_of_set
from mbkf.io.session import SessionNotes
from tests.app.asking import asked, plain
from tests.studies import study
from tests.waiting import PATIENCE_S


def test_the_page_and_what_it_says(server, cookie):
    assert plain(server, cookie, "/marker_set/say?session=P1", "POST", '{"do": "done"}')[0] == 400
    answer, text = asked(server, "/marker_set?session=P1", Cookie=cookie)
    assert answer.status == 200 and b'id="marker-set"' in text
    say = "/" + re.search(rb'"say":"([^"]+)"', text)[1].decode()
    status, said = plain(server, cookie, say, "POST", json.dumps({"do": "done"}))
    assert (status, said) == (200, {"done": True})
    status, said = plain(server, cookie, say, "POST", b"\xff")
    assert status == 200 and "cannot be read; load it again" in said["trouble"]
    assert asked(server, "/marker_set?session=P9", Cookie=cookie)[0].status == 404


def test_a_set_is_changed_and_saved_by_clicks(server, browser):
    study(server.workspace.root / "more", persons=1)
    page = browser.new_context(viewport={"width": 1280, "height": 720}, locale="en").new_page()
    page.goto(server.url)
    page.locator("button.session", has_text="more/P1").click()
    page.wait_for_selector("h2:has-text('more/P1')")
    page.locator("button.marker-set").first.click()
    editor = page.frame_locator("dialog iframe")
    editor.locator(".item", has_text="RASI").click(timeout=1e3 * PATIENCE_S)
    editor.locator("#segment").select_option("")
    editor.locator("#save").click()
    editor.locator("#state", has_text="saved:").wait_for()
    editor.locator("#done").click()
    page.locator("dialog").wait_for(state="detached")
    folder = server.workspace.root / "more" / "P1"
    assert "RASI" in (folder / "marker_set.toml").read_text().partition("ignored")[2]
    assert 'protocol = "marker_set.toml"' in (folder / "session.toml").read_text()


@pytest.mark.parametrize(
    ("stated", "file"),
    [("worn.toml", "worn.toml"), ("../lab.toml", SET_FILE), ("plug_in_gait", SET_FILE), (None, SET_FILE)],
)
def test_a_set_is_saved_where_the_session_names_its_own(stated, file):
    assert file_of_set(SessionNotes(protocol=stated)) == file
