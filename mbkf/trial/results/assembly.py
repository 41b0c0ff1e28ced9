"""The result of a tracked trial: reactions, torques, clinical coordinates and warnings put together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import compress
from pathlib import Path

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.record import Track
from mbkf.io.contacts import bearing
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.result_groups import Measurements, Provenance, Quality
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.io.utf8 import storable
from mbkf.model.body import Body
from mbkf.sensors.gap_filling import filled
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.trial.emg.muscles import muscles_of
from mbkf.trial.loads.balance import LoadBalance
from mbkf.trial.loads.unexplained import unexplained_loads
from mbkf.trial.preparation.filters import FilterInputs
from mbkf.trial.preparation.settings import ReconstructSettings, recorded
from mbkf.trial.results.clinical import clinical_motion
from mbkf.trial.results.progression import Progression, pelvis_frame
from mbkf.trial.results.reactions import GroundReactions, ground_reactions
from mbkf.trial.results.readings import angle_reading, zero_posture
from mbkf.trial.results.summary import ROOT_DOFS
from mbkf.trial.results.trunk import trunk_moments
from mbkf.trial.results.validity import torques_known, torques_possible
from mbkf.trial.results.warnings import TrackCounts, track_warnings
from mbkf.version import __version__

FOOT_SD_M = 0.03
"""A foot whose height is known no better than this may or may not touch the floor."""


OPENED_S = 0.1
"""A causal filter opens a contact no longer after the end of the load that it was found by."""


def assemble(
    capture: Capture,
    subject: Subject,
    settings: ReconstructSettings,
    measured: MarkerTrajectories,
    hidden: BoolArray,
    inputs: FilterInputs,
    result: Track,
    wrench: Array | None = None,
    frame: Progression | None = None,
) -> Reconstruction:
    """Reactions, torques and clinical coordinates of a tracked trial, put together.

    Args:
        capture: The trial, for its name and notes.
        subject: The person, as tracked.
        settings: The filter and its settings.
        measured: (T, M, 3) the subject's markers.
        hidden: (T, M) those taken away on purpose.
        inputs: Inputs of the filter, with the plates it read.
        result: The track.
        wrench: (T, P, 6) wrenches of the plates over the frames, where they are known.
        frame: Of a part of a trial, the frame of the pelvis's angles by the whole one, whose track has remarks of its
            own; None: the motion shows it.
    """
    model, times_s, whole = inputs.sensor.model, measured.times_s, frame is None
    given = settings.filter == "torque" and settings.torque.plates == "inputs"
    ground = ground_reactions(model, result, times_s, measured.rate_hz, inputs.plates, given, wrench)
    torques, frame = ground.torques, frame or pelvis_frame(settings.pelvis, model, result.q, times_s)
    reading = angle_reading(settings.angles, model, subject, capture.processing)
    zero_q = zero_posture(settings.angles_zero, subject)
    motion, moments = clinical_motion(model, result, torques, frame, reading, zero_q)
    located, force_n = result.tracked & _located(result), ground.loads.foot_wrench[:, :, 2]
    bears, source = bearing(ground.supports.support_wrench), ground.loads.foot_source
    known = torques_known(model, motion.coordinate_names, moments.moments_sd, source, force_n, bears)
    known &= torques_possible(torques.tau, ROOT_DOFS, model.mass_kg)
    balance = balance_of(model, result, measured.rate_hz, ground)
    judged = unexplained_loads(balance, times_s, inputs.contradictions, causal=not result.smoothed)
    muscles, of_emg = muscles_of(capture.analog, capture.markers.start_time_s, times_s, settings.emg)
    instrument = "marker" if measured.names else "sensor"
    counts = TrackCounts.of(result)
    of_track = track_warnings(counts, motion.dof_names, inputs.unobservable, instrument) if whole else []
    warnings = (*capture.notes, *inputs.remarks, *ground.warnings, *of_track, *of_emg)
    return Reconstruction.of(
        _provenance(capture, subject, settings, measured, result, warnings),
        Measurements(
            marker_names=measured.names,
            measured_m=measured.positions_m,
            predicted_m=_predicted(inputs.sensor, result, measured, hidden),
            hidden=hidden,
            unobserved_dofs=tuple(compress(motion.dof_names, inputs.unobservable)),
            plate_names=tuple(plate.name for plate in capture.plates),
            plate_corners_m=_corners(capture),
        ),
        result,
        motion,
        torques,
        moments,
        ground.loads,
        ground.supports,
        trunk_moments(model, result, ground),
        muscles,
        Quality(
            measured=ground.measured & located,
            valid=ground.accounted & located & known & ~judged.acts,
            unexplained_force_n=judged.force_n,
            unexplained=judged.loads if result.smoothed else before_contacts(judged.loads, bears, times_s),
            limb_doubts=in_time(result.limb_doubts, times_s),
        ),
    )


def _provenance(
    capture: Capture,
    subject: Subject,
    settings: ReconstructSettings,
    measured: MarkerTrajectories,
    result: Track,
    warnings: tuple[str, ...],
) -> Provenance:
    return Provenance(
        trial=storable(Path(capture.path).stem) or "capture",
        protocol=subject.protocol,
        filter=settings.filter,
        version=__version__,
        rate_hz=measured.rate_hz,
        times_s=measured.times_s,
        smoothed=result.smoothed,
        uncorrected=int(result.uncorrected.sum()),
        subject=subject,
        settings=recorded(settings),
        processing=dict(capture.processing),
        file_axes=capture.axes,
        file_axes_source=capture.axes_source.value,
        warnings=warnings,
    )


def before_contacts(
    loads: Sequence[UnexplainedLoad], bears: BoolArray, times_s: Array
) -> tuple[UnexplainedLoad, ...]:
    """Loads but for those that a contact gives which opened before they ended; their frames do not count either way.

    Args:
        loads: The loads.
        bears: (T, B) parts besides the feet that bear.
        times_s: (T,) times of the frames.
    """
    any_bears = np.asarray(bears.any(axis=1))
    opened_s = times_s[1:][any_bears[1:] & ~any_bears[:-1]]
    return tuple(
        one for one in loads if not ((opened_s > one.from_s) & (opened_s <= one.to_s + OPENED_S)).any()
    )


def in_time(doubts: Sequence[LimbDoubt], times_s: Array) -> tuple[LimbDoubt, ...]:
    """Doubts since the first frame by the times of the trial."""
    begin = float(times_s[0])
    return tuple(
        replace(
            one,
            from_s=begin + one.from_s,
            to_s=begin + one.to_s,
            right_from_s=None if one.right_from_s is None else begin + one.right_from_s,
        )
        for one in doubts
    )


def balance_of(model: Body, result: Track, rate_hz: float, ground: GroundReactions) -> LoadBalance:
    """Positions and contacts of a tracked trial.

    Args:
        model: The body.
        result: The track.
        rate_hz: Frame rate.
        ground: Loads on it.
    """
    bears = np.nan_to_num(ground.supports.support_wrench[..., :3]).sum(axis=1)
    return LoadBalance.of(model, result.q, rate_hz, ground.loads.foot_wrench[..., :3], bears, ground.judged)


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
