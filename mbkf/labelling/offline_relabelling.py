"""Offline relabelling, with the whole capture known: every tracklet gets one label, or none.

A filter that labels frame by frame must decide at once. Afterwards the smoothed body predicts each marker in every
frame, and a tracklet is compared with it as a whole: a marker keeps its place on the segment to a few millimetres, a
ghost drifts. With mean offset r̄ from the marker's place, scatter s² about it (three coordinates together) and n_e
independent looks, the cost of a pair is

    c = |r̄|² / (σ_p² + σ² + p²) + ln det(2π(σ_p² + σ² + p²) I) + 2 ln λ + (n_e − 1)(s² / (σ² + min(p², σ²)) − κ)

with placement σ_p, marker noise σ, the body's own uncertainty p and λ ghosts per m³ (compare
:mod:`mbkf.labelling.assignment`); κ allows skin more than its stated noise.
"""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from mbkf.conventions import Array, BoolArray
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.tracklets import Tracklets


@dataclass(frozen=True)
class RelabellingSettings:
    """Limits within which a tracklet carries a marker's name.

    Attributes:
        placement_sd_m: How far the mean of a tracklet may be from its marker's place, σ_p.
        gate: Squared Mahalanobis distance (3 coordinates) of the mean beyond which a tracklet is not the marker's.
        radius_m: Distance of the mean beyond which it never is, however unsure the body.
        doubt: The squared distance beyond which it is in doubt ...
        brief_s: ... as is any tracklet shorter than this, unless the capture is not much longer.
        most_doubt: Where a larger share of the labels would be in doubt, none is: a capture begins, or comes back.
        restless: Scatter that is no longer a marker's, κ, in variances of its noise over three coordinates.
        correlation_s: Offsets this far apart in time are independent looks.
        ghosts_per_m3: λ.
        kept: How much cheaper the label is that the tracklet carried so far.
        named: How much cheaper the label is by which the capture names it; no gate then holds.
        least_votes: Least share of a tracklet's frames that must have carried a label for it to win the vote.
        least_share: A marker labelled in a smaller share of the frames was not worn: a ghost took its place.
        rare: Likewise one labelled in less than this share of the typical number of frames, if ...
        wandering: ... its offset scatters by more than this many times its noise.
    """

    placement_sd_m: float = 0.005
    gate: float = 20.0
    radius_m: float = 0.05
    doubt: float = 4.0
    brief_s: float = 0.4
    most_doubt: float = 0.4
    restless: float = 9.0
    correlation_s: float = 0.1
    ghosts_per_m3: float = 5.0
    kept: float = 6.0
    named: float = 40.0
    least_votes: float = 0.15
    least_share: float = 0.15
    rare: float = 0.6
    wandering: float = 1.5


@dataclass(frozen=True)
class SmoothedMarkers:
    """The smoothed body's markers in every frame of a capture; NaN where the body was not tracked.

    Attributes:
        on_body_m: (T, M, 3) the markers' places.
        rotations: (T, M, 3, 3) orientations of their segments.
        variance_m2: (T, M) variance of such a place, mean over its coordinates.
    """

    on_body_m: Array
    rotations: Array
    variance_m2: Array

    def local(self, markers_m: Array) -> Array:
        """(T, M, 3) offsets of measured markers from their places, in their segments' frames."""
        return np.einsum("tmji,tmj->tmi", self.rotations, markers_m - self.on_body_m)


def majority_labels(
    label_of_point: Indices, markers: int, tracklets: Tracklets, settings: RelabellingSettings
) -> Indices:
    """(n,) label of every tracklet by the frames in which its points carried it.

    A tracklet gives its label up for another one that it carried as well where more frames keep theirs in all.

    Args:
        label_of_point: (T, C) labels frame by frame.
        markers: Their number M.
        tracklets: The links.
        settings: How many frames it takes.
    """
    votes = _votes(label_of_point, markers, tracklets)
    length = np.diff(tracklets.spans, axis=1)
    votes = np.where(votes >= settings.least_votes * (length + 5.0), votes, 0.0)
    return _traded(votes, _without_overlap(votes, tracklets), tracklets)


