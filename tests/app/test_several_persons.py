"""A session of several persons: refused for a run, and copied into a session of each where it is asked for."""

import shutil

import pytest

from mbkf.app.failures import Refused
from mbkf.app.run_states import FAILED
from mbkf.app.several_persons import SeveralPersons, separate
from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.io.session import SessionNotes, TrialKind, TrialNotes, read_session, write_session
from tests.app.asking import plain
from tests.studies import study
from tests.waiting import PATIENCE_S


def mix(folder):
    """Captures of two persons in a session's folder of one, by the names of the files."""
    for code in ("S01", "S02"):
        for name in ("static", "walk1"):
            shutil.copy(folder / f"{name}.c3d", folder / f"{code}_{name}.c3d")
    for file in [path for path in folder.iterdir() if not path.name.startswith("S0")]:
        file.unlink()


@pytest.fixture
def workspace(tmp_path):
    study(tmp_path / "lab", persons=1, trials=1)
    mix(tmp_path / "lab" / "P1")
    return Workspace(tmp_path / "lab")


def files_of(workspace, session="P1"):
    with pytest.raises(SeveralPersons) as refused:
        workspace.plan(session)
    return refused.value.files


def test_each_person_gets_a_session_with_the_statements_about_the_captures(workspace):
    folder, turn = workspace.root / "P1", TrialNotes(kind=TrialKind.TURN)
    (folder / "set.toml").write_text("name = 'mine'\n")
    trials = {"S01_walk1": turn, "S02_walk1": TrialNotes(kind=TrialKind.WALK)}
    stated = SessionNotes(mass_kg=70.0, name="X", protocol="set.toml", trials=trials)
    write_session(stated, folder / "session.toml")
    before, found = {path.name: path.read_bytes() for path in folder.iterdir()}, files_of(workspace)
    assert found == {f"P1-{code}": [f"{code}_static.c3d", f"{code}_walk1.c3d"] for code in ("S01", "S02")}
    separate(workspace.root, folder, found)
    assert workspace.sessions() == ("P1", "P1-S01", "P1-S02")
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    for name in (*found["P1-S01"], "set.toml"):
        assert (workspace.root / "P1-S01" / name).read_bytes() == before[name]
    own = read_session(workspace.root / "P1-S01" / "session.toml")
    assert own == SessionNotes(protocol="set.toml", trials={"S01_walk1": turn})
    (trial,) = workspace.plan("P1-S01").trials
    assert (trial.name, trial.person.name, trial.person.mass_kg) == ("S01_walk1", "P1-S01", None)
    separate(workspace.root, folder, found)  # once more: the same files
    (workspace.root / "P1-S01" / "S01_walk1.c3d").write_bytes(b"another")
    with pytest.raises(Refused, match="another content"):
        separate(workspace.root, folder, found)


@pytest.mark.parametrize("name", ["gone.c3d", "../outside.c3d", "/outside.c3d"])
def test_files_outside_the_folder_are_not_copied(workspace, name):
    """The list of files is read from the results' folder, and may be old or changed."""
    (workspace.root / "outside.c3d").write_bytes(b"mine")
    if name.startswith("/"):
        name = str(workspace.root / name[1:])
    with pytest.raises(InvalidInput, match="run the session again"):
        separate(workspace.root, workspace.root / "P1", {"Q": ["S01_walk1.c3d", name]})
    assert not (workspace.root / "Q").exists()


def test_the_page_separates_the_session_of_a_run_that_was_refused(server, cookie):
    mix(server.workspace.root / "P1")
    status, answer = plain(server, cookie, "/separate?session=P1", "POST")
    assert status == 400 and "run the session first" in answer["trouble"]
    plain(server, cookie, "/run?session=P1&do=start", "POST")
    assert server.runs.wait(lambda: server.runs.state("P1").state == FAILED, PATIENCE_S)
    places = ["P1-S01", "P1-S02"]
    assert plain(server, cookie, "/session?session=P1")[1]["run"]["persons"] == places
    assert plain(server, cookie, "/separate?session=P1", "POST") == (200, {"sessions": places})
    known = plain(server, cookie, "/sessions")[1]["sessions"]
    assert {one["id"] for one in known} >= set(places)
