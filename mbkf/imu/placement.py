"""Where people wear eight sensors: pelvis, chest, thighs, shanks and feet, as typical mounts on a body."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.imu.frames import exponential, matrix_quaternion, multiply
from mbkf.io.imu.mount import ImuMount
from mbkf.model.body import Body


def _strapped(out: tuple[float, float, float]) -> Array:
    """(3, 3) rotation sensor → segment of a box strapped flat to a limb: x up the limb, z away from the body."""
    up, away = np.array([0.0, 0.0, 1.0]), np.array(out)
    return np.column_stack([up, np.cross(away, up), away])


_PLACES: dict[str, tuple[tuple[float, float, float], Array]] = {
    "pelvis": ((-0.11, 0.0, -0.06), _strapped((-1.0, 0.0, 0.0))),
    "torso": ((0.11, 0.0, 0.22), _strapped((1.0, 0.0, 0.0))),
    "right_thigh": ((0.0, -0.08, -0.22), _strapped((0.0, -1.0, 0.0))),
    "left_thigh": ((0.0, 0.08, -0.22), _strapped((0.0, 1.0, 0.0))),
    "right_shank": ((0.0, -0.05, -0.20), _strapped((0.0, -1.0, 0.0))),
    "left_shank": ((0.0, 0.05, -0.20), _strapped((0.0, 1.0, 0.0))),
    "right_foot": ((0.08, 0.0, -0.02), np.eye(3)),
    "left_foot": ((0.08, 0.0, -0.02), np.eye(3)),
}
"""Per segment the place in the reference body, m, and the rotation sensor → segment."""

EIGHT = tuple(_PLACES)
"""Segments that the eight sensors sit on."""


def typical_mounts(
    model: Body,
    segments: tuple[str, ...] = EIGHT,
    seed: int | None = None,
    turn_sd_rad: float = 0.15,
    place_sd_m: float = 0.015,
) -> tuple[ImuMount, ...]:
    """Mounts named after their segments, on a scaled body.

    Args:
        model: The body.
        segments: Which of :data:`EIGHT`.
        seed: Of the random error of each placement; None: exact placement.
        turn_sd_rad: Spread of its rotation, per axis.
        place_sd_m: Spread of its place, per axis.

    Raises:
        InvalidInput: A segment has no usual place for a sensor.
    """
    rng = None if seed is None else np.random.default_rng([seed, 7])
    mounts = []
    for segment in segments:
        if segment not in _PLACES:
            raise InvalidInput(f"no usual place for a sensor on '{segment}'; known are {', '.join(_PLACES)}")
        place, rotation = _PLACES[segment]
        position = model.axis_scale(model.description.segment(segment)) * np.array(place)
        mount = ImuMount(segment, segment, position, matrix_quaternion(rotation))
        if rng is not None:
            turn = exponential(rng.normal(0.0, turn_sd_rad, 3))
            mount = replace(
                mount,
                position_m=position + rng.normal(0.0, place_sd_m, 3),
                rotation=multiply(turn, mount.rotation),
            )
        mounts.append(mount)
    return tuple(mounts)


def usual_place(model: Body, segment: str) -> Array:
    """(3,) where a sensor usually sits on a segment, m; its centre of mass where no custom is known."""
    description = model.description.segment(segment)
    place = np.array(_PLACES[segment][0]) if segment in _PLACES else description.com_m
    return model.axis_scale(description) * place
