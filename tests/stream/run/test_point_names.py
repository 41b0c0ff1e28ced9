"""Frames wait for their names and come back in order, also when the search goes wrong."""

import numpy as np
import pytest

from mbkf.stream.receiving.alignment import ReadyFrame
from mbkf.stream.run.point_names import PointNames
from mbkf.trial.live.labels import live_body
from tests.stream.scripted import frames_of


@pytest.fixture
def names(subject):
    return live_body(subject).names


@pytest.fixture
def made(capture, subject, names):
    _, frames = frames_of(capture, unlabelled=True)
    notes = []
    points = PointNames(subject, names[::-1], 0.01, True, lambda *what: notes.append(what))
    plates = np.zeros((0, 6))
    ready = [ReadyFrame(f.number, f.arrival_s, None, f.unlabelled_m, plates) for f in frames[:5]]
    return points, ready, notes


def test_names_come_in_the_order_that_is_asked_for(made, capture, names):
    points, ready, notes = made
    named = [one for frame in ready for one in points.push(frame, None)] + points.finish()
    assert [frame.number for frame, _ in named] == list(range(5))
    columns = [capture.markers.names.index(name) for name in names[::-1]]
    for frame, markers in named:
        np.testing.assert_array_equal(markers, capture.markers.positions_m[frame.number, columns])
    assert notes == []


def test_a_search_that_fails_lets_its_frames_go_and_begins_anew(made, monkeypatch):
    points, ready, notes = made

    def failing(*_):
        raise np.linalg.LinAlgError("singular matrix")

    monkeypatch.setattr(points._labels, "push", failing)
    ((frame, markers),) = points.push(ready[0], None)
    assert frame is ready[0]
    assert np.isnan(markers).all()
    assert notes[0][0] == "labels"
    named = [one for frame in ready[1:] for one in points.push(frame, None)] + points.finish()
    assert [frame.number for frame, _ in named] == [1, 2, 3, 4]
    assert np.isfinite(named[-1][1]).all()
