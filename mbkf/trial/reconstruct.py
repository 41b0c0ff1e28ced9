"""From a capture and a subject to motion, torques and reactions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from mbkf.conventions import Array, BoolArray, StageCallback
from mbkf.errors import InvalidInput, NotObservable, UnknownName
from mbkf.filters.estimate import Recording
from mbkf.filters.tracking import Track, track
from mbkf.io.contacts import bearing
from mbkf.io.findings import Finding
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject, match_names
from mbkf.model.clinical import dof_names
from mbkf.numerics.threads import single_threaded
from mbkf.scaling.correction import correct_markers
from mbkf.scaling.frames import MIN_MARKERS
from mbkf.scaling.verdict import DOUBTS_KEY
from mbkf.sensors.block import AnyBlock
from mbkf.sensors.gap_filling import filled
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.supports.block import BEARING
from mbkf.trial.axes.captures import checked_for_subject
from mbkf.trial.checks.judge import marker_checks, plate_checks, told
from mbkf.trial.inertial.on_body import ImuOnBody, with_imus
from mbkf.trial.preparation.coverage import INFERRED_KEY, use_by_subject
from mbkf.trial.preparation.exchanged import exchange_notes, names_put_right
from mbkf.trial.preparation.filters import FILTERS, FilterInputs, standard, tracking_filter
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.markers_alone import Motion, markers_alone
from mbkf.trial.preparation.other_contacts import with_other_contacts
from mbkf.trial.preparation.settings import Hidden, ReconstructSettings, recorded
from mbkf.trial.results import innovations
from mbkf.trial.results.clinical import clinical_motion
from mbkf.trial.results.progression import PELVIS_FRAMES, pelvis_frame
from mbkf.trial.results.reactions import reactions
from mbkf.trial.results.readings import ANGLES, angle_reading, zero_posture
from mbkf.trial.results.summary import ROOT_DOFS
from mbkf.trial.results.supports import supports_told
from mbkf.trial.results.validity import torques_known, torques_possible
from mbkf.version import __version__

FOOT_SD_M = 0.03
"""A foot whose height is known no better than this may or may not touch the floor."""


def reconstruct(
    capture: Capture,
    subject: Subject,
    *,
    settings: ReconstructSettings | None = None,
    imus: ImuOnBody | None = None,
    blocks: Sequence[AnyBlock] = (),
    readings: Mapping[str, Array] | None = None,
    progress: StageCallback | None = None,
) -> Reconstruction:
    """Tracks the subject through a capture and solves for torques.

    Args:
        capture: Markers and plates.
        subject: The scaled person.
        settings: The filter and its settings; the defaults are the same for every capture, and smooth.
        imus: Inertial sensors on the body, for the dynamic filter.
        blocks: Blocks of one's own, for the dynamic filter, besides the standard ones.
        readings: (T, …) readings of instruments of one's own, by the name that their block knows.
        progress: Called with the stage, items done and items in all.

    Raises:
        InvalidInput: The axes or the unit of the capture cannot be right, and it is not clear what they are; or angles
            are to be zero in a static trial that the person was not scaled with.
        NotObservable: Too few of the subject's markers to track the body.
        NotConverged: The markers do not fit the subject's body.
        UnknownName: A hidden marker, a withheld plate, the filter, the frame of the pelvis or the reading of angles
            does not exist.
    """
    settings = settings or ReconstructSettings()
    _check_names(settings)
    if imus is not None and settings.filter != "dynamic":
        raise InvalidInput(f"the {settings.filter} filter reads no inertial sensors; use --filter dynamic")
    zero_posture(settings.angles_zero, subject)
    with single_threaded():
        capture = checked_for_subject(capture, subject)
        measured, exchanged = names_put_right(subject_markers(capture.markers, subject), subject)
        capture = replace(capture, notes=(*capture.notes, *exchange_notes(exchanged)))
        use = use_by_subject(capture.markers, subject)
        if use.warning:
            capture = replace(capture, notes=(*capture.notes, use.warning))
        hidden = _hidden(measured, settings.hide)
        shown = replace(measured, positions_m=np.where(hidden[:, :, None], np.nan, measured.positions_m))
        plates = _plates(capture, settings.without_plates)
        if settings.correct_markers:
            subject = correct_markers(subject, shown)
        inputs, recording = trial_inputs(shown, plates, subject, settings)
        if imus is not None:
            inputs, recording, remarks = with_imus(inputs, recording, shown.times_s, imus)
            capture = replace(capture, notes=(*capture.notes, *remarks))
        if readings:
            recording = replace(recording, readings=readings)
        alone = None
        if _asks_markers_alone(settings, inputs):
            followed = None if progress is None else partial(progress, "Following markers alone")
            alone = markers_alone(inputs, recording, followed)
            if settings.other_contacts and settings.filter == "dynamic":
                inputs, recording = with_other_contacts(inputs, recording, shown.times_s, alone)
        result = track(
            tracking_filter(settings.filter, inputs, [*standard(inputs), *blocks] if blocks else None),
            recording,
            smoothing=settings.smoothing if settings.smooths else None,
            lag_s=settings.lag_s,
            body=inputs.body,
            spreads=settings.spreads,
            keep_covariance=settings.keep_covariance,
            progress=None if progress is None else lambda done, total: progress("Filtering", done, total),
        )
        found = assemble(capture, subject, settings, measured, hidden, inputs, result)
        checks = _checks(shown, subject, inputs, recording, alone) if settings.checks else ()
        return replace(
            found,
            checks=checks,
            markers_ignored=dict(use.ignored),
            markers_explained=use.share,
            warnings=_remarks(checks, subject, found),
            names_exchanged=exchanged,
        )


def _check_names(settings: ReconstructSettings) -> None:
    """Refuses a filter, a frame or a reading that does not exist."""
    if settings.filter not in FILTERS:
        raise UnknownName("filter", settings.filter, FILTERS)
    if settings.pelvis not in PELVIS_FRAMES:
        raise UnknownName("frame of the pelvis", settings.pelvis, PELVIS_FRAMES)
    if settings.angles not in ANGLES:
        raise UnknownName("reading of angles", settings.angles, ANGLES)


def _asks_markers_alone(settings: ReconstructSettings, inputs: FilterInputs) -> bool:
    """Whether the motion of markers alone is needed besides the filter's."""
    search = settings.other_contacts and settings.filter == "dynamic"
    return (settings.checks and len(inputs.plates) > 0) or (
        search and bool(inputs.sensor.model.description.bearings)
    )