def relabel(
    label_of_point: Indices,
    positions_m: Array,
    tracklets: Tracklets,
    course: SmoothedMarkers,
    noise_m: Array,
    dt_s: float,
    settings: RelabellingSettings,
    known: Indices | None = None,
) -> Indices:
    """(n,) label of every tracklet by the cheapest assignment.

    Args:
        label_of_point: (T, C) labels so far.
        positions_m: (T, C, 3) points.
        tracklets: Their links.
        course: The smoothed body's markers.
        noise_m: (M,) marker noise, NaN for markers that are not looked for.
        dt_s: Time between frames.
        settings: Limits that separate markers from ghosts.
        known: (T, C) marker of the points that carry a name which is relied on; None where there are none.
    """
    cost = _costs(positions_m, tracklets, course, noise_m, dt_s, settings)
    if known is not None:
        length = np.diff(tracklets.spans, axis=1)
        carried = _votes(known, len(noise_m), tracklets) > 0.5 * length
        looks = np.broadcast_to((length - 1) * dt_s / (settings.correlation_s + dt_s), cost.shape)
        sure = settings.named + settings.restless * looks
        cost[carried] = np.minimum(cost[carried], 0.0) - sure[carried]
    votes = _votes(label_of_point, len(noise_m), tracklets)
    cost -= settings.kept * ((votes > 0.0) & (votes == votes.max(axis=1, keepdims=True)))
    times = np.unique(tracklets.spans)
    preference = np.zeros_like(cost)
    for first, end in itertools.pairwise(times):
        active = np.flatnonzero((tracklets.spans[:, 0] <= first) & (tracklets.spans[:, 1] >= end))
        rows, columns = linear_sum_assignment(np.minimum(cost[active], 0.0))
        chosen = cost[active[rows], columns] < 0.0
        preference[active[rows[chosen]], columns[chosen]] += end - first
    return _without_overlap(preference, tracklets)


def doubtful(
    label_of_point: Indices,
    positions_m: Array,
    tracklets: Tracklets,
    course: SmoothedMarkers,
    noise_m: Array,
    dt_s: float,
    settings: RelabellingSettings,
) -> BoolArray:
    """(n,) labelled tracklets that may be ghosts: brief, or far from their marker's place; limits in ``settings``.

    A ghost takes a segment of few markers with it, so that being near is no proof.

    Args:
        label_of_point: (T, C) labels so far.
        positions_m: (T, C, 3) points.
        tracklets: Their links.
        course: The smoothed body's markers.
        noise_m: (M,) marker noise, NaN for markers that are not looked for.
        dt_s: Time between frames.
        settings: When a tracklet is brief, and when it is far.
    """
    votes = _votes(label_of_point, len(noise_m), tracklets)
    label = np.where(votes.any(axis=1), votes.argmax(axis=1), HIDDEN)
    shortest = min(settings.brief_s / dt_s, 0.25 * len(label_of_point))
    far = (np.diff(tracklets.spans, axis=1)[:, 0] < shortest) & (label != HIDDEN)
    for number, (frames, columns) in enumerate(tracklets.pieces):
        marker = label[number]
        if marker != HIDDEN:
            mean = _offsets(positions_m, frames, columns, course)[:, marker].mean(axis=0)
            variance = course.variance_m2[frames, marker].mean()
            placed = settings.placement_sd_m**2 + noise_m[marker] ** 2 + variance
            # Never where the body was not tracked: comparisons with NaN are false.
            far[number] |= bool(mean @ mean > settings.doubt * placed)
    return np.asarray(far & (_share_in_doubt(far, label != HIDDEN, tracklets) <= settings.most_doubt))


def _share_in_doubt(far: BoolArray, labelled: BoolArray, tracklets: Tracklets) -> Array:
    """(n,) share of doubtful ones among the labelled points of a tracklet's frames, in the mean."""
    doubts, all_ = np.zeros(len(tracklets.number)), np.zeros(len(tracklets.number))
    for number, (first, end) in enumerate(tracklets.spans):
        doubts[first:end] += far[number]
        all_[first:end] += labelled[number]
    share = doubts / np.maximum(1.0, all_)
    return np.array([share[first:end].mean() for first, end in tracklets.spans])


def worn(
    course: SmoothedMarkers,
    markers_m: Array,
    noise_m: Array,
    segments: Sequence[str],
    settings: RelabellingSettings,
) -> BoolArray:
    """(M,) markers that are really there, and not made up of ghosts that passed the place of one that was not worn.

    A false marker makes its segment's others restless, too, so that only the worst of each segment is named at once.

    Args:
        course: The smoothed body's markers.
        markers_m: (T, M, 3) labelled trajectories, NaN where hidden.
        segments: Segment of each of the M markers.
        noise_m: (M,) marker noise.
        settings: How rare and how restless a marker may be.
    """
    local = course.local(markers_m)
    share = (~np.isnan(local[:, :, 0])).mean(axis=0)
    if not share.any():
        return np.zeros(len(noise_m), dtype=bool)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # markers without a frame
        scatter = np.sqrt(np.nanvar(local, axis=0).mean(axis=1))
    rare = share < settings.rare * np.median(share[share > 0.0])
    excess = np.where(rare, scatter / noise_m, 0.0)
    own = np.array(segments)
    worst = np.array([excess[k] >= excess[own == segment].max() for k, segment in enumerate(own)])
    return (share >= settings.least_share) & ~(worst & (excess > settings.wandering))


