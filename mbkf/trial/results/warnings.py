"""Warnings of a trial's result: of the checks, the innovations, the subject and the track."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

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

TrackRecords: TypeAlias = Mapping[str, BoolArray] | NDArray
"""Records of frames, or their flags by the names of fields (:mod:`mbkf.filters.record`)."""

MOST_LISTED = 4
"""Number of unexplained loads that have a remark of their own."""


def all_warnings(checks: Sequence[Finding], subject: Subject, found: Reconstruction) -> tuple[str, ...]:
    """Warnings of a result, in order: of checks, innovations, the marker set, the subject file, the trial.

    Args:
        checks: The checks of the trial.
        subject: The person.
        found: The result, with the warnings of the trial itself.
    """
    return (
        *finding_warnings(checks, found),
        *innovations.remarks(found),
        *subject_warnings(subject),
        *found.warnings,
        *supports_remarks(found.contacts),
    )


def finding_warnings(checks: Sequence[Finding], found: Reconstruction) -> tuple[str, ...]:
    """Warnings of checks, of unexplained loads and of limbs in doubt.

    Args:
        checks: The checks of the trial.
        found: The result.
    """
    doubts = (one.sentence for one in found.limb_doubts)
    return (*messages(tuple(checks)), *unexplained_remarks(found.unexplained), *doubts)


def subject_warnings(subject: Subject) -> tuple[str, ...]:
    """Warnings of the marker set and the subject file.

    Args:
        subject: The person.
    """
    report = subject.report
    inferred, doubts = report.get(INFERRED_KEY), report.get(DOUBTS_KEY)
    known = report.get(APPROXIMATED_KEY)
    return (
        *((str(inferred["told"]),) if isinstance(inferred, dict) else ()),
        *(f"the subject file: {doubt}" for doubt in (doubts if isinstance(doubts, list) else ())),
        *(f"the body: {one}" for one in (known if isinstance(known, list) else ())),
    )


def unexplained_remarks(loads: Sequence[UnexplainedLoad]) -> tuple[str, ...]:
    """A remark on each unexplained load, the largest first."""
    largest = sorted(loads, key=lambda one: -one.force_n)
    rest = (f"and {len(loads) - MOST_LISTED} smaller unexplained forces",) if len(loads) > MOST_LISTED else ()
    return (*(one.sentence for one in largest[:MOST_LISTED]), *rest)


@dataclass
class TrackCounts:
    """Numbers of frames of a track that did not go as usual, from one track or from its parts in order.

    Attributes:
        frames: Frames in all.
        lost: Without enough markers to follow the body.
        uncorrected: Left as the filter had them, where smoothing failed.
        gone: Whose estimate was implausible and was dropped.
        refused: Marker samples that the innovation gate refused.
        starts: Frames at which the filter was started or restarted.
    """

    frames: int = 0
    lost: int = 0
    uncorrected: int = 0
    gone: int = 0
    refused: int = 0
    starts: list[int] = field(default_factory=list)

    def add(self, part: TrackRecords) -> None:
        """Adds the next frames.

        Args:
            part: Flags of the frames by the fields of their records.
        """
        known, started = part["known"], np.flatnonzero(part["started"])
        first = 0 if self.starts else int(started[0]) if len(started) else len(known)
        self.gone += int((~known[first:]).sum())
        self.starts += [self.frames + int(t) for t in started]
        self.lost += int((~part["tracked"]).sum())
        self.uncorrected += int(part["uncorrected"].sum())
        self.refused += int(part["rejected"].sum())
        self.frames += len(known)

    @classmethod
    def of(cls, track: Track) -> TrackCounts:
        """Those of a whole track."""
        started = np.zeros(len(track.known), dtype=bool)
        started[list(track.starts)] = True
        counts, names = cls(), ("known", "tracked", "uncorrected", "rejected")
        counts.add({name: getattr(track, name) for name in names} | {"started": started})
        return counts


def track_warnings(
    counts: TrackCounts, names: tuple[str, ...], unobservable: BoolArray, instrument: str
) -> list[str]:
    """Remarks on a trial.

    Args:
        counts: Frames of the track.
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
    if counts.lost:
        warnings.append(
            f"{counts.lost} of {counts.frames} frames have too few markers within the gate to track the body, "
            "or most of them far from where it was"
        )
    if counts.uncorrected:
        warnings.append(
            f"smoothing failed in {counts.uncorrected} of {counts.frames} frames (joint rates above "
            f"{MOST_RAD_S:g} rad/s, impossible loads, or a body away from its markers); these frames keep the filtered "
            "estimate: readings contradict each other, check units, marker names and the checks"
        )
    if counts.gone:
        warnings.append(
            f"in {counts.gone} frames the estimate was implausible (joint rates above {MOST_RAD_S:g} rad/s or "
            "impossible loads) and was dropped; they do not count as tracked: check units, marker names and the checks"
        )
    if len(counts.starts) > 1:
        anew = ", ".join(str(t) for t in counts.starts[1:])
        warnings.append(f"the filter started anew at frame{'s' if len(counts.starts) > 2 else ''} {anew}")
    if counts.refused:
        warnings.append(f"{counts.refused} marker samples lay outside the innovation gate and were refused")
    return warnings
