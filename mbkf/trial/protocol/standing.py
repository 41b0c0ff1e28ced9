"""The markers of a capture in one frame, and a body posed beside them by a marker set."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array, StageCallback
from mbkf.errors import MbkfError
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.model.protocol import Protocol
from mbkf.scaling.records import ScalingSettings
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import fit_most_markers, segment_by_segment
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.trial.axes.captures import checked_for_protocol
from mbkf.trial.scale import scale

NOMINAL_MASS_KG = 70.0
"""Mass of a person of unknown mass: it hardly affects the places of markers."""

STILL_M = 0.05
"""Greatest distance of half of a standing trial's markers from their means."""

_FEW = 4
"""Least number of known markers by which a body is posed."""


@dataclass(frozen=True)
class Standing:
    """A capture in one frame, and a body beside it.

    Attributes:
        names: The P markers that have a name and were seen.
        points_m: (P, 3) their places in that frame; of a marker not seen then, in the nearest frame with it.
        model: The person's body, or the reference body.
        q: (nq,) its configuration.
        subject: The scaled person; None where scaling by the set failed.
        trouble: Reason why scaling failed, or "".
    """

    names: tuple[str, ...]
    points_m: Array
    model: HumanModel
    q: Array
    subject: Subject | None
    trouble: str = ""

    def to_reference(self, segment: str, point_m: Array) -> Array:
        """(3,) place on the reference body, in a segment's frame, of a point (3,) of the capture, m."""
        R, origin, scale = self._frame(segment)
        return np.asarray(R.T @ (point_m - origin) / scale)

    def to_world(self, segment: str, position_m: Array) -> Array:
        """(3,) place on the body beside the capture of a place (3,) in the reference body's segment, m."""
        R, origin, scale = self._frame(segment)
        return np.asarray(origin + R @ (scale * position_m))

    def _frame(self, segment: str) -> tuple[Array, Array, Array]:
        rotations, origins = self.model.placements(self.q)
        joint = self.model.joint(segment).joint_id
        scale = self.model.axis_scale(self.model.description.segment(segment))
        return rotations[joint], origins[joint], scale


def stand_beside(capture: Capture, protocol: Protocol, progress: StageCallback | None = None) -> Standing:
    """The person of a capture, or where scaling fails, the reference body posed on the markers.

    Args:
        capture: The capture, standing or moving.
        protocol: The marker set, even if it knows few of the markers.
        progress: As for :func:`mbkf.trial.scale.scale`.
    """
    subject, trouble = None, ""
    try:
        subject = scale_nominally(capture, protocol, progress)
        capture = checked_for_protocol([capture], protocol)[0]
    except MbkfError as error:
        trouble = str(error)
    names, points = _moment(capture.markers)
    if subject is not None:
        model = HumanModel.of(subject)
        placed = {marker.name: (marker.segment, marker.position_m) for marker in subject.markers}
    else:
        model = _sized(protocol, points)
        placed = {
            m.name: (m.segment, model.axis_scale(model.description.segment(m.segment)) * m.position_m)
            for m in protocol.markers
            if m.kind != "computed"
        }
    known = {name: marker.name for name, marker in protocol.match(names).items() if marker.name in placed}
    if len(known) < _FEW:
        return Standing(names, points, model, _upright(model, points), subject, trouble)
    columns = [names.index(name) for name in known]
    sensor = MarkerSensor(
        model,
        [placed[known[name]][0] for name in known],
        np.array([placed[known[name]][1] for name in known]),
    )
    start = segment_by_segment(sensor, points[columns])
    noise = np.full(len(columns), 0.01 if subject is not None else 0.05)
    fit = fit_most_markers(sensor, PostureSensor(model), points[columns], noise, start)
    return Standing(names, points, model, fit.q, subject, trouble)


