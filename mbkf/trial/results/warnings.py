"""Warnings of a trial's result: of the checks, the innovations, the subject and the track."""

from __future__ import annotations

from collections.abc import Sequence

from mbkf.conventions import BoolArray
from mbkf.filters.plausibility import MOST_RAD_S
from mbkf.filters.record import Track
from mbkf.io.findings import Finding
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.scaling.verdict import APPROXIMATED_KEY, DOUBTS_KEY
from mbkf.trial.checks.judge import messages
from mbkf.trial.preparation.coverage import INFERRED_KEY
from mbkf.trial.results import innovations
from mbkf.trial.results.supports import supports_remarks

MOST_LISTED = 4
"""Number of unexplained loads that have a remark of their own."""


def all_warnings(checks: Sequence[Finding], subject: Subject, found: Reconstruction) -> tuple[str, ...]:
    """Warnings of a result, in order: of checks, innovations, the marker set, the subject file, the trial.

    Args:
        checks: The checks of the trial.
        subject: The person.
        found: The result, with the warnings of the trial itself.
    """
    report = subject.report
    inferred, doubts = report.get(INFERRED_KEY), report.get(DOUBTS_KEY)
    known = report.get(APPROXIMATED_KEY)
    return (
        *messages(tuple(checks)),
        *unexplained_remarks(found.unexplained),
        *(one.sentence for one in found.limb_doubts),
        *innovations.remarks(found),
        *((str(inferred["told"]),) if isinstance(inferred, dict) else ()),
        *(f"the subject file: {doubt}" for doubt in (doubts if isinstance(doubts, list) else ())),
        *(f"the body: {one}" for one in (known if isinstance(known, list) else ())),
        *found.warnings,
        *supports_remarks(found.contacts),
    )


def unexplained_remarks(loads: Sequence[UnexplainedLoad]) -> tuple[str, ...]:
    """A remark on each unexplained load, the largest first."""
    largest = sorted(loads, key=lambda one: -one.force_n)
    rest = (f"and {len(loads) - MOST_LISTED} smaller unexplained forces",) if len(loads) > MOST_LISTED else ()
    return (*(one.sentence for one in largest[:MOST_LISTED]), *rest)


def track_warnings(
    result: Track, names: tuple[str, ...], unobservable: BoolArray, instrument: str
) -> list[str]:
    """Remarks on a trial.

    Args:
        result: The track.
        names: (nv,) of the dofs.
        unobservable: (nv,) those that no instrument observes.
        instrument: The instrument that observes the others.
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
            f"smoothing failed in {int(result.uncorrected.sum())} of {len(result.tracked)} frames (joint rates above "
            f"{MOST_RAD_S:g} rad/s, impossible loads, or a body away from its markers); these frames keep the filtered "
            "estimate: readings contradict each other, check units, marker names and the checks"
        )
    gone = int((~result.known[result.starts[0] :]).sum()) if result.starts else 0
    if gone:
        warnings.append(
            f"in {gone} frames the estimate was implausible (joint rates above {MOST_RAD_S:g} rad/s or impossible "
            "loads) and was dropped; they do not count as tracked: check units, marker names and the checks"
        )
    if len(result.starts) > 1:
        anew = ", ".join(str(t) for t in result.starts[1:])
        warnings.append(f"the filter started anew at frame{'s' if len(result.starts) > 2 else ''} {anew}")
    refused = int(result.rejected.sum())
    if refused:
        warnings.append(f"{refused} marker samples lay outside the innovation gate and were refused")
    return warnings
