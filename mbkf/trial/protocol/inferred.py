"""A protocol inferred for captures with an unknown marker set."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import read_only
from mbkf.errors import InvalidInput, NotObservable
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.marker_sets.combined_points import combined_points
from mbkf.marker_sets.inference import SURE, Inference, InferredMarker, infer_markers
from mbkf.marker_sets.names import NameReading, read_names
from mbkf.marker_sets.parts import parts_in_words, segments_named, upper_body_only
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
from mbkf.scaling.frames import MIN_PRESENT
from mbkf.trial.preparation.coverage import listed
from mbkf.trial.preparation.exchanged import trials_put_right
from mbkf.trial.protocol.upright import upright_captures

NAME = "inferred"
"""Name of an inferred protocol."""

LEAST_LOG_ODDS, LEAST_NAMED_LOG_ODDS = 15.0, 0.0
"""Least log odds of a person against scattered points: measured persons have 29 and more, synthetic trunks with one arm
9 to 27, scattered points about −15 and 13 at most, a person upside down up to 73. The second holds where the names of
most points mean places on a body."""

FEWEST_SEGMENTS = 3
"""Least number of segments with markers."""

LANDMARK_SD_M, PLACED_SD_M = 0.015, 0.035
"""Spread of a marker about its landmark, and of one without a landmark about its place on the posed body."""

ROUNDS = 2
"""Greatest number of inferences: it is repeated where names are exchanged between the standing trial and the others."""

DOUBTFUL_NOISE = 1.2
"""Noise of a marker of doubtful segment, over that of a certain one."""

OFF_LANDMARK_M = 0.045
"""Greatest distance of a marker from its landmark."""

OFF_BODY = "off the body: it does not fit or follow a segment"
OBJECT = "off the body, by its name"
COMPUTED = "computed by software, by its name"


@dataclass(frozen=True)
class InferredSet:
    """An inferred marker set.

    Attributes:
        protocol: The same as a protocol, with probabilities, alternatives and ignored points.
        captures: The captures that it was inferred from, static one first, with corrected axes.
        equipment: Name of the part of the body that carries markers.
        rms_m: RMS distance of the certain markers from the body; NaN where no frame was posed.
        exchanged: Names exchanged against the standing trial, and numbers of frames; corrected in :attr:`captures`.
    """

    protocol: Protocol
    captures: tuple[Capture, ...]
    equipment: str
    rms_m: float
    exchanged: tuple[tuple[str, str, int], ...] = ()

    @property
    def doubtful(self) -> tuple[str, ...]:
        """Names of the markers of doubtful segment, with their alternatives in :attr:`protocol`."""
        return tuple(marker.name for marker in self.protocol.markers if marker.probability < SURE)

    @property
    def line(self) -> str:
        """Summary of the inferred set."""
        markers, doubts = self.protocol.markers, self.doubtful
        segments = len({marker.segment for marker in markers})
        line = f"marker set inferred: {len(markers)} markers on {segments} segments ({self.equipment})"
        line += f"; {len(doubts)} doubtful" + (f": {listed(doubts)}" if doubts else "")
        if self.protocol.ignored:
            line += f"; left out: {listed(tuple(self.protocol.ignored))}"
        return line

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
        use_names: True to read the markers' names.
        leave_out: Shipped protocols that do not count, for tests on the sets that they describe.

    Raises:
        InvalidInput: No capture is given, or its axes contradict the body.
        NotObservable: Too few markers, or no body is found among them.
    """
    reference = body or load_body()
    captures = [*([] if static is None else [static]), *trials]
    if not captures:
        raise InvalidInput("inferring a marker set needs captures: a static trial, moving trials, or both")
    names = tuple(dict.fromkeys(name for one in captures for name in _named(one.markers)))
    readings = read_names(names) if use_names else {}
    try:
        return _inferred_set(captures, 0 if static is None else 1, readings, reference, leave_out)
    except (NotObservable, InvalidInput) as error:
        partial = _partial_body(readings)
        if not partial:
            raise
        raise NotObservable(partial) from error


def _inferred_set(
    captures: Sequence[Capture],
    standing: int,
    readings: Mapping[str, NameReading],
    reference: BodyDescription,
    leave_out: Sequence[str],
) -> InferredSet:
    """The inferred set of captures, of which so many first ones are standing trials."""
    names = tuple(dict.fromkeys(name for one in captures for name in _named(one.markers)))
    ignored = off_the_skin(captures, readings)
    if not names:
        raise NotObservable("no marker that is seen has a name; name them with 'mbkf label'")
    if len(names) - len(ignored) < FEWEST_POINTS:
        raise NotObservable(
            f"the captures have {len(names) - len(ignored)} markers of a body ({listed(names)}); "
            f"fewer than {FEWEST_POINTS} do not show which part of it they are on; give --protocol"
        )
    keypoints = {name for name, one in readings.items() if one.kind == "keypoint"}
    exchanged: tuple[tuple[str, str, int], ...] = ()
    with single_threaded():
        upright = upright_captures(captures, readings, reference, standing=standing)
        for _ in range(ROUNDS):
            worn = worn_markers(upright, ignored)
            found = infer_markers(worn[:standing], worn[standing:], readings, reference, leave_out)
            require_person(found, LEAST_NAMED_LOG_ODDS if _mostly_named(worn, readings) else LEAST_LOG_ODDS)
            left_out = ignored | {marker.name: OFF_BODY for marker in found.markers if not marker.segment}
            protocol = _protocol(found, reference, left_out, keypoints)
            if not standing or len(captures) == 1:
                break
            corrected, pairs = trials_put_right(upright[0].markers, upright[1:], protocol)
            if not pairs:
                break
            upright, exchanged = [upright[0], *corrected], (*exchanged, *pairs)
    return InferredSet(protocol, tuple(upright), found.found.equipment.name, found.rms_m, exchanged)


