"""From a capture and a subject to motion, torques and reactions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from mbkf.conventions import Array, StageCallback
from mbkf.errors import InvalidInput, UnknownName
from mbkf.filters.plant import PlantMaker
from mbkf.filters.tracking import track
from mbkf.io.records import Capture
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.numerics.threads import single_threaded
from mbkf.sensors.block import AnyBlock
from mbkf.trial.axes.captures import checked_for_subject
from mbkf.trial.gait.convention import convention_of
from mbkf.trial.inertial.on_body import ImuOnBody, with_imus
from mbkf.trial.order import needs_motion, ready, result_of, searches_contacts
from mbkf.trial.preparation.exchanged import renamed_by_filter
from mbkf.trial.preparation.filters import FILTERS, standard, tracking_filter
from mbkf.trial.preparation.markers_alone import markers_alone
from mbkf.trial.preparation.other_contacts import contact_opener, with_other_contacts
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.results.progression import PELVIS_FRAMES
from mbkf.trial.results.readings import ANGLES, zero_posture


def reconstruct(
    capture: Capture,
    subject: Subject,
    *,
    settings: ReconstructSettings | None = None,
    imus: ImuOnBody | None = None,
    blocks: Sequence[AnyBlock] = (),
    plant: PlantMaker | None = None,
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
        plant: Makes the plant of the dynamic filter, a class of :class:`mbkf.Plant`; None for the standard one.
        readings: (T, …) readings of instruments of one's own, by the name that their block knows.
        progress: Called with the stage, items done and items in all.

    Raises:
        InvalidInput: The axes or the unit of the capture cannot be right, and it is not clear what they are; or angles
            are to be zero in a static trial that the person was not scaled with; or blocks, a plant or inertial sensors
            are given for another filter than the dynamic one.
        NotObservable: Too few of the subject's markers to track the body.
        NotConverged: The markers do not fit the subject's body.
        UnknownName: A hidden marker, a withheld plate, the filter, the frame of the pelvis or the reading of angles
            does not exist.
    """
    settings = settings or ReconstructSettings()
    check_names(settings, subject, imus is not None)
    with single_threaded():
        capture = checked_for_subject(capture, subject, settings.without_plates)
        trial = ready(capture, subject, settings)
        inputs, recording, shown = trial.inputs, trial.recording, trial.shown
        notes = [*capture.notes, *trial.remarks, *trial.notes]
        if imus is not None:
            inputs, recording, of_imus = with_imus(inputs, recording, shown.times_s, imus)
            notes += of_imus
        recording = replace(recording, readings=readings) if readings else recording
        followed = None if progress is None else partial(progress, "Following markers alone")
        alone = markers_alone(inputs, recording, followed) if needs_motion(settings, inputs) else None
        if alone is not None and searches_contacts(settings):
            inputs, recording = with_other_contacts(inputs, recording, shown.times_s, alone, settings.smooths)
        result = track(
            tracking_filter(settings.filter, inputs, [*standard(inputs), *blocks] if blocks else None, plant),
            recording,
            smoothing=settings.smoothing if settings.smooths else None,
            lag_s=settings.lag_s,
            body=inputs.body,
            spreads=settings.spreads,
            keep_covariance=settings.keep_covariance,
            progress=None if progress is None else partial(progress, "Filtering"),
            contacts=None if settings.smooths or blocks else contact_opener(inputs, settings),
        )
        # the first frame need not wait for these
        from mbkf.trial.checks.in_view import in_view_finding
        from mbkf.trial.checks.trial import trial_checks
        from mbkf.trial.results.warnings import all_warnings
        from mbkf.trial.verdict.judge import judged_result

        measured, taken_up = renamed_by_filter(trial.measured, result.limb_doubts)
        capture = replace(capture, notes=tuple(notes))
        markers = measured, trial.hidden, trial.use
        found = result_of(capture, trial.subject, settings, markers, inputs, result, recording.plates)
        seen = (shown, trial.subject, inputs, recording, alone, trial.before, trial.lengths)
        view = in_view_finding(capture.markers, trial.use.used)
        judged = (*trial_checks(*seen), view) if settings.checks else ()
        return judged_result(
            replace(
                found,
                checks=judged,
                warnings=all_warnings(judged, trial.subject, found),
                names_exchanged=(*trial.exchanged, *taken_up),
            )
        )


def check_names(settings: ReconstructSettings, subject: Subject, sensors: bool) -> None:
    """Refuses a filter, a frame or a reading that does not exist, and ``sensors`` for a filter that reads none.

    Args:
        settings: Settings of the reconstruction.
        subject: The person.
        sensors: Inertial sensors are given.

    Raises:
        UnknownName: The filter, the frame of the pelvis or the reading of angles does not exist.
        InvalidInput: The filter reads no inertial sensors, or the person was not scaled with a static trial whose
            posture angles count from.
    """
    if settings.filter not in FILTERS:
        raise UnknownName("filter", settings.filter, FILTERS)
    if settings.pelvis not in PELVIS_FRAMES:
        raise UnknownName("frame of the pelvis", settings.pelvis, PELVIS_FRAMES)
    if settings.angles not in ANGLES:
        raise UnknownName("reading of angles", settings.angles, ANGLES)
    convention_of(settings.convention)
    zero_posture(settings.angles_zero, subject)
    if sensors and settings.filter != "dynamic":
        raise InvalidInput(f"the {settings.filter} filter reads no inertial sensors; use --filter dynamic")
