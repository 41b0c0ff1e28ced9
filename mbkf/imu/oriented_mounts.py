"""Mounts of segments' own frames, whose orientations another system states in one world.

Such a system has calibrated its wearer: x forward, y left, z up in the neutral posture, so that R₀ = I. Where the
standing posture was measured, its segments R_s are the better reference: R₀ = R_sᵀ R, with R the stated orientations
then, turned so that the pelvis faces the same way.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.imu.frames import matrix_quaternion
from mbkf.imu.heading import turned
from mbkf.imu.placement import usual_place
from mbkf.imu.sensor_to_segment import alignments
from mbkf.imu.worn_mounts import MountSettings, SensorMounts
from mbkf.io.imu.mount import ImuMount
from mbkf.model.human import HumanModel
from mbkf.numerics.cardan import quaternion_matrices


def facing_of(orientation: Array) -> float:
    """Heading of the x axis of an orientation (4,) in its world, rad."""
    forward = quaternion_matrices(orientation)[:, 0]
    return float(np.arctan2(forward[1], forward[0]))


def oriented_mounts(
    model: HumanModel,
    names: Sequence[str],
    segments: Sequence[str],
    standing: Array,
    posture: Array | None,
    settings: MountSettings,
) -> SensorMounts:
    """Mounts of segments' own frames, which lie in the joints at the segments' upper ends.

    Args:
        model: The body.
        names: (S,) names of the sensors.
        segments: (S,) segments that carry them, the root's first.
        standing: (S, 4) orientations while the person stands, of a world in which the first one's x axis faces x.
        posture: (nq,) posture while standing where it was measured.
        settings: How well this is known.
    """
    s, aligned = settings, np.tile([0.0, 0.0, 0.0, 1.0], (len(segments), 1))
    sd = float(np.hypot(s.tilt_sd_rad, s.posture_sd_rad))
    if posture is not None:
        rotations, _ = model.placements(posture)
        rest = matrix_quaternion(np.array([rotations[model.joint(name).joint_id] for name in segments]))
        rest = turned(rest, np.full(len(segments), -facing_of(rest[0])))
        aligned, sd = alignments(standing, rest, 0.0), s.tilt_sd_rad
    places = [joint_place(model, name) for name in segments]
    mounts = tuple(ImuMount(*one) for one in zip(names, segments, places, aligned, strict=True))
    shape = (len(mounts), 3)
    return SensorMounts(
        mounts, np.full(shape, sd), np.zeros(shape), np.full(len(mounts), s.derived_bias_sd_rad_s)
    )


def joint_place(model: HumanModel, segment: str) -> Array:
    """(3,) place of the joint above a segment in the segment's axes, m.

    It is the middle of the hips for the pelvis, and the chest's height for the torso, whose lower parts other systems
    take for segments of their own; the origin for all others.

    Args:
        model: The body.
        segment: Name of the segment.
    """
    if segment == model.roles.root:
        rotations, places = model.placements(model.neutral())
        root = model.root.joint_id
        hips = np.mean([places[model.joint(pair[0]).joint_id] for pair in model.roles.knees], axis=0)
        return np.asarray(rotations[root].T @ (hips - places[root]))
    if segment == "torso":
        return usual_place(model, segment) * np.array([0.0, 0.0, 1.0])
    return np.zeros(3)
