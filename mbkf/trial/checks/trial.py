"""All checks of one trial, from what its filter was built from and the motion of its markers alone."""

from __future__ import annotations

import numpy as np

from mbkf.filters.estimate import Recording
from mbkf.io.findings import Finding
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.scaling.trial_lengths import LengthEvidence
from mbkf.sensors.supports.block import BEARING
from mbkf.trial.checks.judge import marker_checks, plate_checks
from mbkf.trial.checks.persons import finding_of_markers, person_finding
from mbkf.trial.checks.places import place_of_markers_finding
from mbkf.trial.preparation.filters import FilterInputs
from mbkf.trial.preparation.markers_alone import Motion


def trial_checks(
    shown: MarkerTrajectories,
    subject: Subject,
    inputs: FilterInputs,
    recording: Recording,
    alone: Motion | None,
    before: Subject | None = None,
    lengths: LengthEvidence | None = None,
) -> tuple[Finding, ...]:
    """All checks of the trial, those of the plates first.

    Args:
        shown: The markers that are used.
        subject: The person.
        inputs: What the filter was built from.
        recording: What the instruments read, with what bears besides the feet.
        alone: The motion of markers alone; None without plates.
        before: The person before markers were corrected on the trial; None where they were not.
        lengths: Segment lengths by that correction; None where a few frames are to show them.
    """
    person = finding_of_markers(subject, shown) if lengths is None else person_finding(lengths)
    found = (*marker_checks(shown, subject), person)
    if before is not None:
        found = (*found, place_of_markers_finding(before, subject, shown.names))
    if alone is None or not inputs.plates:
        return found
    others = recording.readings.get(BEARING)
    bears = None if others is None else np.asarray(np.asarray(others).any(axis=1))
    model = inputs.sensor.model
    return (
        *plate_checks(model, alone, shown.times_s, shown.rate_hz, inputs.plates, bears, recording.plates),
        *found,
    )
