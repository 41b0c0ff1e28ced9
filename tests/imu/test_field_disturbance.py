"""Disturbed fields are told with their times and sizes; an even field is not accused."""

import numpy as np

from mbkf.imu.field_disturbance import field_remarks, size_and_dip
from mbkf.imu.frames import exponential
from mbkf.io.imu.readings import ImuReadings
from mbkf.numerics.cardan import quaternion_matrices

FIELD = np.array([24.0, 0.0, -39.0])
TIMES = np.arange(3000) / 100.0
Q = exponential(np.column_stack([np.sin(TIMES), 0.5 * np.cos(TIMES), 0.3 * TIMES]))


def sensor(added=None):
    world = np.tile(FIELD, (3000, 1)) + 0.3 * np.random.default_rng(0).normal(size=(3000, 3))
    if added is not None:
        world[1000:1500] += added
    local = np.einsum("tji,tj->ti", quaternion_matrices(Q), world)
    zero = np.zeros((3000, 3))
    return ImuReadings("thigh", TIMES, zero, zero, local, 100.0)


def test_an_even_field_is_not_accused():
    assert field_remarks(sensor(), Q) == ()
    none = ImuReadings("thigh", TIMES, np.zeros((3000, 3)), np.zeros((3000, 3)), None, 100.0)
    assert field_remarks(none, Q) == ()


def test_a_magnet_is_told_with_its_time_and_size():
    (told,) = field_remarks(sensor([0.0, 0.0, -30.0]), Q)
    assert told.startswith("sensor thigh") and "10 to 15 s" in told and "17 %" in told
    size, dip = size_and_dip(sensor().magnetic_field, Q)
    assert abs(np.median(size) - np.linalg.norm(FIELD)) < 0.2
    assert abs(np.median(dip) - np.arctan2(-39.0, 24.0)) < 0.01
