"""Recorded live runs stand among a session's trials, and a batch of the folder leaves them in peace."""

import json
from dataclasses import replace

import pytest

from mbkf.app.recordings import recording_rows
from mbkf.app.workspace import RESULTS, Workspace
from mbkf.errors import InvalidInput
from mbkf.io.results_folder import write_reconstruction
from mbkf.stream.run.report import LIVE_FILE
from mbkf.trial.results.summary import summarise
from tests.captures import snapshot
from tests.recordings import walk
from tests.studies import batch_here, study


@pytest.fixture
def workspace(tmp_path):
    return Workspace(study(tmp_path / "lab"))


def record(workspace, name, lost=0):
    folder = workspace.place("P1") / name
    r = replace(walk(), trial="a stream")
    write_reconstruction(r, summarise(r), folder)
    (folder / LIVE_FILE).write_text(json.dumps({"frames_in": r.frames, "frames_lost": lost}))
    return folder


def test_recordings_are_rows_with_what_was_lost(workspace):
    assert recording_rows(workspace, "P1") == []
    record(workspace, "live-2", lost=3)
    record(workspace, "live-1")
    first, second = recording_rows(workspace, "P1")
    assert (first["name"], second["name"]) == ("live-1", "live-2")
    assert first["live"] and first["status"] == "done" and first["problems"] == []
    assert first["seconds"] == pytest.approx(walk().frames / walk().rate_hz, abs=0.02)
    assert first["markers"] > 20
    assert second["problems"][0]["what"] == f"3 of {walk().frames + 3} frames were lost"
    assert workspace.result("P1", "live-2") == workspace.place("P1") / "live-2"


def test_a_run_that_left_no_result_is_no_recording_and_a_damaged_one_says_so(workspace):
    folder = record(workspace, "live-1")
    (folder / LIVE_FILE).write_text("{")
    assert recording_rows(workspace, "P1")[0]["status"] == "failed"
    (folder / "summary.json").unlink()
    assert recording_rows(workspace, "P1") == []
    for name in ("live-1", "../P1/live-1", ".", ""):
        with pytest.raises(InvalidInput, match="no result"):
            workspace.result("P1", name)


def test_a_batch_leaves_them_in_peace(workspace):
    folder = record(workspace, "live-1")
    before = snapshot(folder)
    table = batch_here(workspace.root, workspace.root / RESULTS, static_only=True)
    assert table["trial"].to_pylist() == ["walk1"]
    assert snapshot(folder) == before
    assert workspace.sessions() == ("P1",)
    assert [row["name"] for row in recording_rows(workspace, "P1")] == ["live-1"]


def test_the_newest_body_that_stood_still_serves_the_next_run(workspace):
    assert workspace.subject("P1") is None
    for name in ("live-1", "live-2"):
        (record(workspace, name) / "subject.toml").write_text("")
    assert workspace.subject("P1") == workspace.place("P1") / "live-2" / "subject.toml"
    own = workspace.folder("P1") / "subject.toml"
    own.write_text("")
    assert workspace.subject("P1") == own
