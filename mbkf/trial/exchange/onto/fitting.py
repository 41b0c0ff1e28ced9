"""A result's motion in the coordinates of an OpenSim model: fitted frame by frame, with the distances that remain.

The model's markers go to the places of the person's markers of the same name on the reconstructed body; a body that
such markers do not place goes to its segment by four points of its frame, which together count as one marker.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput
from mbkf.io.axes import rotation_to_world
from mbkf.io.osim import OsimModel
from mbkf.io.results import Reconstruction
from mbkf.model.body import Body
from mbkf.model.human import HumanModel
from mbkf.model.osim_fit import Targets, fit
from mbkf.model.osim_kinematics import OsimKinematics, OsimPoses
from mbkf.model.segment_poses import segment_poses
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.trial.exchange.onto.pairs import Pair, pairs, replaced, shared_markers

ARM_M = 0.1
"""Length of the axes of a frame that stands for a segment."""


@dataclass(frozen=True)
class SegmentResidual:
    """Distance of a body from the segment that it moves with, over the frames.

    Attributes:
        pair: The body and the segment.
        place_mm: RMS distance of the middle of the body's markers, or of its joint.
        turn_deg: RMS angle between the body and the segment.
    """

    pair: Pair
    place_mm: float
    turn_deg: float


@dataclass(frozen=True)
class OntoMotion:
    """The motion of an OpenSim model that follows a result.

    Attributes:
        kinematics: The model.
        rows: (T,) frames of the result in which the body is followed.
        q: (F, C) coordinates in these frames, rad and m.
        residuals: Distances of the model's bodies from our segments.
        markers: (M,) markers of the result that the model has.
        markers_m: (F, M, 3) the model's, in the ground's axes, m.
        to_ours_mm: RMS distance of these markers from those of the reconstructed body; NaN without any.
        to_measured_mm: RMS distance from the measured ones, where seen.
        limited: Share of the frames in which a coordinate is at a limit of the model, by coordinate.
    """

    kinematics: OsimKinematics
    rows: BoolArray
    q: Array
    residuals: tuple[SegmentResidual, ...]
    markers: tuple[str, ...]
    markers_m: Array
    to_ours_mm: float
    to_measured_mm: float
    limited: Mapping[str, float]


def onto(r: Reconstruction, model: OsimModel) -> OntoMotion:
    """Fits an OpenSim model to a result.

    Args:
        r: The result.
        model: The OpenSim model, of the person's size.

    Raises:
        InvalidInput: The body is followed in no frame, or the model's bodies have unknown names, or it has joints or
            constraints that are not supported.
        UnknownName: The subject's body is unknown.
    """
    rows = r.tracked & np.isfinite(r.q).all(axis=1)
    if not rows.any():
        raise InvalidInput(
            "the result follows the body in no frame, so it holds no motion; reconstruct the trial anew"
        )
    kinematics, ours = OsimKinematics(model), HumanModel.of(r.subject)
    shared = shared_markers(model, r.subject.markers)
    names = tuple(
        name for name in r.marker_names if name in shared and shared[name].body in kinematics.bodies
    )
    columns, turned = [r.marker_names.index(name) for name in names], rotation_to_world("y")
    found = [
        _Followed(pair, *_moved(ours, r.q[rows], pair.segment))
        for pair in pairs(kinematics, ours, r.subject.markers)
    ]
    points = Targets(
        np.array([kinematics.body(shared[name].body) for name in names], int),
        np.array([shared[name].position_m for name in names]).reshape(-1, 3),
        r.predicted_m[rows][:, columns] @ turned,
        np.ones(len(names)),
    )
    q = fit(kinematics, _with_frames(kinematics, points, found), r.rate_hz)
    poses = kinematics.poses(q)
    found = [one.replaced(kinematics, poses) for one in found]
    q = fit(kinematics, _with_frames(kinematics, points, found), r.rate_hz, q[0])
    poses = kinematics.poses(q)
    markers_m = poses.points(points.bodies, points.places_m)[0]
    measured = np.where(r.present[rows][:, columns, None], r.measured_m[rows][:, columns] @ turned, np.nan)
    return OntoMotion(
        kinematics,
        rows,
        q,
        tuple(one.residual(kinematics, poses) for one in found),
        names,
        markers_m,
        _rms_mm(markers_m - points.at_m),
        _rms_mm(markers_m - measured),
        _limited(kinematics, q),
    )


@dataclass(frozen=True)
class _Followed:
    """A pair, and its segment in F frames.

    Attributes:
        pair: The body and the segment.
        R: (F, 3, 3) the segment's axes, in the ground's.
        origin_m: (F, 3) its origin.
    """

    pair: Pair
    R: Array
    origin_m: Array

    def goal(self) -> tuple[Array, Array]:
        """(F, 3, 3) axes and (F, 3) origin of the body where its segment is."""
        return self.R @ self.pair.rotation, self.origin_m + self.R @ self.pair.origin_m

    def replaced(self, kinematics: OsimKinematics, poses: OsimPoses) -> _Followed:
        """With the body where it lies on its segment on the average, if no marker places it."""
        apart = poses.origins_m[:, kinematics.body(self.pair.body)] - self.origin_m
        return replace(self, pair=replaced(self.pair, np.einsum("fji,fj->fi", self.R, apart)))

    def residual(self, kinematics: OsimKinematics, poses: OsimPoses) -> SegmentResidual:
        """Distance of the body from its place on the segment."""
        (R, origin), number, centre = self.goal(), kinematics.body(self.pair.body), self.pair.centre_m
        found = poses.rotations[:, number]
        apart = poses.origins_m[:, number] + found @ centre - origin - R @ centre
        cosine = 0.5 * (np.einsum("fij,fij->f", found, R) - 1.0)
        turns = np.rad2deg(np.arccos(np.clip(cosine, -1.0, 1.0)))
        return SegmentResidual(self.pair, _rms_mm(apart), float(np.sqrt(np.mean(turns**2))))


def _moved(ours: Body, q: Array, segment: str) -> tuple[Array, Array]:
    """(F, 3, 3) axes and (F, 3) origin of a segment of ours, in the ground's axes."""
    poses, to_ground = segment_poses(ours, q)[:, list(ours.joints).index(segment)], rotation_to_world("y").T
    return to_ground @ quaternion_matrices(poses[:, 3:]), poses[:, :3] @ to_ground.T


