"""Inference of a marker set: the segment of every marker, with its probability, and the place on it.

Three sources are combined: the marker's name, which gives the places of markers with such names
(:mod:`mbkf.marker_sets.names`); a body posed in the cloud of points of one frame, which gives the marker's place on it
(:mod:`mbkf.marker_sets.search`); and the other frames, which show the segment that it moves with
(:mod:`mbkf.marker_sets.movement`). The probability of a segment s for a marker with mean place ȳ in its frame is

    P(s) ∝ Σ_{c of s} w_c N(ȳ; m_c, (s₀² + σ_c²) 1) · exp(−scatter of the marker in the frame of s)

with the components c of :mod:`mbkf.marker_sets.places`, weighted by the name; a point off the body has the density
ε u and a scatter of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import NotObservable
from mbkf.io.records import MarkerTrajectories
from mbkf.marker_sets.equipment import equipped_weight
from mbkf.marker_sets.frames import anchor_frames, spread_frames
from mbkf.marker_sets.movement import OBSERVATIONS, SKIN, Movement, movement, movement_cost, segment_scatter_m
from mbkf.marker_sets.names import NameReading
from mbkf.marker_sets.places import WornPlaces, worn_places
from mbkf.marker_sets.posed_cloud import OFF_BODY, ROOM_M3
from mbkf.marker_sets.search import FoundBody, find_body
from mbkf.model.description import BodyDescription
from mbkf.model.human import HumanModel

Indices = NDArray[np.intp]

SURE = 0.9
"""Probability from which a marker's segment is certain; below it is doubtful."""

PLACE_SD_M = 0.025
"""Width s₀: spread of the person about the fitted body."""

OTHER_NAME = 0.03
"""Probability that a name means another place than those of the dictionary."""

STRAY = 4.0
"""Scatter of a point on every segment, in units of the skin's variance, above which it is off the body."""

LOINS_M, OTHER_LOIN = (-0.12, 0.03), 0.15
"""Heights above the joint of pelvis and trunk at which a marker of one is on the other with at least this probability:
the lumbar spine bends there over a hand's breadth, and the body has one joint, at its upper end."""

ANCHORS = 4
"""Greatest number of frames of moving trials in which a body is searched."""

CLEAR_LOG_RATIO = 1.8
"""Mean log-likelihood ratio of a frame's points on the body at which that search ends."""

PASSES = 2
"""Number of times that the certain markers are chosen."""


@dataclass(frozen=True)
class InferredMarker:
    """The inferred segment and place of a marker.

    Attributes:
        name: Its name in the captures.
        segment: Its likeliest segment, "" for a point off the body.
        probability: Probability of that.
        alternatives: Other segments with their probabilities, likeliest first, from 1 % on.
        landmark: Likely landmark that it sits on, or "".
        position_m: (3,) its place on the reference body, in the segment's frame, m.
        noise_m: Noise of a marker there, mostly movement of the skin, per coordinate, m.
    """

    name: str
    segment: str
    probability: float
    alternatives: tuple[tuple[str, float], ...]
    landmark: str
    position_m: Array
    noise_m: float

    @property
    def doubtful(self) -> bool:
        """True where another segment may carry it."""
        return self.probability < SURE


@dataclass(frozen=True)
class Inference:
    """An inferred marker set.

    Attributes:
        markers: Every marker that was seen.
        found: The body in the frame that the search began with.
        rms_m: RMS distance of the certain markers from the body, over all frames.
    """

    markers: tuple[InferredMarker, ...]
    found: FoundBody
    rms_m: float


def infer_markers(
    static: Sequence[MarkerTrajectories],
    dynamic: Sequence[MarkerTrajectories],
    readings: Mapping[str, NameReading],
    body: BodyDescription,
    leave_out: Sequence[str] = (),
) -> Inference:
    """Segment and place of every marker of a person's captures.

    Args:
        static: Standing trials.
        dynamic: Trials of any movement.
        readings: Readings of the names, by name; empty to ignore names.
        body: The reference body.
        leave_out: Shipped protocols that do not count, for tests on the sets that they describe.

    Raises:
        NotObservable: Too few points, or no body is found among them.
    """
    names = tuple(dict.fromkeys(name for one in (*static, *dynamic) for name in one.names))
    places = worn_places(body, leave_out)
    by_name = np.array([name_factors(places, readings.get(name)) for name in names])
    candidates = anchor_frames(static or dynamic, names, 1 if static else ANCHORS)
    found, anchor = _anchor(places, candidates, by_name, standing=bool(static))
    frames = np.concatenate([anchor[None], spread_frames([*static, *dynamic], names)])
    inferred = _Markers(places, names, by_name, found, anchor, frames).settled()
    placed = {marker.name for marker in inferred.markers}
    if not (static and dynamic) or placed.issuperset(names):
        return inferred
    return _with_others(inferred, dynamic, readings, body, leave_out)


