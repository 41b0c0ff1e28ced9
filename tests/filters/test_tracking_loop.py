"""A filter's way through a trial is the one that a track records, restarts included."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.filters.estimate import Recording
from mbkf.filters.fixed_lag import SmoothingSettings
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.report import KinematicReport
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.kinematic.warm_start import WarmStart
from mbkf.filters.tracking import track
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.filters.tracking_loop import TrackingLoop, followed
from tests.motions import marker_positions, protocol_sensor, reference_model, smooth_motion

MODEL = reference_model()
FRAMES, RATE_HZ = 70, 100.0


def test_it_is_what_a_track_records():
    sensor, _ = protocol_sensor(MODEL)
    markers = marker_positions(
        sensor, smooth_motion(MODEL, np.random.default_rng(1)).frames(FRAMES, RATE_HZ)[0]
    )
    markers[:3] = np.nan
    markers[20:50] = np.nan
    recording = Recording(markers, np.zeros((FRAMES, 0, 6)), 1.0 / RATE_HZ)
    everywhere = np.zeros(MODEL.nv, dtype=bool)
    kalman = KinematicFilter(sensor, np.full(36, 0.005), recording.dt_s, everywhere, KinematicSettings())
    tracking = TrackingFilter(KinematicReport(kalman), WarmStart(kalman))
    recorded = track(tracking, recording)
    course = list(followed(TrackingLoop(tracking), recording))
    assert [t for t, _, _ in course] == list(range(3, FRAMES))
    assert tuple(t for t, estimate, _ in course if estimate.started) == recorded.starts
    assert len(recorded.starts) == 2
    np.testing.assert_array_equal([estimate.q for _, estimate, _ in course], recorded.q[3:])
    assert all(seconds > 0.0 for _, _, seconds in course)


def whole_motion(filter=TrackingFilter):
    """A filter, and a smooth motion that it sees all markers of."""
    sensor, _ = protocol_sensor(MODEL)
    markers = marker_positions(
        sensor, smooth_motion(MODEL, np.random.default_rng(1)).frames(FRAMES, RATE_HZ)[0]
    )
    dt_s, everywhere = 1.0 / RATE_HZ, np.zeros(MODEL.nv, dtype=bool)
    kalman = KinematicFilter(sensor, np.full(36, 0.005), dt_s, everywhere, KinematicSettings())
    return filter(KinematicReport(kalman), WarmStart(kalman)), Recording(
        markers, np.zeros((FRAMES, 0, 6)), dt_s
    )


def thrown(estimate):
    return estimate._replace(v=1e6 * np.ones_like(estimate.v))


class Thrown(TrackingFilter):
    """The step into frame 30 throws it."""

    def step(self, before, recording, t, prediction=None):
        found = super().step(before, recording, t, prediction)
        return thrown(found) if t == 30 else found


class ThrownTwice(Thrown):
    """And so does a start there."""

    def start(self, recording, t, guess):
        found = super().start(recording, t, guess)
        return thrown(found) if t == 30 else found


def test_a_frame_with_an_implausible_estimate_starts_anew():
    found = track(*whole_motion(Thrown))
    assert found.starts == (0, 30)
    assert found.known.all() and found.tracked.all()


def test_a_frame_whose_start_is_implausible_too_has_no_estimate():
    found = track(*whole_motion(ThrownTwice))
    assert np.flatnonzero(~found.known).tolist() == [30]
    assert found.starts == (0, 31)
    assert np.isnan(found.q[30]).all() and not found.tracked[30]
    assert np.isfinite(found.q[31:]).all() and found.tracked[31:].all()


@pytest.mark.parametrize("gap", [0, 5])
@pytest.mark.parametrize("smoothing", [None, SmoothingSettings(window_s=1.0, frames=0)])
def test_a_body_that_stands_elsewhere_is_found_there_in_the_same_frame(gap, smoothing):
    """It errs no more than the same motion without the step, before and after it, and is not thrown across."""
    filter, recording = whole_motion()
    still = track(filter, recording, smoothing=smoothing)
    markers = recording.markers_m.copy()
    markers[30:] += [0.3, -0.4, 0.0]
    markers[30 : 30 + gap] = np.nan
    found = track(filter, replace(recording, markers_m=markers), smoothing=smoothing)
    assert found.starts == (0, 30 + gap)
    assert found.tracked[30 + gap :].all()
    seen = [*range(30), *range(30 + gap, FRAMES)]
    off = found.q[seen, :3] - still.q[seen, :3]
    off[30:] -= [0.3, -0.4, 0.0]
    assert np.abs(off).max() < 0.004
    assert np.abs(found.v[seen, :3] - still.v[seen, :3]).max() < 0.2


def test_a_body_of_which_too_little_is_seen_is_not_sought_elsewhere():
    filter, recording = whole_motion()
    markers = recording.markers_m.copy()
    markers[30:33] += [0.3, -0.4, 0.0]
    markers[30:33, 16:] = np.nan
    starts = track(filter, replace(recording, markers_m=markers)).starts
    assert not set(starts) & {30, 31, 32}
