"""The first posture of a body that inertial sensors alone show, and how well it is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from mbkf.conventions import Array
from mbkf.filters.kinematic.plant import KinematicState
from mbkf.model.human import HumanModel
from mbkf.sensors.contact.feet import FeetOnBody


@dataclass(frozen=True)
class StartSettings:
    """Spread of the first posture.

    Attributes:
        tilt_sd_rad, heading_sd_rad: Spread of a segment's tilt and heading, the root's heading excepted: it is where
            the laboratory's x axis points.
        joint_sd_rad: Spread of joints between sensors that the two do not observe.
        place_sd_m: Spread of the root's place.
        rate_sd_rad_s, speed_sd_m_s: Spread of joints' and the root's velocity in a start in motion.
        still_rate_sd_rad_s, still_speed_sd_m_s: The same while the person stands.
    """

    tilt_sd_rad: float = 0.035
    heading_sd_rad: float = 0.14
    joint_sd_rad: float = 0.35
    place_sd_m: float = 0.01
    rate_sd_rad_s: float = 1.0
    speed_sd_m_s: float = 0.7
    still_rate_sd_rad_s: float = 0.1
    still_speed_sd_m_s: float = 0.05


ROOT_HEADING_SD_RAD = 0.002
"""The heading of the first segment, usually the root, is known by definition."""


def first_posture(
    model: HumanModel,
    segments: Sequence[str],
    course: Array,
    dt_s: float,
    standing: bool,
    settings: StartSettings = StartSettings(),
) -> KinematicState:
    """The posture of a first guess, its root over the floor's origin, its lower foot on the floor and at rest.

    Args:
        model: The body.
        segments: Segments that carry sensors.
        course: (2, nq) configurations of the first two frames by the sensors' orientations, at the origin.
        dt_s: Time between them.
        standing: Whether the person stands still.
        settings: How well this is known.
    """
    s, q = settings, course[0].copy()
    v = np.zeros(model.nv) if standing else model.difference(course[0], course[1]) / dt_s
    v[:3] = 0.0
    at = FeetOnBody(model).at(q, v)
    ends = [(foot, point) for foot in (0, 1) for point in at.soles[foot]]
    foot, low = min(ends, key=lambda end: end[1][2])
    q[2] -= low[2]
    rotations, _ = model.placements(q)
    v[:3] = -rotations[model.root.joint_id].T @ np.array(at.velocity(foot, low))
    sd = np.full(model.nv, s.still_rate_sd_rad_s if standing else s.rate_sd_rad_s)
    sd[:3] = s.still_speed_sd_m_s if standing else s.speed_sd_m_s
    covariance = block_diag(_posture_covariance(model, segments, q, s), np.diag(sd**2))
    return KinematicState(q, v, covariance)


def _posture_covariance(model: HumanModel, segments: Sequence[str], q: Array, s: StartSettings) -> Array:
    """(nv, nv) of a configuration of which each sensor's segment is known by tilt and heading.

    Args:
        model: The body.
        segments: They.
        q: (nq,) configuration.
        s: Spreads.
    """
    sd = np.full(model.nv, s.joint_sd_rad)
    sd[:3] = s.place_sd_m
    information = np.diag(sd**-2.0)
    _, spatial = model.frames_and_jacobian(q)
    for name in segments:
        turns = spatial[3:] * model.supports[model.joint(name).joint_id]
        heading = ROOT_HEADING_SD_RAD if name == segments[0] else s.heading_sd_rad
        rows = turns / np.array([s.tilt_sd_rad, s.tilt_sd_rad, heading])[:, None]
        information += rows.T @ rows
    return np.asarray(np.linalg.inv(information))
