"""A scaled person's mass by the plates of the captures: standing, or over any movement by their impulse."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from mbkf.errors import InvalidInput, NotObservable
from mbkf.io.findings import Finding
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.numerics.threads import single_threaded
from mbkf.trial.axes.captures import checked_for_subject
from mbkf.trial.checks import mass
from mbkf.trial.checks.judge import plate_checks
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.markers_alone import markers_alone
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings

PROVISIONAL_KG = 70.0
"""A mass to scale with before it is known; scale factors and markers do not depend on it."""

PASSES = 2
"""Which readings no plate under a person gives depends on the mass: the second pass knows it."""

MASS_KEY = "mass"
"""Key of a subject's report under which it stands by which capture a person was weighed."""


def weighed(subject: Subject, captures: Sequence[Capture]) -> Subject:
    """The person with the mass that plates tell best, and a note of it in the report.

    Args:
        subject: The scaled person, of any mass.
        captures: Captures of the person; those with plates count.

    Raises:
        InvalidInput: No capture tells the mass.
    """
    found, why = [], "no capture has plates"
    for capture in captures:
        if not capture.plates:
            continue
        finding = _weighed(subject, capture)
        why = finding.hint
        if finding.better is not None and finding.expected_sd is not None:
            found.append((finding.expected_sd, finding.better, Path(capture.path).name))
    if not found:
        raise InvalidInput(f"the plates do not tell the body mass ({why}); give --mass KG")
    sd, mass_kg, name = min(found)
    told: dict[str, object] = {"kg": mass_kg, "sd_percent": sd, "capture": name}
    return replace(subject, mass_kg=mass_kg, report={**subject.report, MASS_KEY: told})


def _weighed(subject: Subject, capture: Capture) -> Finding:
    """What the plates of a capture say of the mass."""
    finding = mass.undetermined("the capture has too few of the subject's markers")
    for _ in range(PASSES):
        with single_threaded():
            try:
                checked = checked_for_subject(capture, subject)
                markers = subject_markers(checked.markers, subject)
            except NotObservable:
                return finding
            inputs, recording = trial_inputs(markers, checked.plates, subject, ReconstructSettings())
            motion = markers_alone(inputs, recording)
            model, times = inputs.sensor.model, markers.times_s
            found = plate_checks(model, motion, times, markers.rate_hz, inputs.plates)
        finding = next(one for one in found if one.name == mass.NAME)
        if finding.better is None:
            return finding
        subject = replace(subject, mass_kg=finding.better)
    return finding
