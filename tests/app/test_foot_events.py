"""Events by hand go into the session's file and into the curves; what cannot be is told and changes nothing."""

import json

import numpy as np
import pytest

from mbkf.app.foot_events import MOST_EVENTS, cycles_in, events_of, events_version
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.results_folder import read_reconstruction
from mbkf.io.session import EventKind, FootEvent, SessionNotes, TrialKind, TrialNotes, read_session
from mbkf.study.batch.curves import curves_of, read_curves
from mbkf.study.batch.inputs import RECORD
from mbkf.study.batch.trial import CURVES_FILE
from tests.app.asking import asked, changed, plain
from tests.studies import batch_here
from tests.waiting import PATIENCE_S

EVENTS = "/trial/events?session=P1&trial=walk1"


@pytest.fixture(scope="module")
def run(server, cookie):
    """The folder of the trial's results, and what a page draws of them."""
    plain(server, cookie, "/run?session=P1&do=start", "POST")
    ended = {"finished", "cancelled", "failed"}
    assert server.runs.wait(lambda: server.runs.state("P1").state in ended, PATIENCE_S)
    status, told = plain(server, cookie, "/trial/recording?session=P1&trial=walk1")
    assert status == 200
    return server.workspace.result("P1", "walk1"), told


def said(server, cookie, events, address=EVENTS):
    """The reply to a change of the present events."""
    now = server.workspace.events("P1", "walk1")
    return changed(server, cookie, address, {"events": events}, events_version(now))


def starts(folder):
    return sorted(set(read_curves(folder / CURVES_FILE)["start_s"].to_pylist()))


def test_the_page_and_the_frames_are_given_out(server, cookie, run):
    _, told = run
    assert {"scene", "rows", "found", "events", "version", "frame_s", "span_s", "verdict"} == set(
        told
    ) and told["events"] is None
    kinds = {(one["side"], one["kind"]) for one in told["found"]}
    assert kinds == {(side, kind) for side in ("right", "left") for kind in ("strike", "off")}
    answer, text = asked(server, "/trial/look?session=P1&trial=walk1", Cookie=cookie)
    assert answer.status == 200 and b'id="recording"' in text and b"default-src 'none'" in text
    for path in ("/trial/look", "/trial/recording"):
        answer, text = asked(server, f"{path}?session=P1&trial=other", Cookie=cookie)
        assert answer.status in {400, 404} and b"no result of 'other' yet" in text


def test_events_by_hand_cut_the_curves_and_a_batch_keeps_them(server, cookie, run):
    folder, told = run
    before = starts(folder)
    moved = [{**one, "time_s": one["time_s"] + 0.04} for one in told["found"] if one["time_s"] < 2.4]
    status, answer = said(server, cookie, moved)
    assert status == 200 and answer["events"] == moved
    assert answer["cycles"] == cycles_in(folder / CURVES_FILE) != [0, 0]
    np.testing.assert_allclose(starts(folder), np.array(before) + 0.04, atol=1e-12)
    file = server.workspace.root / "P1" / "session.toml"
    assert [one.time_s for one in read_session(file).trial("walk1").events] == [
        one["time_s"] for one in moved
    ]
    cut, written = read_curves(folder / CURVES_FILE), (folder / CURVES_FILE).read_bytes()
    table = batch_here(server.workspace.root, server.workspace.out).to_pylist()
    assert {row["trial"]: row["status"] for row in table}["walk1"] == "unchanged"
    by_hand = read_session(file).trial("walk1").events
    assert (folder / CURVES_FILE).read_bytes() == written
    assert curves_of(read_reconstruction(folder), by_hand)["start_s"].equals(cut["start_s"])
    assert said(server, cookie, None)[1]["events"] is None
    assert starts(folder) == before and "event" not in file.read_text(encoding="utf-8")


def test_the_report_is_cut_at_events_by_hand(server, cookie, run):
    address = "/trial/report?session=P1&trial=walk1"
    found = asked(server, address, Cookie=cookie)[1]
    assert said(server, cookie, [])[1]["cycles"] == [0, 0]
    without = asked(server, address, Cookie=cookie)[1]
    assert b"over the gait cycle" in found and b"over the gait cycle" not in without
    said(server, cookie, None)
    assert asked(server, address, Cookie=cookie)[1] == found


