"""Inertial sensors on a body: rows whitened and silent where nothing was read, and which joints they observe."""

from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.io.imu.mount import ImuMount
from mbkf.model.human import HumanModel
from mbkf.sensors.block import Frame, OperatingPoint
from mbkf.sensors.inertial import InertialSensors, InertialSettings, observed_dofs
from mbkf.sensors.inertial_sensor import InertialSensor
from tests.dynamics import notes_of

MODEL = HumanModel.scaled()
STRAIGHT = np.array([0.0, 0.0, 0.0, 1.0])
SENSOR = InertialSensor(
    MODEL,
    [
        ImuMount("a", "pelvis", np.array([0.1, 0.0, 0.0]), STRAIGHT),
        ImuMount("b", "left_foot", np.zeros(3), STRAIGHT),
    ],
)


def test_rows_are_whitened_and_missing_readings_are_left_out():
    rng = np.random.default_rng(3)
    q = MODEL.integrate(MODEL.neutral(), rng.normal(0, 0.3, MODEL.nv))
    v, a = rng.normal(0, 1, (2, MODEL.nv))
    block = InertialSensors(SENSOR, InertialSettings(0.1, 2.0))
    expected = SENSOR.values(q, v, a)
    measured = expected + np.repeat([0.1, 2.0], 3)
    measured[1, 4] = np.nan
    rows, values = block.rows(q, v, a, measured)
    assert rows.shape == (11, 3 * MODEL.nv)
    np.testing.assert_allclose(values, 1.0, atol=1e-9)
    step = 1e-6 * rng.normal(size=3 * MODEL.nv)
    n = MODEL.nv
    moved = SENSOR.values(MODEL.integrate(q, step[:n]), v + step[n : 2 * n], a + step[2 * n :])
    weight = np.repeat([10.0, 0.5], 3)
    change = ((moved - expected) * weight).ravel()
    np.testing.assert_allclose(rows @ step, np.delete(change, 10), atol=1e-9)


def test_only_joints_of_carrying_segments_are_observed():
    observed = observed_dofs(MODEL, ["pelvis", "left_foot"])
    assert observed[:6].all()
    assert observed.sum() == 6 + 3


def point_at(q):
    return OperatingPoint(SimpleNamespace(q=q, v=np.zeros(MODEL.nv), a=np.zeros(MODEL.nv)), None)


def test_they_observe_joints_that_no_marker_shows():
    block = InertialSensors(SENSOR)
    foot, hand = (np.arange(MODEL.nv)[MODEL.joint(name).v] for name in ("left_foot", "right_hand"))
    notes = notes_of(unmarked=np.concatenate([foot, hand]), unobserved=np.concatenate([foot, hand]))
    measured = np.full((2, 6), np.nan)
    measured[1, 3] = 1.0
    frame = Frame(np.zeros((0, 3)), np.zeros((0, 6)), measured)
    decision = block.decide(point_at(MODEL.neutral()), frame, None, notes)
    assert notes.imus is measured and notes.observed
    np.testing.assert_array_equal(notes.unobserved, hand)
    np.testing.assert_array_equal(notes.unmarked, np.concatenate([foot, hand]))
    assert block.linearise(point_at(MODEL.neutral()), decision).jacobian.shape == (1, 3 * MODEL.nv)


@pytest.mark.parametrize("imus", [None, np.full((2, 6), np.nan)])
def test_where_none_reads_nothing_is_said(imus):
    block, notes = InertialSensors(SENSOR), notes_of(unmarked=np.arange(6), unobserved=np.arange(6))
    frame = Frame(np.zeros((0, 3)), np.zeros((0, 6)), imus)
    decision = block.decide(point_at(MODEL.neutral()), frame, None, notes)
    assert block.linearise(point_at(MODEL.neutral()), decision) is None
    assert notes.imus is None and not notes.observed and len(notes.unobserved) == 6
