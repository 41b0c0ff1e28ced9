"""The pose that fits one frame of markers: by segment first, then all at once (thesis eq. 4.1, positions only)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import SegmentJoint
from mbkf.numerics.elimination import Border
from mbkf.numerics.levenberg_marquardt import ArrowEquations, minimise
from mbkf.numerics.rotations import nearest_rotations, quaternion_of
from mbkf.sensors.marker_sensor import MarkerInformation, MarkerSensor
from mbkf.sensors.posture import prior_information
from mbkf.sensors.posture_sensor import PostureSensor

_TRUNK_WEIGHT = 0.05
_NEUTRAL_PULL = 2e-3

_STRAY_M, _STRAY_SHARE = 0.06, 0.25


@dataclass(frozen=True)
class PoseFit:
    """A fitted pose.

    Attributes:
        q: (nq,) configuration.
        rms_m: RMS distance of the markers used, m.
        information: (nv, nv) on q in its tangent space.
        converged: True if the iteration settled.
    """

    q: Array
    rms_m: float
    information: Array
    converged: bool

    @cached_property
    def covariance(self) -> Array:
        """(nv, nv) of q in its tangent space; built on demand."""
        return np.asarray(np.linalg.inv(self.information))


def segment_by_segment(sensor: MarkerSensor, measured_m: Array) -> Array:
    """A first pose from the markers of each segment in turn (Wahba's problem, SVD solution of Markley 1988).

    Each segment turns about its proximal joint so that its markers point where they were measured; a small weight of
    the parent's orientation determines the rest.

    Args:
        sensor: The markers on the body.
        measured_m: (…, M, 3) measured positions of one frame or of many, NaN where missing.

    Returns:
        (…, nq) configurations.
    """
    frames = measured_m.reshape(-1, *measured_m.shape[-2:])
    poses = np.tile(sensor.model.neutral(), (len(frames), 1))
    seen = np.asarray(~np.isnan(frames).any(axis=2))
    names = np.array(sensor.segments)
    weight = np.where(names == sensor.model.roles.root, 1.0, _TRUNK_WEIGHT) * seen
    some = np.flatnonzero(weight.sum(axis=1))
    if len(some):
        target = np.where(seen[some, :, None], frames[some], 0.0)
        poses[some] = _with_limbs(sensor, target, seen[some], _with_root(sensor, target, weight[some]))
    return poses.reshape(*measured_m.shape[:-2], sensor.model.nq)


def _with_root(sensor: MarkerSensor, target_m: Array, weight: Array) -> Array:
    """(N, nq) poses whose joints are neutral, placed by all markers.

    Args:
        sensor: The markers on the body.
        target_m: (N, M, 3) measured positions, 0 where missing.
        weight: (N, M) of each, 0 where missing.
    """
    neutral = sensor.model.neutral()
    placed = sensor.positions(neutral)
    counted, whole = weight[:, :, None], weight.sum(axis=1)[:, None]
    centre_from, centre_to = (counted * placed).sum(axis=1) / whole, (counted * target_m).sum(axis=1) / whole
    away = counted * (target_m - centre_to[:, None])
    attitude = np.swapaxes(away, 1, 2) @ (placed - centre_from[:, None])
    poses, root = np.tile(neutral, (len(target_m), 1)), sensor.model.root.q.start
    turns = nearest_rotations(attitude + 1e-9 * np.eye(3))
    poses[:, root : root + 3] = centre_to - (turns @ centre_from[:, :, None])[..., 0]
    poses[:, root + 3 : root + 7] = quaternion_of(turns)
    return poses


def joint_by_joint(
    sensor: MarkerSensor, measured_m: Array, q: Array, joints: Sequence[SegmentJoint]
) -> Array:
    """(nq,) the pose q with the ball joints among ``joints`` turned by the markers of their segments, one by one.

    Args:
        sensor: The markers on the body.
        measured_m: (M, 3) measured positions of a frame, NaN where missing.
        q: (nq,) the pose.
        joints: Joints of a limb, the first one first.
    """
    pose, seen = q.copy(), np.asarray(~np.isnan(measured_m).any(axis=1))
    for joint in joints:
        pose[joint.q] = sensor.model.neutral()[joint.q]
    found = _with_limbs(
        sensor, np.where(seen[:, None], measured_m, 0.0)[None], seen[None], pose[None], joints
    )
    return np.asarray(found[0])


def _with_limbs(
    sensor: MarkerSensor,
    target_m: Array,
    seen: BoolArray,
    poses: Array,
    among: Iterable[SegmentJoint] | None = None,
) -> Array:
    """The poses (N, nq) with each ball joint turned in place, from the root on.

    Args:
        sensor: The markers on the body.
        target_m: (N, M, 3) measured positions.
        seen: (N, M) measured markers.
        poses: (N, nq) poses whose joints are neutral.
        among: Joints that are turned; None for all.
    """
    model, names = sensor.model, np.array(sensor.segments)
    every = model.joints.values() if among is None else among
    joints = [joint for joint in every if joint.kind == "spherical"]
    placed = [model.placements(q) for q in poses]
    axes, origins = np.array([one for one, _ in placed]), np.array([one for _, one in placed])
    turns = []
    for joint in joints:
        own = np.flatnonzero(names == joint.segment)
        parents, origin = axes[:, joint.joint_id], origins[:, joint.joint_id]
        arms = np.where(seen[:, own, None], target_m[:, own] - origin[:, None], 0.0)
        attitude = np.swapaxes(arms, 1, 2) @ sensor.local_m[own] + _NEUTRAL_PULL * parents
        turned = nearest_rotations(attitude)
        turns.append(np.swapaxes(parents, 1, 2) @ turned)
        beyond = model.supports[:, joint.v.start]
        turn = (turned @ np.swapaxes(parents, 1, 2))[:, None]
        axes[:, beyond] = turn @ axes[:, beyond]
        away = origins[:, beyond] - origin[:, None]
        origins[:, beyond] = origin[:, None] + (turn @ away[..., None])[..., 0]
    for joint, found in zip(joints, quaternion_of(np.reshape(turns, (-1, len(poses), 3, 3))), strict=True):
        poses[:, joint.q] = found
    return poses


def fit_pose(
    sensor: MarkerSensor,
    posture: PostureSensor,
    measured_m: Array,
    noise_m: Array,
    start: Array,
    max_iterations: int = 30,
) -> PoseFit:
    """Most likely pose given one frame of markers and the weak posture prior.

    Args:
        sensor: The markers on the body.
        posture: The posture prior.
        measured_m: (M, 3) measured positions, NaN where missing.
        noise_m: (M,) marker noise, m.
        start: (nq,) first guess.
        max_iterations: Largest number of iterations.
    """
    seen = np.asarray(~np.isnan(measured_m).any(axis=1))
    target, noise = measured_m[seen], noise_m[seen, None]
    nv = sensor.model.nv
    nothing = Border.plain(np.zeros((1, nv, 0)))
    markers, weights = MarkerInformation(sensor, noise_m), posture.weights(1.0, np.zeros(nv, dtype=bool))

    def weighed(positions_m: Array, deviation: Array) -> float:
        errors, pull = (positions_m[seen] - target) / noise, deviation * weights
        return float((errors**2).sum() + pull @ pull)

    def cost(q: Array) -> float:
        return weighed(sensor.positions(q), posture.deviation(q)[0])

    def linearise(q: Array) -> ArrowEquations:
        reading, (deviation, turning) = sensor.reading(q), posture.deviation(q)
        known = markers.at(reading, measured_m - reading.positions_m, seen)
        known += prior_information(posture, deviation, turning, weights)
        hessian, gradient = known.matrix[None] + 1e-9 * np.eye(nv), -known.vector[None]
        found = weighed(reading.positions_m, deviation)
        return ArrowEquations(hessian, nothing, np.zeros((0, 0)), gradient, np.zeros(0), found)

    solution = minimise(
        start,
        linearise,
        cost,
        lambda q, own, _: sensor.model.integrate(q, own[0]),
        tolerance=1e-4,
        max_iterations=max_iterations,
    )
    q = solution.state
    distance = np.linalg.norm(sensor.positions(q)[seen] - target, axis=1)
    rms = float(np.sqrt((distance**2).mean())) if seen.any() else np.inf
    return PoseFit(q, rms, solution.equations.frames[0], solution.converged)


def fit_most_markers(
    sensor: MarkerSensor, posture: PostureSensor, measured_m: Array, noise_m: Array, start: Array
) -> PoseFit:
    """:func:`fit_pose` without the markers that lie far from the body, at most a quarter of them, the worst first.

    Args:
        sensor: The markers on the body.
        posture: The posture prior.
        measured_m: (M, 3) measured positions, NaN where missing.
        noise_m: (M,) marker noise, m.
        start: (nq,) first guess.
    """
    kept = measured_m.copy()
    fit = fit_pose(sensor, posture, kept, noise_m, start)
    for _ in range(int(_STRAY_SHARE * np.count_nonzero(~np.isnan(measured_m[:, 0])))):
        distance = np.linalg.norm(sensor.positions(fit.q) - kept, axis=1)
        if not (distance > _STRAY_M).any():
            break
        kept[np.nanargmax(distance)] = np.nan
        fit = fit_pose(sensor, posture, kept, noise_m, fit.q)
    return fit