def scale_nominally(capture: Capture, protocol: Protocol, progress: StageCallback | None = None) -> Subject:
    """The person of a single capture, with its stated mass or a nominal one.

    Args:
        capture: The capture, standing or moving.
        protocol: The marker set.
        progress: As for :func:`mbkf.trial.scale.scale`.

    Raises:
        MbkfError: The markers of the set do not fit a person.
    """
    mass = capture.subject_mass_kg or NOMINAL_MASS_KG
    static, trials = (capture, ()) if stands_still(capture.markers) else (None, (capture,))
    names_as_read = ScalingSettings(correct_names=False)  # the set is judged by its names
    return scale(static, trials, mass_kg=mass, protocol=protocol, settings=names_as_read, progress=progress)


def stands_still(markers: MarkerTrajectories, share: float = 0.5) -> bool:
    """True where this share of a capture's markers stay near their means."""
    seen = markers.positions_m[:, markers.present.any(axis=0)]
    if not seen.size:
        return False
    away = np.linalg.norm(seen - np.nanmean(seen, axis=0), axis=2)
    return bool(np.quantile(np.nanmax(away, axis=0), share) < STILL_M)


def faced_forward(standing: Standing) -> Standing:
    """The person turned and moved so that the body faces forward with its root above the origin."""
    from scipy.spatial.transform import Rotation  # loads slowly

    model, q = standing.model, standing.q.copy()
    rotations, origins = model.placements(q)
    joint = model.root.joint_id
    forward = rotations[joint][:, 0]
    turn = Rotation.from_euler("z", -np.arctan2(forward[1], forward[0]))
    middle = np.array([*origins[joint][:2], 0.0])
    root = q[model.root.q]
    root[:3] = turn.apply(root[:3] - middle)
    root[3:7] = (turn * Rotation.from_quat(root[3:7])).as_quat()
    points = turn.apply(standing.points_m - middle) if len(standing.names) else standing.points_m
    return replace(standing, q=q, points_m=points)


def neutral_on_floor(model: HumanModel) -> Array:
    """(nq,) the neutral posture with the soles on the floor."""
    q = model.neutral()
    _, origins = model.placements(q)
    soles = [
        origins[model.joint(sole.segment).joint_id][2]
        + model.axis_scale(model.description.segment(sole.segment))[2] * sole.height_m
        for sole in model.roles.soles
    ]
    q[model.root.q][2] -= min(soles)
    return q


def _moment(markers: MarkerTrajectories) -> tuple[tuple[str, ...], Array]:
    """Names and (P, 3) places in the frame with most markers; of others, in the nearest frame with them."""
    seen = markers.present
    columns = [i for i, name in enumerate(markers.names) if seen[:, i].any() and not name.startswith("*")]
    frame = int(np.argmax(seen[:, columns].sum(axis=1))) if columns else 0
    points = np.empty((len(columns), 3))
    for row, column in enumerate(columns):
        frames = np.flatnonzero(seen[:, column])
        points[row] = markers.positions_m[frames[np.argmin(np.abs(frames - frame))], column]
    return tuple(markers.names[i] for i in columns), points


def _sized(protocol: Protocol, points_m: Array) -> HumanModel:
    """The reference body, scaled to the height of the capture's points."""
    body = protocol.body
    tall = float(np.ptp(points_m[:, 2])) / body.reference_height_m if len(points_m) else 1.0
    factor = float(np.clip(tall, 0.7, 1.2)) if len(points_m) >= _FEW and tall > 0.7 else 1.0
    return HumanModel.scaled(dict.fromkeys(body.scale_factors, factor), None, body)


def _upright(model: HumanModel, points_m: Array) -> Array:
    """(nq,) the neutral posture on the floor in the middle of the points, across their longer horizontal axis."""
    q = neutral_on_floor(model)
    if len(points_m) < _FEW:
        return q
    middle = points_m.mean(axis=0)
    _, _, axes = np.linalg.svd(points_m[:, :2] - middle[:2])
    yaw = np.arctan2(axes[0, 1], axes[0, 0]) - 0.5 * np.pi
    yaw = (yaw + 0.5 * np.pi) % np.pi - 0.5 * np.pi  # forward is taken as nearer to the laboratory's forward
    root = q[model.root.q]
    root[:2] = middle[:2]
    root[2] += points_m[:, 2].min()
    root[3:7] = [0.0, 0.0, np.sin(0.5 * yaw), np.cos(0.5 * yaw)]
    return q
