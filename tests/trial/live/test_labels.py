"""A stream's points are named frame by frame, with the filter's own prediction."""

import time
from dataclasses import replace

import numpy as np
import pytest

from mbkf.numerics.threads import single_threaded
from mbkf.sensors.block import Frame
from mbkf.trial.labelling.score import score
from mbkf.trial.live.filter import LiveFilter
from mbkf.trial.live.labels import LONGEST_WAIT_S, LiveLabels, live_body
from tests.walker import walker

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def walk():
    made = walker()
    return made.trial.markers, made.raw.markers, made.subject


def streamed(points_m, rate_hz, subject):
    """The body, (T, M, 3) names given while a filter follows, and the frames in which they were searched."""
    body = live_body(subject)
    tracking = live_body(subject).tracking_filter(1.0 / rate_hz)
    labels, live = LiveLabels(body, tracking.dt_s, patient=True), LiveFilter(tracking)
    named, plates = [], np.zeros((0, 6))
    with single_threaded():
        for number, frame in enumerate(points_m):
            for markers in labels.push(frame, live.predict()):
                steps = live.push(len(named), Frame(markers, plates))
                named.append(markers)
            if named and steps and steps[-1].number == number and steps[-1].estimate is not None:
                labels.learn(steps[-1].estimate.q)
    named += labels.finish()
    return body, np.array(named), labels.starts


def test_shuffled_points_with_ghosts_are_named_as_they_come(walk):
    truth, raw, subject = walk
    body, named, starts = streamed(raw.positions_m, raw.rate_hz, subject)
    result = score(replace(truth, names=body.names, positions_m=named), truth, subject)
    assert len(starts) == 1
    assert result.correct_fraction >= 0.995
    assert result.wrong_fraction <= 0.002


def test_a_total_loss_is_followed_by_a_new_start(walk):
    truth, raw, subject = walk
    points = raw.positions_m.copy()
    gone = slice(35, 35 + round(0.35 * raw.rate_hz))
    points[gone] = np.nan
    body, named, _ = streamed(points, raw.rate_hz, subject)
    assert np.isnan(named[gone]).all()
    shown = truth.positions_m.copy()
    shown[gone] = np.nan
    result = score(
        replace(truth, names=body.names, positions_m=named), replace(truth, positions_m=shown), subject
    )
    back = gone.stop + round(0.2 * raw.rate_hz)
    assert not result.wrong[back:].any()
    assert result.right[back:].sum() >= 0.99 * (result.right[back:].sum() + result.missed[back:].sum())


def test_nobody_is_nobody(walk):
    _, _, subject = walk
    body = live_body(subject)
    labels = LiveLabels(body, 0.01, patient=True)
    rng = np.random.default_rng(0)
    frames = [rng.uniform(-1, 1, (40, 3)), np.full((40, 3), np.nan), np.zeros((0, 3))]
    due = [one for frame in frames for one in labels.push(frame, None)] + labels.finish()
    assert len(due) == len(frames)
    assert np.isnan(due).all()


def test_a_stream_goes_on_while_it_is_searched(walk):
    truth, raw, subject = walk
    body = live_body(subject)
    labels = LiveLabels(body, 1.0 / raw.rate_hz)
    assert labels.push(raw.positions_m[0], None) == []  # the search has only begun
    due = []
    for frame in raw.positions_m[1:60]:
        due += labels.push(frame, None)
        time.sleep(1.0 / raw.rate_hz)
    due += labels.finish()
    assert len(due) == 60
    result = score(
        replace(truth, names=body.names, positions_m=np.array(due)),
        replace(truth, positions_m=truth.positions_m[:60]),
        subject,
    )
    assert result.correct_fraction >= 0.98


def test_frames_do_not_wait_for_ever(walk):
    _, _, subject = walk
    body = live_body(subject)
    labels = LiveLabels(body, 0.01, patient=True)
    most = round(LONGEST_WAIT_S / 0.01)
    due = [labels.push(np.zeros((0, 3)), None) for _ in range(most + 5)]
    assert [len(one) for one in due] == [0] * most + [1] * 5
