"""Correction of marker places (thesis 4.1.1, Figure 4.1) as the thesis does it: each marker to its mean measured place.

Persons whose markers sit beside the protocol's places squat. Poses are fitted to the protocol's places on the person's
own body, every marker moves to its mean place in its segment, and the poses are fitted again.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from benchmarks.dynamic.methods import Mapper
from benchmarks.full_body.persons import PERSONS, subject_of
from benchmarks.references import rms
from benchmarks.thesis_report.contents import Claim, Findings, Row, Sheet, judged
from mbkf.conventions import Array
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.pose_fit import fit_pose, segment_by_segment
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.synthesis.person import body_of
from mbkf.trial.synth import synthesise

SECONDS, EVERY = 2.4, 24
"""One squat, and the step between the frames that are fitted."""

BEFORE_MM, AFTER_MM, TOLERANCE = (10.0, 15.0), 5.0, 1.5
"""RMS distances that the thesis states, and the factor within which a number is alike."""


class Placement(NamedTuple):
    """RMS distance of markers from the fitted body before and after the correction, mm, of a person."""

    person: str
    before_mm: float
    after_mm: float


def measure_placement(number: int) -> Placement:
    """The correction on one of the persons.

    Args:
        number: Place in :data:`benchmarks.full_body.persons.PERSONS`.
    """
    subject = subject_of(number)
    _, made = synthesise("squat", seconds=SECONDS, seed=number, subject=subject)
    measured, model = made.trial.markers.positions_m[::EVERY], body_of(subject)
    printed = _protocol_places(subject, model, made.trial.markers.names)
    before, local = _fitted(printed, measured)
    after, _ = _fitted(MarkerSensor(model, printed.segments, np.nanmean(local, axis=0)), measured)
    return Placement(PERSONS[number].label, 1e3 * before, 1e3 * after)


def _protocol_places(subject: Subject, model: HumanModel, names: tuple[str, ...]) -> MarkerSensor:
    """Markers at the protocol's places, scaled with the person's segments."""
    known = {one.name: one for one in load_protocol(subject.protocol).markers}
    markers = [known[name] for name in names]
    scales = [model.axis_scale(model.description.segment(one.segment)) for one in markers]
    places = np.array([scale * one.position_m for scale, one in zip(scales, markers, strict=True)])
    return MarkerSensor(model, [one.segment for one in markers], places)


def _fitted(sensor: MarkerSensor, measured_m: Array) -> tuple[float, Array]:
    """RMS distance of markers from fitted poses, m, and their places in the segments (T, M, 3)."""
    posture, noise_m = PostureSensor(sensor.model), np.full(len(sensor.segments), 0.005)
    joints = [sensor.model.joint(segment).joint_id for segment in sensor.segments]
    away, local = [], []
    for frame in measured_m:
        q = fit_pose(sensor, posture, frame, noise_m, segment_by_segment(sensor, frame)).q
        rotations, origins = sensor.model.placements(q)
        away.append(np.linalg.norm(frame - sensor.positions(q), axis=1))
        local.append(np.einsum("mji,mj->mi", rotations[joints], frame - origins[joints]))
    return rms(np.array(away)), np.array(local)


def placement_findings(mapper: Mapper, *, quick: bool) -> Findings:
    """The correction on all persons; on one of them when quick.

    Args:
        mapper: Runs a function on many items, in turn or on several processes.
        quick: Whether to do a shorter run.
    """
    found = list(mapper(measure_placement, list(range(len(PERSONS)))[: 1 if quick else None]))
    before, after = (rms(np.array(values)) for values in zip(*(one[1:] for one in found), strict=True))
    rows: tuple[Row, ...] = tuple(tuple(one) for one in found)
    note = "Markers sit beside the protocol's places as those of people do, and skin slides."
    sheet = Sheet(
        "figure_4_1", "Correction of marker places", ("person", "before (mm)", "after (mm)"), rows, note
    )
    claim = Claim(
        "4.1.1, Figure 4.1",
        "Moving every marker to its mean measured place takes the RMS distance from 10 to 15 mm to about 5 mm.",
        f"{before:.1f} mm before, {after:.1f} mm after, {len(found)} of {len(PERSONS)} persons",
        judged(
            BEFORE_MM[0] / TOLERANCE < before < BEFORE_MM[1] * TOLERANCE and after < AFTER_MM * TOLERANCE,
            after < 0.6 * before,
        ),
    )
    return Findings(sheets=[sheet], claims=[claim])