def _checks(
    shown: MarkerTrajectories,
    subject: Subject,
    inputs: FilterInputs,
    recording: Recording,
    alone: Motion | None,
) -> tuple[Finding, ...]:
    """All checks of the trial, those of the plates first.

    Args:
        shown: The markers that are used.
        subject: The person.
        inputs: What the filter was built from.
        recording: What the instruments read, with what bears besides the feet.
        alone: The motion of markers alone; None without plates.
    """
    found = marker_checks(shown, subject)
    if alone is None or not inputs.plates:
        return found
    others = recording.readings.get(BEARING)
    bears = None if others is None else np.asarray(np.asarray(others).any(axis=1))
    model = inputs.sensor.model
    return (*plate_checks(model, alone, shown.times_s, shown.rate_hz, inputs.plates, bears), *found)


def subject_markers(markers: MarkerTrajectories, subject: Subject) -> MarkerTrajectories:
    """The capture's trajectories of the subject's markers, under the subject's names.

    Raises:
        NotObservable: There are too few of them.
    """
    found = match_names(markers.names, subject.markers)
    if len(found) < MIN_MARKERS:
        raise NotObservable(
            f"the capture has {len(found)} of the subject's markers (protocol '{subject.protocol}'; "
            f"at least {MIN_MARKERS} are needed); its own are {', '.join(markers.names[:6]) or 'none'}"
        )
    return replace(markers.select(tuple(found)), names=tuple(marker.name for marker in found.values()))


def _hidden(markers: MarkerTrajectories, hide: Sequence[Hidden]) -> BoolArray:
    hidden = np.zeros(markers.present.shape, dtype=bool)
    for one in hide:
        if one.to_s < one.from_s:
            raise InvalidInput(f"--hide: the time window {one.from_s}:{one.to_s} ends before it begins")
        frames = (markers.times_s >= one.from_s) & (markers.times_s <= one.to_s)
        for name in one.names:
            if name not in markers.names:
                raise UnknownName("marker", name, markers.names, "--hide")
            hidden[frames, markers.names.index(name)] = True
    return hidden & markers.present


