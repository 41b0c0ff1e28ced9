"""Hip centres and knee axes against truth, in the world, with the scaled body laid into the true markers of a walk."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from benchmarks.better_body.persons import Trial, scaled, trial
from benchmarks.checks import Check, information
from benchmarks.references import rms
from mbkf.conventions import Array
from mbkf.io.subject import Subject
from mbkf.model.body import Body
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import segment_by_segment
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.synthesis.person import body_of

EVERY, NOISE_M, ROUNDS = 20, 0.005, 30
SIDES = ("right", "left")


def centre_rows(motion: str, seeds: Sequence[int], *, centre_mm: float, axis_deg: float) -> list[Check]:
    """The rows of bodies scaled from standing and a trial of one motion, judged on the walk.

    Args:
        motion: Name of the motion they are scaled from.
        seeds: Persons and trials.
        centre_mm: Bound of the hip centre.
        axis_deg: Bound of the knee axis.
    """
    static, both = [], []
    for seed in seeds:
        walk = trial("walk", seed)
        static.append(misplaced(walk, scaled(walk, moving=False)))
        moved = replace(walk, moving=trial(motion, seed).moving)
        both.append(misplaced(walk, scaled(moved, moving=True)))
    name = f"static and {motion}, {len(seeds)} persons"
    before, after = (np.sqrt(np.mean(np.square(one), axis=0)) for one in (static, both))
    return [
        Check(f"{name}: hip centre, RMS", after[0], centre_mm, "<=", "mm"),
        Check(f"{name}: knee axis, RMS", after[1], axis_deg, "<=", "°"),
        information(f"{name}: hip centre, static alone", before[0], "mm"),
        information(f"{name}: knee axis, static alone", before[1], "°"),
        *(
            information(f"{name}: {joint} centre (static alone {before[k]:.1f})", after[k], "mm")
            for k, joint in ((2, "knee"), (3, "ankle"), (4, "shoulder"), (5, "elbow"))
        ),
    ]


def misplaced(one: Trial, body: Subject) -> list[float]:
    """RMS of hip centre (mm), knee axis (degrees), and centres of knee, ankle, shoulder and elbow (mm)."""
    model, true = body_of(body), body_of(one.person)
    order = [one.truth.marker_names.index(marker.name) for marker in body.markers]
    sensor = MarkerSensor(
        model, [m.segment for m in body.markers], np.array([m.position_m for m in body.markers])
    )
    frames = range(0, len(one.truth.q), EVERY)
    poses = laid_into(sensor, one.truth.markers_m[frames][:, order])
    pairs = [(_placed(model, q), _placed(true, one.truth.q[t])) for q, t in zip(poses, frames, strict=True)]
    centres = np.array([found[0] - truth[0] for found, truth in pairs])
    turned = [np.cross(found[1], truth[1]) for found, truth in pairs]
    sine = np.linalg.norm(turned, axis=2)
    away_mm = 1e3 * np.sqrt((np.linalg.norm(centres, axis=3) ** 2).mean(axis=(0, 2)))
    return [
        float(away_mm[0]),
        float(np.rad2deg(rms(np.arcsin(np.clip(sine, 0.0, 1.0))))),
        *map(float, away_mm[1:]),
    ]


def _placed(model: Body, q: Array) -> tuple[Array, Array]:
    """(5, 2, 3) centres of hips, knees, ankles, shoulders and elbows, and (2, 3) flexion axes of the knees."""
    rotations, origins = model.placements(q)
    joints = [
        [model.joint(f"{side}_{segment}").joint_id for side in SIDES]
        for segment in ("thigh", "shank", "foot", "upper_arm", "forearm")
    ]
    return origins[np.array(joints)], rotations[joints[0]][:, :, 1]


def laid_into(sensor: MarkerSensor, markers_m: Array) -> Array:
    """(N, nq) poses of a body in markers (N, M, 3), with the weight that posture has in a filter."""
    posture = PostureSensor(sensor.model)
    poses, q = [], segment_by_segment(sensor, markers_m[0])
    for frame in markers_m:
        for _ in range(ROUNDS):
            reading, usual = sensor.reading(q), posture.reading(q)
            error = (frame - reading.positions_m).ravel() / NOISE_M
            jacobian = reading.jacobian.reshape(len(error), -1) / NOISE_M
            pull = usual.jacobian / posture.sd[:, None]
            right = jacobian.T @ error - pull.T @ (usual.deviation / posture.sd)
            step = np.linalg.solve(jacobian.T @ jacobian + pull.T @ pull, right)
            q = sensor.model.integrate(q, step)
            if np.abs(step).max() < 1e-4:
                break
        poses.append(q)
    return np.array(poses)
