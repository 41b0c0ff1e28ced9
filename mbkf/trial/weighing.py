"""A scaled person's mass by the plates of the captures: by standing, or by the impulse of any movement."""

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
from mbkf.trial.checks.unscaled_mass import PERSONS_KG, PLATES_KEY, stated_mass_notes
from mbkf.trial.preparation.inputs import trial_inputs
from mbkf.trial.preparation.markers_alone import markers_alone
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.preparation.static_names import markers_as_scaled

PROVISIONAL_KG = 70.0
"""Mass to scale with while it is unknown; scale factors and markers do not depend on it."""

PASSES = 2
"""Number of passes: the second judges impossible readings by the mass of the first."""

GIVE_MASS = "; give --mass KG"
"""Remedy of a person whom no plates weigh, for a command that has the option."""

MASS_KEY = "mass"
"""Key of a subject's report for the capture by which a person was weighed."""


def weighed(subject: Subject, captures: Sequence[Capture]) -> Subject:
    """The person with the mass of least standard deviation that plates give, noted in the report.

    Args:
        subject: The scaled person, of any mass.
        captures: Captures of the person, some of them with plates.

    Raises:
        InvalidInput: The plates of no capture give the mass.
    """
    found, why = [], "no capture has plates"
    for capture in captures:
        if not capture.plates:
            continue
        finding = _weighed(subject, capture)
        why = finding.hint
        if finding.better is not None and not PERSONS_KG[0] <= finding.better <= PERSONS_KG[1]:
            why = f"{finding.better:.0f} kg is not the mass of a person; check the plates' units, gains and offsets"
        elif finding.better is not None and finding.expected_sd is not None:
            found.append((finding.expected_sd, finding.better, Path(capture.path).name))
    if not found:
        stated = [one.subject_mass_kg for one in captures if one.subject_mass_kg is not None]
        leave = f"; {stated[0]:.1f} kg, which a capture states, is used without --mass" if stated else ""
        raise InvalidInput(f"the plates do not give the body mass ({why}){leave}{GIVE_MASS}")
    sd, mass_kg, name = min(found)
    note: dict[str, object] = {"kg": mass_kg, "sd_percent": sd, "capture": name}
    report = {key: value for key, value in subject.report.items() if key != PLATES_KEY}
    contradictions = stated_mass_notes(captures, mass_kg)
    if contradictions:
        report[PLATES_KEY] = contradictions
    return replace(subject, mass_kg=mass_kg, report={**report, MASS_KEY: note})


def _weighed(subject: Subject, capture: Capture) -> Finding:
    """The finding about the mass from the plates of a capture."""
    finding = mass.undetermined("the capture has too few of the subject's markers")
    for _ in range(PASSES):
        with single_threaded():
            try:
                checked = checked_for_subject(capture, subject)
                markers = markers_as_scaled(checked.markers, subject)
            except NotObservable:
                return finding
            person = subject.in_neutral_posture()
            inputs, recording = trial_inputs(
                markers, checked.plates, person, ReconstructSettings(), body_errors=False
            )
            motion = markers_alone(inputs, recording)
            model, times = inputs.sensor.model, markers.times_s
            found = plate_checks(model, motion, times, markers.rate_hz, inputs.plates)
        finding = next(one for one in found if one.name == mass.NAME)
        if finding.better is None:
            return finding
        subject = replace(subject, mass_kg=finding.better)
    return finding
