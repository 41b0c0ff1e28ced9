"""Whether a marker set explains a capture: what it knows, what it does not reach, and how well a person fits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import StageCallback
from mbkf.errors import MbkfError
from mbkf.io.records import Capture
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.model.protocol import Protocol
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.trial.preparation.coverage import LEAST_SHARE, MarkerUse, listed, use_by_protocol
from mbkf.trial.protocol.standing import scale_nominally

OK, DOUBTFUL, BAD = "ok", "doubtful", "bad"

WHOLE_SHARE = 0.9
"""A set that knows a smaller share of the capture's markers is not its whole set."""

GOOD_RMS_MM, POOR_RMS_MM = 12.0, 25.0
"""Up to the first the markers fit as those of a right set do (2 to 12 mm in our captures); beyond the second they are
on other places than the set says."""

POOR_MARKER_MM = 40.0
"""A single marker that fits worse than this is on another segment than the set says, or carries another's name."""

FAR_SHARE, FAR_MM = 2.7, 80.0
"""A marker that scaling moved by more than both, the first as a multiple of what the set allows for, is far from where
the set says. A standing trial shows this where its single posture fits anything."""

TWISTED_RAD = np.deg2rad(45.0)
"""A standing person none of whose joints can turn so far beyond its limits carries markers elsewhere than the set says:
with both knees' outer markers exchanged, both thighs face backwards and every marker fits."""

WRONG_SHARE, WRONG_MM = 4.0, 250.0
"""Beyond either, a marker that is far is not where the set says at all."""


@dataclass(frozen=True)
class MarkerFit:
    """How a marker fits the scaled person.

    Attributes:
        name: The marker.
        segment: The segment that the set has it on.
        rms_mm: RMS distance from where the person carries it.
        moved_mm: How far it was moved from its place in the set.
        share: The same as a multiple of what the set allows for.
    """

    name: str
    segment: str
    rms_mm: float
    moved_mm: float
    share: float

    @property
    def far(self) -> bool:
        """Whether it lies far from where the set says."""
        return self.share > FAR_SHARE and self.moved_mm > FAR_MM

    @property
    def badness(self) -> float:
        """How bad the fit is: 1 where a bound is reached."""
        return max(self.share / FAR_SHARE, self.rms_mm / POOR_MARKER_MM)

    @property
    def wrong(self) -> bool:
        """Whether it cannot be where the set says."""
        return self.far and (self.share > WRONG_SHARE or self.moved_mm > WRONG_MM)


@dataclass(frozen=True)
class SetCheck:
    """What a marker set makes of a capture.

    Attributes:
        use: The markers it knows and does not know.
        absent: Its own markers that the capture lacks, computed points aside.
        bare: Segments of its body that no known marker is on.
        rms_mm: RMS distance of the markers from the scaled person; None where none could be scaled.
        markers: The fit of every marker, the worst first.
        trouble: Why no person could be scaled, "" where one was.
        verdict: "ok", "doubtful" or "bad".
        reasons: Why it is not "ok", each with what to do.
    """

    use: MarkerUse
    absent: tuple[str, ...]
    bare: tuple[str, ...]
    rms_mm: float | None
    markers: tuple[MarkerFit, ...]
    trouble: str
    verdict: str
    reasons: tuple[str, ...]


def check_set(protocol: Protocol, capture: Capture, progress: StageCallback | None = None) -> SetCheck:
    """Scales a person by the marker set and tells how well that went.

    Args:
        protocol: The marker set.
        capture: A standing trial, or a moving one.
        progress: As for :func:`mbkf.trial.scale.scale`.
    """
    use = use_by_protocol([capture.markers], protocol)
    match = protocol.match(capture.markers.names)
    there = {match[name].name for name in use.used}
    absent = [m.name for m in protocol.markers if m.name not in there and m.kind != "computed"]
    carried = {m.segment for m in protocol.markers if m.name in there and m.kind != "computed"}
    bare = [s.name for s in protocol.body.segments if s.name not in carried]
    rms, fits, twisted, trouble = None, [], dict[str, float](), ""
    try:
        subject = scale_nominally(capture, protocol, progress)
    except MbkfError as error:
        trouble = str(error)
    else:
        rms = float(str(subject.report["marker_rms_mm"]))
        fits, twisted = _fits(subject.report["markers"], protocol), _twisted(subject)
    verdict, reasons = _judged(use, rms, fits, twisted, trouble)
    return SetCheck(use, tuple(absent), tuple(bare), rms, tuple(fits), trouble, verdict, tuple(reasons))


def _fits(report: object, protocol: Protocol) -> list[MarkerFit]:
    assert isinstance(report, dict)
    own = {marker.name: marker for marker in protocol.markers}
    found = []
    for name, entry in report.items():
        if entry["rms_mm"] is not None:
            allowed_mm = 1e3 * np.sqrt(3.0) * own[name].placement_sd_m
            moved = float(entry["moved_mm"])
            found.append(
                MarkerFit(name, own[name].segment, float(entry["rms_mm"]), moved, float(moved / allowed_mm))
            )
    return sorted(found, key=lambda one: -one.badness)


def _twisted(subject: Subject) -> dict[str, float]:
    """Segments that a standing person turns too far beyond their joints' limits, rad; none without a standing trial."""
    if subject.standing_q is None:
        return {}
    model = HumanModel.of(subject)
    deviation, _ = PostureSensor(model).deviation(subject.standing_q)
    beyond = np.abs(deviation - np.clip(deviation, *model.limits.T))
    turned = {name: float(beyond[joint.v].max()) for name, joint in model.joints.items()}
    return {name: angle for name, angle in turned.items() if angle > TWISTED_RAD}


def _judged(
    use: MarkerUse, rms: float | None, fits: list[MarkerFit], twisted: dict[str, float], trouble: str
) -> tuple[str, list[str]]:
    """The verdict and its reasons.

    Args:
        use: What the set knows of the capture.
        rms: RMS distance of the markers, mm.
        fits: Every marker's fit, the worst first.
        twisted: Segments turned beyond their joints' limits, rad.
        trouble: Why no person could be scaled.
    """
    bad, doubtful = [], []
    if trouble:
        bad.append(trouble)
    if use.unknown:
        told = f"{use.told}, not {listed(use.unknown)}: add them, or leave them out with 'mbkf protocol edit'"
        if use.share < LEAST_SHARE:
            bad.append(told)
        elif use.share < WHOLE_SHARE:
            doubtful.append(told)
    if rms is not None and rms > GOOD_RMS_MM:
        told = f"markers fit to {rms:.0f} mm RMS, a right set to {GOOD_RMS_MM:.0f}: see which are worst"
        (bad if rms > POOR_RMS_MM else doubtful).append(told)
    if twisted:
        turned = listed([f"{name} ({np.rad2deg(angle):.0f}°)" for name, angle in twisted.items()])
        worst = listed([one.name for one in fits if one.segment in twisted][:3])
        bad.append(f"turned beyond what joints allow: {turned}; are markers exchanged, {worst} among them?")
    for wrong, into in ((True, bad), (False, doubtful)):
        far = [f"{one.name} ({one.moved_mm:.0f} mm)" for one in fits if one.far and one.wrong == wrong]
        if far:
            into.append(
                f"far from where the set has them: {listed(far)}; are they on the segments that it says?"
            )
    poor = [one for one in fits if one.rms_mm > POOR_MARKER_MM]
    if poor:
        names = listed([one.name for one in poor])
        doubtful.append(f"{names}: on another segment than the set says, or under another's name")
    verdict = BAD if bad else DOUBTFUL if doubtful else OK
    return verdict, bad + doubtful
