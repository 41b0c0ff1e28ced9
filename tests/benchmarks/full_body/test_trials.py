"""The study's persons and trials: what is taken away, and where."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.full_body.persons import OF_GENERAL, OF_JUMP, OF_SQUAT, PERSONS, subject_of
from benchmarks.full_body.trials import (
    KNEE_MARKERS,
    LOST_FRAMES,
    deepest_stretch,
    knee_bend,
    without_a_step,
    without_markers,
)


def test_persons_are_the_thesis_s():
    masses = [person.mass_kg for person in PERSONS]
    assert sorted(person.sex for person in PERSONS) == ["M"] * 4 + ["W"] * 4
    assert (min(masses), max(masses)) == (49.75, 85.0)
    assert [PERSONS[k].mass_kg for k in (OF_SQUAT, OF_GENERAL, OF_JUMP)] == [49.75, 78.0, 85.0]
    assert all(20 <= person.age_years <= 32 for person in PERSONS)
    bodies = [subject_of(k) for k in range(len(PERSONS))]
    assert [body.mass_kg for body in bodies] == masses
    assert [body.height_m for body in bodies] == pytest.approx([person.height_m for person in PERSONS])


def test_the_lost_stretch_lies_about_the_deepest_bend(short_squat):
    trial, _ = short_squat
    bend = knee_bend(trial.subject, trial.truth.q)
    stretch = deepest_stretch(trial.subject, trial.truth)
    assert stretch.sum() == LOST_FRAMES
    assert np.ptp(np.flatnonzero(stretch)) == LOST_FRAMES - 1
    assert stretch[np.argmax(bend)]
    assert np.array_equal(stretch, trial.stretch)


def test_the_knee_bends_as_far_as_its_rotation(short_squat):
    trial, run = short_squat
    column = run.coordinate_names.index("knee_angle_r")
    assert np.abs(knee_bend(trial.subject, run.q) - run.angles[:, column]).max() < np.deg2rad(2)


def test_only_the_knee_s_markers_are_lost_and_only_in_the_stretch(short_squat):
    trial, _ = short_squat
    before, after = trial.capture.markers, without_markers(trial.capture, trial.stretch).markers
    own = np.isin(before.names, KNEE_MARKERS)
    assert own.sum() == 3
    assert np.isnan(after.positions_m[np.ix_(trial.stretch, own)]).all()
    for rest in (np.ix_(trial.stretch, ~own), np.ix_(~trial.stretch, own)):
        np.testing.assert_array_equal(after.positions_m[rest], before.positions_m[rest])


def test_the_plate_that_goes_is_the_most_loaded_of_those_stepped_on_later():
    def plate(*vertical):
        return SimpleNamespace(force_n=np.column_stack([np.zeros((3, 2)), np.array(vertical, float)]))

    stood, briefly, long = plate(800, 800, 800), plate(0, 0, 300), plate(0, 500, 500)
    assert without_a_step((stood, briefly, long)) == (stood, briefly)
