"""Virtual sensors on people who walk, sit down and stand, as the source recorded its own: 60 Hz, thigh and foot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from mbkf.conventions import Array
from mbkf.imu.orientation import Orientation, OrientSettings, orientations
from mbkf.imu.orientation_error import error_angles
from mbkf.imu.placement import EIGHT, typical_mounts
from mbkf.imu.virtual import ImuErrors, virtual_imus
from mbkf.io.imu.readings import ImuReadings
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.person import body_of, synthesise_subject

RATE_HZ = 60.0
SECONDS = 10.0
WALKING, SITTING, STANDING = "walking", "sitting down", "standing"
MOVEMENTS = {WALKING: "walk", SITTING: "sit_to_stand", STANDING: "stand"}
"""Movements of the source, and ours that stand for them: sitting down is the second half of standing up and down."""

THIGH, FOOT = "right_thigh", "right_foot"
CHOSEN_ON, SHOWN_ON = (0,), (1, 2)
"""Persons by whom gains were chosen, and others by whom results are shown."""

WORSE = 4.0
"""Factor by which all errors of the sensors grow where robustness is asked for."""


@dataclass(frozen=True)
class Scene:
    """A movement of one person: ``readings`` of its sensors hold their true orientations, in NWU."""

    person: int
    movement: str
    readings: tuple[ImuReadings, ...]

    def sensor(self, name: str) -> ImuReadings:
        """The sensor of a segment."""
        return next(one for one in self.readings if one.name == name)


def worse_errors() -> ImuErrors:
    """A unit whose errors are :data:`WORSE` times those of the usual one."""
    usual = ImuErrors()
    ranges = {"gyro_range_rad_s", "accelerometer_range_mps2"}
    return ImuErrors(
        **{name: value if name in ranges else WORSE * value for name, value in vars(usual).items()}
    )


@cache
def scene(
    person: int, movement: str, worse: bool = False, segments: tuple[str, ...] = (THIGH, FOOT)
) -> Scene:
    """A movement of ten seconds.

    Args:
        person: Number of the person.
        movement: One of :data:`MOVEMENTS`.
        worse: Whether the sensors' errors are enlarged.
        segments: Segments that carry a sensor.
    """
    model = body_of(synthesise_subject(person))
    motion = synthesise_motion(model, MOVEMENTS[movement], SECONDS, 2.0 * RATE_HZ, person)
    readings = virtual_imus(
        model,
        motion.times_s,
        motion.q,
        motion.v,
        motion.a,
        typical_mounts(model, segments, seed=person),
        errors=worse_errors() if worse else None,
        seed=person,
        rate_hz=RATE_HZ,
    )
    return Scene(person, movement, readings)


def scenes(
    persons: Sequence[int], movements: Sequence[str] = tuple(MOVEMENTS), worse: bool = False
) -> list[Scene]:
    """Every movement of every person.

    Args:
        persons: Numbers of the persons.
        movements: Names of the movements.
        worse: Whether the sensors' errors are enlarged.
    """
    return [scene(person, movement, worse) for movement in movements for person in persons]


def eight(person: int) -> Scene:
    """A walk with all eight sensors of the source."""
    return scene(person, WALKING, False, EIGHT)


def truth_of(one: ImuReadings) -> Array:
    """(T, 4) true orientations of a sensor."""
    assert one.orientation is not None
    return one.orientation


def filtered(readings: Sequence[ImuReadings], settings: OrientSettings) -> tuple[Orientation, ...]:
    """Orientations of sensors from their true first ones, as the source starts from those of the sensor.

    Args:
        readings: The sensors.
        settings: The filter.
    """
    start = np.array([truth_of(one)[0] for one in readings])
    return orientations(readings, frame="NWU", settings=settings, start=start)


def rms_deg(estimates: Sequence[Array], readings: Sequence[ImuReadings]) -> float:
    """Root mean square of the total error over all samples of all sensors, degrees.

    Args:
        estimates: (T, 4) orientations of each sensor.
        readings: The sensors with their true ones.
    """
    errors = [error_angles(q, truth_of(one))[0] for q, one in zip(estimates, readings, strict=True)]
    return float(np.degrees(np.sqrt(np.mean(np.concatenate(errors) ** 2))))
