"""Mounts of sensors on their segments without magnetometers: tilt from standing still, heading from swinging legs.

While a person stands in a known posture, gravity shows two of the three angles of each sensor against its segment. The
third, about the vertical, is taken to be as people usually strap sensors on, and is corrected where the segment turns
mostly about its side-to-side axis: legs that walk, sit down or swing.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.imu.frames import matrix_quaternion
from mbkf.imu.placement import EIGHT, typical_mounts, usual_place
from mbkf.io.imu.mount import ImuMount
from mbkf.io.imu.readings import ImuReadings
from mbkf.model.body import Body
from mbkf.numerics.cardan import quaternion_matrices

LEAST_SWING_RAD_S = 0.5
"""A segment that turns less than this (root mean square) does not show its side-to-side axis."""

LEAST_LEVEL = 0.3
"""Share of a side-to-side axis that is level while standing; a steeper one has no heading."""


@dataclass(frozen=True)
class MountSettings:
    """Spread of mounts.

    Attributes:
        custom_sd_rad: Spread of headings of sensors about how they are usually strapped on.
        swing_sd_rad: Spread of a side-to-side axis that a swinging leg shows about the segment's own.
        foot_swing_sd_rad: The same of a foot, which points outwards.
        tilt_sd_rad: Spread of a tilt by gravity in a posture that is known.
        posture_sd_rad: Further spread where the posture while standing is only taken to be the neutral one.
        unusual_heading_rad: A heading by swinging that is further from the usual one is reported.
        sway_rad: How far a segment turns to and fro while the person stands still: over a standing of length T a
            gyroscope's mean reading is its bias to within this over T.
        usual_bias_rad_s: Spread of biases before anything is read.
        derived_bias_sd_rad_s: Spread of the bias of an angular velocity that follows from orientations.
    """

    custom_sd_rad: float = 0.17
    swing_sd_rad: float = 0.10
    foot_swing_sd_rad: float = 0.15
    tilt_sd_rad: float = 0.026
    posture_sd_rad: float = 0.07
    unusual_heading_rad: float = 0.8
    sway_rad: float = 0.005
    usual_bias_rad_s: float = 0.02
    derived_bias_sd_rad_s: float = 1e-4


@dataclass(frozen=True)
class SensorMounts:
    """Calibrated sensors.

    Attributes:
        mounts: Mount of each.
        turn_sd_rad: (S, 3) spread of its turn about its segment's axes.
        bias_rad_s: (S, 3) gyroscope's reading at rest.
        bias_sd_rad_s: (S,) spread of each component of it.
        remarks: Sensors that are mounted in an unusual way.
    """

    mounts: tuple[ImuMount, ...]
    turn_sd_rad: Array
    bias_rad_s: Array
    bias_sd_rad_s: Array
    remarks: tuple[str, ...] = ()


def worn_mounts(
    model: Body,
    segments: Sequence[str],
    standing: Sequence[ImuReadings],
    moving: Sequence[ImuReadings],
    posture: Array,
    posture_known: bool,
    settings: MountSettings = MountSettings(),
    turned: Collection[str] = (),
    derived: Collection[str] = (),
) -> SensorMounts:
    """Mounts and biases from standing still and from the movement.

    Args:
        model: The body.
        segments: S segments that carry them.
        standing: The sensors' readings while the person stands still.
        moving: Their readings during the movement.
        posture: (nq,) posture while standing.
        posture_known: Whether it was measured; otherwise it is usual.
        settings: How well this is known.
        turned: Segments whose sensors are strapped on the other way round than usual.
        derived: Segments whose sensors' angular velocities follow from orientations, and have no bias.
    """
    s, rotations = settings, model.placements(posture)[0]
    custom = {m.segment: m for m in typical_mounts(model, tuple(n for n in segments if n in EIGHT))}
    tilt_sd = s.tilt_sd_rad if posture_known else float(np.hypot(s.tilt_sd_rad, s.posture_sd_rad))
    mounts, spreads, biases, bias_sds, remarks = [], [], [], [], []
    for segment, still, one in zip(segments, standing, moving, strict=True):
        up = rotations[model.joint(segment).joint_id][2]
        felt = np.nanmean(still.specific_force_mps2, axis=0)
        bias, bias_sd = (np.zeros(3), s.derived_bias_sd_rad_s) if segment in derived else _bias(still, s)
        usual = custom.get(segment)
        R = np.eye(3) if usual is None else quaternion_matrices(usual.rotation)
        R = upright(R, felt, up)
        turn, turn_sd = _by_swing(R, one.angular_velocity_rad_s - bias, up, _swing_sd(model, segment, s), s)
        if abs(turn) > s.unusual_heading_rad:
            remarks.append(
                f"sensor {one.name} sits {abs(np.degrees(turn)):.0f} deg about the {segment}'s length from where it is "
                "usually strapped on, as the segment's swinging shows; check which sensor is which"
            )
        R = _rotation((turn + np.pi * (segment in turned)) * up) @ R
        mounts.append(ImuMount(one.name, segment, usual_place(model, segment), matrix_quaternion(R)))
        spreads.append(np.sqrt((up * turn_sd) ** 2 + (1.0 - up**2) * tilt_sd**2))
        biases.append(bias)
        bias_sds.append(bias_sd)
    return SensorMounts(
        tuple(mounts), np.array(spreads), np.array(biases), np.array(bias_sds), tuple(remarks)
    )


def upright(R: Array, felt: Array, up: Array) -> Array:
    """(3, 3) the rotation sensor → segment nearest to R that takes the specific force at rest to the vertical.

    Args:
        R: (3, 3) as it usually is.
        felt: (3,) specific force at rest, sensor axes.
        up: (3,) the vertical in segment axes.
    """
    here = R @ (felt / np.linalg.norm(felt))
    axis = np.cross(here, up)
    size = np.linalg.norm(axis)
    if size < 1e-12:
        return R if here @ up > 0.0 else _rotation(np.pi * _across(up)) @ R
    angle = np.arctan2(size, here @ up)
    return np.asarray(_rotation(axis / size * angle) @ R)


def _rotation(vector_rad: Array) -> Array:
    """(3, 3) the turn about a vector by its length."""
    # loads slowly, and every trial imports this file
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_rotvec(vector_rad).as_matrix())


def _bias(still: ImuReadings, settings: MountSettings) -> tuple[Array, float]:
    """(3,) a gyroscope's bias by its mean reading while standing, and its spread: both by how long that lasted.

    Args:
        still: The readings then.
        settings: Sway and usual biases.
    """
    read = np.nanmean(still.angular_velocity_rad_s, axis=0)
    sway = (settings.sway_rad * still.rate_hz / still.samples) ** 2
    usual = settings.usual_bias_rad_s**2
    return read * usual / (usual + sway), float(np.sqrt(usual * sway / (usual + sway)))


def _swing_sd(model: Body, segment: str, settings: MountSettings) -> float | None:
    """Spread of the heading by swinging; None: the segment does not swing."""
    if segment in model.roles.feet:
        return settings.foot_swing_sd_rad
    if segment in {name for pair in model.roles.knees for name in pair}:
        return settings.swing_sd_rad
    return None


def _by_swing(
    R: Array, rates: Array, up: Array, swing_sd: float | None, settings: MountSettings
) -> tuple[float, float]:
    """Turn about the vertical, rad, that makes a segment swing about its side-to-side axis, and its spread.

    Custom and swinging count by their spreads where they agree; where they do not, swinging alone does.

    Args:
        R: (3, 3) sensor → segment as usual.
        rates: (T, 3) angular velocities without bias, sensor axes.
        up: (3,) the vertical in segment axes while standing.
        swing_sd: Spread of the heading by swinging; None: nothing swings.
        settings: Spread of custom.
    """
    custom_sd = settings.custom_sd_rad
    known = rates[np.isfinite(rates).all(axis=1)] @ R.T
    if swing_sd is None or len(known) < 10:
        return 0.0, custom_sd
    values, vectors = np.linalg.eigh(known.T @ known / len(known))
    axis = vectors[:, -1] - up * (vectors[:, -1] @ up)
    side = np.array([0.0, 1.0, 0.0]) - up * up[1]
    size = np.linalg.norm(axis)
    if values[-1] < LEAST_SWING_RAD_S**2 or values[-1] < 2.0 * values[-2] or size < LEAST_LEVEL:
        return 0.0, custom_sd
    axis *= np.sign(axis @ side) or 1.0
    turn = float(np.arctan2(np.cross(axis, side) @ up, axis @ side))
    if abs(turn) > settings.unusual_heading_rad:
        return turn, swing_sd
    share = custom_sd**2 / (custom_sd**2 + swing_sd**2)
    return share * turn, swing_sd * share**0.5


def _across(axis: Array) -> Array:
    """(3,) a unit vector at right angles to another."""
    other = np.eye(3)[np.argmin(np.abs(axis))]
    found = np.cross(axis, other)
    return np.asarray(found / np.linalg.norm(found))
