"""Offline relabelling, with the whole capture known: every tracklet gets one label or remains without.

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
from dataclasses import dataclass, field

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.tracklets import Tracklets


@dataclass(frozen=True)
class RelabellingSettings:
    """Limits within which a tracklet carries a marker's name.

    Attributes:
        placement_sd_m: Spread of the mean of a tracklet about its marker's place, σ_p.
        gate: Greatest squared Mahalanobis distance (3 coordinates) of that mean.
        radius_m: Greatest distance of that mean, however uncertain the body.
        doubt: Squared Mahalanobis distance beyond which a tracklet is doubtful.
        brief_s: A shorter tracklet is doubtful, unless the capture is not much longer.
        most_doubt: Share of doubtful labels above which no label counts as doubtful: a capture begins, or comes back.
        most_scatter: Greatest scatter of a marker, κ, in variances of its noise over three coordinates.
        correlation_s: Offsets this far apart in time are independent looks.
        ghosts_per_m3: λ.
        kept: Reduction of the cost of the label that the tracklet carried so far.
        named: Reduction of the cost of the label by which the capture names it; the gate then does not apply.
        least_votes: Least share of a tracklet's frames with a label for which that label can win the vote.
        least_share: A marker labelled in a smaller share of the frames was not worn: a ghost took its place.
        rare: The same for less than this share of the typical number of frames, if the offset scatters ...
        wandering: ... by more than this many times its noise.
    """

    placement_sd_m: float = 0.005
    gate: float = 20.0
    radius_m: float = 0.05
    doubt: float = 4.0
    brief_s: float = 0.4
    most_doubt: float = 0.4
    most_scatter: float = 9.0
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

    A tracklet exchanges its label for another one that it also carried, where more frames in all then keep theirs.

    Args:
        label_of_point: (T, C) labels frame by frame.
        markers: Their number M.
        tracklets: The links.
        settings: Least share of the frames.
    """
    votes = _votes(label_of_point, markers, tracklets)
    length = np.diff(tracklets.spans, axis=1)
    votes = np.where(votes >= settings.least_votes * (length + 5.0), votes, 0.0)
    return _traded(votes, _without_overlap(votes, tracklets), tracklets)


