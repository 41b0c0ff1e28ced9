"""What every filter promises: the same questions, answers of the same shape, the same robustness."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.filters.estimate import NO_WRENCH
from mbkf.filters.kinematic.warm_start import WARM_UP_S
from mbkf.filters.spread import SpreadReader
from mbkf.filters.tracking import track
from mbkf.trial.preparation.filters import FILTERS
from tests.dynamics import DT, MARKER_SD_M
from tests.followed import (
    FRAMES,
    WHOLE,
    errors,
    estimates,
    inputs,
    made,
    made_filter,
    recording,
    tracked,
    without,
)
from tests.motions import angle_errors, worst

LONG = range(20, 130)
GAP = slice(30, 80)
"""Half a second without any marker."""

MARKER, WRONG = 7, slice(32, 42)
"""A marker that is displaced in some frames."""

LAST = len(FRAMES) - 1
every_filter = pytest.mark.parametrize("name", FILTERS)


def two(name):
    """The filter, its start and the estimate of the next frame."""
    one, found = estimates(name)
    return one, found[0], found[1]


@pytest.mark.slow
@every_filter
def test_a_recording_knows_its_length(name):
    assert len(recording()) == len(FRAMES) == len(tracked(name).q)


@pytest.mark.slow
@every_filter
def test_the_first_estimate_already_moves_as_the_body_does(name):
    one, first, second = two(name)
    truth = made().motion
    assert (first.started, second.started) == (True, False)
    assert first.tracked and second.tracked
    off = made().model.difference(truth.q[FRAMES.start], first.q)
    assert worst(off / one.spread(first).position) < 5.0
    assert np.linalg.norm(first.v - truth.v[FRAMES.start]) < np.linalg.norm(truth.v[FRAMES.start])


@every_filter
def test_shapes(name):
    for estimate in two(name)[1:]:
        nq, nv = made().model.nq, made().model.nv
        assert (estimate.q.shape, estimate.v.shape, estimate.a.shape) == ((nq,), (nv,), (nv,))
        assert (estimate.wrench.shape, estimate.refused.shape) == ((2, 6), (36,))
        assert np.isfinite(np.r_[estimate.q, estimate.v, estimate.a]).all()


@every_filter
def test_covariances_are_symmetric_positive_and_those_of_the_spread(name):
    one, *both = two(name)
    nv = made().model.nv
    for estimate in both:
        P, spread = one.covariance(estimate), one.spread(estimate)
        assert P.shape == (2 * nv, 2 * nv)
        np.testing.assert_allclose(P, P.T, rtol=0, atol=1e-12)
        assert np.linalg.eigvalsh(P).min() > -1e-12
        np.testing.assert_allclose(np.r_[spread.position, spread.velocity] ** 2, np.diag(P), rtol=1e-12)


@every_filter
def test_spreads_are_finite_and_positive(name):
    one, first, second = two(name)
    nv, angles = made().model.nv, len(SpreadReader(made().model).clinical.names)
    widths = dict(position=nv, velocity=nv, angle=angles, rate=angles, foot_height=2)
    for estimate in (first, second):
        spread = one.spread(estimate)
        for part, width in widths.items():
            values = getattr(spread, part)
            assert values.shape == (width,), part
            assert (np.isfinite(values) & (values > 0)).all(), part
        assert spread.torque.shape == (nv,)


@every_filter
def test_torques_of_all_dofs_with_a_torque_have_a_spread(name):
    """The thesis's filter has no torque in the toes and head, the kinematic one none at a start."""
    one, first, second = two(name)
    known = np.isfinite(one.spread(second).torque)
    assert (one.spread(second).torque[known] > 0).all()
    assert known.sum() >= (50 if name == "torque" else 52)
    assert np.isnan(one.spread(first).torque).all() == (name == "kinematic")


