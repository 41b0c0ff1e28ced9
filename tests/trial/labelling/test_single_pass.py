"""One pass through time: labels that are lost with all points are found again."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.trial.label import label
from mbkf.trial.labelling.score import score
from mbkf.trial.labelling.single_pass import LOST_S
from tests.walker import unlabelled, walker

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def walk():
    """A second of walking: capture with labels, unlabelled with ghosts, and the scaled subject."""
    made = walker()
    return made.trial, made.raw, made.subject


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
