"""Labels against the truth: right, wrong and missed samples are counted, and other trials refused."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.records import MarkerTrajectories
from mbkf.trial.labelling.score import score
from tests.walker import walker

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def walk():
    """A second of walking: capture with labels, unlabelled with ghosts, and the scaled subject."""
    made = walker()
    return made.trial, made.raw, made.subject


def test_the_truth_must_be_of_the_same_trial(walk):
    trial, _, subject = walk
    with pytest.raises(InvalidInput, match="frames"):
        score(replace(trial.markers, positions_m=trial.markers.positions_m[:5]), trial.markers, subject)
    other = MarkerTrajectories(("nothing",), np.zeros((trial.markers.frames, 1, 3)), 100.0)
    with pytest.raises(InvalidInput, match="no marker of the subject"):
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
