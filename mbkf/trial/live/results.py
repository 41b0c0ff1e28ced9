"""The results of a live run from its log, equal to the causal ones of ``reconstruct`` on the same frames."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from mbkf.errors import MbkfError, NotObservable
from mbkf.filters.offset_change import OffsetChanges
from mbkf.filters.record import Track
from mbkf.filters.tracking import track_of
from mbkf.imu.segments import segment_of
from mbkf.io.findings import Finding
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject, read_subject
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.numerics.threads import single_threaded
from mbkf.trial.checks.in_view import unseen_finding
from mbkf.trial.checks.trial import trial_checks
from mbkf.trial.live.filter import NUMERICAL, live_inputs
from mbkf.trial.live.log import SUBJECT_FILE, Logged, read_live_log
from mbkf.trial.preparation.coverage import use_of_names
from mbkf.trial.preparation.exchanged import renamed_by_filter
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.markers_alone import markers_alone
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.results.assembly import assemble
from mbkf.trial.results.warnings import all_warnings
from mbkf.trial.verdict.judge import judged_result

CHECKED_S = 60.0
"""Longest part of a run whose plates are compared with the motion of its markers alone, from its beginning."""


def live_results(folder: Path, notes: tuple[str, ...] = ()) -> Reconstruction:
    """Motion, torques and reactions of a logged run; what its damaged log lacks stands in their warnings.

    Args:
        folder: The log.
        notes: Remarks for the reader, e.g. of lost frames.

    Raises:
        FileFormatError: The log is missing or damaged.
        NotObservable: In no frame did the markers fit the body.
    """
    return results_of(read_live_log(folder), read_subject(folder / SUBJECT_FILE), notes)


def results_of(logged: Logged, subject: Subject, notes: tuple[str, ...] = ()) -> Reconstruction:
    """The same from what was read of the log.

    Args:
        logged: Contents of the log.
        subject: The person.
        notes: Remarks for the reader.

    Raises:
        NotObservable: In no frame did the markers fit the body.
    """
    notes = (*notes, *(f"live: {sentence}" for sentence in logged.left_out))
    chosen = str(logged.settings["filter"])
    settings = ReconstructSettings(filter=chosen, smooth=False, correct_markers=False)
    result = replace(track_of(logged.rows), limb_doubts=logged.limb_doubts)
    if logged.stream.sensors:
        return _by_sensors(logged, subject, notes, result)
    if not result.starts:
        raise NotObservable(
            "in no frame of the stream did the markers fit the scaled body; is this the subject's protocol, "
            "and is the vertical axis right (--up)?"
        )
    measured = measured_of(logged)
    # A stream may have held nonsense, which ends as NaN.
    with single_threaded(), np.errstate(invalid="ignore", divide="ignore"):
        inputs = live_inputs(logged.names, measured.rate_hz, logged.stream.plates, subject, settings).inputs
        capture = Capture(logged.stream.trial, measured, logged.stream.plates, notes=notes)
        hidden = np.zeros(measured.present.shape, dtype=bool)
        if inputs.body is not None:
            changes = OffsetChanges(inputs.body, ClinicalAngles(inputs.sensor.model), inputs.dt_s)
            changes.follow_all(logged.rows)
            result = changes.added_to(result, logged.rows)
        renamed, taken_up = renamed_by_filter(measured, result.limb_doubts)
        found = assemble(capture, subject, settings, renamed, hidden, inputs, result)
        checks = checks_of(logged, subject, settings)
    use = use_of_names(logged.stream.marker_names, subject)
    return judged_result(
        replace(
            found,
            settings=logged.settings,
            checks=checks,
            markers_ignored=dict(use.ignored),
            markers_explained=use.share,
            warnings=all_warnings(checks, subject, found),
            names_exchanged=taken_up,
        )
    )


def checks_of(logged: Logged, subject: Subject, settings: ReconstructSettings) -> tuple[Finding, ...]:
    """The checks of ``reconstruct`` on the frames of a run, or so far; of a long run on its first :data:`CHECKED_S`.

    Args:
        logged: Contents of the log.
        subject: The person.
        settings: Settings of the filters.
    """
    shown = measured_of(logged, CHECKED_S)
    try:
        inputs, recording = trial_inputs(
            shown, logged.stream.plates, subject.in_neutral_posture(), settings, body_errors=False
        )
        alone = markers_alone(inputs, recording) if inputs.plates else None
        return (*trial_checks(shown, subject, inputs, recording, alone), unseen_finding())
    except (MbkfError, *NUMERICAL):  # the first frames of a run may show nobody, or nonsense
        return ()


def _by_sensors(logged: Logged, subject: Subject, notes: tuple[str, ...], tracked: Track) -> Reconstruction:
    """The result where inertial sensors alone show the person.

    The log does not hold the spreads of their mounts, so that the change of an offset is not known. All of it counts as
    change.

    Args:
        logged: Contents of the log.
        subject: The person.
        notes: Remarks for the reader.
        tracked: What the filter found.
    """
    from mbkf.trial.inertial.motion_result import (
        Timeline,
        motion_result,
    )  # loads slowly; few runs are of sensors

    stream, joints = logged.stream, HumanModel.of(subject).joints
    segments = [segment_of(name, joints) for name in stream.sensors]
    tracked = replace(
        tracked,
        angle_change=tracked.angle_offset,
        rate_change=tracked.rate_offset,
        torque_change=tracked.torque_offset,
        wrench_change=tracked.wrench_offset,
    )
    timeline = Timeline(stream.trial, stream.rate_hz, _start_s(logged))
    with single_threaded(), np.errstate(invalid="ignore", divide="ignore"):
        return motion_result(subject, segments, timeline, tracked, notes=notes, more=logged.settings)


def _start_s(logged: Logged) -> float:
    return logged.stream.start_time_s + logged.first / logged.stream.rate_hz


def measured_of(logged: Logged, seconds: float = np.inf) -> MarkerTrajectories:
    """The markers of a run as its stream named them, of its first seconds where it is longer.

    Args:
        logged: Contents of the log.
        seconds: Most of it, s.
    """
    frames = int(min(len(logged.rows), np.ceil(seconds * logged.stream.rate_hz)))
    measured = logged.rows["measured_m"][:frames]
    return MarkerTrajectories(logged.names, measured, logged.stream.rate_hz, _start_s(logged))
