"""Zero-phase inverse dynamics, the offline practice: fit every frame, low-pass at 6 Hz, differentiate twice.

Gaps in the markers are filled with a cubic spline, the pose is fitted to each frame on its own, and every
coordinate is low-passed forwards and backwards. Rotations are filtered as rotation vectors about their mean over
the trial. The plates get the same low-pass, so that inertia and load stay in step.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from benchmarks.references import LOW_PASS_HZ, low_pass
from mbkf.conventions import Array
from mbkf.errors import NotObservable
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.numerics.threads import single_threaded
from mbkf.sensors.contact.offline import assign_feet
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import fit_pose, segment_by_segment
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.trial.preparation.selection import subject_markers


@dataclass(frozen=True)
class OfflineMotion:
    """Result of the offline practice: q (T, nq), v, a (T, nv) and generalised forces tau (T, nv)."""

    q: Array
    v: Array
    a: Array
    tau: Array


def offline_motion(capture: Capture, subject: Subject, cut_off_hz: float = LOW_PASS_HZ) -> OfflineMotion:
    """Fit, low-pass, differentiate, inverse dynamics.

    Args:
        capture: Markers and plates.
        subject: The person, with markers where this capture has them.
        cut_off_hz: Of the low-pass on coordinates and plates alike.

    Raises:
        NotObservable: A frame has too few markers.
    """
    with single_threaded():
        markers = subject_markers(capture.markers, subject)
        model = HumanModel.of(subject)
        own = {marker.name: marker for marker in subject.markers}
        followed = [own[name] for name in markers.names]
        sensor = MarkerSensor(
            model, [m.segment for m in followed], np.array([m.position_m for m in followed])
        )
        noise = np.array([m.noise_m for m in followed])
        fitted = fitted_poses(sensor, noise, filled(markers.positions_m))
        q = smoothed_poses(model, fitted, markers.rate_hz, cut_off_hz)
        loads = assign_feet(model, q, markers.times_s, markers.rate_hz, capture.plates)
        wrench = low_pass(loads.wrench, markers.rate_hz, cut_off_hz)
        v, a = rates(model, q, markers.rate_hz)
        return OfflineMotion(q, v, a, generalised_forces(model, q, v, a, wrench))


def filled(positions_m: Array) -> Array:
    """(T, M, 3) positions with gaps between two sightings joined by a cubic spline; NaN stays at the ends."""
    result = positions_m.copy()
    frames = np.arange(len(positions_m))
    for marker in range(positions_m.shape[1]):
        seen = np.flatnonzero(~np.isnan(positions_m[:, marker]).any(axis=1))
        if len(seen) < 4:
            continue
        inside = frames[seen[0] : seen[-1] + 1]
        gaps = np.setdiff1d(inside, seen)
        result[gaps, marker] = CubicSpline(seen, positions_m[seen, marker])(gaps)
    return result


def fitted_poses(sensor: MarkerSensor, noise_m: Array, positions_m: Array) -> Array:
    """(T, nq) the likeliest pose of each frame, searched from the pose before.

    Args:
        sensor: The markers on the body.
        noise_m: (M,) marker noise, m.
        positions_m: (T, M, 3) measured positions, m.

    Raises:
        NotObservable: A frame shows no marker.
    """
    posture = PostureSensor(sensor.model)
    q = segment_by_segment(sensor, positions_m[0])
    poses = np.empty((len(positions_m), sensor.model.nq))
    for t, frame in enumerate(positions_m):
        if np.isnan(frame).any(axis=1).all():
            raise NotObservable(f"frame {t} shows no marker")
        q = fit_pose(sensor, posture, frame, noise_m, q).q
        poses[t] = q
    return poses


def smoothed_poses(model: HumanModel, q: Array, rate_hz: float, cut_off_hz: float) -> Array:
    """(T, nq) poses with every coordinate low-passed; rotations as rotation vectors about their mean.

    Args:
        model: The body.
        q: (T, nq) poses.
        rate_hz: Frame rate.
        cut_off_hz: Cut-off of the low pass.
    """
    result = q.copy()
    for joint in model.joints.values():
        plain, turning = _parts(joint.kind, joint.q)
        result[:, plain] = low_pass(q[:, plain], rate_hz, cut_off_hz)
        if turning is not None:
            rotations = Rotation.from_quat(q[:, turning])
            mean = rotations.mean()
            vectors = low_pass((mean.inv() * rotations).as_rotvec(), rate_hz, cut_off_hz)
            result[:, turning] = (mean * Rotation.from_rotvec(vectors)).as_quat()
    return result


def _parts(kind: str, q: slice) -> tuple[slice, slice | None]:
    """Where a joint's plain coordinates and its quaternion lie."""
    if kind == "free":
        return slice(q.start, q.start + 3), slice(q.start + 3, q.stop)
    if kind == "spherical":
        return slice(q.start, q.start), q
    return q, None


def rates(model: HumanModel, q: Array, rate_hz: float) -> tuple[Array, Array]:
    """Central differences (T, nv) of first and second order on the manifold; one-sided at the ends.

    Args:
        model: The body.
        q: (T, nq) poses.
        rate_hz: Frame rate.
    """
    steps = np.array([model.difference(a, b) for a, b in pairwise(q)]) * rate_hz
    padded = np.vstack([steps[:1], steps, steps[-1:]])
    a = np.diff(padded, axis=0) * rate_hz
    a[0], a[-1] = a[1], a[-2]
    return 0.5 * (padded[1:] + padded[:-1]), a


def generalised_forces(model: HumanModel, q: Array, v: Array, a: Array, foot_wrench: Array) -> Array:
    """(T, nv) generalised forces M a − Q_g − B_pᵀ p (thesis eq. 3.12).

    Args:
        model: The body.
        q: (T, nq) poses.
        v: (T, nv) velocities.
        a: (T, nv) accelerations.
        foot_wrench: (T, 2, 6) wrenches on the feet about the world's origin, N and N m.
    """
    tau = np.empty_like(v)
    supports = [model.supports[model.joint(segment).joint_id] for segment in model.roles.feet]
    for t in range(len(q)):
        tau[t] = model.inverse_dynamics(q[t], v[t], a[t])
        jacobian = model.placements_and_jacobian(q[t])[2]
        for moves, wrench in zip(supports, foot_wrench[t], strict=True):
            tau[t] -= np.where(moves, wrench @ jacobian, 0.0)
    return tau
