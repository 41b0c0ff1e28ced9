"""Inertial sensors in the dynamic filter: they carry it through a loss of all markers, and are silent when silent."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from mbkf.filters.fixed_lag import SmoothingSettings
from mbkf.filters.tracking import track
from mbkf.imu.placement import typical_mounts
from mbkf.imu.virtual import ImuErrors, virtual_imus
from mbkf.sensors.inertial_sensor import InertialSensor
from mbkf.trial.preparation.filters import tracking_filter
from tests.followed import FRAMES, inputs, made, recording, without

pytestmark = pytest.mark.slow

LOST = slice(25, 50)
"""A quarter of a second without any marker, in a squat that goes down."""


@cache
def worn(seed=0, errors=None):
    """Sensors on the squat, and what they read (T, S, 6)."""
    m, some = made().motion, slice(FRAMES.start, FRAMES.stop)
    mounts = typical_mounts(made().model, seed=seed)
    readings = virtual_imus(
        made().model, m.times_s[some], m.q[some], m.v[some], m.a[some], mounts, errors=errors, seed=seed
    )
    measured = np.stack(
        [np.hstack([one.angular_velocity_rad_s, one.specific_force_mps2]) for one in readings], axis=1
    )
    return InertialSensor(made().model, mounts), measured


def carried(segments=("pelvis", "torso", "thigh", "shank", "foot")):
    return [k for k, marker in enumerate(made().subject.markers) if marker.segment.endswith(segments)]


def marker_error(found, frames):
    sensor, truth = inputs().sensor, made().motion.q[FRAMES.start : FRAMES.stop]
    pairs = [
        (sensor.positions(found.q[t]), sensor.positions(truth[t]))
        for t in range(*frames.indices(len(found.q)))
    ]
    apart = np.array([np.linalg.norm(a - b, axis=1)[carried()] for a, b in pairs])
    return float(np.sqrt((apart**2).mean()))


def followed(imus=None, lost=LOST, smoothing=None):
    sensor, measured = worn()
    known = inputs() if imus is None else replace(inputs(), inertial=sensor)
    read = without(recording(), lost)
    if imus is not None:
        read = replace(read, imus=np.where(imus, measured, np.nan))
    return track(tracking_filter("dynamic", known), read, smoothing=smoothing)


def test_they_carry_the_body_through_a_loss_of_all_markers():
    alone, beside = followed(), followed(imus=True)
    assert marker_error(beside, LOST) < 0.008
    assert marker_error(beside, LOST) < 0.3 * marker_error(alone, LOST)
    assert beside.starts == (0,)
    assert beside.tracked.all()


def test_sensors_that_never_read_change_nothing():
    silent, none = followed(imus=False, lost=slice(0)), followed(lost=slice(0))
    np.testing.assert_array_equal(silent.q, none.q)
    np.testing.assert_array_equal(silent.torque_sd, none.torque_sd)


def test_standard_deviations_stay_finite_and_grow_where_nothing_is_seen():
    found = followed(imus=True)
    assert np.isfinite(found.sd_q).all()
    assert np.isfinite(found.torque_sd).all()
    hand = made().model.joint("right_hand").v
    assert found.sd_q[LOST.stop - 1, hand].max() > 2 * found.sd_q[LOST.start - 2, hand].max()


def test_the_smoother_uses_them_too():
    smooth = followed(imus=True, smoothing=SmoothingSettings())
    assert marker_error(smooth, LOST) < marker_error(followed(imus=True), LOST)


def test_unseen_arms_are_not_thrown_about():
    """Held near their mean posture, while a filter without sensors lets them go where Newton's law needs them."""
    found = followed(imus=True)
    clear = made().model
    arms = np.concatenate([np.arange(*clear.joint(f"{side}_{part}").v.indices(clear.nv))
                           for side in ("right", "left") for part in ("upper_arm", "forearm", "hand")])  # fmt: skip
    truth = made().motion.q[FRAMES.start : FRAMES.stop]
    apart = np.array([clear.difference(a, b)[arms] for a, b in zip(truth[LOST], found.q[LOST], strict=True)])
    assert np.abs(apart).max() < 0.6


def test_perfect_sensors_agree_with_the_motion():
    sensor, measured = worn(errors=ImuErrors.none())
    m, t = made().motion, FRAMES.start + 7
    np.testing.assert_allclose(sensor.values(m.q[t], m.v[t], m.a[t]), measured[7], atol=1e-9)