def _with_others(
    inferred: Inference,
    dynamic: Sequence[MarkerTrajectories],
    readings: Mapping[str, NameReading],
    body: BodyDescription,
    leave_out: Sequence[str],
) -> Inference:
    """The inference with markers that only the moving trials show, inferred from these alone."""
    try:
        moving = infer_markers((), dynamic, readings, body, leave_out)
    except NotObservable:
        return inferred
    placed = {marker.name for marker in inferred.markers}
    others = tuple(marker for marker in moving.markers if marker.name not in placed)
    return replace(inferred, markers=(*inferred.markers, *others))


def _anchor(
    places: WornPlaces, candidates: Array, by_name: Array, *, standing: bool
) -> tuple[FoundBody, Array]:
    """The body that explains the points of a frame best, and that frame (K, 3); the first clear one ends the search."""
    best: tuple[float, FoundBody, Array] | None = None
    refused: NotObservable | None = None
    for frame in candidates:
        seen = ~np.isnan(frame[:, 0])
        try:
            found = find_body(places, frame[seen], by_name[seen], standing=standing)
        except NotObservable as error:
            refused = error
            continue
        per_point = found.log_posterior / np.count_nonzero(seen)
        if best is None or per_point > best[0]:
            best = (per_point, found, frame)
        if found.log_ratio_per_point >= CLEAR_LOG_RATIO:
            break
    if best is None:
        raise refused or NotObservable("no frame of the captures shows a marker")
    return best[1], best[2]


def place_log_density(squared_m2: Array, variance_m2: Array) -> Array:
    """Logarithm of the normal density in space (1/m³) at points this far from a place, squared, alike in all axes."""
    return -1.5 * np.log(2.0 * np.pi * variance_m2) - 0.5 * squared_m2 / variance_m2


def name_factors(places: WornPlaces, reading: NameReading | None) -> Array:
    """(C,) likelihood ratio of each component by a marker's name."""
    factors = np.ones(len(places.segments))
    if reading is None or not reading.places:
        return factors
    whole = sum(place.probability for place in reading.places)
    stated = min(whole, 1.0 - OTHER_NAME)
    factors *= 1.0 - stated
    segments, landmarks = np.array(places.segments), np.array(places.landmarks)
    for place in reading.places:
        own = segments == place.segment
        share = stated * place.probability / whole
        if place.landmark and (landmarks == place.landmark).any():
            at = landmarks == place.landmark
            factors[at] += 0.7 * share / places.weight[at].sum()
            share *= 0.3
        factors[own] += share / max(places.weight[own].sum(), 1e-12)
    return np.asarray(factors)