def _with_frames(kinematics: OsimKinematics, points: Targets, followed: Sequence[_Followed]) -> Targets:
    """Targets of markers, then those of the frames that stand for bodies without markers."""
    arms = ARM_M * np.vstack([np.zeros(3), np.eye(3)])
    bodies, places, goals, weights = [points.bodies], [points.places_m], [points.at_m], [points.weights]
    for one in followed:
        if one.pair.markers:
            continue
        R, origin = one.goal()
        bodies.append(np.full(len(arms), kinematics.body(one.pair.body)))
        places.append(arms)
        goals.append(origin[:, None] + arms @ np.swapaxes(R, 1, 2))
        weights.append(np.full(len(arms), 1.0 / np.sqrt(len(arms))))
    return Targets(
        np.concatenate(bodies), np.concatenate(places), np.concatenate(goals, axis=1), np.concatenate(weights)
    )


def _rms_mm(apart: Array) -> float:
    """RMS length of vectors (…, 3), mm; those with NaN do not count."""
    squares = (apart**2).sum(axis=-1)
    known = np.isfinite(squares)
    return float(1e3 * np.sqrt(squares[known].mean())) if known.any() else float("nan")


def _limited(kinematics: OsimKinematics, q: Array) -> dict[str, float]:
    found: dict[str, float] = {}
    for number in kinematics.free:
        one = kinematics.model.coordinates[number]
        if one.clamped:
            share = float(np.mean((q[:, number] <= one.lowest) | (q[:, number] >= one.highest)))
            found |= {one.name: share} if share else {}
    return found
