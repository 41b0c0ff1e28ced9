"""A person of a batch: scaled once from the same, weighed where no mass is stated, taken where a file is given."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from mbkf.errors import FileFormatError, InvalidInput, NotObservable, ProtectedFile
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.io.subject import read_subject
from mbkf.study.batch.person import RECORD, SUBJECT_FILE, captures_used, scaled, subject_of
from mbkf.study.batch.plan import Files, Person
from mbkf.study.scaling.report import LEFT_OUT_KEY, SCALED_FROM_KEY
from tests.studies import walk_folder


@pytest.fixture
def person():
    static, trial = (walk_folder() / name for name in ("static.c3d", "trial.c3d"))
    return Person("P", "", (static,), (Files(trial),), mass_kg=70.0, static_only=True)


def test_a_person_is_scaled_once_from_the_same(person, tmp_path):
    file = subject_of(person, tmp_path)
    assert file == tmp_path / "P" / SUBJECT_FILE and read_subject(file).mass_kg == 70.0
    before = file.stat().st_mtime_ns
    assert subject_of(person, tmp_path) == file and file.stat().st_mtime_ns == before
    assert read_subject(subject_of(replace(person, mass_kg=71.0), tmp_path)).mass_kg == 71.0
    (tmp_path / "P" / RECORD).unlink()
    subject_of(person, tmp_path)
    assert read_subject(file).mass_kg == 70.0


@pytest.mark.parametrize("name", [SUBJECT_FILE, RECORD])
def test_a_file_of_others_in_the_place_of_the_persons_stays_and_costs_no_work(
    name, person, tmp_path, monkeypatch
):
    (tmp_path / "P").mkdir()
    (tmp_path / "P" / name).write_text("a photo")
    monkeypatch.setattr("mbkf.study.batch.person.scaled", None)
    with pytest.raises(ProtectedFile, match="not written by mbkf"):
        subject_of(person, tmp_path)
    assert [(path.name, path.read_text()) for path in (tmp_path / "P").iterdir()] == [(name, "a photo")]


def test_a_mass_that_nothing_states_is_weighed(person):
    found = scaled(replace(person, mass_kg=None))
    stated = read_capture(person.statics[0]).subject_mass_kg
    truth = read_subject(walk_folder() / "subject.toml").mass_kg
    assert found.mass_kg == pytest.approx(truth, rel=0.02)
    assert stated is None or found.mass_kg == stated


def test_the_plates_beside_moving_trials_weigh_a_person_whose_standing_trial_has_none(person, tmp_path):
    bare = replace(read_capture(person.statics[0]), plates=(), subject_mass_kg=None)
    write_c3d(bare, tmp_path / "static.c3d")
    found = scaled(replace(person, mass_kg=None, statics=(tmp_path / "static.c3d",)))
    truth = read_subject(walk_folder() / "subject.toml").mass_kg
    assert found.mass_kg == pytest.approx(truth, rel=0.02) and "mass" in found.report
    with pytest.raises(InvalidInput, match="state mass_kg"):
        scaled(replace(person, mass_kg=None, statics=(tmp_path / "static.c3d",), moving=()))


def test_without_a_standing_trial_moving_ones_are_taken_those_that_can_be_read(person, tmp_path):
    (tmp_path / "damaged.c3d").write_bytes(b"no capture")
    moving = (Files(tmp_path / "damaged.c3d"), *person.moving)
    assert scaled(replace(person, statics=(), moving=moving)).report["frames"] > 0
    with pytest.raises(FileFormatError, match="damaged"):
        scaled(replace(person, statics=(), moving=moving[:1]))


def test_where_no_name_tells_the_trial_that_stands_still_is_the_standing_one(person):
    named, looked = scaled(person), (*person.moving, Files(person.statics[0]))
    found = scaled(replace(person, statics=(), moving=looked))
    assert found.scale_factors == named.scale_factors and found.report["frames"] == named.report["frames"]
    assert scaled(replace(person, statics=())).scale_factors != named.scale_factors


def test_a_still_capture_that_shows_nobody_standing_is_a_moving_one(person, monkeypatch):
    def bent(*_):
        raise NotObservable("the pelvis is tilted by 74° from upright")

    monkeypatch.setattr("mbkf.study.batch.person.scale_from_session", bent)
    with pytest.raises(NotObservable, match="tilted"):
        scaled(person)
    looked = (*person.moving, Files(person.statics[0]))
    found = scaled(replace(person, statics=(), moving=looked))
    assert [one["trial"] for one in found.report[SCALED_FROM_KEY]] == ["trial"]


def test_trials_that_help_are_taken_and_each_further_trial_leaves_the_file_as_it_is(person, tmp_path):
    """The walk is chosen, also with its copy beside it, whose reason stands in the record alone."""
    (tmp_path / "film.c3d").write_bytes(b"no capture")
    person = replace(person, static_only=False)
    file = subject_of(person, tmp_path)
    before = file.read_bytes()
    assert [one["trial"] for one in read_subject(file).report[SCALED_FROM_KEY]] == ["static", "trial"]
    assert (
        subject_of(replace(person, moving=(Files(tmp_path / "film.c3d"), *person.moving)), tmp_path) == file
    )
    record = json.loads((tmp_path / "P" / RECORD).read_text())
    assert file.read_bytes() == before and list(record[LEFT_OUT_KEY]) == ["film"]
    assert record[SCALED_FROM_KEY] == read_subject(file).report[SCALED_FROM_KEY]
    captures = captures_used(person, read_subject(file))
    assert [Path(one.path).name for one in captures] == ["static.c3d", "trial.c3d"]


def test_a_file_of_the_person_is_taken_as_it_is(person, tmp_path):
    given = walk_folder() / "subject.toml"
    assert subject_of(replace(person, subject=given), tmp_path) == given
    assert list(tmp_path.iterdir()) == []


def test_a_person_of_no_trial_is_refused(tmp_path):
    with pytest.raises(FileFormatError, match="no trial to scale from"):
        subject_of(Person("P"), tmp_path)