def _votes(label_of_point: Indices, markers: int, tracklets: Tracklets) -> Array:
    """(n, M) number of frames in which each tracklet's point carried each label."""
    votes = np.zeros((tracklets.count, markers))
    there = (label_of_point != HIDDEN) & (tracklets.number != HIDDEN)
    np.add.at(votes, (tracklets.number[there], label_of_point[there]), 1.0)
    return votes


def _without_overlap(frames: Array, tracklets: Tracklets) -> Indices:
    """(n,) labels by the number of frames (n, M) with each of them, no label twice in a frame."""
    label = np.full(tracklets.count, HIDDEN, dtype=np.intp)
    taken = np.zeros((len(tracklets.number), frames.shape[1]), dtype=bool)
    rows, columns = np.nonzero(frames)
    for k in np.argsort(-frames[rows, columns], kind="stable"):
        piece, marker = rows[k], columns[k]
        first, end = tracklets.spans[piece]
        if label[piece] == HIDDEN and not taken[first:end, marker].any():
            label[piece] = marker
            taken[first:end, marker] = True
    return label


def _traded(votes: Array, label: Indices, tracklets: Tracklets) -> Indices:
    """(n,) labels after trades: one tracklet takes another label, and tracklets without any take its own.

    Args:
        votes: (n, M) number of frames in which each tracklet carried each label, 0 where they are too few.
        label: (n,) labels, none twice in a frame.
        tracklets: The links.
    """
    for piece in np.flatnonzero((label != HIDDEN) & (np.count_nonzero(votes, axis=1) > 1)).tolist():
        own = int(label[piece])
        for other in np.flatnonzero(votes[piece]).tolist():
            if other == own or not _free(other, piece, label, tracklets):
                continue
            trial, gained = label.copy(), votes[piece, other] - votes[piece, own]
            trial[piece] = other
            heirs = np.flatnonzero((label == HIDDEN) & (votes[:, own] > 0.0))
            for heir in heirs[np.argsort(-votes[heirs, own], kind="stable")].tolist():
                if _free(own, heir, trial, tracklets):
                    trial[heir], gained = own, gained + votes[heir, own]
            if gained > 0.0:
                label = trial
                break
    return label


def _free(marker: int, piece: int, label: Indices, tracklets: Tracklets) -> bool:
    """Whether no other tracklet has the marker's label while this one lasts."""
    spans = tracklets.spans[(label == marker) & (np.arange(len(label)) != piece)]
    first, end = tracklets.spans[piece]
    return not ((spans[:, 0] < end) & (spans[:, 1] > first)).any()


def _costs(
    positions_m: Array,
    tracklets: Tracklets,
    course: SmoothedMarkers,
    noise_m: Array,
    dt_s: float,
    settings: RelabellingSettings,
) -> Array:
    """(n, M) costs of the module's equation; infinite beyond the gate and where the body was not tracked."""
    cost = np.full((tracklets.count, len(noise_m)), np.inf)
    followed = ~np.isnan(course.variance_m2[:, 0])
    for number, (frames, columns) in enumerate(tracklets.pieces):
        known = followed[frames]
        if not known.any():
            continue
        at = frames[known]
        local = _offsets(positions_m, at, columns[known], course)
        looks = 1.0 + (len(at) - 1) * dt_s / (settings.correlation_s + dt_s)
        mean = local.mean(axis=0)
        scatter = local.var(axis=0).sum(axis=1)
        unsure = course.variance_m2[at].mean(axis=0)
        placed = settings.placement_sd_m**2 + noise_m**2 + unsure
        squared = (mean**2).sum(axis=1)
        away = squared / placed
        once = away + 3.0 * np.log(2.0 * math.pi * placed) + 2.0 * math.log(settings.ghosts_per_m3)
        steady = noise_m**2 + np.minimum(unsure, noise_m**2)  # the body's own error changes slowly
        pair = once + (looks - 1.0) * (scatter / steady - settings.restless)
        inside = (away <= settings.gate) & (squared <= settings.radius_m**2) & ~np.isnan(pair)
        cost[number] = np.where(inside, pair, np.inf)
    return cost


def _offsets(positions_m: Array, frames: Indices, columns: Indices, course: SmoothedMarkers) -> Array:
    """(k, M, 3) offsets of a tracklet's points from the places of all markers, in their segments' frames."""
    offset = positions_m[frames, columns, None] - course.on_body_m[frames]
    return np.einsum("tmji,tmj->tmi", course.rotations[frames], offset)
