"""A live run from the page: asked for, framed, ended, and then a trial of the session with playback and report."""

import json
from dataclasses import asdict

import pytest

from mbkf.app import routes as module
from mbkf.app.pages import live_frame_page
from mbkf.stream.discovery import Found
from mbkf.stream.found import FoundStream
from mbkf.stream.run.folder import LOG_FOLDER
from mbkf.trial.live.log import FRAMES_FILE
from tests.app.asking import asked, plain
from tests.waiting import until

SOME_FRAMES = 200_000
"""Bytes of a log."""

START = "/live?session=P1&do=start"
WALK = json.dumps({"source": "file", "trial": "walk1", "body": "subject"})
STATIC = json.dumps({"source": "file", "trial": "static", "body": "standing"})


def once(server, cookie, wanted):
    """The run's state as soon as it is as wanted."""
    seen = []

    def reached():
        seen.append(plain(server, cookie, "/live/state")[1]["run"])
        return wanted(seen[-1])

    until(reached, lambda: seen[-1])
    return seen[-1]


@pytest.fixture(scope="module")
def recorded(server, cookie):
    """A person who stood still in a replayed capture and was scaled; the recording's name."""
    assert plain(server, cookie, "/live/state") == (200, {"run": None})
    assert asked(server, "/live/page", Cookie=cookie)[0].status == 404
    status, begun = plain(server, cookie, START, "POST", STATIC)
    assert status == 200 and begun["run"]["goes_on"]
    ended = once(server, cookie, lambda run: not run["goes_on"])
    assert ended["state"] == "ended", ended["reason"]
    return ended["name"]


@pytest.mark.slow
def test_a_person_who_stood_still_is_scaled_and_recorded(server, cookie, recorded):
    status, session = plain(server, cookie, "/session?session=P1")
    (row,) = [trial for trial in session["trials"] if trial["name"] == recorded]
    assert status == 200 and row["live"] and row["status"] == "done" and row["problems"] == []
    assert plain(server, cookie, "/live?session=P1")[1]["subject"] is True
    for look, sign in (("look", b'id="recording"'), ("report", "· report</title>".encode())):
        answer, text = asked(server, f"/trial/{look}?session=P1&trial={recorded}", Cookie=cookie)
        assert answer.status == 200 and sign in text


@pytest.mark.slow
def test_a_run_is_framed_at_its_own_address_alone_and_stopped(server, cookie, recorded):
    assert plain(server, cookie, START, "POST", WALK)[0] == 200
    status, refused = plain(server, cookie, START, "POST", WALK)
    assert status == 400 and "goes on already" in refused["trouble"]
    now = once(server, cookie, lambda run: run["port"] is not None)
    answer, text = asked(server, "/live/page", Cookie=cookie)
    assert answer.status == 200 and answer.headers["X-Frame-Options"] == "SAMEORIGIN"
    assert text.decode() == live_frame_page(now["port"])
    log = server.workspace.place("P1") / now["name"] / LOG_FOLDER / FRAMES_FILE
    once(server, cookie, lambda run: log.is_file() and log.stat().st_size > SOME_FRAMES)
    assert plain(server, cookie, "/live?session=P1&do=stop", "POST")[1]["run"]["state"] in {"ending", "ended"}
    ended = once(server, cookie, lambda run: not run["goes_on"])
    assert ended["state"] == "ended", ended["reason"]
    names = [trial["name"] for trial in plain(server, cookie, "/session?session=P1")[1]["trials"]]
    assert (
        names == sorted(names, key=lambda name: (name.startswith("live-"), name)) and ended["name"] in names
    )


@pytest.mark.slow
def test_a_run_that_is_killed_says_so_and_its_frames_are_kept(server, cookie, recorded):
    begun = plain(server, cookie, START, "POST", WALK)[1]["run"]
    log = server.workspace.place("P1") / begun["name"] / LOG_FOLDER / FRAMES_FILE
    once(server, cookie, lambda run: log.is_file() and log.stat().st_size > SOME_FRAMES)
    server.live._process.kill()
    failed = once(server, cookie, lambda run: not run["goes_on"])
    assert failed["state"] == "failed"
    assert failed["reason"].endswith("Hz; the frames recorded until then are kept")
    assert asked(server, f"/trial/look?session=P1&trial={begun['name']}", Cookie=cookie)[0].status == 200
    (row,) = [
        trial
        for trial in plain(server, cookie, "/session?session=P1")[1]["trials"]
        if trial["name"] == begun["name"]
    ]
    assert row["status"] == "done" and row["seconds"] > 0.0


def test_the_frame_may_hold_the_live_page_and_nothing_else():
    text = live_frame_page(51234)
    assert "default-src 'none'" in text and 'frame-src http://127.0.0.1:51234"' in text
    assert text.count("http:") == 2 and "{{" not in text and "<script" not in text


def test_what_can_be_followed_is_offered(server, cookie, monkeypatch):
    status, offer = plain(server, cookie, "/live?session=P1")
    assert status == 200 and [one["name"] for one in offer["captures"]] == ["walk1", "static"]
    found = FoundStream("lsl", "<b>QTM</b>", "lab", "", {"stream": "<b>QTM</b>"}, 36, 120.0, 2)
    monkeypatch.setattr(module, "find_streams", lambda: Found((found,), ()))
    told = {"streams": [asdict(found)]}
    assert plain(server, cookie, "/live/streams") == (200, told)


@pytest.mark.parametrize("body", ["{", "3", '{"source": "lsl"}'])
def test_what_cannot_be_run_is_told(server, cookie, body):
    status, told = plain(server, cookie, START, "POST", body)
    assert status == 400 and told["trouble"]


def test_an_unknown_session_is_told(server, cookie):
    for path, method in (("/live?session=P9", "GET"), ("/live?session=P9&do=start", "POST")):
        status, told = plain(server, cookie, path, method, STATIC)
        assert status == 400 and "no session 'P9'" in told["trouble"]
