"""A marker set inferred: for every marker the segment that carries it, with a probability, and where on it.

Three sources are brought together. A marker's name tells where markers of such names are worn
(:mod:`mbkf.marker_sets.names`). A body posed in the cloud of points of one frame tells where the marker is on it
(:mod:`mbkf.marker_sets.search`). The other frames tell which segment it moves with (:mod:`mbkf.marker_sets.movement`).
The probability of a segment s for a marker with mean place ȳ in its frame is

    P(s) ∝ Σ_{c of s} w_c N(ȳ; m_c, (s₀² + σ_c²) 1) · exp(−scatter of the marker in the frame of s)

with the components c of :mod:`mbkf.marker_sets.places`, weighted by the name; a point that is no part of the body has
the density ε u and a scatter of its own.
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
from mbkf.marker_sets.movement import LOOKS, SKIN, Movement, movement, movement_cost, unrest_m
from mbkf.marker_sets.names import NameReading
from mbkf.marker_sets.places import WornPlaces, worn_places
from mbkf.marker_sets.posed_cloud import NO_BODY, ROOM_M3
from mbkf.marker_sets.search import FoundBody, find_body
from mbkf.model.description import BodyDescription
from mbkf.model.human import HumanModel

Indices = NDArray[np.intp]

SURE = 0.9
"""From this probability on a marker's segment is not called doubtful."""

PLACE_SD_M = 0.025
"""Width s₀: how far the fitted body is from the person."""

OTHER_NAME = 0.03
"""Probability that a name means another place than any that the dictionary gives."""

STRAY = 4.0
"""A point that scatters by more than so many times the skin's variance on every segment is no part of the body."""

LOINS_M, OTHER_LOIN = (-0.12, 0.03), 0.15
"""At these heights above the joint of pelvis and trunk a marker is on the other of both with this probability at least:
the lumbar spine bends there over a hand's breadth, and the body has one joint, at its upper end."""

ANCHORS = 4
"""Frames of moving trials in which a body is searched for, at most."""

CLEAR_EVIDENCE = 1.8
"""A frame whose points are so much likelier on the body than anywhere near (mean logarithm) ends that search."""

PASSES = 2
"""How often the sure markers are chosen anew."""


@dataclass(frozen=True)
class InferredMarker:
    """What a marker is thought to be.

    Attributes:
        name: Its name in the captures.
        segment: Its likeliest segment, "" for a point that is no part of the body.
        probability: Of that.
        alternatives: Other segments with their probabilities, likeliest first, from 1 % on.
        landmark: Landmark that it sits on, "" where none is likely.
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
        """Whether another segment is not unlikely."""
        return self.probability < SURE


@dataclass(frozen=True)
class Inference:
    """An inferred marker set.

    Attributes:
        markers: Every marker that was seen.
        found: The body in the frame that the search began with.
        rms_m: RMS distance of the sure markers from the body, over all frames looked at.
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
        readings: What the names tell, by name; empty to do without.
        body: The reference body.
        leave_out: Shipped protocols that do not count, for a trial on what they describe.

    Raises:
        NotObservable: Too few points, or no person is found among them.
    """
    names = tuple(dict.fromkeys(name for one in (*static, *dynamic) for name in one.names))
    places = worn_places(body, leave_out)
    by_name = np.array([name_factors(places, readings.get(name)) for name in names])
    candidates = anchor_frames(static or dynamic, names, 1 if static else ANCHORS)
    found, anchor = _anchor(places, candidates, by_name)
    frames = np.concatenate([anchor[None], spread_frames([*static, *dynamic], names)])
    inferred = _Evidence(places, names, by_name, found, anchor, frames).settled()
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
    """With the markers that only the moving trials show, where the standing trial's body cannot be followed there."""
    try:
        moving = infer_markers((), dynamic, readings, body, leave_out)
    except NotObservable:
        return inferred
    placed = {marker.name for marker in inferred.markers}
    others = tuple(marker for marker in moving.markers if marker.name not in placed)
    return replace(inferred, markers=(*inferred.markers, *others))