@every_filter
def test_wrenches_have_a_spread_where_there_are_wrenches(name):
    one, *both = two(name)
    for estimate in both:
        sd = one.wrench_sd(estimate)
        assert sd.shape == (2, 6)
        assert (np.isnan(sd) == np.isnan(estimate.wrench)).all()
        if name == "kinematic":
            assert np.isnan(sd).all() and estimate.contact is None
            assert estimate.wrench is NO_WRENCH
        else:
            assert (sd > 0).all() and estimate.contact == (1, 1)


@every_filter
def test_innovations(name):
    """Of 36 markers, and 12 numbers of plates and 6 of Newton's law where they were read before; none at a start."""
    one, first, second = two(name)
    assert one.innovations(first) is None
    judged = one.innovations(second)
    assert judged.readings[0] == 3 * 36 and 0.0 < judged.squared[0] < 5.0 * 3 * 36
    # Nothing is known of the spread of loads before the first of them.
    later = one.innovations(one.step(second, recording(), 2))
    loads = {"kinematic": [0, 0, 0], "torque": [12, 0, 0], "dynamic": [12, 6, 0]}[name]
    np.testing.assert_array_equal(later.readings, [3 * 36, *loads])


@every_filter
def test_a_start_without_markers_is_none(name):
    empty = without(recording(), slice(None))
    assert made_filter(name).start(empty, 0, None) is None


@every_filter
def test_steps_leave_the_estimate_before_alone(name):
    one, first, second = two(name)
    kept = first.q.copy(), one.covariance(first).copy()
    again = one.step(first, recording(), 1)
    np.testing.assert_array_equal(again.q, second.q)
    np.testing.assert_array_equal(first.q, kept[0])
    np.testing.assert_array_equal(one.covariance(first), kept[1])


GAIN = {"kinematic": (0.97, 0.6, 0.3), "torque": (0.85, 0.6, 0.85), "dynamic": (0.97, 0.6, 0.85)}
"""Largest smoothed error over the filter's, of angles, velocities and torques."""


@pytest.mark.slow
@every_filter
def test_smoothing_comes_nearer_to_the_truth(name):
    gain = errors(tracked(name, WHOLE)) / errors(tracked(name))
    assert (gain < GAIN[name]).all(), gain


@every_filter
def test_smoothed_spreads_are_smaller(name):
    before, after = tracked(name), tracked(name, WHOLE)
    assert after.smoothed and not before.smoothed
    for part in ("sd_q", "sd_v"):
        shrunk = getattr(after, part)[5:-5] / getattr(before, part)[5:-5]
        # Skin does not average out: of the dynamic filter's positions it is most of the spread.
        assert np.median(shrunk) < (1.0 if (name, part) == ("dynamic", "sd_q") else 0.9), part
        assert shrunk.max() < 1.05, part


@every_filter
def test_the_last_frame_of_a_run_is_the_filters(name):
    """No later readings say more; the dynamic smoother, linearised anew, moves it by a fraction of its spread."""
    before, after = tracked(name), tracked(name, WHOLE)
    q = made().model.difference(before.q[LAST], after.q[LAST]) / before.sd_q[LAST]
    v = (after.v[LAST] - before.v[LAST]) / before.sd_v[LAST]
    assert worst(np.r_[q, v]) < (0.2 if name == "dynamic" else 1e-9)


@every_filter
def test_asked_for_a_part_the_smoother_gives_that_part(name):
    one, found = estimates(name)
    whole = one.smooth(found, len(found))
    part = one.smooth(found, 20)
    assert (len(whole), len(part)) == (len(found), 20)
    for a, b in zip(part, whole, strict=False):
        np.testing.assert_array_equal(a.q, b.q)


@pytest.mark.slow
@every_filter
def test_a_wrong_marker_is_refused_and_hardly_moves_the_estimate(name):
    """Refused means not there: the same as if the marker were out of sight in these frames."""
    wrong = recording().markers_m.copy()
    wrong[WRONG, MARKER] += [0.0, 0.0, 0.3]
    found = track(made_filter(name), replace(recording(), markers_m=wrong))
    expected = np.zeros((len(FRAMES), 36), dtype=bool)
    expected[WRONG, MARKER] = True
    np.testing.assert_array_equal(found.rejected, expected)
    hidden = track(made_filter(name), without(recording(), WRONG, MARKER))
    np.testing.assert_allclose(found.q, hidden.q, rtol=0, atol=1e-12)
    moved = angle_errors(made().model, found.q, tracked(name).q) / found.sd_q
    assert worst(moved) < 2.0