@dataclass(frozen=True)
class SmoothedCapture:
    """The tracklets of a capture beside its smoothed body.

    Attributes:
        positions_m: (T, C, 3) points.
        tracklets: Their links.
        smoothed: The smoothed body's markers.
        noise_m: (M,) marker noise, NaN for markers that are not looked for.
        dt_s: Time between frames.
        settings: Limits that separate markers from ghosts.
    """

    positions_m: Array
    tracklets: Tracklets
    smoothed: SmoothedMarkers
    noise_m: Array
    dt_s: float
    settings: RelabellingSettings = field(default_factory=RelabellingSettings)

    def relabelled(self, label_of_point: Indices, known: Indices | None = None) -> Indices:
        """(n,) label of every tracklet by the cheapest assignment.

        Args:
            label_of_point: (T, C) labels so far.
            known: (T, C) marker of the points that carry a reliable name; None where none does.
        """
        from scipy.optimize import linear_sum_assignment  # loads slowly

        cost, spans, markers = self._costs(), self.tracklets.spans, len(self.noise_m)
        if known is not None:
            length = np.diff(spans, axis=1)
            carried = _votes(known, markers, self.tracklets) > 0.5 * length
            looks = np.broadcast_to(
                (length - 1) * self.dt_s / (self.settings.correlation_s + self.dt_s), cost.shape
            )
            sure = self.settings.named + self.settings.most_scatter * looks
            cost[carried] = np.minimum(cost[carried], 0.0) - sure[carried]
        votes = _votes(label_of_point, markers, self.tracklets)
        cost -= self.settings.kept * ((votes > 0.0) & (votes == votes.max(axis=1, keepdims=True)))
        preference = np.zeros_like(cost)
        for first, end in itertools.pairwise(np.unique(spans)):
            active = np.flatnonzero((spans[:, 0] <= first) & (spans[:, 1] >= end))
            rows, columns = linear_sum_assignment(np.minimum(cost[active], 0.0))
            chosen = cost[active[rows], columns] < 0.0
            preference[active[rows[chosen]], columns[chosen]] += end - first
        return _without_overlap(preference, self.tracklets)

    def doubtful(self, label_of_point: Indices) -> BoolArray:
        """(n,) tracklets, labelled (T, C) so far, that may be ghosts: brief, or far from their marker's place.

        A ghost takes a segment of few markers with it, so that nearness proves nothing.
        """
        votes = _votes(label_of_point, len(self.noise_m), self.tracklets)
        label = np.where(votes.any(axis=1), votes.argmax(axis=1), HIDDEN)
        shortest = min(self.settings.brief_s / self.dt_s, 0.25 * len(label_of_point))
        far = (np.diff(self.tracklets.spans, axis=1)[:, 0] < shortest) & (label != HIDDEN)
        for number, (frames, columns) in enumerate(self.tracklets.pieces):
            marker = label[number]
            if marker != HIDDEN:
                mean = self._offsets(frames, columns)[:, marker].mean(axis=0)
                variance = self.smoothed.variance_m2[frames, marker].mean()
                placed = self.settings.placement_sd_m**2 + self.noise_m[marker] ** 2 + variance
                # False where the body was not tracked: comparisons with NaN are.
                far[number] |= bool(mean @ mean > self.settings.doubt * placed)
        share = _share_in_doubt(far, label != HIDDEN, self.tracklets)
        return np.asarray(far & (share <= self.settings.most_doubt))

    def _costs(self) -> Array:
        """(n, M) costs of the module's equation; infinite beyond the gate and where the body was not tracked."""
        settings, noise = self.settings, self.noise_m
        cost = np.full((self.tracklets.count, len(noise)), np.inf)
        tracked = ~np.isnan(self.smoothed.variance_m2[:, 0])
        for number, (frames, columns) in enumerate(self.tracklets.pieces):
            known = tracked[frames]
            if not known.any():
                continue
            at = frames[known]
            local = self._offsets(at, columns[known])
            looks = 1.0 + (len(at) - 1) * self.dt_s / (settings.correlation_s + self.dt_s)
            unsure = self.smoothed.variance_m2[at].mean(axis=0)
            placed = settings.placement_sd_m**2 + noise**2 + unsure
            squared = (local.mean(axis=0) ** 2).sum(axis=1)
            away = squared / placed
            once = away + 3.0 * np.log(2.0 * math.pi * placed) + 2.0 * math.log(settings.ghosts_per_m3)
            steady = noise**2 + np.minimum(unsure, noise**2)  # the body's own error changes slowly
            pair = once + (looks - 1.0) * (local.var(axis=0).sum(axis=1) / steady - settings.most_scatter)
            inside = (away <= settings.gate) & (squared <= settings.radius_m**2) & ~np.isnan(pair)
            cost[number] = np.where(inside, pair, np.inf)
        return cost

    def _offsets(self, frames: Indices, columns: Indices) -> Array:
        """(k, M, 3) offsets of a tracklet's points from the places of all markers, in their segments' frames."""
        offset = self.positions_m[frames, columns, None] - self.smoothed.on_body_m[frames]
        return np.einsum("tmji,tmj->tmi", self.smoothed.rotations[frames], offset)


def _share_in_doubt(far: BoolArray, labelled: BoolArray, tracklets: Tracklets) -> Array:
    """(n,) share of doubtful ones among the labelled points of a tracklet's frames, in the mean."""
    doubts, all_ = np.zeros(len(tracklets.number)), np.zeros(len(tracklets.number))
    for number, (first, end) in enumerate(tracklets.spans):
        doubts[first:end] += far[number]
        all_[first:end] += labelled[number]
    share = doubts / np.maximum(1.0, all_)
    return np.array([share[first:end].mean() for first, end in tracklets.spans])


def worn_markers(
    smoothed: SmoothedMarkers,
    markers_m: Array,
    noise_m: Array,
    segments: Sequence[str],
    settings: RelabellingSettings,
) -> BoolArray:
    """(M,) True for markers that were worn; False for those made up of ghosts that passed a marker's place.

    A false marker makes its segment's other markers scatter as well, so only the worst of each segment is False.

    Args:
        smoothed: The smoothed body's markers.
        markers_m: (T, M, 3) labelled trajectories, NaN where hidden.
        segments: Segment of each of the M markers.
        noise_m: (M,) marker noise.
        settings: Limits of share and scatter.
    """
    local = smoothed.local(markers_m)
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
    """True where no other tracklet has the marker's label while this one lasts."""
    spans = tracklets.spans[(label == marker) & (np.arange(len(label)) != piece)]
    first, end = tracklets.spans[piece]
    return not ((spans[:, 0] < end) & (spans[:, 1] > first)).any()
