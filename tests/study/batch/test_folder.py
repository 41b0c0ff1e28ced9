"""Folders understood: persons, sessions, standing trials, ground reactions, stated masses."""

import os
import shutil
from pathlib import Path

import pytest

from mbkf.errors import InvalidInput
from mbkf.io.c3d_person import StatedPerson
from mbkf.io.session import EventKind, FootEvent
from mbkf.study.batch.folder import (
    forces_beside,
    is_static,
    person_of_folder,
    plan_of_folder,
    session_folders,
)


def made(folder, *names, **texts):
    for name in names:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"")
    for name, text in texts.items():
        (folder / name.replace("__", "/").replace("_toml", ".toml")).write_text(text, encoding="utf-8")
    return folder


def told(plan):
    return [(t.person.name, t.person.session, t.path.name) for t in plan.trials]


def test_the_first_folder_is_the_person_and_further_ones_the_session(tmp_path):
    made(
        tmp_path,
        "P1/walk1.c3d",
        "P1/static.c3d",
        "P2/monday/am/run.trc",
        "P2/tuesday/run.trc",
        "P2/.old/x.c3d",
    )
    assert told(plan_of_folder(tmp_path)) == [
        ("P1", "", "walk1.c3d"), ("P2", "monday-am", "run.trc"), ("P2", "tuesday", "run.trc"),
    ]  # fmt: skip


def test_captures_in_the_folder_itself_are_one_person_s(tmp_path):
    plan = plan_of_folder(made(tmp_path / "Anna", "walk.c3d", "Static01.c3d"))
    assert told(plan) == [("Anna", "", "walk.c3d")]
    assert [path.name for path in plan.persons[0].statics] == ["Static01.c3d"]


@pytest.mark.parametrize(
    "name",
    ["static.c3d", "Static_1.trc", "P01_cal_01.c3d", "T-Pose.c3d", "n_pose.trc", "HC032A_Static_HC032A01.c3d",
     "calibration2.c3d", "standing.c3d", "statisch.c3d"],
)  # fmt: skip
def test_standing_trials_are_known_by_their_names(name):
    assert is_static(Path(name))


@pytest.mark.parametrize(
    "name", ["walk.c3d", "ecstatic_dance.c3d", "calf_raise.c3d", "understand.trc", "run1.c3d"]
)
def test_other_names_are_not_standing_trials(name):
    assert not is_static(Path(name))


@pytest.mark.parametrize(
    "capture, forces",
    [("walk1.trc", "walk1_grf.mot"), ("run.trc", "run_grf.mot"), ("lower_walk1.trc", "lower_walk1.forces"),
     ("motion_capture_walk.trc", "grf_walk.mot"), ("subject01_walk2_markers.trc", "subject01_walk2_grf.mot"),
     ("walk1.trc", "walk1_forces.csv")],
)  # fmt: skip
def test_ground_reactions_lie_beside_their_trial(tmp_path, capture, forces):
    made(tmp_path, capture, forces, "other_grf.mot", "walk.mot", "id_walk.sto", "walk1_angles.csv")
    found = forces_beside(tmp_path / capture, sorted(tmp_path.iterdir()))
    assert found is not None and found.name == forces


def test_motion_files_without_forces_are_not_ground_reactions(tmp_path):
    made(tmp_path, "walk.trc", "walk.mot", "walk_ik.sto", "walk.csv")
    assert forces_beside(tmp_path / "walk.trc", sorted(tmp_path.iterdir())) is None


