"""Named trajectories from shuffled points: synthetic captures, losses, ghosts, exchanged tracks."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, NotObservable
from mbkf.io.records import MarkerTrajectories
from mbkf.labelling.assignment import HIDDEN
from mbkf.pipelines.label import label, labelled_capture, summarise
from mbkf.pipelines.label_score import score
from mbkf.pipelines.labelling_pass import LOST_S
from mbkf.pipelines.reconstruct import ReconstructSettings, reconstruct
from mbkf.synthesis.cameras import without_labels
from tests.walker import walker


@pytest.fixture(scope="module")
def walk():
    """A second of walking: capture with labels, unlabelled with ghosts, and the scaled subject."""
    made = walker()
    return made.trial, made.raw, made.subject


def unlabelled(trial, positions, seed=0, shuffle=True):
    if shuffle:
        positions = without_labels(positions, np.random.default_rng(seed))
    names = tuple(f"*{k}" for k in range(positions.shape[1]))
    return replace(trial, markers=replace(trial.markers, names=names, positions_m=positions))


def test_shuffled_points_with_ghosts(walk):
    trial, raw, subject = walk
    found = label(raw, subject)
    result = score(found.markers, trial.markers, subject)
    assert result.correct_fraction >= 0.998
    assert result.wrong_fraction <= 0.001
    for labels in found.label_of_point:
        used = labels[labels != HIDDEN]
        assert len(used) == len(set(used.tolist()))
    points = (~np.isnan(raw.markers.positions_m).any(axis=2)).sum(axis=1)
    assert np.array_equal(found.ghosts + found.markers.present.sum(axis=1), points)
    numbers = summarise(found, result)
    assert numbers["correct_fraction"] == result.correct_fraction
    assert numbers["ghosts_dropped"] == found.ghosts.sum() > 0
    assert numbers["first_labelled_frame"] == 0


def test_labelled_capture_can_be_reconstructed(walk):
    _, raw, subject = walk
    named = labelled_capture(raw, label(raw, subject))
    assert named.plates == raw.plates
    result = reconstruct(named, subject, settings=ReconstructSettings(filter="kinematic"))
    distance = np.linalg.norm(result.predicted_m - result.measured_m, axis=2)
    assert np.sqrt(np.nanmean(distance**2)) < 0.015


def test_labels_come_back_after_a_total_loss(walk):
    trial, _, subject = walk
    positions = trial.markers.positions_m.copy()
    gone = slice(30, 30 + round(2 * LOST_S * trial.markers.rate_hz))
    positions[gone] = np.nan
    shown = replace(trial.markers, positions_m=positions)
    found = label(unlabelled(trial, positions), subject)
    result = score(found.markers, shown, subject)
    assert not found.markers.present[gone].any()
    assert result.correct_fraction >= 0.998
    assert not result.wrong.any()


def test_exchanged_tracks_are_repaired(walk):
    trial, _, subject = walk
    names = trial.markers.names
    pair = [names.index("RKNE"), names.index("LKNE")]
    positions = trial.markers.positions_m.copy()
    positions[60:, pair] = positions[60:, pair[::-1]]
    found = label(unlabelled(trial, positions, shuffle=False), subject)
    result = score(found.markers, trial.markers, subject)
    assert not result.wrong[80:].any()


def test_a_capture_of_something_else_is_refused(walk):
    trial, _, subject = walk
    noise = np.random.default_rng(0).uniform(-1.0, 1.0, (25, 40, 3))
    with pytest.raises(NotObservable, match="in no frame"):
        label(unlabelled(trial, noise), subject)


def test_the_truth_must_be_of_the_same_trial(walk):
    trial, _, subject = walk
    with pytest.raises(InvalidInput, match="frames"):
        score(replace(trial.markers, positions_m=trial.markers.positions_m[:5]), trial.markers, subject)
    other = MarkerTrajectories(("nothing",), np.zeros((trial.markers.frames, 1, 3)), 100.0)
    with pytest.raises(InvalidInput, match="none of the subject's"):
        score(trial.markers, other, subject)


def test_scores_tell_right_wrong_and_missed(walk):
    trial, _, subject = walk
    positions = trial.markers.positions_m.copy()
    present = trial.markers.present
    t = int(np.flatnonzero(present[:, :3].all(axis=1))[0])
    positions[t, [0, 1]] = positions[t, [1, 0]]
    positions[t, 2] = np.nan
    result = score(replace(trial.markers, positions_m=positions), trial.markers, subject)
    assert result.wrong.sum() == 2
    assert result.missed.sum() == 1
    assert result.right.sum() == present.sum() - 3
