"""The waiting page: shows what was said last and how far the standing is, and leaves its address to the next page."""

import json
import re
import socket
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st
from websockets.sync.client import connect

from mbkf.errors import InvalidInput
from mbkf.viz.live.page import LivePage
from mbkf.viz.live.standing_page import StandingPage, standing_page
from mbkf.viz.page import page
from mbkf.viz.sentences import said
from mbkf.viz.server import PageServer
from tests import waiting
from tests.recordings import PLATE, walk, walker
from tests.viz.browsing import until
from tests.viz.streams import feeding
from tests.waiting import PATIENCE_S

pytestmark = pytest.mark.slow

SENTENCES = (
    "stand still for 1 s, upright and in sight of the cameras",
    "waiting for a person to stand still: marker RWRA moved 38 mm",
    "standing still; scaling from 100 frames …",
    "scaled in 1.2 s: protocol reference36, 70.0 kg, markers fit to 2.1 mm RMS; result/subject.toml",
    "one <b>clause</b>",
)


@pytest.fixture
def standing():
    made = StandingPage()
    yield made
    made.close()


def socket_of(url):
    return connect(re.sub(r"^http(.*?)/(\?|$)", r"ws\1/frames\2", url))


def row_of(connection):
    return {
        name: value
        for name, value in json.loads(connection.recv(PATIENCE_S).decode()).items()
        if name != "said"
    }


def test_the_page_is_whole_and_connects_to_its_server_alone():
    text = standing_page()
    assert re.findall(r"\b(?:src|href)=[\"'](?!data:)", text) == []
    assert "connect-src 'self'" in text
    assert "{{" not in text


def test_the_live_page_is_told_from_this_one():
    """By the mark that the script looks for."""
    (mark,) = re.findall(r"OWN = '(.*)'", standing_page())
    assert mark in standing_page().split("<script>")[0]
    assert mark not in page()


def test_what_was_said_before_it_opened_is_shown_then(standing):
    standing.say(SENTENCES[0])
    with socket_of(standing.open("visit")) as one:
        assert json.loads(one.recv(PATIENCE_S)) == {"title": "visit"}
        assert row_of(one) == {"text": SENTENCES[0], "share": None}
        standing.progress(0.25)
        assert row_of(one) == {"text": SENTENCES[0], "share": 0.25}
        standing.say("scaling failed: « »")
        assert row_of(one) == {"text": "scaling failed: « »", "share": 0.25}
        standing.progress(None)
        assert row_of(one)["share"] is None


def test_a_sentence_comes_in_every_language(standing):
    standing.say(SENTENCES[0])
    said = json.loads(standing._packed()[1])["said"]
    assert said["es"] == {SENTENCES[0]: "quédese quieto 1 s, erguido y a la vista de las cámaras"}


@given(st.lists(st.one_of(st.sampled_from(("a", "b", "é\n")), st.none(), st.floats(0.0, 1.0)), min_size=1))
def test_rows_are_numbered_by_what_they_show(steps):
    standing, text, share = StandingPage(), "", None
    for step in steps:
        before = standing._packed()
        if isinstance(step, str):
            text = step
            standing.say(step)
        else:
            share = step
            standing.progress(step)
        number, row = standing._packed()
        assert json.loads(row) == {"text": text, "share": share, "said": {"en": {}, "es": {}}}
        assert (number == before[0]) == (row == before[1])


def test_the_next_page_gets_port_and_token_while_connections_are_still_open():
    """Also one over which nothing was ever asked, as browsers keep in reserve."""
    standing = StandingPage(address="0.0.0.0")
    url = standing.open("visit")
    port = int(re.search(r":(\d+)/", url)[1])
    local = f"http://127.0.0.1:{port}/?{url.split('?')[1]}"
    with socket.create_connection(("127.0.0.1", port)), socket_of(local) as one:
        one.recv(PATIENCE_S)
        given_port, token = standing.hand_over()
        assert given_port == port
        following = PageServer(
            "live", greeting="hello", newest=lambda: None, address="0.0.0.0", port=port, token=token
        )
        try:
            assert following.url == url
            with socket_of(local) as other:
                assert other.recv(PATIENCE_S) == "hello"
        finally:
            following.close()
    standing.close()


def test_closing_ends_the_thread_whether_it_was_opened_or_not(standing):
    before = set(threading.enumerate())
    StandingPage().close()
    standing.open("visit")
    standing.close()
    standing.close()
    waiting.until(lambda: set(threading.enumerate()) <= before, threading.enumerate)


def test_a_port_in_use_is_said(standing):
    port = int(standing.open("visit").split(":")[2].strip("/"))
    with pytest.raises(InvalidInput, match=f"127.0.0.1:{port}.*choose another"):
        StandingPage(port=port).open("visit")


def test_a_browser_shows_every_sentence_and_becomes_the_live_page(opened, standing):
    standing.say(SENTENCES[0])
    with opened(standing.open("visit")) as shown:
        for sentence in SENTENCES:
            standing.say(sentence)
            until(
                shown, f"document.getElementById('said').textContent === {json.dumps(said(sentence, 'en'))}"
            )
            assert shown.evaluate("document.documentElement.scrollHeight <= innerHeight")
        assert shown.text_content("#trial") == "visit"
        assert not shown.is_visible("#share")
        standing.progress(0.4)
        until(shown, "document.getElementById('share').getAttribute('aria-valuenow') === '40'")
        bar, done = (shown.locator(selector).bounding_box()["width"] for selector in ("#share", "#share i"))
        assert done == pytest.approx(0.4 * bar, abs=1.0)
        asked = len(shown.requested)
        assert shown.requested == [shown.url]
        port, token = standing.hand_over()
        until(shown, "document.getElementById('state').textContent === 'not connected'")
        with shown.expect_event("load"):
            live = LivePage(
                walker()[1], walk().marker_names, PLATE[None], title="a walk", port=port, token=token
            )
        with feeding(live):
            until(shown, "Boolean(window.mbkf && mbkf.view && mbkf.view.seenPelvis)")
            assert shown.locator("#scene canvas").is_visible()
        assert {re.sub("^http", "ws", url) for url in shown.requested[asked:]} == {
            re.sub("^http", "ws", shown.url)
        }
        live.close()
        opened.errors.clear()  # the lost connection
