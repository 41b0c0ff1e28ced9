"""Starts of labelling: a known pose, a named frame, else the frames that a search can label."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import NotObservable
from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.running import RunningSettings
from mbkf.trial.labelling.body import label_body
from mbkf.trial.labelling.starts import Start, find_starts, points_of
from tests.walker import walker


@pytest.fixture(scope="module")
def walk():
    """The subject's body, the unlabelled points of three frames, and the true poses of these."""
    made = walker()
    body = label_body(made.subject.markers, made.subject, RunningSettings())
    markers = made.raw.markers
    return body, replace(markers, positions_m=markers.positions_m[:3]), made.truth.q[:3]


def report(*_):
    pass


def right(body, markers, first, frame):
    """Share of the markers whose label is that of the labelled trial's point."""
    truth = walker().trial.markers
    own = [truth.names.index(name) for name in body.names]
    shown = points_of(markers, frame)[first.points]
    away = np.linalg.norm(shown - truth.positions_m[frame, own], axis=1)
    return (away[first.points != HIDDEN] < 1e-3).mean()


def test_a_known_pose_is_the_only_start(walk):
    body, markers, q = walk
    ((frame, first),) = find_starts(body, markers, Start(1, q[1]), None, report)
    assert frame == 1
    assert right(body, markers, first, 1) == 1.0


def test_frames_are_searched_where_the_known_pose_does_not_fit(walk):
    body, markers, q = walk
    elsewhere = q[1].copy()
    elsewhere[:3] += 5.0
    starts = find_starts(body, markers, Start(1, elsewhere), None, report)
    assert starts
    assert all(right(body, markers, first, frame) > 0.95 for frame, first in starts)
    ratios = [first.log_ratio for _, first in starts]
    assert ratios == sorted(ratios, reverse=True)


def test_the_frame_with_most_named_points_is_the_start(walk):
    body, markers, _ = walk
    truth = walker().trial.markers
    known = np.full(markers.positions_m.shape[:2], HIDDEN)
    own = truth.positions_m[:3][:, [truth.names.index(name) for name in body.names]]
    for t, named in ((0, 8), (2, 20)):
        away = np.linalg.norm(markers.positions_m[t, :, None] - own[t], axis=2)
        columns, marker = np.nonzero(away < 1e-4)
        known[t, columns[:named]] = marker[:named]
    ((frame, first),) = find_starts(body, markers, None, known, report)
    assert frame == 2
    assert right(body, markers, first, 2) == 1.0


def test_points_of_something_else_are_refused(walk):
    body, markers, _ = walk
    noise = np.random.default_rng(0).uniform(-1.0, 1.0, (3, 12, 3))
    with pytest.raises(NotObservable, match="in no frame"):
        find_starts(body, replace(markers, positions_m=noise, names=("*",) * 12), None, None, report)