def _partial_body(readings: Mapping[str, NameReading]) -> str:
    """Message on names of the upper body, hands or a head alone, "" for others."""
    upper = upper_body_only(segments_named(readings), load_body().roles)
    if not upper:
        return ""
    seen, bare = parts_in_words(upper)
    return (
        f"the names of {sum(upper.values())} of {len(readings)} markers mean {seen}; no marker is on {bare}: add "
        "markers of the pelvis or the legs, or place these with --protocol"
    )


def off_the_skin(captures: Sequence[Capture], readings: Mapping[str, NameReading]) -> dict[str, str]:
    """The reason by name of points that are not on a person's skin, by their names or as combinations of others.

    Combinations count only where the points beside them suffice for a body.

    Args:
        captures: The captures of a person.
        readings: Readings of the points' names; empty to ignore names.
    """
    reasons = {"object": OBJECT, "computed": COMPUTED}
    ignored = {name: reasons[one.kind] for name, one in readings.items() if one.kind in reasons}
    worn = worn_markers(captures, ignored)
    combined = combined_points([one.markers for one in captures])
    names = {name for one in worn for name in one.names}
    if len(names.difference(combined)) >= FEWEST_POINTS:
        ignored |= {
            name: f"computed by software: a combination of {', '.join(combined[name])}"
            for name in sorted(names.intersection(combined))
        }
    return ignored


def _named(markers: MarkerTrajectories) -> tuple[str, ...]:
    """Names of the markers that have one of their own and are seen."""
    seen = np.asarray(markers.present.any(axis=0))
    return tuple(
        name for name, there in zip(markers.names, seen, strict=True) if there and not name.startswith("*")
    )


def worn_markers(captures: Sequence[Capture], ignored: Collection[str]) -> list[MarkerTrajectories]:
    """The markers of each capture that have a name of their own, are seen, and are not ignored.

    A capture that hardly shows a marker does not count for it where another one does: a few frames may be a ghost's.

    Args:
        captures: The captures of a person.
        ignored: Names to leave out.
    """
    shares = [
        dict(zip(one.names, (one.present.sum(axis=0) / max(one.frames, 1)).tolist(), strict=True))
        for one in (capture.markers for capture in captures)
    ]
    most = {name: max(one.get(name, 0.0) for one in shares) for name in set().union(*shares)}
    return [
        one.markers.select(
            tuple(
                name
                for name in _named(one.markers)
                if name not in ignored and (share[name] >= MIN_PRESENT or most[name] < MIN_PRESENT)
            )
        )
        for one, share in zip(captures, shares, strict=True)
    ]


def _mostly_named(captures: Sequence[MarkerTrajectories], readings: Mapping[str, NameReading]) -> bool:
    """True where the names of most markers mean places on a body."""
    names = {name for one in captures for name in one.names}
    return 2 * sum(name in readings and bool(readings[name].places) for name in names) > len(names)


def require_person(found: Inference, least_log_odds: float) -> None:
    """Refuses points that do not form a body, or too small a part of one.

    Raises:
        NotObservable: The log odds of the body, or the number of segments, are too small.
    """
    segments = {marker.segment for marker in found.markers if marker.segment}
    if found.found.log_odds < least_log_odds:
        raise NotObservable(
            "no upright body is found among the points; give the axis that points up (--up), a static trial, or "
            "the marker set (--protocol)"
        )
    if len(segments) < FEWEST_SEGMENTS:
        raise NotObservable(
            f"the markers are on {len(segments)} segments ({', '.join(sorted(segments)) or 'none'}); "
            f"fewer than {FEWEST_SEGMENTS} do not show a body; give --protocol"
        )


def _protocol(
    found: Inference, body: BodyDescription, ignored: Mapping[str, str], keypoints: set[str]
) -> Protocol:
    markers = protocol_markers([one for one in found.markers if one.segment], body, keypoints)
    return Protocol(
        NAME,
        "inferred from the captures",
        body,
        markers,
        "inferred from the markers' names, an upright body, and markers that move together",
        dict(ignored),
    )


def protocol_markers(
    inferred: Sequence[InferredMarker],
    body: BodyDescription,
    keypoints: Collection[str],
    taken: Collection[str] = (),
) -> tuple[ProtocolMarker, ...]:
    """Markers of a protocol out of inferred ones.

    Args:
        inferred: The inferred markers, each on a segment.
        body: The reference body.
        keypoints: Names of those that are keypoints.
        taken: Landmarks that other markers are on.
    """
    on_landmark = _nearest_on_landmarks(inferred, body, taken)
    return tuple(_marker(one, body, one.name in on_landmark, one.name in keypoints) for one in inferred)


def _nearest_on_landmarks(
    inferred: Sequence[InferredMarker], body: BodyDescription, taken: Collection[str]
) -> set[str]:
    """Names of the markers on landmarks: of those with the same one, the nearest, if it is near enough."""
    nearest: dict[str, tuple[float, str]] = {}
    for marker in inferred:
        if marker.landmark and marker.landmark not in taken:
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
