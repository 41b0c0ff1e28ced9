"""A trial's folder appears whole or not at all, and only once from the same."""

import errno
import os
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mbkf.io.capture import read_capture
from mbkf.io.results_folder import read_reconstruction
from mbkf.io.subject import read_subject, write_subject
from mbkf.study.batch import trial as module
from mbkf.study.batch.curves import read_curves
from mbkf.study.batch.inputs import RECORD
from mbkf.study.batch.plan import Person, Trial
from mbkf.study.batch.trial import CURVES_FILE, curves_anew, trial_done, trial_doubts
from mbkf.trial.gait.events import foot_events, plain_found
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from tests.captures import snapshot
from tests.studies import walk_folder

SETTINGS = ReconstructSettings(filter="kinematic", smooth=False)


@cache
def walk():
    """The walk, followed once."""
    folder = walk_folder()
    return reconstruct(
        read_capture(folder / "trial.c3d"), read_subject(folder / "subject.toml"), settings=SETTINGS
    )


@pytest.fixture
def followed(monkeypatch):
    """Every run has the results of the walk that was followed once: the test asks what becomes of the files."""
    monkeypatch.setattr(module, "reconstruct", lambda capture, person, **how: walk())


@pytest.fixture
def task(tmp_path):
    trial = Trial(Person("P"), walk_folder() / "trial.c3d", name="walk")
    return trial, walk_folder() / "subject.toml", tmp_path


def test_a_trial_is_done_once_from_the_same(task, tmp_path):
    assert trial_done(*task, SETTINGS)
    folder = tmp_path / "P" / "walk"
    assert {RECORD, CURVES_FILE, "summary.json", "motion.h5"} <= {path.name for path in folder.iterdir()}
    assert read_reconstruction(folder).filter == "kinematic"
    before = snapshot(tmp_path)
    assert not trial_done(*task, SETTINGS) and snapshot(tmp_path) == before
    assert trial_done(*task, ReconstructSettings(filter="dynamic", smooth=False))
    assert read_reconstruction(folder).filter == "dynamic"
    assert [path.name for path in (tmp_path / "P").iterdir()] == ["walk"]


@pytest.mark.usefixtures("followed")
def test_doubts_about_the_person_stay_with_a_trial_that_is_done(task, tmp_path, monkeypatch):
    assert trial_done(*task, SETTINGS) and trial_doubts(task[0], tmp_path) == ""
    (tmp_path / "P" / "walk" / RECORD).unlink()
    monkeypatch.setattr(module, "checked_owner", lambda *_: "markers were put on anew")
    for anew in (True, False):
        assert trial_done(*task, SETTINGS) is anew
        assert trial_doubts(task[0], tmp_path) == "markers were put on anew"


def test_a_person_that_was_scaled_anew_in_the_same_file_is_read_again(task, monkeypatch):
    trial, file, out = task
    subject, seen = read_subject(file), []
    monkeypatch.setattr(
        module, "reconstruct", lambda capture, person, **how: seen.append(person.mass_kg) or walk()
    )
    for mass_kg in (70.0, 80.0):
        write_subject(replace(subject, mass_kg=mass_kg), out / "subject.toml")
        assert trial_done(trial, out / "subject.toml", out, SETTINGS)
    assert seen == [70.0, 80.0]


@pytest.mark.usefixtures("followed")
@pytest.mark.parametrize("fails", ["write_result_files", "write_curves", "write_record"])
@pytest.mark.parametrize("earlier", [False, True])
def test_a_full_disk_leaves_nothing_half_written(task, tmp_path, monkeypatch, fails, earlier):
    """Nor touches what an earlier run left."""
    if earlier:
        trial_done(*task, SETTINGS)
    before = snapshot(tmp_path / "P") if earlier else {}
    original = getattr(module, fails)

    def full(*args):
        if fails != "write_record":
            original(*args)
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(module, fails, full)
    with pytest.raises(OSError, match="No space left"):
        trial_done(*task, ReconstructSettings(filter="kinematic", smooth=False, correct_markers=False))
    assert snapshot(tmp_path / "P") == before


def assert_same(table, other):
    """Tables with the same numbers, NaN in the same places."""
    for name in other.column_names:
        np.testing.assert_array_equal(table[name].to_numpy(), other[name].to_numpy())


@pytest.mark.usefixtures("followed")
def test_events_by_hand_are_noticed_and_only_the_curves_are_made_again(task, tmp_path):
    trial, subject, out = task
    folder = tmp_path / "P" / "walk"
    assert trial_done(*task, SETTINGS)
    before, found = snapshot(folder), read_curves(folder / CURVES_FILE)
    told = plain_found(foot_events(read_reconstruction(folder)))
    moved = tuple(replace(event, time_s=event.time_s + 0.02) for event in told)
    stated = replace(trial, events=moved)
    assert trial_done(stated, subject, out, SETTINGS) and not trial_done(stated, subject, out, SETTINGS)
    after = snapshot(folder)
    assert {name for name in after if after[name] != before[name]} == {CURVES_FILE, RECORD}
    cut = read_curves(folder / CURVES_FILE)
    assert trial_done(stated, subject, tmp_path / "new", SETTINGS)
    anew = read_curves(tmp_path / "new" / "P" / "walk" / CURVES_FILE)
    assert_same(anew, cut)  # a run from the start does so too
    assert trial_done(replace(trial, events=()), subject, out, SETTINGS)
    assert read_curves(folder / CURVES_FILE).num_rows == 0
    assert curves_anew(trial, out)
    assert_same(read_curves(folder / CURVES_FILE), found)
    assert not trial_done(*task, SETTINGS)
