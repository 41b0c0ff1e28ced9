"""Changing a marker set on its page: what a person does there is in the file afterwards; strangers change nothing."""

import json
import re
import urllib.error
import urllib.request
from dataclasses import replace

import pytest
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from mbkf.errors import InvalidInput
from mbkf.io.records import MarkerTrajectories
from mbkf.model.protocol import Protocol, load_protocol
from mbkf.trial.protocol.standing import stand_beside
from mbkf.viz.protocol.edit import EditPage
from tests.captures import made_capture
from tests.viz.browsing import until
from tests.waiting import PATIENCE_S

PROTOCOL = load_protocol("reference36")
HARM = "<img src=x onerror=window.harmed=1>"
CAPTURE = made_capture(5, 0.0)


@pytest.fixture
def page_of(tmp_path):
    made = []

    def open_(protocol=PROTOCOL, capture=CAPTURE):
        page = EditPage(protocol, stand_beside(capture, protocol), tmp_path / "mine.toml")
        made.append(page)
        return page

    yield open_
    for page in made:
        page.close()


def asked(page, **word):
    return json.loads(page.hear(json.dumps(word)))


def named(path):
    return {marker.name: marker for marker in load_protocol(path).markers}


def test_saving_writes_and_done_ends(page_of, tmp_path):
    page = page_of()
    answer = asked(page, do="save", choices={"RASI": {"ignored": "loose"}})
    assert answer == {"saved": "mine.toml", "markers": len(PROTOCOL.markers) - 1, "ignored": 1}
    assert dict(load_protocol(tmp_path / "mine.toml").ignored) == {"RASI": "loose"}
    assert page.saved is not None and not page.done.is_set()
    back = asked(page, do="save", choices={}, before={"RASI": {"ignored": "loose"}})
    assert back["markers"] == len(PROTOCOL.markers)
    assert asked(page, do="done") == {"done": True}
    assert page.done.is_set()


def test_two_pages_and_the_file_are_merged_marker_by_marker(page_of, tmp_path):
    one, out = page_of(), tmp_path / "mine.toml"
    asked(one, do="save", choices={"RASI": {"ignored": "loose"}})
    asked(one, do="save", choices={"LASI": {"ignored": "fell off"}})  # another page of the same editor
    out.write_text(out.read_text() + '[[ignored]]\nname = "X1"\nreason = "by hand"\n')
    asked(one, do="save", choices={"RASI": {"ignored": "loose"}, "LKNE": {"landmark": "left_ankle_lateral"}},
          before={"RASI": {"ignored": "loose"}})  # fmt: skip
    found = load_protocol(out)
    assert dict(found.ignored) == {"RASI": "loose", "LASI": "fell off", "X1": "by hand"}
    assert named(out)["LKNE"].landmark == "left_ankle_lateral"


def test_a_marker_that_two_pages_changed_is_chosen(page_of, tmp_path):
    page, out = page_of(), tmp_path / "mine.toml"
    asked(page, do="save", choices={"RASI": {"ignored": "loose"}})
    late = {"RASI": {"ignored": "wrong place"}, "LASI": {"ignored": "fell off"}}
    answer = asked(page, do="save", choices=late)
    assert answer["differences"] == ["RASI"] and "RASI" in answer["trouble"]
    assert dict(load_protocol(out).ignored) == {"RASI": "loose", "LASI": "fell off"}
    assert "differences" not in asked(page, do="save", choices=late, over=True)
    assert dict(load_protocol(out).ignored) == {"RASI": "wrong place", "LASI": "fell off"}


@pytest.mark.parametrize(
    "word",
    [
        "", "[]", "3", "null", '{"do": "format"}', '{"do": "save", "choices": {"RASI": 3}}',
        '{"do": "save", "choices": {"RASI": {"path": "/etc"}}}', '{"do": "save", "choices": {"nobody": {}}}',
        '{"do": "save", "choices": {"RASI": {"segment": "tail"}}}',
    ],
)  # fmt: skip
def test_what_is_no_request_changes_nothing(word, page_of, tmp_path):
    page = page_of()
    assert set(json.loads(page.hear(word))) == {"trouble"}
    assert list(tmp_path.iterdir()) == []
    assert not page.done.is_set()


def test_only_who_has_the_token_may_speak(page_of, tmp_path):
    page = page_of()
    token = re.search(r"token=([\w-]+)", page.url)[1]
    assert page.url.startswith("http://127.0.0.1:") and len(token) > 15
    there = f"ws{page.url[4:].split('?')[0]}frames"
    for url, headers in (
        (there, {}),
        (f"{there}?token=guess", {}),
        (f"{there}?token={token}", {"Origin": "http://evil.example"}),
    ):
        with pytest.raises(InvalidStatus, match="403"), connect(url, additional_headers=headers):
            pass
    with pytest.raises(urllib.error.HTTPError, match="403") as refused:
        urllib.request.urlopen(
            urllib.request.Request(page.url, headers={"Host": "evil.example"}), timeout=PATIENCE_S
        )
    refused.value.close()
    with connect(f"{there}?token={token}") as mine:
        mine.recv(PATIENCE_S)
        mine.send(json.dumps({"do": "save", "choices": {}}))
        assert json.loads(mine.recv(PATIENCE_S))["saved"] == "mine.toml"
    assert (tmp_path / "mine.toml").is_file()


def test_a_name_that_is_no_marker_set_s_is_refused_at_once(tmp_path):
    with pytest.raises(InvalidInput, match=r"ends in \.toml"):
        EditPage(PROTOCOL, stand_beside(CAPTURE, PROTOCOL), tmp_path / "mine.txt")


