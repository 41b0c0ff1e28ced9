"""Virtual sensors on synthetic people who stand and then move: what tests of motion from sensors alone begin with."""

from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from mbkf.imu.placement import typical_mounts
from mbkf.imu.virtual import ImuErrors, virtual_imus
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.person import body_of, synthesise_subject

RATE_HZ = 100.0
ERRORS = ImuErrors(gyro_bias_sd_rad_s=np.radians(0.5))


class Worn(NamedTuple):
    """A person, the true motion, the standing posture, and what the sensors read in both."""

    subject: object
    model: object
    motion: object
    posture: np.ndarray
    standing: tuple
    moving: tuple


@lru_cache(maxsize=4)
def worn(plan="walk", seconds=4.0, seed=0):
    """Eight sensors, put on 5° askew, with biases of 0.5°/s."""
    subject = synthesise_subject(seed)
    model = body_of(subject)
    posture = synthesise_motion(model, "stand", 2.0, RATE_HZ, seed).q[0]
    motion = synthesise_motion(model, plan, seconds, RATE_HZ, seed)
    mounts = typical_mounts(model, seed=seed, turn_sd_rad=np.radians(5.0))
    still = np.zeros((300, model.nv))
    times = np.arange(len(still)) / RATE_HZ
    courses = (times, np.tile(posture, (len(still), 1)), still, still)
    standing, moving = (
        virtual_imus(model, *course, mounts, seed=seed, errors=ERRORS)
        for course in (courses, (motion.times_s, motion.q, motion.v, motion.a))
    )
    return Worn(subject, model, motion, posture, standing, moving)


def exchanged(readings, one, other):
    """The same sensors, two of them under each other's name."""
    names = {one: other, other: one}
    return tuple(replace(sensor, name=names.get(sensor.name, sensor.name)) for sensor in readings)
