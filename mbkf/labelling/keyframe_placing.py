"""Poses of one segment that match its marker cluster with tracks, at several keyframes at once.

This body has not been scaled: its markers lie some centimetres from their places in the protocol, and its limbs are
longer or shorter. A segment's pose therefore comes from its own tracks, with a weak residual of its joint. Wrong
tracks do not move with the segment, or fit at one keyframe only, and so are kept out.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.labelling.assignment import HIDDEN, Indices
from mbkf.labelling.beam import BRANCHES, Placing, distinct_rows
from mbkf.labelling.keyframes import Keyframes
from mbkf.labelling.placing import MOST_POSTURE, PLACING_SD_M, match_log_ratios, nearest
from mbkf.labelling.skeleton import Cluster
from mbkf.numerics.rotations import nearest_rotations

TOGETHER_M = 0.05
"""Greatest variation of the distance of two tracks on one segment, as skin and shoulder blades move."""

LENGTH_M = 0.03
"""Greatest difference of two markers' distance from the protocol's."""

JOINT_REACH_M, JOINT_SD_M = 0.12, 0.04
"""Greatest and typical distance of a joint from its place in the chain of segments."""

REACH_M = 0.09
"""Greatest distance of a track from its marker while the segment's pose is rough."""

SETTLED_SDS = 3.0
"""The same after the first round, in standard deviations of the marker."""

MATCH_SD_M = 0.02
"""A marker's spread against which :data:`JOINT_SD_M` weighs the joint's residual."""

ROUNDS = 3
"""Rounds of alternately finding pose and tracks."""

_PAIRS, _SINGLES, _KEPT = 120, 40, 24
_PULL = 2e-4


