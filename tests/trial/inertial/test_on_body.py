"""Sensors brought to a followed body: read at its frames, calibrated on its motion, refused where they cannot be."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.errors import InvalidInput
from mbkf.imu.placement import typical_mounts
from mbkf.imu.virtual import ImuErrors, virtual_imus
from mbkf.io.imu.readings import ImuReadings
from mbkf.sensors.inertial_sensor import InertialSensor
from mbkf.trial.inertial.on_body import ImuOnBody, calibrated, frame_readings, with_imus
from tests.dynamics import trial
from tests.followed import FRAMES, inputs, made, recording, tracked

SEGMENTS = ("pelvis", "right_thigh", "left_shank")


@cache
def sensors(name="squat", frames=FRAMES):
    one, some = trial(name), slice(frames.start, frames.stop)
    m, mounts = one.motion, typical_mounts(one.model, SEGMENTS, seed=1)
    args = (one.model, np.arange(len(frames)) / 100.0, m.q[some], m.v[some], m.a[some], mounts)
    return mounts, virtual_imus(*args, errors=ImuErrors(gyro_bias_sd_rad_s=0.02), seed=2)


def test_frames_read_faster_sensors_on_average_and_slower_ones_between():
    fine = np.arange(2001) / 1000.0
    wave = np.column_stack([np.sin(5 * fine), fine, 1.0 + 0 * fine])
    fast = ImuReadings("a", fine, wave, wave, None, 1000.0)
    slow = ImuReadings("b", fine[::20], wave[::20], wave[::20], None, 50.0)
    frames = np.arange(10, 180) / 100.0
    found = frame_readings([fast, slow], frames)
    expected = np.column_stack([np.sin(5 * frames), frames, 1.0 + 0 * frames])
    np.testing.assert_allclose(found[:, 0, 3:], expected, atol=1e-3)
    np.testing.assert_allclose(found[:, 1, :3], expected, atol=2e-3)
    assert np.isnan(frame_readings([slow], np.array([5.0, 6.0]))).all()
    gap = wave.copy()
    gap[500:700] = np.nan
    lost = frame_readings([replace(fast, specific_force_mps2=gap)], frames)
    np.testing.assert_array_equal(np.isnan(lost[:, 0, 3]), (frames > 0.4949) & (frames < 0.7051))


def test_mounts_and_biases_are_found_from_the_motion():
    whole = range(len(trial("walk").motion.q))
    mounts, readings = sensors("walk", whole)
    m, model = trial("walk").motion, trial("walk").model
    motion = SimpleNamespace(q=m.q, v=m.v, a=m.a, tracked=np.ones(len(whole), dtype=bool))
    measured = frame_readings(readings, np.arange(len(whole)) / 100.0)
    found, biases = calibrated(model, motion, measured, ImuOnBody(readings))
    for one, known in zip(found, mounts, strict=True):
        turn = Rotation.from_quat(one.rotation.copy()) * Rotation.from_quat(known.rotation.copy()).inv()
        assert np.degrees(turn.magnitude()) < 3.0, one.name
        assert np.linalg.norm(one.position_m - known.position_m) < 0.05
        assert one.segment == known.segment
    given, again = calibrated(model, motion, measured, ImuOnBody(readings, mounts))
    assert given == mounts
    true = (
        measured[:, :, :3]
        - np.array([InertialSensor(model, mounts).values(*x) for x in zip(m.q, m.v, m.a, strict=True)])[
            :, :, :3
        ]
    ).mean(axis=0)
    assert np.abs(again - true).max() < 0.6 * np.abs(true).max()
    assert biases.shape == (3, 3)


def test_inputs_and_recording_carry_the_sensors():
    mounts, readings = sensors()
    times = np.arange(len(FRAMES)) / 100.0
    known, read, warnings = with_imus(inputs(), recording(), times, ImuOnBody(readings, mounts))
    assert known.inertial is not None
    assert read.imus.shape == (len(FRAMES), 3, 6)
    assert warnings == ()


def test_what_cannot_be_used_is_refused():
    mounts, readings = sensors()
    times = np.arange(len(FRAMES)) / 100.0
    with pytest.raises(InvalidInput, match="overlap"):
        with_imus(inputs(), recording(), times + 100.0, ImuOnBody(readings, mounts))
    grams = tuple(replace(one, specific_force_mps2=one.specific_force_mps2 / 9.81) for one in readings)
    with pytest.raises(InvalidInput, match="acc=g"):
        with_imus(inputs(), recording(), times, ImuOnBody(grams, mounts))
    measured = frame_readings(readings, times)
    still = tracked("dynamic")
    still = replace(still, q=np.tile(still.q[30], (len(FRAMES), 1)), v=0 * still.v, a=0 * still.a)
    with pytest.raises(InvalidInput, match="hardly turns"):
        calibrated(made().model, still, measured, ImuOnBody(readings))
    measured[10:] = np.nan
    with pytest.raises(InvalidInput, match="frames have markers"):
        calibrated(made().model, tracked("dynamic"), measured, ImuOnBody(readings))