def test_persons_in_one_folder_are_scaled_each_from_their_own(tmp_path):
    made(tmp_path, "P1_static.c3d", "P1_walk.c3d", "P2_static.c3d", "P2_walk.c3d", "subject.toml")
    plan = plan_of_folder(tmp_path)
    assert told(plan) == [("P1", "", "P1_walk.c3d"), ("P2", "", "P2_walk.c3d")]
    for person in plan.persons:
        assert [path.name for path in person.statics] == [f"{person.name}_static.c3d"]
        assert [files.path.name for files in person.moving] == [f"{person.name}_walk.c3d"]
        assert person.subject is None and not person.remarks
    assert len(plan.notes) == 1 and "2 persons: P1 (2 captures), P2 (2 captures)" in plan.notes[0]
    with pytest.raises(InvalidInput, match=r"2 persons: P1 .*put the captures of each person into a folder"):
        person_of_folder(tmp_path)


def test_persons_in_a_session_s_folder_keep_its_name_before_theirs(tmp_path):
    plan = plan_of_folder(
        made(tmp_path, "lab/monday/P1_static.c3d", "lab/monday/P1_walk.c3d", "lab/monday/P2_walk.c3d")
    )
    assert told(plan) == [("lab-P1", "monday", "P1_walk.c3d"), ("lab-P2", "monday", "P2_walk.c3d")]
    one, other = plan.persons
    assert not one.remarks and "has no standing trial" in other.remarks[0]


def test_a_stated_mass_is_only_that_of_the_person_whose_captures_state_it(tmp_path, monkeypatch):
    stated = {"adult": StatedPerson((), 60.3, 1.58), "child": StatedPerson((), 39.4, 1.45)}
    monkeypatch.setattr(
        "mbkf.study.batch.folder.person_of_c3d", lambda path: stated.get(path.stem[:5], StatedPerson())
    )
    made(tmp_path, "adult1.c3d", "child1.c3d", "hop.c3d", session_toml="mass_kg = 61\nheight_m = 1.6\n")
    plan = plan_of_folder(tmp_path)
    persons = [person for person in plan.persons if not person.hosts]
    found = {person.name: (person.mass_kg, person.height_m) for person in persons}
    assert found == {"60.3kg_1.58m": (61.0, 1.6), "39.4kg_1.45m": (None, None)}
    assert "states 61.0 kg, the captures 39.4 kg; the captures' mass is used" in persons[1].remarks[-1]
    (open_,) = [person for person in plan.persons if person.hosts]
    assert [files.path.name for files in open_.unsorted] == ["hop.c3d"] and open_.mass_kg is None
    assert open_.hosts == tuple(persons)


def test_a_stated_mass_far_from_that_of_the_captures_is_a_doubt_about_the_person(tmp_path, monkeypatch):
    monkeypatch.setattr("mbkf.study.batch.folder.person_of_c3d", lambda path: StatedPerson((), 39.4))
    (person,) = plan_of_folder(made(tmp_path, "walk.c3d", session_toml="mass_kg = 60")).persons
    assert person.mass_kg == 60.0 and "the stated mass is used" in person.remarks[0]


def test_of_two_captures_of_one_name_the_c3d_is_taken(tmp_path):
    assert told(plan_of_folder(made(tmp_path, "P1/walk.trc", "P1/walk.c3d"))) == [("P1", "", "walk.c3d")]


def test_session_files_state_what_holds_below_them_the_nearest_first(tmp_path):
    made(tmp_path, "P1/monday/walk.c3d", "P1/tuesday/walk.c3d")
    (tmp_path / "P1" / "session.toml").write_text("mass_kg = 70\nheight_m = 1.8\n", encoding="utf-8")
    (tmp_path / "P1" / "tuesday" / "session.toml").write_text("mass_kg = 71.5\n", encoding="utf-8")
    monday, tuesday = plan_of_folder(tmp_path).persons
    assert (monday.mass_kg, monday.height_m, monday.protocol) == (70.0, 1.8, None)
    assert (tuesday.mass_kg, tuesday.height_m) == (71.5, 1.8)