def _plates(capture: Capture, without: Sequence[str]) -> tuple:
    names = [plate.name for plate in capture.plates]
    for name in without:
        if name not in names:
            raise UnknownName("plate", name, names or ["(the capture has none)"], "--without-plate")
    return tuple(plate for plate in capture.plates if plate.name not in without)


def assemble(
    capture: Capture,
    subject: Subject,
    settings: ReconstructSettings,
    measured: MarkerTrajectories,
    hidden: BoolArray,
    inputs: FilterInputs,
    result: Track,
) -> Reconstruction:
    """Reactions, torques and clinical coordinates of a tracked trial, put together.

    Args:
        capture: The trial, for its name and notes.
        subject: The person, as tracked.
        settings: The filter and its settings.
        measured: (T, M, 3) the subject's markers.
        hidden: (T, M) those taken away on purpose.
        inputs: What the filter was built from, with the plates it read.
        result: The track.
    """
    model, unobservable = inputs.sensor.model, inputs.unobservable
    ground = reactions(model, result, measured.times_s, measured.rate_hz, inputs.plates)
    tau, names = ground.tau, dof_names(model)
    tau_sd, tau_offset = (
        np.where(np.isnan(tau), np.nan, sd) for sd in (result.torque_sd, result.torque_offset)
    )
    frame = pelvis_frame(settings.pelvis, model, result.q, measured.times_s)
    reading = angle_reading(settings.angles, model, subject, capture.processing)
    zero_q = zero_posture(settings.angles_zero, subject)
    clinical = clinical_motion(model, result, tau, tau_sd, frame, reading, zero_q)
    located = result.tracked & _located(result)
    supports = ground.supports
    bears = bearing(supports.wrench)
    known = torques_known(model, clinical.names, clinical.moments_sd, ground.foot_source, bears)
    known &= torques_possible(tau, ROOT_DOFS, model.mass_kg)
    told_of_track = _warnings(result, names, unobservable, "marker" if measured.names else "sensor")
    return Reconstruction(
        trial=Path(capture.path).stem or "capture", protocol=subject.protocol, filter=settings.filter,
        smoothed=result.smoothed, uncorrected=int(result.uncorrected.sum()),
        version=__version__, subject=subject, rate_hz=measured.rate_hz,
        times_s=measured.times_s,
        dof_names=names, q=result.q, v=result.v, a=result.a, tau=tau, sd_q=result.position_sd,
        sd_v=result.velocity_sd, sd_tau=tau_sd, sd_q_offset=result.position_offset,
        sd_v_offset=result.velocity_offset, sd_tau_offset=tau_offset,
        coordinate_names=clinical.names, angles=clinical.angles, angles_lab=clinical.angles_lab,
        angle_rates=clinical.rates, moments=clinical.moments, angles_sd=clinical.angles_sd,
        angle_rates_sd=clinical.rates_sd, moments_sd=clinical.moments_sd, singular=clinical.singular,
        angles_sd_offset=clinical.angles_offset, angle_rates_sd_offset=clinical.rates_offset,
        moments_sd_offset=clinical.moments_offset,
        direction=frame.direction, heading_rad=frame.heading_rad, angles_read=reading.name,
        angles_zero=settings.angles_zero,
        marker_names=measured.names, measured_m=measured.positions_m,
        predicted_m=_predicted(inputs.sensor, result, measured, hidden), hidden=hidden,
        rejected=result.refused,
        foot_wrench=ground.wrench, foot_wrench_sd=ground.wrench_sd, foot_cop_m=ground.centre_of_pressure_m,
        foot_wrench_sd_offset=None if ground.wrench_sd is None else result.wrench_offset,
        foot_free_moment_nm=ground.free_moment_nm, foot_contact=result.contact,
        foot_source=ground.foot_source,
        support_names=supports.names, support_wrench=supports.wrench,
        support_wrench_sd=supports.wrench_sd, support_point_m=supports.point_m,
        residual_force_n=ground.residual_force_n, residual_moment_nm=ground.residual_moment_nm,
        plate_change=ground.plate_change, plate_corners_m=_corners(capture),
        tracked=result.tracked, measured=ground.measured & located, valid=ground.accounted & located & known,
        nis=result.nis, nis_readings=result.readings, step_seconds=result.step_seconds,
        nis_by_kind=result.nis_by_kind, nis_readings_by_kind=result.readings_by_kind,
        marker_nis=result.marker_nis, marker_spread_m=result.marker_spread_m,
        covariance=result.covariance,
        unobserved_dofs=tuple(name for name, without in zip(names, unobservable, strict=True) if without),
        warnings=(*capture.notes, *inputs.remarks, *ground.warnings, *told_of_track),
        settings=recorded(settings), file_axes=capture.axes, file_axes_source=capture.axes_source.value,
    )  # fmt: skip


