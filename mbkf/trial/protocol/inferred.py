"""A protocol made for captures whose markers no shipped one explains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import read_only
from mbkf.errors import InvalidInput, NotObservable
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.marker_sets.inference import SURE, Inference, InferredMarker, infer_markers
from mbkf.marker_sets.names import NameReading, read_names
from mbkf.marker_sets.search import FEWEST_POINTS
from mbkf.model.body_file import load_body
from mbkf.model.description import BodyDescription
from mbkf.model.protocol import (
    DEFAULT_CORRELATED_M,
    DEFAULT_CORRELATION_S,
    DEFAULT_NOISE_M,
    Protocol,
    ProtocolMarker,
)
from mbkf.numerics.threads import single_threaded
from mbkf.trial.preparation.coverage import COMPUTED, listed
from mbkf.trial.preparation.exchanged import trials_put_right
from mbkf.trial.protocol.upright import upright_captures

NAME = "inferred"
"""Name of an inferred protocol."""

LEAST_ODDS, LEAST_NAMED_ODDS = 15.0, 0.0
"""How much likelier (logarithm) the points must be a person than strewn about: 29 and more of measured persons, 9 to 27
of synthetic trunks with one arm, about −15 of scattered points and 13 at most; up to 73 of a person on his head. The
second where names tell of most points that they are on a body."""

FEWEST_SEGMENTS = 3
"""Markers on fewer segments do not show a person."""

LANDMARK_SD_M, PLACED_SD_M = 0.015, 0.035
"""How far a marker is from its landmark, and one without a landmark from where the posed body shows it."""

ROUNDS = 2
"""How often a set is inferred: again where names turn out to be exchanged between the standing trial and the others."""

DOUBTFUL_NOISE = 1.2
"""Noise of a marker whose segment is doubtful, over that of a sure one: it may follow, but not lead."""

OFF_LANDMARK_M = 0.045
"""A marker further from its landmark than this is not on it."""

NOT_BODY = "no part of the body: it fits and follows no segment"
OBJECT = "no part of the body, by its name"


@dataclass(frozen=True)
class InferredSet:
    """An inferred marker set.

    Attributes:
        protocol: The same as a protocol, with probabilities, alternatives and ignored points.
        captures: The captures that it was inferred from, static one first, with their axes put right.
        equipment: The part of the body that carries markers, in words.
        rms_m: RMS distance of the sure markers from the body that they were found on; NaN where no frame was posed.
        exchanged: Names that trials exchange against the standing trial and frames, put right in :attr:`captures`.
    """

    protocol: Protocol
    captures: tuple[Capture, ...]
    equipment: str
    rms_m: float
    exchanged: tuple[tuple[str, str, int], ...] = ()

    @property
    def doubtful(self) -> tuple[str, ...]:
        """Names of the markers whose segment is not sure, with their alternatives in :attr:`protocol`."""
        return tuple(marker.name for marker in self.protocol.markers if marker.probability < SURE)

    @property
    def line(self) -> str:
        """What was inferred, in one line."""
        markers, doubts = self.protocol.markers, self.doubtful
        segments = len({marker.segment for marker in markers})
        told = f"marker set inferred: {len(markers)} markers on {segments} segments ({self.equipment})"
        told += f"; {len(doubts)} doubtful" + (f": {listed(doubts)}" if doubts else "")
        if self.protocol.ignored:
            told += f"; left out: {listed(tuple(self.protocol.ignored))}"
        return told

    @property
    def doubts(self) -> dict[str, list[tuple[str, float]]]:
        """Every doubtful marker's segments with their probabilities, likeliest first."""
        return {
            marker.name: [(marker.segment, round(marker.probability, 2)), *marker.alternatives]
            for marker in self.protocol.markers
            if marker.probability < SURE
        }


def infer_marker_set(
    static: Capture | None,
    trials: Sequence[Capture] = (),
    body: BodyDescription | None = None,
    *,
    use_names: bool = True,
    leave_out: Sequence[str] = (),
) -> InferredSet:
    """Infers which segment each marker of a person's captures is on, and where.

    Args:
        static: A standing trial, if there is one.
        trials: Trials of any movement.
        body: The reference body; human18 by default.
        use_names: Whether the markers' names are read.
        leave_out: Shipped protocols that do not count, for a trial on what they describe.

    Raises:
        InvalidInput: No capture is given, or its axes cannot be right.
        NotObservable: Too few markers, or no person is found among them.
    """
    reference = body or load_body()
    captures = [*([] if static is None else [static]), *trials]
    if not captures:
        raise InvalidInput("a marker set is inferred from a static trial, from moving trials, or both")
    names = tuple(dict.fromkeys(name for one in captures for name in _named(one.markers)))
    readings = read_names(names) if use_names else {}
    ignored = _ignored_by_name(readings)
    if len(names) - len(ignored) < FEWEST_POINTS:
        raise NotObservable(
            f"the captures have {len(names) - len(ignored)} markers of a body ({listed(names) or 'none'}); "
            f"fewer than {FEWEST_POINTS} do not show which part of it they are on; give --protocol"
        )
    keypoints = {name for name, one in readings.items() if one.kind == "keypoint"}
    standing = 0 if static is None else 1
    exchanged: tuple[tuple[str, str, int], ...] = ()
    with single_threaded():
        upright = upright_captures(captures, readings, reference)
        for _ in range(ROUNDS):
            worn = [_without(one.markers, ignored) for one in upright]
            found = infer_markers(worn[:standing], worn[standing:], readings, reference, leave_out)
            _require_person(found, LEAST_NAMED_ODDS if _mostly_named(worn, readings) else LEAST_ODDS)
            left_out = ignored | {marker.name: NOT_BODY for marker in found.markers if not marker.segment}
            protocol = _protocol(found, reference, left_out, keypoints)
            if not (standing and trials):
                break
            fresh, told = trials_put_right(upright[0].markers, upright[1:], protocol)
            if not told:
                break
            upright, exchanged = [upright[0], *fresh], (*exchanged, *told)
    return InferredSet(protocol, tuple(upright), found.found.equipment.name, found.rms_m, exchanged)