def test_trials_are_left_out_and_told_apart_by_the_session_file(tmp_path):
    made(tmp_path, "P1/static.c3d", "P1/walk1.c3d", "P1/walk2.c3d", "P1/deep/walk1.c3d")
    (tmp_path / "P1" / "session.toml").write_text(
        'mass_kg = 70\n[trial.static]\nkind = "walk"\n[trial.walk1]\nkind = "static"\n'
        '[trial.walk2]\nexcluded = "stumbled"\n',
        encoding="utf-8",
    )
    plan = plan_of_folder(tmp_path)
    assert told(plan) == [("P1", "", "static.c3d"), ("P1", "deep", "walk1.c3d")]
    person, deep = plan.persons
    assert [path.name for path in person.statics] == ["walk1.c3d"]
    assert (deep.mass_kg, deep.statics) == (70.0, ())


def test_events_by_hand_belong_to_their_trial(tmp_path):
    made(tmp_path, "P1/static.c3d", "P1/walk1.c3d", "P1/walk2.c3d", "P1/walk3.c3d")
    (tmp_path / "P1" / "session.toml").write_text(
        '[[trial.walk1.event]]\nside = "left"\nkind = "off"\ntime_s = 1.5\n[trial.walk2]\nevent = []\n',
        encoding="utf-8",
    )
    found = {trial.name: trial.events for trial in plan_of_folder(tmp_path).trials}
    assert found == {"walk1": (FootEvent("left", EventKind.OFF, 1.5),), "walk2": (), "walk3": None}


@pytest.mark.parametrize(
    "text",
    [
        "mass_kg = 'much'",
        "mass_kg = 0",
        "mass_kg = nan",
        "height_m = 180",
        "protocol = ''",
        "mass_kg = true",
        "= 3",
    ],
)
def test_a_damaged_session_file_costs_its_own_session(tmp_path, text):
    made(tmp_path, "P1/walk.c3d", "P1/static.c3d", "P2/walk.c3d")
    (tmp_path / "P1" / "session.toml").write_text(text, encoding="utf-8")
    lost, kept = plan_of_folder(tmp_path).trials
    assert (lost.path.name, lost.person.name) == ("walk.c3d", "P1") and "session.toml" in lost.fault
    assert kept.person.name == "P2" and not kept.fault


def test_a_damaged_session_file_above_costs_the_sessions_below_it(tmp_path):
    made(tmp_path, "P1/monday/walk.c3d", "P1/friday/walk.c3d", "P2/static.c3d", "P2/walk.c3d")
    (tmp_path / "P1" / "session.toml").write_text("mass = 71", encoding="utf-8")
    faults = {(one.person.name, one.person.session): one.fault for one in plan_of_folder(tmp_path).trials}
    assert not faults["P2", ""]
    assert (
        "unknown session entry 'mass'; did you mean mass_kg"
        in faults["P1", "monday"]
        == faults["P1", "friday"]
    )


@pytest.mark.parametrize("name", ["w1.c3d", "W1", "w_1", "w 1.C3D"])
def test_a_trial_in_a_session_file_is_a_capture_by_its_exact_name(tmp_path, name):
    made(tmp_path, "P1/w1.c3d", "P1/w2.c3d")
    file = tmp_path / "P1" / "session.toml"
    file.write_text(f'mass_kg = 70\n[trial."{name}"]\nexcluded = "fell"\n', encoding="utf-8")
    reason = f"{file}, line 2: unknown trial '{name}'; did you mean w1"
    assert [one.fault for one in plan_of_folder(tmp_path).trials] == [reason, reason]


def test_a_statement_about_a_capture_that_is_gone_is_a_remark(tmp_path):
    made(tmp_path, "P1/w1.c3d", "P1/w2.c3d")
    (tmp_path / "P1" / "session.toml").write_text('[trial.w3]\nexcluded = "fell"\n', encoding="utf-8")
    plan = plan_of_folder(tmp_path)
    assert [one.fault for one in plan.trials] == ["", ""]
    (note,) = plan.notes
    assert "this folder has no capture of its trial 'w3'; did you mean w2, w1" in note


