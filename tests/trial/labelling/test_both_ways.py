"""Runs from a frame both ways through time: all frames are labelled, and the more likely of two runs is kept."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.labelling.assignment import HIDDEN
from mbkf.labelling.first_frame import labelled_points
from mbkf.labelling.running import RunningSettings
from mbkf.trial.labelling.body import label_body
from mbkf.trial.labelling.both_ways import most_likely_run
from mbkf.trial.labelling.starts import Start, find_starts, points_of
from tests.walker import walker

FRAMES, FROM = 12, 6


@pytest.fixture(scope="module")
def walk():
    made = walker()
    body = label_body(made.subject.markers, made.subject, RunningSettings())
    markers = made.raw.markers
    return body, replace(markers, positions_m=markers.positions_m[:FRAMES]), made.truth.q[:FRAMES]


def test_both_directions_are_labelled_and_the_likelier_start_wins(walk):
    body, markers, q = walk
    (start,) = find_starts(body, markers, Start(FROM, q[FROM]), None, lambda *_: None)
    first = start[1]
    swapped = first.points.copy()
    pair = [body.names.index("LKNE"), body.names.index("RKNE")]
    swapped[pair] = swapped[pair[::-1]]
    wrong = (FROM, replace(first, points=swapped))
    reported = []
    run = most_likely_run(body, markers, [wrong, start], None, lambda *done: reported.append(done))
    np.testing.assert_array_equal(
        run.markers_m[FROM], labelled_points(points_of(markers, FROM), first.points)
    )
    truth = walker().trial.markers
    own = truth.positions_m[:FRAMES][:, [truth.names.index(name) for name in body.names]]
    seen = ~np.isnan(run.markers_m[..., 0])
    assert seen.mean() > 0.95
    np.testing.assert_allclose(run.markers_m[seen], own[seen], atol=1e-3)
    assert not np.isnan(run.q).any()
    assert FROM in run.starts
    assert reported[-1] == (FRAMES, FRAMES)


def test_labels_of_points_and_markers_agree(walk):
    body, markers, q = walk
    starts = find_starts(body, markers, Start(FROM, q[FROM]), None, lambda *_: None)
    run = most_likely_run(body, markers, starts, None, lambda *_: None)
    frames, columns = np.nonzero(run.label_of_point != HIDDEN)
    shown = run.markers_m[frames, run.label_of_point[frames, columns]]
    np.testing.assert_array_equal(shown, markers.positions_m[frames, columns])
    assert len(frames) == (~np.isnan(run.markers_m[..., 0])).sum()
