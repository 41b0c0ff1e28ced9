"""All checks of a trial, in an order in which a fault that one finds is corrected for the next."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.findings import Finding
from mbkf.io.records import MarkerTrajectories, PlateReadings
from mbkf.io.subject import Subject
from mbkf.model.body import Body
from mbkf.numerics.windows import dilated
from mbkf.trial.checks import clocks, floor, gains, lengths, mass, newton, order, orientation, rigidity
from mbkf.trial.checks.evidence import Evidence
from mbkf.trial.preparation.markers_alone import Motion

OTHERS_S = 0.2
"""Within this time of a contact of another part than a foot, plates do not carry the whole load."""


def marker_checks(markers: MarkerTrajectories, subject: Subject) -> tuple[Finding, ...]:
    """Checks that need markers and the subject alone.

    Args:
        markers: The subject's markers, under the subject's names.
        subject: The person.
    """
    return lengths.length_finding(subject), rigidity.rigidity_finding(markers, subject)


def plate_checks(
    model: Body,
    motion: Motion,
    times_s: Array,
    rate_hz: float,
    plates: tuple[PlateReadings, ...],
    others: BoolArray | None = None,
    wrench: Array | None = None,
) -> tuple[Finding, ...]:
    """Checks of the plates against the motion of markers alone.

    Wrong axes of a plate, exchanged plates and a late clock are corrected for the checks that follow, so that each
    finds one fault; Newton's law is judged for the capture as it is.

    Args:
        model: The body.
        motion: Its motion from markers alone.
        times_s: (T,) times of the frames.
        rate_hz: Frame rate.
        plates: The plates.
        others: (T,) frames in which parts besides the feet carry load.
        wrench: (T, P, 6) wrenches of the plates over the frames, where they are known.
    """
    if not plates:
        return ()

    def evidence_of(given: tuple[PlateReadings, ...], wrench: Array | None = None) -> Evidence:
        return Evidence.of(model, motion, times_s, rate_hz, given, wrench)

    as_read = evidence_of(plates, wrench)
    near = np.zeros(len(times_s), dtype=bool)
    if others is not None and not gains.explained(as_read):
        near = dilated(others, round(OTHERS_S * rate_hz))
    axes, laid = orientation.axes_findings(as_read.without(near))
    turned = any(one.verdict == "outside" for one in axes)
    evidence = evidence_of(laid) if turned else as_read
    exchanged = None
    if not turned:
        exchanged, laid = order.order_finding(as_read.without(near))
        evidence = as_read if exchanged is None else evidence_of(laid)
    clock = clocks.clock_finding(evidence.without(near))
    if clock.verdict == "outside" and clock.value is not None:
        evidence = evidence_of(clocks.delayed(laid, -1e-3 * clock.value))
    gain = gains.gain_finding(evidence.without(near))
    weight = mass.mass_finding(evidence, near, gain.verdict != "outside")
    before = newton.newton_findings(as_read.restricted(evidence.accounted & ~near))
    places = orientation.place_findings(evidence.without(near))
    height = floor.floor_finding(evidence, model, motion)
    found = () if exchanged is None else (exchanged,)
    return (weight, *before, gain, clock, *axes, *found, *places, height)


def messages(checks: tuple[Finding, ...]) -> tuple[str, ...]:
    """Warnings of checks outside their bounds; of Newton's law only if no other check explains it."""
    outside = [one for one in checks if one.verdict == "outside"]
    consequences = (newton.FORCE, newton.MOMENT)
    causes = [one for one in outside if one.name not in consequences]
    return tuple(f"{one.name}: {_number(one)}; {one.hint}" for one in causes or outside)


def _number(finding: Finding) -> str:
    assert finding.value is not None and finding.expected_sd is not None
    return f"{finding.value:+.3g} {finding.unit} (noise explains ± {2.0 * finding.expected_sd:.2g})"