def test_events_and_other_notes_leave_each_other_alone(server, cookie, run):
    workspace, event = server.workspace, FootEvent("left", EventKind.OFF, 1.25)
    workspace.change_events("P1", "walk1", None, (event,))
    workspace.change(
        "P1", SessionNotes(), SessionNotes(name="A", trials={"static": TrialNotes(TrialKind.STATIC)})
    )
    workspace.change_events("P1", "other", None, ())
    notes = workspace.survey("P1").notes
    assert notes.name == "A" and notes.trial("walk1").events == (event,) and notes.trial("other").events == ()
    workspace.change("P1", SessionNotes(), SessionNotes(trials={"walk1": TrialNotes(TrialKind.WALK)}))
    kept = workspace.survey("P1").notes.trial("walk1")
    assert kept == TrialNotes(TrialKind.WALK, events=(event,)), "a page that knows older events loses none"
    for trial in ("walk1", "other"):
        workspace.change_events("P1", trial, workspace.events("P1", trial), None)


def test_while_a_session_runs_its_curves_are_left_to_the_run(server, cookie, run, monkeypatch):
    folder, _ = run
    before = starts(folder)
    state = server.runs.state("P1")
    monkeypatch.setattr(state, "state", "running")
    answer = said(server, cookie, [])[1]
    assert (answer["events"], answer["cycles"]) == ([], None) and starts(folder) == before
    monkeypatch.undo()
    said(server, cookie, None)


def test_curves_that_cannot_be_made_are_left_to_the_next_run(server, cookie, run):
    folder, _ = run
    record = (folder / RECORD).read_bytes()
    (folder / RECORD).write_text("{")
    status, answer = said(server, cookie, [])
    assert status == 200 and (answer["events"], answer["cycles"]) == ([], None)
    assert read_session(server.workspace.root / "P1" / "session.toml").trial("walk1").events == ()
    (folder / RECORD).write_bytes(record)
    assert said(server, cookie, None)[1]["cycles"] == cycles_in(folder / CURVES_FILE)


@pytest.mark.parametrize(
    ("address", "body", "told"),
    [
        (EVENTS, "no json", "cannot be read; load it again"),
        (EVENTS, "[]", "sent no events"),
        (EVENTS, "{}", "sent no events"),
        (EVENTS, '{"events": 3}', "event must be a list"),
        (EVENTS, '{"events": [{"side": "right", "kind": "strike"}]}', "time_s is missing"),
        (EVENTS, '{"events": [{"side": "middle", "kind": "off", "time_s": 1}]}', "side must be"),
        (EVENTS, '{"events": [{"side": "left", "kind": "off", "time_s": NaN}]}', "not finite"),
        ("/trial/events?session=P9&trial=walk1", '{"events": []}', "no session 'P9'"),
        ("/trial/events?session=P1&trial=walk9", '{"events": []}', "no result of 'walk9'"),
        ("/trial/events?session=P1&trial=static", '{"events": []}', "no result of 'static'"),
    ],
)
def test_what_cannot_be_is_told_and_changes_nothing(server, cookie, run, address, body, told):
    file = server.workspace.root / "P1" / "session.toml"
    before = file.read_bytes() if file.exists() else None
    version = events_version(server.workspace.events("P1", "walk1"))
    answer, text = asked(server, address, "POST", body, **{"Cookie": cookie, "If-Match": version})
    assert answer.status == 400 and told in json.loads(text)["trouble"]
    assert (file.read_bytes() if file.exists() else None) == before


def test_events_of_a_request_are_events():
    one = {"side": "left", "kind": "off", "time_s": 1.5}
    assert events_of({"events": [one]}) == (FootEvent("left", EventKind.OFF, 1.5),)
    assert events_of({"events": None}) is None and events_of({"events": []}) == ()
    with pytest.raises(InvalidInput, match="more than"):
        events_of({"events": [one] * (MOST_EVENTS + 1)})
    with pytest.raises(FileFormatError):
        events_of({"events": [{**one, "kind": "hop"}]})