def test_a_person_scaled_before_is_taken(tmp_path):
    made(tmp_path, "P1/walk.c3d", "P1/subject.toml", "P2/walk.c3d")
    first, second = plan_of_folder(tmp_path).persons
    assert first.subject == tmp_path / "P1" / "subject.toml" and second.subject is None


def test_a_folder_without_trials_is_refused(tmp_path):
    made(tmp_path, "P1/static.c3d", "notes.txt")
    with pytest.raises(InvalidInput, match="no trial"):
        plan_of_folder(tmp_path)


def test_files_whose_names_no_folder_can_have_get_one_that_it_can(tmp_path):
    made(tmp_path, "P<1>/mon:day/walk?.c3d")
    (trial,) = plan_of_folder(tmp_path).trials
    assert trial.path.name == "walk?.c3d" and trial.place.as_posix() == "P_1_/mon_day/walk_"


def test_hidden_folders_and_those_that_vanish_meanwhile_are_left_out(tmp_path, monkeypatch):
    """As those of results that are being written do while a page looks at the folder."""
    for place in ("P1", "P2", ".hidden", "P1/.partial"):
        (tmp_path / place).mkdir()
        (tmp_path / place / "walk.c3d").touch()
    (tmp_path / "P1" / ".walk.c3d").touch()
    assert session_folders(tmp_path) == [tmp_path / "P1", tmp_path / "P2"]
    walked = os.walk

    def vanishing(root):
        for step in walked(root):
            shutil.rmtree(tmp_path / "P2", ignore_errors=True)
            yield step

    monkeypatch.setattr(os, "walk", vanishing)
    assert session_folders(tmp_path) == [tmp_path / "P1"]


def test_a_session_may_be_scaled_from_standing_alone(tmp_path):
    made(tmp_path, "P1/static.c3d", "P1/walk1.c3d", "P2/walk1.c3d", "P2/static.c3d")
    made(tmp_path, session_toml="scaling = 'static'\n", P2__session_toml="scaling = 'session'\n")
    assert [one.static_only for one in plan_of_folder(tmp_path).persons] == [True, False]


def test_the_person_of_one_session_is_found_without_moving_trials_and_not_taken_from_before(tmp_path):
    made(tmp_path, "P1/Static.c3d", "P1/subject.toml", P1__session_toml="height_m = 1.7\n")
    person = person_of_folder(tmp_path / "P1")
    assert (person.name, person.height_m, person.subject, person.moving) == ("P1", 1.7, None, ())
    assert [path.name for path in person.statics] == ["Static.c3d"]
    with pytest.raises(InvalidInput, match="its sessions are P1; name one of them"):
        person_of_folder(tmp_path)
    (tmp_path / "empty").mkdir()
    with pytest.raises(InvalidInput, match="name a session's folder"):
        person_of_folder(tmp_path / "empty")


def test_conditions_are_those_of_the_trial_else_of_the_visit(tmp_path):
    made(tmp_path, "P1/w1.c3d", "P1/w2.c3d")
    text = '[visit]\ncondition = "barefoot"\n[trial.w2]\ncondition = "orthosis"\n'
    (tmp_path / "P1" / "session.toml").write_text(text, encoding="utf-8")
    assert [one.condition for one in plan_of_folder(tmp_path).trials] == ["barefoot", "orthosis"]


@pytest.mark.parametrize(("born", "faulty"), [("2025-04-01", True), ("2025-03-31", False)])
def test_a_birth_after_the_visit_is_refused_though_two_files_state_them(tmp_path, born, faulty):
    made(tmp_path, "P1/monday/walk.c3d")
    (tmp_path / "P1" / "session.toml").write_text(f"[visit]\nbirth_date = {born}\n", encoding="utf-8")
    file = tmp_path / "P1" / "monday" / "session.toml"
    file.write_text("[visit]\ndate = 2025-03-31\n", encoding="utf-8")
    (trial,) = plan_of_folder(tmp_path).trials
    assert trial.fault == (f"{file}: birth_date {born} lies after date 2025-03-31" if faulty else "")