@pytest.mark.slow
@pytest.mark.parametrize("width", [1300, 800])
def test_a_person_moves_a_marker_leaves_one_out_and_saves(opened, page_of, tmp_path, width):
    page = page_of()
    with opened(page.url) as shown:
        shown.set_viewport_size({"width": width, "height": 850})
        until(shown, "Boolean(window.mbkf && mbkf.labels.seen !== '' && mbkf.socket.readyState === 1)")
        shown.click('.item[data-item="RASI"]')
        shown.select_option("#segment", "right_thigh")
        until(shown, "document.querySelector('.dot[data-marker=RASI]').dataset.segment === 'right_thigh'")
        assert shown.text_content("#state") == "changed, not saved"
        shown.click('.item[data-item="LASI"]')
        shown.select_option("#landmark", "left_psis")
        shown.click('.item[data-item="LFHD"]')
        shown.click("#card >> text=Leave out")
        assert (
            shown.evaluate("document.querySelector('.item[data-item=LFHD]').className").split()[1]
            == "ignored"
        )
        shown.click('.item[data-item="RFHD"]')
        shown.click("#card >> text=Not known")
        shown.click("#card >> text=As before")
        assert shown.evaluate("document.documentElement.scrollWidth <= innerWidth")
        shown.click("#save")
        until(shown, "document.getElementById('state').textContent.startsWith('saved')")
        found = named(tmp_path / "mine.toml")
        assert (found["RASI"].segment, found["RASI"].kind) == ("right_thigh", "technical")
        assert found["LASI"].landmark == "left_psis"
        assert "LFHD" not in found and "RFHD" in found
        assert dict(load_protocol(tmp_path / "mine.toml").ignored) == {"LFHD": "left out by hand"}
        shown.click("#done")
        assert page.done.wait(PATIENCE_S)
        page.close()
        until(shown, "document.getElementById('state').textContent.startsWith('done')")


@pytest.mark.slow
def test_the_keyboard_alone_is_enough(opened, page_of, tmp_path):
    page = page_of()
    with opened(page.url) as shown:
        until(shown, "Boolean(window.mbkf && mbkf.labels.seen !== '' && mbkf.socket.readyState === 1)")
        shown.focus('.item[data-item="RASI"]')
        shown.keyboard.press("Enter")
        assert shown.evaluate("document.activeElement.dataset.item") == "RASI"  # the focus stays
        shown.focus("#segment")
        shown.keyboard.type("left shank")
        until(shown, "document.querySelector('.dot[data-marker=RASI]').dataset.segment === 'left_shank'")
        assert shown.evaluate("document.activeElement.id") == "segment"
        shown.focus("#save")
        shown.keyboard.press("Enter")
        until(shown, "document.getElementById('state').textContent.startsWith('saved')")
    assert named(tmp_path / "mine.toml")["RASI"].segment == "left_shank"


@pytest.mark.slow
def test_a_doubt_is_settled_and_a_name_does_no_harm(opened, page_of, tmp_path):
    doubtful = replace(PROTOCOL.markers[1], probability=0.6, alternatives=(("torso", 0.4),))
    protocol = replace(
        PROTOCOL,
        title=HARM,
        markers=(replace(PROTOCOL.markers[0], name=HARM), doubtful, *PROTOCOL.markers[2:]),
        ignored={"__proto__": HARM},
    )
    names = tuple(HARM if n == PROTOCOL.markers[0].name else n for n in CAPTURE.markers.names)
    markers = MarkerTrajectories(names, CAPTURE.markers.positions_m, CAPTURE.markers.rate_hz)
    page = page_of(protocol, replace(CAPTURE, markers=markers))
    with opened(page.url) as shown:
        until(shown, "Boolean(window.mbkf && mbkf.labels.seen !== '' && mbkf.socket.readyState === 1)")
        shown.locator(".item").filter(has_text=HARM).first.click()
        assert shown.text_content("#card h2") == HARM
        shown.select_option("#segment", "head")
        shown.click('.item[data-item="__proto__"]')
        shown.select_option("#landmark", "c7")
        shown.click(f'.item[data-item="{doubtful.name}"]')
        shown.click("#card >> text=torso (40 %)")
        shown.click("#save")
        until(shown, "document.getElementById('state').textContent.startsWith('saved')")
        assert shown.evaluate("window.harmed") is None
        assert shown.locator("img").count() == 0
    found = named(tmp_path / "mine.toml")
    assert found[HARM].segment == "head"
    assert found["__proto__"].landmark == "c7"
    assert (found[doubtful.name].segment, found[doubtful.name].probability) == ("torso", 1.0)


@pytest.mark.slow
def test_a_set_is_begun_from_nothing(opened, page_of, tmp_path):
    page = page_of(Protocol("none", "None", PROTOCOL.body, ()))
    with opened(page.url) as shown:
        until(shown, "Boolean(window.mbkf && mbkf.labels.seen !== '' && mbkf.socket.readyState === 1)")
        assert f"{len(CAPTURE.markers.names)} not in the set" in shown.text_content("#count")
        assert "does not fit this capture yet" in shown.text_content("#column")
        shown.click('.item[data-item="C7"]')
        shown.select_option("#landmark", "c7")
        shown.click("#save")
        until(shown, "document.getElementById('state').textContent.startsWith('saved')")
    assert list(named(tmp_path / "mine.toml")) == ["C7"]
