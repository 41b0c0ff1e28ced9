"""The markers of a capture at one moment, and a body beside them, as well as a marker set explains them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from mbkf.conventions import Array, StageCallback
from mbkf.errors import MbkfError
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.model.protocol import Protocol, ProtocolMarker
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import fit_most_markers, segment_by_segment
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.trial.axes.captures import checked_for_protocol
from mbkf.trial.scale import scale

NOMINAL_MASS_KG = 70.0
"""Mass of a person whose mass nobody told: it hardly matters to where markers are."""

STILL_M = 0.05
"""A capture in which half of the markers stay within this of their mean is a standing trial."""

_FEW = 4
"""Known markers with which a body can be laid roughly beside a capture."""


@dataclass(frozen=True)
class Standing:
    """A capture at one moment, and a body beside it.

    Attributes:
        names: The P markers that have a name and were seen.
        points_m: (P, 3) their places in that moment; where a marker was not seen then, in the nearest frame it was.
        model: The body: of the person, or the reference body.
        q: (nq,) its configuration.
        subject: The scaled person; None where the set does not explain the capture.
        trouble: Why there is none, "" where there is one.
    """

    names: tuple[str, ...]
    points_m: Array
    model: HumanModel
    q: Array
    subject: Subject | None
    trouble: str = ""


def stand_beside(capture: Capture, protocol: Protocol, progress: StageCallback | None = None) -> Standing:
    """The person of a capture, or where the marker set does not give one, the reference body laid on the markers.

    Args:
        capture: The capture, standing or moving.
        protocol: The marker set; it may know few of the markers or none.
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
        placed = {m.name: (m.segment, _scaled(model, m)) for m in protocol.markers if m.kind != "computed"}
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
        MbkfError: The marker set does not explain the capture.
    """
    mass = capture.subject_mass_kg or NOMINAL_MASS_KG
    still = stands_still(capture.markers)
    return scale(
        capture if still else None,
        () if still else (capture,),
        mass_kg=mass,
        protocol=protocol,
        progress=progress,
    )


def stands_still(markers: MarkerTrajectories, share: float = 0.5) -> bool:
    """Whether the person of a capture stands still.

    Args:
        markers: The capture's markers.
        share: So many of them must stay, 0 to 1.
    """
    seen = markers.positions_m[:, markers.present.any(axis=0)]
    if not seen.size:
        return False
    away = np.linalg.norm(seen - np.nanmean(seen, axis=0), axis=2)
    return bool(np.quantile(np.nanmax(away, axis=0), share) < STILL_M)


def in_reference(standing: Standing, segment: str, point_m: Array) -> Array:
    """(3,) where a point of the capture is in a segment's frame on the reference body, m.

    Args:
        standing: The capture, with the body beside it.
        segment: The segment.
        point_m: (3,) the point, m.
    """
    rotations, origins = standing.model.placements(standing.q)
    joint = standing.model.joint(segment).joint_id
    own = rotations[joint].T @ (point_m - origins[joint])
    found: Array = own / standing.model.axis_scale(standing.model.description.segment(segment))
    return found


def in_world(standing: Standing, segment: str, position_m: Array) -> Array:
    """(3,) where a place of the reference body's segment is on the body beside the capture, m.

    Args:
        standing: The capture, with the body beside it.
        segment: The segment.
        position_m: (3,) the place in the segment's frame on the reference body, m.
    """
    rotations, origins = standing.model.placements(standing.q)
    joint = standing.model.joint(segment).joint_id
    own = standing.model.axis_scale(standing.model.description.segment(segment)) * position_m
    found: Array = origins[joint] + rotations[joint] @ own
    return found


def faced_forward(standing: Standing) -> Standing:
    """The same with the body's root above the origin and facing forward, wherever it stood in the laboratory."""
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
    """Names and (P, 3) places in the frame that shows most markers, the rest as near to it as they were seen."""
    seen = markers.present
    columns = [i for i, name in enumerate(markers.names) if seen[:, i].any() and not name.startswith("*")]
    frame = int(np.argmax(seen[:, columns].sum(axis=1))) if columns else 0
    points = np.empty((len(columns), 3))
    for row, column in enumerate(columns):
        frames = np.flatnonzero(seen[:, column])
        points[row] = markers.positions_m[frames[np.argmin(np.abs(frames - frame))], column]
    return tuple(markers.names[i] for i in columns), points


def _sized(protocol: Protocol, points_m: Array) -> HumanModel:
    """The reference body, as tall as the capture's points say."""
    body = protocol.body
    tall = float(np.ptp(points_m[:, 2])) / body.reference_height_m if len(points_m) else 1.0
    factor = float(np.clip(tall, 0.7, 1.2)) if len(points_m) >= _FEW and tall > 0.7 else 1.0
    return HumanModel.scaled(dict.fromkeys(body.scale_factors, factor), None, body)


def _scaled(model: HumanModel, marker: ProtocolMarker) -> Array:
    found: Array = model.axis_scale(model.description.segment(marker.segment)) * marker.position_m
    return found


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
