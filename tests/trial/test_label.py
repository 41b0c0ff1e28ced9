"""Named trajectories from shuffled points: synthetic captures, ghosts, exchanged tracks."""

import numpy as np
import pytest

from mbkf.errors import NotObservable
from mbkf.labelling.assignment import HIDDEN
from mbkf.trial.label import label
from mbkf.trial.labelling.result import label_summary, labelled_capture
from mbkf.trial.labelling.score import score
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from tests.walker import unlabelled, walker

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def walk():
    """A second of walking: capture with labels, unlabelled with ghosts, and the scaled subject."""
    made = walker()
    return made.trial, made.raw, made.subject


@pytest.fixture(scope="module")
def labelled(walk):
    _, raw, subject = walk
    return label(raw, subject)


def test_shuffled_points_with_ghosts(walk, labelled):
    (trial, raw, subject), found = walk, labelled
    result = score(found.markers, trial.markers, subject)
    assert result.correct_fraction >= 0.998
    assert result.wrong_fraction <= 0.001
    for labels in found.label_of_point:
        used = labels[labels != HIDDEN]
        assert len(used) == len(set(used.tolist()))
    points = (~np.isnan(raw.markers.positions_m).any(axis=2)).sum(axis=1)
    assert np.array_equal(found.ghosts + found.markers.present.sum(axis=1), points)
    numbers = label_summary(found, result)
    assert numbers["correct_fraction"] == result.correct_fraction
    assert numbers["ghosts_dropped"] == found.ghosts.sum() > 0
    assert numbers["first_labelled_frame"] == 0


def test_labelled_capture_can_be_reconstructed(walk, labelled):
    _, raw, subject = walk
    named = labelled_capture(raw, labelled)
    assert named.plates == raw.plates
    result = reconstruct(named, subject, settings=ReconstructSettings(filter="kinematic", smooth=False))
    distance = np.linalg.norm(result.predicted_m - result.measured_m, axis=2)
    assert np.sqrt(np.nanmean(distance**2)) < 0.015


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