@pytest.mark.parametrize("name", ["kinematic", "dynamic"])
def test_a_marker_wrong_where_the_warm_start_begins_does_little(name):
    """The backward run begins 0.25 s ahead, and one marker of the torso's, arm's or thigh's is 0.3 m off there."""
    begin = round(WARM_UP_S / DT)
    for marker in (7, 12, 20):
        wrong = recording().markers_m.copy()
        wrong[begin, marker] += [0.0, 0.0, 0.3]
        found = made_filter(name).start(replace(recording(), markers_m=wrong), 0, None)
        clean = estimates(name)[1][0]
        assert worst(made().model.difference(clean.q, found.q)) < np.deg2rad(20.0)


@pytest.mark.slow
@every_filter
def test_after_half_a_second_without_markers_the_filter_starts_anew(name):
    read = without(recording(LONG), GAP)
    found = track(made_filter(name), read)
    assert found.starts == (0, GAP.stop)
    np.testing.assert_array_equal(np.flatnonzero(~found.tracked), np.arange(GAP.start, GAP.stop))
    truth = made().motion.q[LONG.start : LONG.stop]
    assert np.isfinite(found.q).all()
    off = angle_errors(made().model, found.q, truth) / found.sd_q
    assert worst(off[GAP.stop :]) < 5.5


@pytest.mark.slow
@every_filter
def test_a_short_loss_is_bridged_with_growing_spreads(name):
    found = track(made_filter(name), without(recording(), slice(30, 40)))
    assert found.starts == (0,)
    assert not found.tracked[30:40].any() and found.tracked[40:].all()
    assert (found.sd_q[39, 3:6] > 2 * found.sd_q[29, 3:6]).all()


@every_filter
def test_a_step_with_what_was_expected_is_the_same_step(name):
    tracking, found = estimates(name)
    for t in (5, 30):
        prediction = tracking.predict(found[t])
        np.testing.assert_array_equal(
            tracking.step(found[t], recording(), t + 1, prediction).q, found[t + 1].q
        )


@every_filter
def test_what_is_expected_is_as_far_off_as_stated(name):
    """Innovations lie within H P Hᵀ + R, marker by marker: well within, since a squat is slower than most motion."""
    tracking, found = estimates(name)
    everyone = np.ones(len(recording().markers_m[0]), dtype=bool)
    squared = []
    for t in range(20, LAST):
        markers = tracking.predict(found[t]).markers
        S = markers.spread(everyone)
        S[:, np.arange(3), np.arange(3)] += MARKER_SD_M**2
        y = recording().markers_m[t + 1] - markers.positions_m
        squared.append(np.einsum("mi,mij,mj->m", y, np.linalg.inv(S), y))
    assert 0.25 < np.mean(squared) / 3.0 < 1.0


@pytest.mark.parametrize(
    ("name", "jump_m"), [("kinematic", 1.0), ("kinematic", 5.0), ("dynamic", 0.5), ("dynamic", 5.0)]
)
def test_a_body_that_is_suddenly_elsewhere_is_found_there(name, jump_m):
    """Another person, or a recording that begins anew: no plant gets there, so the filter starts once more."""
    there = 30  # the start looks a quarter of a second ahead
    read = recording(LONG)
    moved = read.markers_m.copy()
    moved[there:] += np.array([jump_m, 0.0, 0.0])
    tracking = made_filter(name)
    found = track(tracking, replace(read, markers_m=moved))
    settled = there + round(2.5 * tracking.restart_after_s / DT)
    assert found.tracked[settled:].all()
    sensor = inputs().sensor
    off = np.array([sensor.positions(q) for q in found.q[settled:]]) - moved[settled:]
    assert np.sqrt(np.mean(off**2)) < 3.0 * MARKER_SD_M
