"""A true walk as a reconstruction, for tests of what is made of results: no filter runs."""

from dataclasses import replace
from functools import cache

import numpy as np

from mbkf.io.contacts import Source
from mbkf.io.results import Reconstruction
from mbkf.model.clinical import ClinicalAngles, dof_names
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.supports.bearings import BearingParts
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.person import body_of, synthesise_subject
from mbkf.trial.results.supports import pressed_points
from tests.motions import marker_positions

LOST = slice(100, 110)
"""Frames in which the walker's body is not followed."""

RAIL, SEAT = slice(100, 150), slice(60, 80)
"""Frames in which the right hand holds a rail, and in which the pelvis touches a seat."""

PLATE = np.array([[0.6, 0.4, 0.0], [0.0, 0.4, 0.0], [0.0, -0.4, 0.0], [0.6, -0.4, 0.0]])


@cache
def performer(name, seconds, seed):
    """A person, the body, and a true motion."""
    person = synthesise_subject(seed)
    model = body_of(person)
    return person, model, synthesise_motion(model, name, seconds, seed=seed)


def walker():
    """The person, the body, and two and a half seconds of true walking."""
    return performer("walk", 2.5, 5)


def walk():
    """The walk as a dynamic filter would tell it."""
    return recorded("walk", 2.5, 5)


@cache
def recorded(name, seconds, seed):
    """A motion as a dynamic filter would tell it, with standard deviations of 0.02 rad, 3 N m and 5 N."""
    person, model, motion = performer(name, seconds, seed)
    T, M, nv = len(motion.times_s), len(person.markers), model.nv
    clinical = ClinicalAngles(model)
    angles = clinical.angles(motion.q)
    segments = [marker.segment for marker in person.markers]
    sensor = MarkerSensor(model, segments, np.array([marker.position_m for marker in person.markers]))
    markers = marker_positions(sensor, motion.q)
    rng = np.random.default_rng(0)
    per_dof, per_angle = np.ones((T, nv)), np.ones((T, len(clinical.names)))
    force = motion.foot_wrench
    return Reconstruction(
        trial=f"{name} <1>", protocol=person.protocol, filter="dynamic", smoothed=False, version="0", subject=person,
        rate_hz=motion.rate_hz, times_s=motion.times_s, dof_names=dof_names(model), q=motion.q, v=motion.v,
        a=motion.a, tau=motion.tau, sd_q=0.02 * per_dof, sd_v=0.1 * per_dof, sd_tau=3.0 * per_dof,
        coordinate_names=clinical.names, angles=angles, angle_rates=0.0 * per_angle,
        moments=clinical.moments(motion.q, motion.tau, angles), angles_sd=0.02 * per_angle,
        angle_rates_sd=0.1 * per_angle, moments_sd=3.0 * per_angle, singular=np.zeros(angles.shape, bool),
        marker_names=tuple(m.name for m in person.markers),
        measured_m=markers + 0.002 * rng.normal(size=markers.shape), predicted_m=markers,
        hidden=np.zeros((T, M), bool), rejected=np.zeros((T, M), bool), foot_wrench=force,
        foot_cop_m=motion.centre_of_pressure, foot_free_moment_nm=np.zeros((T, 2)),
        residual_force_n=np.full((T, 3), 1.0), residual_moment_nm=np.full((T, 3), 0.5), tracked=np.ones(T, bool),
        support_names=(), support_wrench=np.zeros((T, 0, 6)), support_wrench_sd=np.zeros((T, 0, 6)),
        support_point_m=np.zeros((T, 0, 3)), measured=np.ones(T, bool), valid=np.ones(T, bool),
        foot_source=(force[..., 2] > 0).astype(int), unobserved_dofs=(), nis=np.full(T, 90.0),
        nis_readings=np.full(T, 100),
        step_seconds=np.full(T, 1e-3), warnings=("a remark with <b>markup</b>",),
        settings={"dynamic": {"jerk": 200.0}, "hide": []}, foot_wrench_sd=np.full((T, 2, 6), 5.0),
        foot_contact=np.where(force[..., 2] > 0, Contact.MEASURED, Contact.AIR), plate_corners_m=PLATE[None],
    )  # fmt: skip


@cache
def broken_walk():
    """The walk with a marker unseen, one hidden, one refused, and the body lost for a while."""
    r = walk()
    measured, hidden, rejected = r.measured_m.copy(), r.hidden.copy(), r.rejected.copy()
    measured[20:50, 0] = np.nan
    hidden[30:40, 1] = True
    rejected[60:65, 2] = True
    tracked = r.tracked.copy()
    tracked[LOST] = False
    return replace(r, measured_m=measured, hidden=hidden, rejected=rejected, tracked=tracked)


@cache
def leaning_walk():
    """The walk with a hand on a rail in its middle half second, a seat touched, and a left foot that nothing reads."""
    r, model = walk(), walker()[1]
    names = tuple(model.description.bearings)
    support, parts = np.zeros((r.frames, len(names), 6)), BearingParts(model)
    hand, seat, t = names.index("right_hand"), names.index("pelvis"), np.arange(r.frames)
    support[RAIL, hand, :3] = [40.0, 10.0, 180.0]
    support[SEAT, seat, 2] = 250.0
    at = np.array([parts.at(q, v).points_m for q, v in zip(r.q, r.v, strict=True)])
    support[..., 3:] = np.cross(at, support[..., :3])
    point = np.array([pressed_points(parts, q, wrench) for q, wrench in zip(r.q, support, strict=True)])
    source = np.where((r.foot_source == Source.MEASURED) & (t[:, None] > 150), [1, 3], r.foot_source)
    return replace(
        r, support_names=names, support_wrench=support, support_wrench_sd=np.where(support != 0.0, 20.0, 0.0),
        support_point_m=point, foot_source=source, measured=source[:, 1] != Source.ESTIMATED,
    )  # fmt: skip
