"""Excitation of the joints by a trial: how far they turn from the standing posture.

The body of the standing trial is posed on evenly spread frames. A joint's excursion is the angle between the segment's
long axis now and in standing, both seen from the proximal segment: rotation about the axis, which few markers show,
does not count.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import NotObservable
from mbkf.io.records import MarkerTrajectories
from mbkf.io.session import TrialKind
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.numerics.printed import percent
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import fit_most_markers, segment_by_segment
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.sensors.subject_sensor import subject_sensor
from mbkf.study.scaling.likeness import StandingMarkers
from mbkf.study.survey.movement import kind_of_markers
from mbkf.trial.preparation.static_names import markers_as_scaled

FRAMES = 16
"""Greatest number of frames looked at."""

WELL_SEEN = 0.6
"""Frames that show a smaller share of the markers of the best-seen one are not looked at."""

STRAY_M, MOST_STRAY = 0.06, 0.1
"""Markers further from the fitted body are probably other markers, and their greatest share: two exchanged markers of
fifty, as in public captures, give 0.03."""

EXCURSION_PERCENTILE = 95.0
"""Percentile over frames that counts as greatest excursion: a single frame may be badly fitted."""


@dataclass(frozen=True)
class Excitation:
    """Movement of a person's joints in a trial.

    Attributes:
        kind: Kind of movement, by the paths of feet and pelvis.
        hips_deg, knees_deg: Flexion where both are deepest at once, degrees; of the leg that bends less.
        swing_deg: Greatest flexion of the knee, degrees; of the leg that bends less.
        upper_deg: Greatest excursion of trunk, upper arms and forearms by segment with markers, degrees.
        coverage: Share of the standing trial's markers that the frames show, 0 to 1.
    """

    kind: TrialKind
    hips_deg: float
    knees_deg: float
    swing_deg: float
    upper_deg: Mapping[str, float]
    coverage: float


class StandingBody:
    """The body of a standing trial, by which other trials are judged.

    Args:
        subject: The person scaled from it.
        standing: Its markers, axes put right.
    """

    def __init__(self, subject: Subject, standing: MarkerTrajectories) -> None:
        self._subject, self._model = subject, HumanModel.of(subject)
        self._posture = PostureSensor(self._model)
        posture = subject.standing_q
        self._axes = _long_axes(self._model, (self._model.neutral() if posture is None else posture)[None])
        self._markers = StandingMarkers(subject, standing)

    def excitation(self, markers: MarkerTrajectories) -> Excitation:
        """The excitation by a trial.

        Args:
            markers: Its markers, axes put right.

        Raises:
            NotObservable: It shows too few of the person's markers, or those of another person.
        """
        own = _looked_at(markers_as_scaled(markers, self._subject))
        if refusal := self._markers.refusal(own):
            raise NotObservable(refusal)
        by_name = {marker.name: marker for marker in self._subject.markers}
        worn = [by_name[name] for name in own.names]
        sensor = subject_sensor(self._model, worn)
        poses = self._poses(sensor, own.positions_m, np.array([m.noise_m for m in worn]))
        turned = np.degrees(_angles(_long_axes(self._model, poses), self._axes))
        greatest = np.percentile(turned, EXCURSION_PERCENTILE, axis=0)
        excursion = {name: float(deg) for name, deg in zip(self._model.joints, greatest, strict=True)}
        there = np.asarray(own.present.any(axis=0))
        shown = {m.segment for m, seen in zip(worn, there, strict=True) if seen}
        hips, knees = _bent(self._model, turned)
        return Excitation(
            kind_of_markers(markers),
            hips,
            knees,
            min((excursion[shank] for _, shank in self._model.roles.knees), default=0.0),
            {name: excursion[name] for name in _upper(self._model) if name in shown},
            self._markers.coverage(own),
        )

    def _poses(self, sensor: MarkerSensor, measured_m: Array, noise_m: Array) -> Array:
        """(N, nq) poses of frames (N, M, 3).

        Raises:
            NotObservable: Many markers lie far from the body.
        """
        poses, apart = segment_by_segment(sensor, measured_m), np.full(measured_m.shape[:2], np.nan)
        for n, frame in enumerate(measured_m):
            poses[n] = fit_most_markers(sensor, self._posture, frame, noise_m, poses[n]).q
            apart[n] = np.linalg.norm(sensor.positions(poses[n]) - frame, axis=1)
        stray = float((apart[np.isfinite(apart)] > STRAY_M).mean())
        if stray > MOST_STRAY:
            raise NotObservable(
                f"{percent(stray)} of the markers lie more than {1e3 * STRAY_M:.0f} mm from the body of the "
                "standing trial: exchanged names, or another person"
            )
        return poses


def _looked_at(markers: MarkerTrajectories) -> MarkerTrajectories:
    """Evenly spread, well-seen frames; the times are those of the first ones."""
    seen = markers.present.sum(axis=1)
    enough = np.flatnonzero((seen > 0) & (seen >= WELL_SEEN * seen.max(initial=0)))
    if len(enough) > FRAMES:
        enough = np.array([part[np.argmax(seen[part])] for part in np.array_split(enough, FRAMES)])
    return replace(markers, positions_m=markers.positions_m[enough])


def _long_axes(model: HumanModel, poses: Array) -> Array:
    """(N, J, 3) long axis of each segment in the frame of the proximal one; the root's in the world."""
    joints = model.joints
    parents = [joints.get(model.description.segment(name).parent) for name in joints]
    found = np.empty((len(poses), len(joints), 3))
    for n, q in enumerate(poses):
        rotations, _ = model.placements(q)
        for i, (joint, parent) in enumerate(zip(joints.values(), parents, strict=True)):
            axis = rotations[joint.joint_id][:, 2]
            found[n, i] = axis if parent is None else rotations[parent.joint_id].T @ axis
    return found


def _angles(axes: Array, others: Array) -> Array:
    """(…) angles between axes (…, 3), rad."""
    return np.asarray(np.arccos(np.clip((axes * others).sum(axis=-1), -1.0, 1.0)))


def _upper(model: HumanModel) -> list[str]:
    """Segments of trunk and arms that carry others."""
    segments, roles = model.description.segments, model.roles
    carrying = {segment.parent for segment in segments}
    lower = {roles.root, *roles.legs, *roles.feet, *roles.toes}
    return [segment.name for segment in segments if segment.name in carrying - lower]


def _bent(model: HumanModel, turned_deg: Array) -> tuple[float, float]:
    """Flexion of hip and knee where both are deepest at once, of the leg that bends less, degrees."""
    names, deepest = list(model.joints), []
    for thigh, shank in model.roles.knees:
        hip, knee = turned_deg[:, names.index(thigh)], turned_deg[:, names.index(shank)]
        at = int(np.argmax(np.minimum(hip, knee)))
        deepest.append((float(hip[at]), float(knee[at])))
    return min(deepest, key=min) if deepest else (0.0, 0.0)