def _anchor(places: WornPlaces, candidates: Array, by_name: Array) -> tuple[FoundBody, Array]:
    """The frame in which a body explains its points best, (K, 3), and that body; the first in which it does clearly."""
    best: tuple[float, FoundBody, Array] | None = None
    refused: NotObservable | None = None
    for frame in candidates:
        seen = ~np.isnan(frame[:, 0])
        try:
            found = find_body(places, frame[seen], by_name[seen])
        except NotObservable as error:
            refused = error
            continue
        worth = found.worth / np.count_nonzero(seen)
        if best is None or worth > best[0]:
            best = (worth, found, frame)
        if found.evidence >= CLEAR_EVIDENCE:
            break
    if best is None:
        raise refused or NotObservable("no frame shows any point")
    return best[1], best[2]


def name_factors(places: WornPlaces, reading: NameReading | None) -> Array:
    """(C,) how much likelier a marker of this name sits at each component than one without a name.

    Args:
        places: Where markers are worn.
        reading: What the name tells.
    """
    factors = np.ones(len(places.segments))
    if reading is None or not reading.places:
        return factors
    told = min(sum(place.probability for place in reading.places), 1.0 - OTHER_NAME)
    factors *= 1.0 - told
    segments, landmarks = np.array(places.segments), np.array(places.landmarks)
    whole = sum(place.probability for place in reading.places)
    for place in reading.places:
        own = segments == place.segment
        share = told * place.probability / whole
        if place.landmark and (landmarks == place.landmark).any():
            at = landmarks == place.landmark
            factors[at] += 0.7 * share / places.weight[at].sum()
            share *= 0.3
        factors[own] += share / max(places.weight[own].sum(), 1e-12)
    return np.asarray(factors)


class _Evidence:
    """What is known of K markers."""

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
        """The marker set once the poses rest on the sure markers."""
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
        """(K, S + 1) probability of every segment, that of no body last, and (K, C) of every component."""
        index = self.places.segment_index
        variance = PLACE_SD_M**2 + self.places.sd_m**2
        standing = np.where(np.isnan(self._first.mean_m), seen.mean_m, self._first.mean_m)
        squared = ((standing[:, index] - self._centres) ** 2).sum(axis=2)
        with np.errstate(divide="ignore"):
            weight = self._weight * self.by_name
            weight /= np.maximum(weight.sum(axis=1), 1e-300)[:, None]
            logs = np.log((1.0 - NO_BODY) * weight) - 1.5 * np.log(2.0 * np.pi * variance)
        logs = logs - 0.5 * squared / variance
        moved = 0.0
        if seen.squared_m2.any():
            stance_statistic = unrest_m(seen, best, len(self.segments))
            spread = np.hypot(SKIN * self.places.noise_m, stance_statistic[index])
            logs = logs - movement_cost(seen.squared_m2[:, index], spread)
            moved = float(movement_cost(np.array(3.0 * LOOKS * STRAY), np.array(1.0)))
        nothing = np.full((len(logs), 1), np.log(NO_BODY / ROOM_M3) - moved)
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
        """The odds (S + 1,) of a marker; near the joint of root and trunk the other of both is never unlikely."""
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
        order = np.argsort(-odds)
        labels = (*self.segments, "")
        best = int(order[0])
        if best == len(self.segments):
            alternatives = tuple(
                (labels[s], round(float(odds[s]), 3)) for s in order[1:] if odds[s] >= 0.01 and labels[s]
            )
            return InferredMarker(self.names[k], "", float(odds[best]), alternatives, "", np.zeros(3), 0.0)
        odds = self._with_loins(odds, best, means_m)
        alternatives = tuple(
            (labels[s], round(float(odds[s]), 3))
            for s in np.argsort(-odds)
            if s != best and odds[s] >= 0.01 and labels[s]
        )
        own = np.flatnonzero(self.places.segment_index == best)
        likeliest = own[components[own].argmax()]
        landmark = self.places.landmarks[likeliest]
        if components[likeliest] < 0.5 * odds[best]:
            landmark = ""
        position = means_m[best] / self._sizes[own[0]]
        return InferredMarker(
            self.names[k],
            labels[best],
            float(odds[best]),
            alternatives,
            landmark,
            position,
            float(self.places.noise_m[likeliest]),
        )
