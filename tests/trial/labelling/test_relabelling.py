"""A second look at labels, with smoother and whole tracklets."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.running import RunningSettings
from mbkf.numerics.threads import single_threaded
from mbkf.trial.labelling.body import label_body
from mbkf.trial.labelling.relabelling import relabel_offline, smoothed_markers, trajectories
from tests.walker import walker

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def walk():
    """A body, points in columns that are markers, their labels, and poses."""
    made = walker()
    body = label_body(made.subject.markers, made.subject, RunningSettings())
    points = made.trial.markers
    label = np.array([body.names.index(name) for name in points.names])
    there = ~np.isnan(points.positions_m).any(axis=2)
    return body, points, np.where(there, label, HIDDEN), made.truth.q


def again(body, points, labels, q):
    with single_threaded():
        return relabel_offline(body, points, labels, q, lambda *_: None)


def test_right_labels_stay(walk):
    body, points, labels, q = walk
    found = again(body, points, labels, q)
    assert np.array_equal(found.label_of_point, labels)
    assert found.changed == 0


def test_exchanged_forgotten_and_invented_labels_are_put_right(walk):
    body, points, labels, q = walk
    wrong = labels.copy()
    knees = [points.names.index("RKNE"), points.names.index("LKNE")]
    wrong[70:90, knees] = labels[70:90, knees[::-1]]
    wrong[20:60, points.names.index("C7")] = HIDDEN
    ghost = points.positions_m[:, points.names.index("LFHD")] + [0.0, 0.05, 0.0]
    ghost = ghost + np.linspace(-0.05, 0.05, len(ghost))[:, None]
    hidden = slice(30, 55)
    positions = np.concatenate([points.positions_m, ghost[:, None]], axis=1)
    positions[hidden, points.names.index("LFHD")] = np.nan
    positions[: hidden.start, -1], positions[hidden.stop :, -1] = np.nan, np.nan
    wrong = np.concatenate([wrong, np.full((len(wrong), 1), HIDDEN)], axis=1)
    wrong[hidden, -1] = body.names.index("LFHD")
    wrong[hidden, points.names.index("LFHD")] = HIDDEN
    shown = replace(points, names=(*points.names, "*"), positions_m=positions)
    found = again(body, shown, wrong, q)
    expected = np.concatenate([labels, np.full((len(wrong), 1), HIDDEN)], axis=1)
    expected[hidden, points.names.index("LFHD")] = HIDDEN
    bad = found.label_of_point != expected
    assert bad.mean() < 0.001, [(shown.names[k], int(n)) for k, n in enumerate(bad.sum(axis=0)) if n]
    assert (found.label_of_point[:, -1] == HIDDEN).all()
    assert found.changed > 0


def test_course_has_the_markers_where_they_are(walk):
    body, points, labels, _ = walk
    own = trajectories(points, labels, body.names)
    with single_threaded():
        places = smoothed_markers(body, own, lambda _: None)
    away = np.linalg.norm(places.on_body_m - own.positions_m, axis=2)
    assert np.sqrt(np.nanmean(away**2)) < 0.012
    local = places.local(own.positions_m)
    assert np.allclose(np.linalg.norm(local, axis=2), away, equal_nan=True)
    assert (places.variance_m2 > 0.0).all()
    assert np.sqrt(places.variance_m2.max()) < 0.05
