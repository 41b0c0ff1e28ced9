"""Check of a marker set against a capture: known and missing markers, and the fit of a person."""

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
"""Least share of the capture's markers that its whole set knows."""

GOOD_RMS_MM, POOR_RMS_MM = 12.0, 25.0
"""RMS distance up to which the markers fit as those of a correct set (2 to 12 mm in our captures), and beyond which
they are at other places than in the set."""

POOR_MARKER_MM = 40.0
"""RMS distance beyond which a single marker is on another segment than in the set, or has another one's name."""

FAR_SHARE, FAR_MM = 2.7, 80.0
"""Distance from its place in the set, as a multiple of the set's spread and in mm, beyond both of which a marker is
far: a wrong marker of a standing trial, whose single posture fits nearly any set."""

TWISTED_RAD = np.deg2rad(45.0)
"""Greatest excess of a standing person's joints over their limits: with both knees' outer markers exchanged, both
thighs face backwards and every marker fits."""

WRONG_SHARE, WRONG_MM = 4.0, 250.0
"""Beyond either, a far marker is wrong."""


@dataclass(frozen=True)
class MarkerFit:
    """Fit of a marker to the scaled person.

    Attributes:
        name: The marker.
        segment: Its segment in the set.
        rms_mm: RMS distance from its place on the person.
        moved_mm: Distance of that place from its place in the set.
        share: The same as a multiple of the set's spread.
    """

    name: str
    segment: str
    rms_mm: float
    moved_mm: float
    share: float

    @property
    def far(self) -> bool:
        """True where it is far from its place in the set."""
        return self.share > FAR_SHARE and self.moved_mm > FAR_MM

    @property
    def badness(self) -> float:
        """Measure of a bad fit: 1 where a bound is reached."""
        return max(self.share / FAR_SHARE, self.rms_mm / POOR_MARKER_MM)

    @property
    def wrong(self) -> bool:
        """True where its place in the set is wrong."""
        return self.far and (self.share > WRONG_SHARE or self.moved_mm > WRONG_MM)


@dataclass(frozen=True)
class SetCheck:
    """Result of the check of a marker set against a capture.

    Attributes:
        use: Known and unknown markers of the capture.
        absent: Markers of the set that the capture lacks, without computed points.
        bare: Segments of its body without a known marker.
        rms_mm: RMS distance of the markers from the scaled person; None where scaling failed.
        markers: The fit of every marker, the worst first.
        trouble: Reason why scaling failed, or "".
        verdict: "ok", "doubtful" or "bad".
        reasons: Reasons why it is not "ok", each with a remedy.
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
    """Scales a person by the marker set and judges the fit.

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
    """Segments that a standing person turns too far beyond their joints' limits, rad; empty without standing."""
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
    """The verdict and its reasons."""
    bad: list[str] = []
    doubtful: list[str] = []
    if trouble:
        bad.append(trouble)
    if use.unknown:
        line = (
            f"{use.summary}, not {listed(use.unknown)}: add them, or leave them out with 'mbkf protocol edit'"
        )
        if use.share < WHOLE_SHARE:
            (bad if use.share < LEAST_SHARE else doubtful).append(line)
    if rms is not None and rms > GOOD_RMS_MM:
        line = f"markers fit to {rms:.0f} mm RMS, those of a correct set to {GOOD_RMS_MM:.0f}: check the worst ones"
        (bad if rms > POOR_RMS_MM else doubtful).append(line)
    if twisted:
        turned = listed([f"{name} ({np.rad2deg(angle):.0f}°)" for name, angle in twisted.items()])
        worst = listed([one.name for one in fits if one.segment in twisted][:3])
        bad.append(
            f"segments turned beyond their joints' limits: {turned}; check for exchanged markers, as {worst}"
        )
    for wrong, into in ((True, bad), (False, doubtful)):
        far = [f"{one.name} ({one.moved_mm:.0f} mm)" for one in fits if one.far and one.wrong == wrong]
        if far:
            into.append(f"markers far from their places in the set: {listed(far)}; check their segments")
    poor = [one for one in fits if one.rms_mm > POOR_MARKER_MM]
    if poor:
        names = listed([one.name for one in poor])
        doubtful.append(f"markers that fit poorly: {names}; check their segments and names")
    verdict = BAD if bad else DOUBTFUL if doubtful else OK
    return verdict, bad + doubtful
