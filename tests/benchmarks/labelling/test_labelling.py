"""What the labelling benchmark does to captures before it labels them."""

import numpy as np
import pytest

from benchmarks.labelling import renamed
from benchmarks.labelling.rows import CROSSING_M, GHOSTS, Trial, crossed, hard, shuffled, truth_of
from tests.captures import made_capture


@pytest.fixture(scope="module")
def trial():
    """A person standing, with a subject that knows the same markers by name."""
    from mbkf.trial.scale import scale

    capture = made_capture(120)
    return Trial("made", capture, scale(made_capture(20, 0.0)))


def test_shuffling_keeps_every_point_and_no_order(trial):
    positions = trial.capture.markers.positions_m
    found = shuffled(positions, 0)
    assert np.allclose(np.sort(found, axis=1), np.sort(positions, axis=1))
    assert not np.array_equal(found, positions)


def test_hard_captures_have_ghosts_and_hidden_samples(trial):
    markers = trial.capture.markers
    shown = hard(markers, 1)
    assert shown.shape[1] == len(markers.names) + GHOSTS
    hidden = np.isnan(shown[:, : len(markers.names), 0]).mean()
    assert hidden == pytest.approx(0.1, abs=0.02)
    assert (~np.isnan(shown[:, len(markers.names) :, 0])).any()


def test_truth_is_what_is_shown(trial):
    shown = hard(trial.capture.markers, 2)
    truth = truth_of(trial, shuffled(shown, 0)).positions_m
    assert np.array_equal(truth, shown[:, : truth.shape[1]], equal_nan=True)


def test_crossing_markers_come_near_and_start_where_they_were(trial):
    positions, middle, (one, two) = crossed(trial)
    assert np.linalg.norm(positions[middle, one] - positions[middle, two]) <= CROSSING_M + 1e-3
    before = trial.capture.markers.positions_m
    assert np.array_equal(positions[0], before[0])
    others = [k for k in range(before.shape[1]) if k not in (one, two)]
    assert np.array_equal(positions[:, others], before[:, others])


def test_names_are_exchanged(trial):
    a, b, *rest = trial.capture.markers.names
    found = renamed(trial.capture, {a: b, b: a}).markers.names
    assert found == (b, a, *rest)