def _located(result: Track) -> BoolArray:
    """(T,) frames in which the height of both feet is known."""
    return np.asarray((result.foot_height_sd <= FOOT_SD_M).all(axis=1))


def _corners(capture: Capture) -> Array | None:
    unknown = np.full((4, 3), np.nan)
    corners = [unknown if plate.corners_m is None else plate.corners_m for plate in capture.plates]
    return np.array(corners) if corners else None


def _predicted(sensor: MarkerSensor, result: Track, measured: MarkerTrajectories, hidden: BoolArray) -> Array:
    """(T, M, 3) markers of the reconstructed body, with their skin's offset where they were not seen."""
    shown = ~hidden & measured.present
    positions = np.where(shown[:, :, None], measured.positions_m, np.nan)
    on_body, with_skin = filled(sensor, result.q, positions, 1.0 / measured.rate_hz, result.smoothed)
    return np.where(shown[:, :, None], on_body, with_skin)


def _remarks(checks: Sequence[Finding], subject: Subject, found: Reconstruction) -> tuple[str, ...]:
    """All that is to be told: of checks first, then of innovations, then of the trial."""
    first = (*told(tuple(checks)), *innovations.told(found), *inferred_set(subject), *_doubts(subject))
    return (*first, *found.warnings, *supports_told(found.contacts))


def _doubts(subject: Subject) -> tuple[str, ...]:
    """What speaks against the scaled body."""
    found = subject.report.get(DOUBTS_KEY)
    return tuple(f"the subject file: {doubt}" for doubt in found) if isinstance(found, list) else ()


def inferred_set(subject: Subject) -> tuple[str, ...]:
    """What is to be told of a person whose marker set was inferred; nothing of one with a known set."""
    inferred = subject.report.get(INFERRED_KEY)
    return (str(inferred["told"]),) if isinstance(inferred, dict) else ()


def _warnings(result: Track, names: tuple[str, ...], unobservable: BoolArray, instrument: str) -> list[str]:
    """Remarks on a trial.

    Args:
        result: The track.
        names: (nv,) of the dofs.
        unobservable: (nv,) those that no instrument tells of.
        instrument: What tells of the others.
    """
    warnings = []
    if unobservable.any():
        listed = ", ".join(name for name, without in zip(names, unobservable, strict=True) if without)
        warnings.append(
            f"{int(unobservable.sum())} dofs move no {instrument} and keep the neutral posture: {listed}"
        )
    lost = int((~result.tracked).sum())
    if lost:
        warnings.append(
            f"{lost} of {len(result.tracked)} frames have too few markers within the gate to track the body, "
            "or most of them far from where it was"
        )
    if result.uncorrected.any():
        warnings.append(
            f"what later frames made of {int(result.uncorrected.sum())} of {len(result.tracked)} frames is no person: "
            "they stand as the filter alone had them; readings contradict each other, see the units and the checks"
        )
    gone = int((~result.known[result.starts[0] :]).sum()) if result.starts else 0
    if gone:
        warnings.append(
            f"in {gone} frames the readings lead to no person that moves: nothing is told of them, and they do not "
            "count as tracked; see the units and the checks"
        )
    if len(result.starts) > 1:
        warnings.append("the filter started anew at frames " + ", ".join(str(t) for t in result.starts[1:]))
    refused = int(result.refused.sum())
    if refused:
        warnings.append(f"{refused} marker samples lay outside the innovation gate and were refused")
    return warnings