def _named(markers: MarkerTrajectories) -> tuple[str, ...]:
    """Names of the markers that have one of their own and are seen."""
    seen = np.asarray(markers.present.any(axis=0))
    return tuple(
        name for name, there in zip(markers.names, seen, strict=True) if there and not name.startswith("*")
    )


def _ignored_by_name(readings: Mapping[str, NameReading]) -> dict[str, str]:
    """The reason by name of points that are no markers of a body, as their names tell."""
    reasons = {"object": OBJECT, "computed": COMPUTED}
    return {name: reasons[one.kind] for name, one in readings.items() if one.kind in reasons}


def _without(markers: MarkerTrajectories, ignored: Mapping[str, str]) -> MarkerTrajectories:
    return markers.select(tuple(name for name in _named(markers) if name not in ignored))


def _mostly_named(captures: Sequence[MarkerTrajectories], readings: Mapping[str, NameReading]) -> bool:
    """Whether names tell of most markers that they are on a body."""
    names = {name for one in captures for name in one.names}
    return 2 * sum(name in readings and bool(readings[name].places) for name in names) > len(names)


def _require_person(found: Inference, least_odds: float) -> None:
    """Refuses what is no person.

    Args:
        found: What was inferred.
        least_odds: Odds that the body has to have.

    Raises:
        NotObservable: The points are not where markers of a person are, or on too small a part of one.
    """
    segments = {marker.segment for marker in found.markers if marker.segment}
    if found.found.odds < least_odds:
        raise NotObservable(
            "no person is found among the points: they do not stand as the markers of an upright body do "
            "(which axis points up? give --up; a static trial with --static; or a marker set with --protocol)"
        )
    if len(segments) < FEWEST_SEGMENTS:
        raise NotObservable(
            f"the markers are on {len(segments)} segments ({', '.join(sorted(segments)) or 'none'}); "
            f"fewer than {FEWEST_SEGMENTS} do not show a person; give --protocol"
        )


def _protocol(
    found: Inference, body: BodyDescription, ignored: Mapping[str, str], keypoints: set[str]
) -> Protocol:
    on_landmark = _nearest_on_landmarks(found, body)
    markers = tuple(
        _marker(marker, body, marker.name in on_landmark, marker.name in keypoints)
        for marker in found.markers
        if marker.segment
    )
    return Protocol(
        NAME,
        "inferred from the captures",
        body,
        markers,
        "inferred from the markers' names, a standing body and what moves together",
        dict(ignored),
    )


def _nearest_on_landmarks(found: Inference, body: BodyDescription) -> set[str]:
    """Names of the markers on landmarks: of those that claim the same one, the nearest, if it is near enough."""
    nearest: dict[str, tuple[float, str]] = {}
    for marker in found.markers:
        if marker.landmark:
            away = float(np.linalg.norm(marker.position_m - body.landmark(marker.landmark).position_m))
            if away <= OFF_LANDMARK_M:
                nearest[marker.landmark] = min(
                    nearest.get(marker.landmark, (np.inf, "")), (away, marker.name)
                )
    return {name for _, name in nearest.values()}


def _marker(
    marker: InferredMarker, body: BodyDescription, on_landmark: bool, keypoint: bool
) -> ProtocolMarker:
    position = body.landmark(marker.landmark).position_m if on_landmark else marker.position_m
    kind = "keypoint" if keypoint else "anatomical" if on_landmark else "technical"
    noise = DEFAULT_NOISE_M[kind] if keypoint else marker.noise_m
    return ProtocolMarker(
        name=marker.name,
        segment=marker.segment,
        position_m=read_only(position),
        kind=kind,
        placement_sd_m=LANDMARK_SD_M if on_landmark else PLACED_SD_M,
        noise_m=noise * (DOUBTFUL_NOISE if marker.doubtful else 1.0),
        landmark=marker.landmark if on_landmark else "",
        probability=round(marker.probability, 3),
        alternatives=marker.alternatives,
        correlated_m=DEFAULT_CORRELATED_M[kind],
        correlation_s=DEFAULT_CORRELATION_S if keypoint else 0.0,
    )
