"""Cases of tests/test_jacobians.py: inertial sensors on the body, and what they add to the dynamic filter."""

import numpy as np

from mbkf.io.imu.mount import ImuMount
from mbkf.sensors.inertial import InertialSensors, InertialSettings
from mbkf.sensors.inertial_sensor import InertialSensor
from tests.derivatives import checks, named, slope
from tests.motions import central_difference, moderate_pose, random_model


def worn(rng):
    """A body, two sensors anywhere on it, and a state."""
    model = random_model(rng)
    turns = rng.normal(size=(2, 4))
    mounts = [
        ImuMount(name, name, rng.normal(0.0, 0.1, 3), turn)
        for name, turn in zip(("torso", "left_shank"), turns, strict=True)
    ]
    q = moderate_pose(model, rng)
    v, a = rng.normal(0.0, 2.0, model.nv), rng.normal(0.0, 10.0, model.nv)
    return model, InertialSensor(model, mounts), q, v, a


@checks(
    "sensors.inertial_sensor.InertialReading.by_q",
    "sensors.inertial_sensor.InertialReading.by_v",
    "sensors.inertial_sensor.InertialReading.by_a",
    "sensors.inertial_sensor.InertialReading.jacobian",
    "sensors.inertial_sensor.InertialSensor.reading",
    tolerance=1e-6,
)
def inertial_readings(rng):
    model, sensor, q, v, a = worn(rng)
    stated = sensor.reading(q, v, a)
    by_q = central_difference(model, lambda at: sensor.values(at, v, a).ravel(), q).reshape(2, 6, -1)
    by_v = slope(lambda at: sensor.values(q, at, a), v)
    by_a = slope(lambda at: sensor.values(q, v, at), a)
    whole = [
        np.concatenate(three, axis=2)
        for three in ((stated.by_q, stated.by_v, stated.by_a), (by_q, by_v, by_a))
    ]
    return named("sensors.inertial_sensor", ("InertialSensor.reading", *whole)) | named(
        "sensors.inertial_sensor.InertialReading",
        ("by_q", stated.by_q, by_q),
        ("by_v", stated.by_v, by_v),
        ("by_a", stated.by_a, by_a),
        ("jacobian", stated.jacobian, np.stack([by_q, by_v, by_a], axis=2)),
    )


@checks("sensors.inertial.InertialSensors.rows", tolerance=1e-6)
def inertial_rows(rng):
    model, sensor, q, v, a = worn(rng)
    block = InertialSensors(sensor, InertialSettings(0.1, 0.7))
    measured = rng.normal(size=(2, 6))
    rows, _ = block.rows(q, v, a, measured)
    numeric = np.hstack(
        [
            central_difference(model, lambda at: -block.rows(at, v, a, measured)[1], q),
            slope(lambda at: -block.rows(q, at, a, measured)[1], v),
            slope(lambda at: -block.rows(q, v, at, measured)[1], a),
        ]
    )
    return named("sensors.inertial", ("InertialSensors.rows", rows, numeric))
