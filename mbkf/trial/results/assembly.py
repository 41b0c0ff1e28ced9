"""The result of a tracked trial: reactions, torques, clinical coordinates and warnings put together."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.tracking import Track
from mbkf.io.contacts import bearing
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.model.clinical import dof_names
from mbkf.sensors.gap_filling import filled
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.trial.preparation.filters import FilterInputs
from mbkf.trial.preparation.settings import ReconstructSettings, recorded
from mbkf.trial.results.clinical import clinical_motion
from mbkf.trial.results.progression import pelvis_frame
from mbkf.trial.results.reactions import reactions
from mbkf.trial.results.readings import angle_reading, zero_posture
from mbkf.trial.results.summary import ROOT_DOFS
from mbkf.trial.results.validity import torques_known, torques_possible
from mbkf.trial.results.warnings import track_warnings
from mbkf.version import __version__

FOOT_SD_M = 0.03
"""A foot whose height is known no better than this may or may not touch the floor."""


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
    told_of_track = track_warnings(result, names, unobservable, "marker" if measured.names else "sensor")
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
