"""A folder's sessions are found, looked at once, and nothing can be put outside of it."""

import shutil

import pytest

from mbkf.app import workspace as module
from mbkf.app.workspace import RESULTS, Workspace
from mbkf.errors import InvalidInput
from mbkf.io.session import SessionNotes, read_session
from mbkf.study.batch.folder import plan_of_folder
from tests.studies import batch_here, study


@pytest.fixture
def workspace(tmp_path):
    study(tmp_path / "lab", persons=2, trials=2)
    return Workspace(tmp_path / "lab")


def test_folders_with_captures_are_sessions(workspace, tmp_path):
    assert workspace.sessions() == ("P1", "P2")
    assert Workspace(tmp_path / "lab" / "P1").sessions() == (".",)
    assert Workspace(tmp_path / "new" / "folder").sessions() == ()
    for name in ("P3", "", "..", "../lab/P1", "P1/.."):
        with pytest.raises(InvalidInput, match="no session"):
            workspace.folder(name)


def test_captures_are_looked_at_once_until_they_change(workspace, monkeypatch):
    looked, original = [], module.survey_trial
    monkeypatch.setattr(module, "survey_trial", lambda *files: looked.append(files) or original(*files))
    first = workspace.survey("P1")
    assert [trial.name for trial in first.trials] == ["static", "walk1", "walk2"]
    assert workspace.survey("P1") == first and len(looked) == 3
    file = workspace.root / "P1" / "walk1.c3d"
    file.write_bytes(file.read_bytes()[:5000])
    assert not workspace.survey("P1").trials[1].usable and len(looked) == 4


def test_what_is_stated_is_written_and_read_back(workspace):
    notes = SessionNotes(name="somebody", mass_kg=70.0)
    assert workspace.change("P1", SessionNotes(), notes).differences == ()
    assert workspace.survey("P1").notes == notes == read_session(workspace.root / "P1" / "session.toml")


def test_its_plan_is_that_of_a_batch_and_results_are_no_captures(workspace):
    plan = workspace.plan("P2")
    assert [trial.place.as_posix() for trial in plan.trials] == ["P2/walk1", "P2/walk2"]
    assert set(plan.trials) < set(plan_of_folder(workspace.root).trials)
    with pytest.raises(InvalidInput, match="no result of 'walk1' yet"):
        workspace.result("P2", "walk1")
    (workspace.root / "P2" / "walk2.c3d").unlink()
    shutil.rmtree(workspace.root / "P1")
    batch_here(workspace.root, workspace.root / RESULTS, static_only=True)
    assert workspace.result("P2", "walk1") == workspace.root / RESULTS / "P2" / "walk1"
    assert workspace.sessions() == ("P2",)
    with pytest.raises(InvalidInput, match="no result of 'other' yet"):
        workspace.result("P2", "other")


def test_a_session_of_standing_trials_only_has_no_plan(workspace):
    for name in ("walk1", "walk2"):
        (workspace.root / "P1" / f"{name}.c3d").unlink()
    with pytest.raises(InvalidInput, match="no moving trial"):
        workspace.plan("P1")


def test_a_session_is_of_one_person(workspace):
    """No trial is reconstructed with the body of another person, and results lie where the page looks for them."""
    folder = workspace.root / "P1"
    for code in ("S01", "S02"):
        for name in ("static", "walk1"):
            shutil.copy(folder / f"{name}.c3d", folder / f"{code}_{name}.c3d")
    for file in ("static", "walk1", "walk2"):
        (folder / f"{file}.c3d").unlink()
    with pytest.raises(
        InvalidInput, match=r"several persons .* \(P1-S01: S01_walk1; P1-S02: S02_walk1\): put"
    ):
        workspace.plan("P1")
    (folder / "S02_walk1.c3d").unlink()
    (folder / "S02_static.c3d").unlink()
    assert [trial.name for trial in workspace.plan("P1").trials] == ["S01_walk1"]
