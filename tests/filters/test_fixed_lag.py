"""Fixed-lag smoothing: what comes back, when, and how near it is to smoothing everything at once."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.filters.fixed_lag import FixedLagSmoother, SmoothingSettings
from mbkf.filters.tracking import track
from mbkf.trial.preparation.filters import FILTERS
from tests.dynamics import DT
from tests.followed import WHOLE, errors, estimates, made, made_filter, recording, tracked, without
from tests.motions import angle_errors, reference_model

SHORT = SmoothingSettings(window_s=0.1, ahead_s=0.2, frames=0)
"""Windows of 10 frames that look 20 frames ahead; the lag is 30."""

every_filter = pytest.mark.parametrize("name", FILTERS)


class Counter:
    """A filter that smooths nothing and remembers what it was asked; estimates are plain numbers."""

    dt_s, model = DT, reference_model()

    def __init__(self):
        self.asked = []

    def smooth(self, run, wanted):
        self.asked.append((run[0].t, len(run), wanted))
        return list(run[:wanted])


class Told:
    """An estimate at rest that only knows its frame and whether it was a start."""

    q, v, a = reference_model().neutral(), np.zeros(1), np.zeros(1)
    wrench, tracked, placed, uncorrected = np.zeros((2, 6)), True, True, False

    def __init__(self, t, started=False, rejoined=False):
        self.t, self.started, self.rejoined = t, started, rejoined


def returned(frames, settings, starts=(0,), dt_s=DT):
    """The frames that come back, with the frame that was put in when they did, and what was asked of the smoother."""
    tracking = Counter()
    tracking.dt_s = dt_s
    smoother = FixedLagSmoother(tracking, settings)
    found = []
    for t in frames:
        found += [(t, k, e) for k, e in smoother.push(t, Told(t, t in starts))]
    found += [(frames[-1], k, e) for k, e in smoother.finish()]
    return found, tracking.asked


@pytest.mark.parametrize("frames", [range(1), range(29), range(30), range(95), range(7, 60)])
def test_every_frame_comes_back_once_in_order(frames):
    found, _ = returned(frames, SHORT, starts=(frames[0],))
    assert [k for _, k, _ in found] == list(frames)
    assert all(estimate.t == k for _, k, estimate in found)


def test_no_frame_waits_longer_than_the_lag():
    found, _ = returned(range(200), SHORT)
    waits = [t - k for t, k, _ in found]
    assert max(waits) * DT <= SHORT.window_s + SHORT.ahead_s == pytest.approx(0.3)
    assert max(waits) == 29  # the frame itself is the 30th
    assert min(waits[:-40]) == 20  # every one is looked ahead of


def test_windows_begin_with_the_frame_before():
    _, asked = returned(range(60), SHORT)
    assert asked == [(0, 30, 10), (9, 31, 11), (19, 31, 11), (29, 31, 11), (39, 21, 21)]


def test_a_restart_ends_a_run():
    """What was before it is smoothed without what comes after."""
    found, asked = returned(range(50), SHORT, starts=(0, 17))
    assert asked[0] == (0, 17, 17)
    assert all(first >= 17 for first, _, _ in asked[1:])
    assert [t for t, k, _ in found if k < 17] == [17] * 17


def test_nothing_comes_of_nothing():
    assert FixedLagSmoother(Counter(), SHORT).finish() == []


@pytest.mark.parametrize(
    ("rate_hz", "window", "ahead"), [(50, 360, 20), (100, 340, 40), (200, 300, 80), (300, 450, 120)]
)
def test_windows_have_380_frames_or_more(rate_hz, window, ahead):
    """At low rates they are longer than 1.5 s, so that few frames are worked through twice."""
    _, asked = returned(range(window + ahead), SmoothingSettings(), dt_s=1.0 / rate_hz)
    assert asked[0] == (0, window + ahead, window)


@pytest.mark.slow
@every_filter
def test_short_windows_are_nearly_the_whole(name):
    """What readings say fades within the 0.2 s a window looks ahead: less than the spread is left, mostly nothing."""
    whole, parts, model = tracked(name, WHOLE), tracked(name, SHORT), made().model
    q = angle_errors(model, parts.q, whole.q) / whole.sd_q
    v = (parts.v - whole.v) / whole.sd_v
    left = np.abs(np.hstack([q, v]))
    assert left.max() < 0.7 and np.median(left) < 0.02
    assert (errors(parts) < 1.03 * errors(whole)).all()


@pytest.mark.slow
@every_filter
def test_the_last_window_is_the_whole(name):
    """It has seen the same later readings; trajectories before it, where the dynamic smoother is linear, differ."""
    whole, parts, model = tracked(name, WHOLE), tracked(name, SHORT), made().model
    q = angle_errors(model, parts.q[30:], whole.q[30:]) / whole.sd_q[30:]
    most, usual = (0.005, 0.001) if name == "dynamic" else (1e-6, 1e-6)
    assert np.abs(q).max() < most and np.sqrt(np.mean(q**2)) < usual


def test_pushing_is_what_a_trial_does():
    one, found = estimates("kinematic")
    smoother = FixedLagSmoother(one, SHORT)
    back = [
        pair for t, estimate in enumerate(found) for pair in smoother.push(t, estimate)
    ] + smoother.finish()
    np.testing.assert_array_equal([e.q for _, e in back], tracked("kinematic", SHORT).q)


def test_frames_before_a_restart_know_nothing_of_those_after():
    """The same smoothed motion as if the trial ended with the loss."""
    read = without(recording(range(20, 130)), slice(30, 80))
    found = track(made_filter("kinematic"), read, smoothing=WHOLE)
    assert found.starts == (0, 80)
    ended = replace(read, markers_m=read.markers_m[:80], plates=read.plates[:80])
    alone = track(made_filter("kinematic"), ended, smoothing=WHOLE)
    np.testing.assert_array_equal(found.q[:80], alone.q)
    np.testing.assert_array_equal(found.a[:80], alone.a)