class KeyframePlacing:
    """Places segments on the tracks of some keyframes.

    Attributes:
        seen: The tracks.
        together: (N, N) True where two may be on one segment.
    """

    def __init__(self, seen: Keyframes) -> None:
        self.seen = seen
        self.together = np.asarray(seen.spread_m <= TOGETHER_M)
        self._weight = (~np.isnan(seen.positions_m[:, :, 0])).astype(float)
        self._points = np.nan_to_num(seen.positions_m)

    def placings(self, cluster: Cluster, origins_m: Array, parents: Array, free: Indices) -> list[Placing]:
        """The best ways to place a segment, best first; the last is without any marker.

        Args:
            cluster: The segment.
            origins_m: (K, 3) its joint by the chain of segments.
            parents: (K, 3, 3) orientation of the segment before.
            free: Tracks not yet taken.
        """
        nothing = Placing(parents, origins_m, np.full(len(cluster.markers), HIDDEN, dtype=np.intp), 0.0)
        tracks, allowed = self._first(cluster, origins_m, free)
        if not len(tracks):
            return [nothing]
        settled_reach = SETTLED_SDS * np.hypot(cluster.sd_m, PLACING_SD_M)
        for round_ in range(ROUNDS):
            rotations, origins = self.settle(cluster.local_m, tracks, origins_m, parents)
            reach = np.maximum(settled_reach, REACH_M if round_ == 0 else 0.0)
            tracks, score = self.rate(cluster, rotations, origins, free, allowed, reach)
            score = score - self._strain(cluster, rotations, origins, origins_m, parents)
            rows = distinct_rows(tracks, score, _KEPT + 1)
            kept = np.array([row for row in rows if (tracks[row] != HIDDEN).any()][:_KEPT], dtype=np.intp)
            tracks, score, allowed = tracks[kept], score[kept], allowed[kept]
            rotations, origins = rotations[kept], origins[kept]
            if not len(kept):
                break
        ways = map(Placing, rotations, origins, tracks, score.tolist())
        return [*list(ways)[: BRANCHES - 1], nothing]

    def settle(
        self, local_m: Array, tracks: Indices, origins_m: Array, parents: Array | None
    ) -> tuple[Array, Array]:
        """Poses (n, K, 3, 3), (n, K, 3) of a segment by its tracks and, with a weak weight, by its joint.

        Least squares of the markers' distances and the joint's, each by its own spread (Wahba's problem with the joint
        as a further point).

        Args:
            local_m: (k, 3) markers in the segment's frame.
            tracks: (n, k) track of each marker, ``HIDDEN`` where none, in n alternatives.
            origins_m: (K, 3) its joint by the chain of segments.
            parents: (K, 3, 3) orientation of the segment before; None for the root, which has no joint.
        """
        weight = np.where((tracks != HIDDEN)[:, None], self._weight[:, tracks].transpose(1, 0, 2), 0.0)
        found = self._points[:, tracks].transpose(1, 0, 2, 3)
        joint = 0.0 if parents is None else (MATCH_SD_M / JOINT_SD_M) ** 2
        total = np.maximum(weight.sum(axis=2) + joint, 1e-9)[:, :, None]
        middle = ((weight[..., None] * found).sum(axis=2) + joint * origins_m) / total
        own = (weight[..., None] * local_m).sum(axis=2) / total
        arms, away = local_m - own[:, :, None], found - middle[:, :, None]
        attitude = np.einsum("nkm,nkmi,nkmj->nkij", weight, away, arms)
        if parents is None:
            attitude += _PULL * self._determined_nearby(attitude)
        else:
            attitude += joint * np.einsum("nki,nkj->nkij", origins_m - middle, -own) + _PULL * parents
        rotations = nearest_rotations(attitude.reshape(-1, 3, 3)).reshape(attitude.shape)
        return rotations, middle - np.einsum("nkij,nkj->nki", rotations, own)

    def rate(
        self,
        cluster: Cluster,
        rotations: Array,
        origins_m: Array,
        free: Indices,
        allowed: BoolArray,
        reach_m: Array,
    ) -> tuple[Indices, Array]:
        """Tracks (n, k) nearest to a cluster's markers in n ways to place it, and their scores (n,).

        Args:
            cluster: The segment.
            rotations: (n, K, 3, 3) its orientations.
            origins_m: (n, K, 3) its joint.
            free: (F,) tracks not yet taken.
            allowed: (n, F) True for those that move with the tracks by which the segment was placed.
            reach_m: (k,) greatest distance of each marker's track.
        """
        placed = np.einsum("nkij,mj->nkmi", rotations, cluster.local_m) + origins_m[:, :, None]
        weight = self._weight[:, free]
        shown = np.maximum(weight.sum(axis=0), 1e-9)
        squared = self._squared(placed, free) / shown
        squared = np.where(allowed[:, None] & (weight.sum(axis=0) > 0), squared, np.inf)
        found, least = nearest(squared, reach_m)
        return np.where(found == HIDDEN, HIDDEN, free[found]), match_log_ratios(cluster, found, least)

    def _determined_nearby(self, attitude: Array) -> Array:
        """(n, K, 3, 3) the root's orientation at the nearest keyframe that determines it, by Wahba's matrices.

        Tracks in one line, as two always are, leave the turn about it open: rounding would decide it.
        """
        determined = np.linalg.svd(attitude, compute_uv=False)[:, :, 1] > _PULL
        away = np.abs(self.seen.frames[:, None] - self.seen.frames)
        near = np.where(determined[:, None], away, np.inf).argmin(axis=2)  # (n, K)
        return nearest_rotations(np.take_along_axis(attitude, near[:, :, None, None], axis=1))

    def _squared(self, placed_m: Array, free: Indices) -> Array:
        """(n, k, F) squared distances of markers (n, K, k, 3) from tracks, summed over the keyframes with these."""
        ways, keyframes, markers, _ = placed_m.shape
        weight, points = self._weight[:, free], self._points[:, free]
        there = placed_m.transpose(0, 2, 1, 3).reshape(ways * markers, 3 * keyframes)
        seen = (weight[:, :, None] * points).transpose(0, 2, 1).reshape(3 * keyframes, len(free))
        own = (there**2).reshape(-1, keyframes, 3).sum(axis=2) @ weight
        found = own - 2.0 * there @ seen + (weight * (points**2).sum(axis=2)).sum(axis=0)
        return np.asarray(np.maximum(found, 0.0).reshape(ways, markers, len(free)))

    def _first(self, cluster: Cluster, origins_m: Array, free: Indices) -> tuple[Indices, BoolArray]:
        """Tracks (n, k) of two markers, or of one of a segment with fewer than three, and tracks that may join them."""
        found = np.zeros((0, len(cluster.markers)), dtype=np.intp)
        if not len(cluster.markers) or not len(free):
            return found, np.zeros((0, len(free)), dtype=bool)
        marker, track, misfit = self._within_reach(cluster, origins_m, free)
        one, two = np.triu_indices(len(marker), 1)
        fits = (
            (marker[one] != marker[two]) & (track[one] != track[two]) & self.together[track[one], track[two]]
        )
        one, two = one[fits], two[fits]
        between = np.linalg.norm(cluster.local_m[marker[one]] - cluster.local_m[marker[two]], axis=1)
        differ = np.abs(between - self.seen.length_m[track[one], track[two]])
        # Long distances determine the orientation better, and are matched less often by chance.
        pairs = np.argsort(differ - 0.1 * between)[:_PAIRS]
        pairs = pairs[differ[pairs] <= LENGTH_M]
        one, two = one[pairs], two[pairs]
        single = np.argsort(misfit)[: _SINGLES if len(cluster.markers) < 3 else 0]
        found = np.full((len(one) + len(single), len(cluster.markers)), HIDDEN, dtype=np.intp)
        row = np.arange(len(one))
        found[row, marker[one]], found[row, marker[two]] = track[one], track[two]
        found[len(one) + np.arange(len(single)), marker[single]] = track[single]
        allowed = self.together[track[one]] & self.together[track[two]]
        return found, np.concatenate([allowed, self.together[track[single]]])[:, free]

    def _within_reach(
        self, cluster: Cluster, origins_m: Array, free: Indices
    ) -> tuple[Indices, Indices, Array]:
        """Markers and tracks at about the same distance from the joint at all keyframes, and their differences."""
        weight = self._weight[:, free]
        distance = np.linalg.norm(self._points[:, free] - origins_m[:, None], axis=2)
        radius = np.linalg.norm(cluster.local_m, axis=1)
        squared = ((distance[:, None] - radius[:, None]) ** 2 * weight[:, None]).sum(axis=0)
        misfit = np.sqrt(squared / np.maximum(weight.sum(axis=0), 1e-9))
        marker, place = np.nonzero(misfit <= JOINT_REACH_M)
        return marker, free[place], misfit[marker, place]

    def _strain(
        self, cluster: Cluster, rotations: Array, origins: Array, origins_m: Array, parents: Array
    ) -> Array:
        """(n,) cost of the joint's gap and of an unusual turn, mean over the keyframes."""
        gap = ((origins - origins_m) ** 2).sum(axis=2) / JOINT_SD_M**2
        cosine = (np.einsum("nkij,kij->nk", rotations, parents) - 1.0) / 2.0
        turn = np.arccos(np.clip(cosine, -1.0, 1.0)) / cluster.posture_sd_rad
        return np.asarray((gap + np.minimum(turn**2, MOST_POSTURE)).mean(axis=1))
