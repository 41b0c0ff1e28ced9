"""The steps before and after a filter, in their order: of a trial that is read whole, and of a look at a long one."""

from __future__ import annotations

from dataclasses import dataclass, replace

from mbkf.conventions import Array, BoolArray
from mbkf.filters.estimate import Recording
from mbkf.filters.record import Track
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.scaling.correction import correction
from mbkf.scaling.trial_lengths import LengthEvidence
from mbkf.trial.checks.plate_contradictions import plate_contradictions
from mbkf.trial.preparation.coverage import MarkerUse, use_by_subject
from mbkf.trial.preparation.entering import without_entering
from mbkf.trial.preparation.exchanged import exchange_notes, names_put_right
from mbkf.trial.preparation.filters import FilterInputs
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.selection import (
    hidden_samples,
    subject_markers,
    without_plates,
    without_samples,
)
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.preparation.shrunken import without_shrunken
from mbkf.trial.results.progression import Progression


@dataclass(frozen=True)
class Ready:
    """A trial whose filter can begin.

    Attributes:
        measured: The subject's markers under their right names.
        hidden: (T, M) samples that are taken away on purpose.
        shown: The markers without them.
        exchanged: Pairs of exchanged names, and in how many frames.
        remarks: Remarks on the markers.
        use: Use of the capture's markers.
        notes: Remarks on that, and on plates that contradict themselves.
        subject: The person, as tracked.
        before: The person before markers were corrected on the trial; None where they were not.
        lengths: Segment lengths by that correction; None without it.
        inputs: Inputs of the filters.
        recording: Readings of markers and plates.
    """

    measured: MarkerTrajectories
    hidden: BoolArray
    shown: MarkerTrajectories
    exchanged: tuple[tuple[str, str, int], ...]
    remarks: tuple[str, ...]
    use: MarkerUse
    notes: tuple[str, ...]
    subject: Subject
    before: Subject | None
    lengths: LengthEvidence | None
    inputs: FilterInputs
    recording: Recording


def ready(
    capture: Capture, subject: Subject, settings: ReconstructSettings, times_s: Array | None = None
) -> Ready:
    """All that is decided before a filter runs.

    Args:
        capture: The trial, in right axes.
        subject: The person.
        settings: Settings of the reconstruction.
        times_s: (T,) times of frames that do not follow each other; None for those of the markers.

    Raises:
        NotObservable: Too few of the subject's markers to track the body.
        NotConverged: The markers do not fit the subject's body.
        UnknownName: A hidden marker or a withheld plate does not exist.
    """
    measured, exchanged, remarks = put_right(capture.markers, subject, settings)
    use = use_by_subject(capture.markers, subject)
    hidden = hidden_samples(measured, settings.hide, times_s)
    shown = without_samples(measured, hidden)
    plates = without_plates(capture, settings.without_plates).plates
    notes = [use.warning] if use.warning else []
    notes += plate_contradictions(replace(capture, plates=plates)) if settings.checks else ()
    tracked, before, lengths = _for_trial(subject, shown, settings)
    inputs, recording = trial_inputs(shown, plates, tracked, settings)
    return Ready(
        measured=measured,
        hidden=hidden,
        shown=shown,
        exchanged=exchanged,
        remarks=tuple(remarks),
        use=use,
        notes=tuple(notes),
        subject=tracked,
        before=before,
        lengths=lengths,
        inputs=inputs,
        recording=recording,
    )


def put_right(
    markers: MarkerTrajectories, subject: Subject, settings: ReconstructSettings
) -> tuple[MarkerTrajectories, tuple[tuple[str, str, int], ...], list[str]]:
    """The subject's markers under their right names, without mixtures and entering frames; the exchanges, and notes.

    Args:
        markers: All markers of the capture.
        subject: The person.
        settings: Settings of the reconstruction.

    Raises:
        NotObservable: Too few of them are the subject's.
    """
    named, exchanged = names_put_right(subject_markers(markers, subject), subject)
    own, shrunken = without_shrunken(named, subject)
    start = settings.kinematic
    measured, entering = without_entering(own, subject, start.min_markers, start.restart_after_s)
    return measured, exchanged, [*exchange_notes(exchanged), *shrunken, *entering]


def _for_trial(
    subject: Subject, shown: MarkerTrajectories, settings: ReconstructSettings
) -> tuple[Subject, Subject | None, LengthEvidence | None]:
    """The subject as it is tracked, the one before and the trial's lengths, both None without a correction.

    Args:
        subject: The person.
        shown: The markers that are used.
        settings: Settings of the reconstruction.

    Raises:
        NotConverged: The markers do not fit the subject's body.
    """
    if not settings.correct_markers:
        return subject.in_neutral_posture(), None, None
    found = correction(subject, shown)
    return found.subject, subject, found.lengths


def needs_motion(settings: ReconstructSettings, inputs: FilterInputs) -> bool:
    """True where checks of plates or the search for other contacts need the motion of markers alone.

    Args:
        settings: Settings of the reconstruction.
        inputs: Inputs of the filters.
    """
    judges_plates = settings.checks and len(inputs.plates) > 0
    return judges_plates or (searches_contacts(settings) and bool(inputs.sensor.model.description.bearings))


def searches_contacts(settings: ReconstructSettings) -> bool:
    """True where contacts of other parts than the feet are looked for."""
    return settings.other_contacts and settings.filter == "dynamic"


def result_of(
    capture: Capture,
    subject: Subject,
    settings: ReconstructSettings,
    markers: tuple[MarkerTrajectories, BoolArray, MarkerUse],
    inputs: FilterInputs,
    track: Track,
    wrench: Array,
    frame: Progression | None = None,
) -> Reconstruction:
    """The result of a tracked trial, before it is judged.

    Args:
        capture: The trial, with the notes that the result keeps.
        subject: The person, as tracked.
        settings: Settings of the reconstruction.
        markers: The subject's markers, hidden samples (T, M) of them, and the use of the capture's.
        inputs: Inputs of the filter, with the plates it read.
        track: The track.
        wrench: (T, P, 6) wrenches of the plates over the frames.
        frame: Of a part of a trial, the frame of the pelvis's angles by the whole one; None: the motion shows it.
    """
    # the first frame need not wait for these
    from mbkf.trial.loads.partners import others_of, with_contacts
    from mbkf.trial.results.assembly import assemble

    measured, hidden, use = markers
    found = assemble(capture, subject, settings, measured, hidden, inputs, track, wrench, frame)
    found = with_contacts(found, inputs.sensor.model, subject, measured, others_of(capture, use.used))
    return replace(found, markers_ignored=dict(use.ignored), markers_explained=use.share)