class _Markers:
    """K markers, their names and the body found in one frame."""

    def __init__(
        self,
        places: WornPlaces,
        names: tuple[str, ...],
        by_name: Array,
        found: FoundBody,
        anchor: Array,
        frames: Array,
    ) -> None:
        body = places.body
        self.places, self.names, self.by_name, self.found = places, names, by_name, found
        self.segments = tuple(segment.name for segment in body.segments)
        self.model = HumanModel(body, found.body.factors, body.reference_mass_kg)
        self._frames = frames
        scale = np.array([body.segment(name).scale_matrix for name in places.segments])
        self._sizes = np.einsum("cak,k->ca", scale, found.body.factors)
        self._centres = self._sizes * places.position_m
        self._weight = equipped_weight(places, found.equipment)
        rotations, origins = self.model.placements(found.body.q)
        joints = [self.model.joint(name).joint_id for name in self.segments]
        local = np.einsum("sji,ksj->ksi", rotations[joints], anchor[:, None] - origins[joints])
        self._first = Movement(local, np.zeros(local.shape[:2]), np.nan)

    def settled(self) -> Inference:
        """The marker set, with poses from the certain markers."""
        seen, best = self._first, np.zeros(len(self.names), dtype=np.intp)
        for _ in range(PASSES):
            odds, _ = self.odds(seen, best)
            best = odds[:, :-1].argmax(axis=1)
            sure = (odds.max(axis=1) >= SURE) & (odds.argmax(axis=1) < len(self.segments))
            sure &= ~np.isnan(seen.mean_m[:, 0, 0])
            if np.count_nonzero(sure) < 6:
                sure = ~np.isnan(seen.mean_m[:, 0, 0]) & (odds.argmax(axis=1) < len(self.segments))
            local = seen.mean_m[np.arange(len(best)), best]
            seen = movement(
                self.model, self._frames, [self.segments[s] for s in best], np.nan_to_num(local), sure
            )
        odds, components = self.odds(seen, best)
        markers = tuple(
            self._marker(k, odds[k], components[k], seen.mean_m[k])
            for k in range(len(self.names))
            if not np.isnan(seen.mean_m[k, 0, 0])
        )
        return Inference(markers, self.found, seen.rms_m)

    def odds(self, seen: Movement, best: Indices) -> tuple[Array, Array]:
        """(K, S + 1) probability of every segment, last that of a point off the body, and (K, C) of every component."""
        index = self.places.segment_index
        variance = PLACE_SD_M**2 + self.places.sd_m**2
        standing = np.where(np.isnan(self._first.mean_m), seen.mean_m, self._first.mean_m)
        squared = ((standing[:, index] - self._centres) ** 2).sum(axis=2)
        with np.errstate(divide="ignore"):
            weight = self._weight * self.by_name
            weight /= np.maximum(weight.sum(axis=1), 1e-300)[:, None]
            logs = np.log((1.0 - OFF_BODY) * weight) + place_log_density(squared, variance)
        moved = 0.0
        if seen.squared_m2.any():
            stance_statistic = segment_scatter_m(seen, best, len(self.segments))
            spread = np.hypot(SKIN * self.places.noise_m, stance_statistic[index])
            logs = logs - movement_cost(seen.squared_m2[:, index], spread)
            moved = float(movement_cost(np.array(3.0 * OBSERVATIONS * STRAY), np.array(1.0)))
        nothing = np.full((len(logs), 1), np.log(OFF_BODY / ROOM_M3) - moved)
        every = np.concatenate([logs, nothing], axis=1)
        every = np.where(np.isnan(every), -np.inf, every)
        top = every.max(axis=1, keepdims=True)
        odds = np.exp(every - np.where(np.isfinite(top), top, 0.0))
        odds /= np.maximum(odds.sum(axis=1, keepdims=True), 1e-300)
        own = np.zeros((len(logs), len(self.segments) + 1))
        for s in range(len(self.segments)):
            own[:, s] = odds[:, :-1][:, index == s].sum(axis=1)
        own[:, -1] = odds[:, -1]
        return own, odds[:, :-1]

    def _with_loins(self, odds: Array, best: int, means_m: Array) -> Array:
        """The odds (S + 1,) of a marker; near the joint of root and trunk both keep a share."""
        body = self.places.body
        trunk = next(
            (s.name for s in body.segments if s.parent == body.roles.root and s.name not in body.roles.legs),
            "",
        )
        pair = {self.segments.index(name) for name in (body.roles.root, trunk) if name}
        joint = means_m[self.segments.index(trunk)] if trunk else np.full(3, np.inf)
        if best not in pair or len(pair) < 2 or not LOINS_M[0] < joint[2] < LOINS_M[1]:
            return odds
        (other,) = pair - {best}
        shared = odds.copy()
        moved = max(OTHER_LOIN - float(odds[other]), 0.0)
        shared[best], shared[other] = odds[best] - moved, odds[other] + moved
        return shared if shared[best] > shared[other] else odds

    def _marker(self, k: int, odds: Array, components: Array, means_m: Array) -> InferredMarker:
        labels = (*self.segments, "")
        best = int(odds.argmax())
        if best < len(self.segments):
            odds = self._with_loins(odds, best, means_m)
        alternatives = tuple(
            (labels[s], round(float(odds[s]), 3))
            for s in np.argsort(-odds)
            if s != best and odds[s] >= 0.01 and labels[s]
        )
        if best == len(self.segments):
            return InferredMarker(self.names[k], "", float(odds[best]), alternatives, "", np.zeros(3), 0.0)
        own = np.flatnonzero(self.places.segment_index == best)
        likeliest = own[components[own].argmax()]
        certain = components[likeliest] >= 0.5 * odds[best]
        return InferredMarker(
            self.names[k],
            labels[best],
            float(odds[best]),
            alternatives,
            self.places.landmarks[likeliest] if certain else "",
            means_m[best] / self._sizes[own[0]],
            float(self.places.noise_m[likeliest]),
        )
