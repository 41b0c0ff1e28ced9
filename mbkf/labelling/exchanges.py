"""Names that two markers of a named capture exchange for some frames, found by distances and by jumps.

A laboratory's labels may be swapped between two markers, mostly after one of them was hidden. Two kinds of evidence are
joined. The first are the distances from a marker to its rigid neighbours: with expected distance D and its spread s, a
point at x costs Σ min((|x − x_n| − D_n)² / s_n², c) as that marker. The second is the vector δ from one marker to the
other, which an exchange from one frame to the next reverses: δ(t) · δ(t+1) < 0. The most likely sequence of stored and
exchanged frames follows by the Viterbi recursion (G. D. Forney, Proc. IEEE 61, 1973, 268-278).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.numerics.percentiles import known_percentiles
from mbkf.numerics.runs import runs, spread_indices
from mbkf.sensors.marker_sensor import MarkerSensor

if TYPE_CHECKING:
    from mbkf.labelling.assignment import Indices

POSTURES = 48
"""Postures from which the spread of the distance of two markers is computed."""

FREE_SD_RAD = 0.4
"""Spread of joint rotations without a posture prior."""

NEIGHBOURS = 6
"""Number of markers, those of the steadiest distances, by which a name is judged."""

WORST = 9.0
"""Greatest cost of one distance, c: a neighbour may itself be misplaced."""

LOOKS = 150
"""Frames, spread over the capture, in which pairs are searched."""

TURNED, FLIPPED = 400.0, 25.0
"""Cost of a state that contradicts a reversal of δ or its absence, and of a change where δ is unknown."""

APART_M = 0.015
"""Least distance of two markers that can be distinguished."""

SUSPECT_GAIN = 5.0
"""Gain in some frame from which a pair is examined."""

LEAST_GAIN, SURE_GAIN = 1.0, 12.0
"""Least mean gain of a frame for an exchange: where δ reverses at all of its ends, and where it does not."""

MOST_LEFT, SURE_MOST_LEFT = 0.9, 0.6
"""Greatest share of the cost that an exchange leaves, in the same two cases."""

BOTH_SEEN = 0.2
"""Least share of an exchange in which both markers are seen: with one alone, whose rigid neighbours are hidden as well,
a limb that is bent further than usual looks like another name."""

KEPT_COS = 0.5
"""Cosine of the angle of δ across a gap above which no names were exchanged in it: the body turns δ, by up to 120°
between knees that pass each other, and an exchange reverses it."""

OBSERVED_SD_M, FEW = 0.008, 20
"""Least spread of a distance observed in the capture, and least number of examined frames that show it."""

BLOCK = 16
"""Frames per block."""

ROUNDS = 8
"""Greatest number of rounds, for exchanges that depend on each other."""


@dataclass(frozen=True)
class Distances:
    """Expected distances between M markers.

    Attributes:
        expected_m: (M, M) expected distance.
        sd_m: (M, M) its spread, by posture and placement.
    """

    expected_m: Array
    sd_m: Array

    @property
    def neighbours(self) -> Indices:
        """(M, k) markers with the steadiest distances from each marker."""
        spread = self.sd_m + np.diag(np.full(len(self.sd_m), np.inf))
        return np.asarray(np.argsort(spread, axis=1)[:, : min(NEIGHBOURS, len(spread) - 1)])


@dataclass(frozen=True)
class Exchange:
    """Two markers and the frames in which their names are exchanged.

    Attributes:
        a, b: Their indices, the smaller first.
        frames: (T,) True where their names are exchanged.
    """

    a: int
    b: int
    frames: BoolArray


def body_distances(sensor: MarkerSensor, placement_m: Array) -> Distances:
    """Distances between M markers of a body over likely postures, each marker with the spread (M,) of its place, m."""
    model, rng = sensor.model, np.random.default_rng(0)
    spread = np.where(model.posture_sd > 0.0, np.minimum(model.posture_sd, FREE_SD_RAD), FREE_SD_RAD)
    spread[:6] = 0.0
    neutral = model.neutral()
    poses = [model.integrate(neutral, spread * rng.standard_normal(model.nv)) for _ in range(POSTURES)]
    places = np.array([sensor.positions(q) for q in poses])
    first, second = np.triu_indices(len(placement_m), 1)
    apart = np.linalg.norm(places[:, first] - places[:, second], axis=2)
    mean, variance = np.zeros((2, len(placement_m), len(placement_m)))
    mean[first, second] = mean[second, first] = apart.mean(axis=0)
    variance[first, second] = variance[second, first] = apart.var(axis=0)
    return Distances(mean, np.sqrt(variance + placement_m[:, None] ** 2 + placement_m**2))


def observed_distances(positions_m: Array, distances: Distances) -> Distances:
    """Median distances of a capture (T, M, 3), NaN where hidden; those given for pairs that are rarely seen together.

    Names may be exchanged in less than half of the frames.
    """
    looks = spread_indices(len(positions_m), LOOKS)
    apart = np.sqrt(np.maximum(_squared(positions_m[looks]), 0.0))
    low, middle, high = known_percentiles(apart, (10.0, 50.0, 90.0))
    seen = (~np.isnan(apart)).sum(axis=0) >= FEW
    spread = np.hypot(OBSERVED_SD_M, high - low)
    return Distances(
        np.where(seen, middle, distances.expected_m),
        np.where(seen, np.minimum(spread, distances.sd_m), distances.sd_m),
    )


def find_exchanges(positions_m: Array, distances: Distances) -> tuple[Exchange, ...]:
    """Exchanges in named trajectories (T, M, 3), NaN where hidden, by the expected distances; each pair once."""
    shown, found = positions_m, dict[tuple[int, int], BoolArray]()
    if shown.shape[1] < 4 or not len(shown):
        return ()
    expected, of_body, turning = distances, True, _turning(shown)
    for _ in range(ROUNDS):
        pairs = _suspects(shown, expected, turning)
        chosen = _chosen(shown, expected, pairs) if len(pairs) else []
        for one in chosen:
            found[one.a, one.b] = found.get((one.a, one.b), np.zeros(len(shown), dtype=bool)) ^ one.frames
        shown = undo_exchanges(shown, chosen)
        if not chosen and not of_body:
            break
        if chosen:
            turning = _turning(shown)
        else:
            expected, of_body = observed_distances(shown, distances), False
    return tuple(Exchange(a, b, frames) for (a, b), frames in found.items() if frames.any())


def undo_exchanges(positions_m: Array, found: tuple[Exchange, ...] | list[Exchange]) -> Array:
    """(T, M, 3) named trajectories without these exchanges, which are undone in the order in which they were found."""
    right = positions_m.copy()
    for one in found:
        right[one.frames, one.a], right[one.frames, one.b] = (
            right[one.frames, one.b],
            right[one.frames, one.a],
        )
    return right


def misfits(positions_m: Array, distances: Distances) -> tuple[Array, Array]:
    """(T, M) cost of every marker under its own name, and number of its neighbours (T, M), by positions (T, M, 3)."""
    near = distances.neighbours
    cost, count = np.zeros(positions_m.shape[:2]), np.zeros(positions_m.shape[:2])
    for marker, own in enumerate(near):
        away = np.sqrt(((positions_m[:, own] - positions_m[:, marker, None]) ** 2).sum(axis=2))
        off = ((away - distances.expected_m[marker, own]) / distances.sd_m[marker, own]) ** 2
        cost[:, marker] = np.nan_to_num(np.minimum(off, WORST), nan=0.0).sum(axis=1)
        count[:, marker] = (~np.isnan(off)).sum(axis=1)
    return cost, count


def _suspects(shown_m: Array, distances: Distances, turning: BoolArray) -> Indices:
    """(P, 2) pairs that fit better with exchanged names in some examined frame, or whose δ reverses (M, M)."""
    frames = shown_m[spread_indices(len(shown_m), LOOKS)]
    suspect = turning.copy()
    for first in range(0, len(frames), BLOCK):  # small blocks stay in the processor's cache
        suspect |= _gaining(frames[first : first + BLOCK], distances)
    return np.argwhere(np.triu(suspect, 1))


def _gaining(frames_m: Array, distances: Distances) -> BoolArray:
    """(M, M) True for pairs that fit better with exchanged names in one of some frames (F, M, 3)."""
    near, count = distances.neighbours, frames_m.shape[1]
    apart = np.sqrt(np.maximum(_squared(frames_m), 0.0))  # (F, M, M)
    markers = np.arange(count)[:, None]
    expected, spread = distances.expected_m[markers, near], distances.sd_m[markers, near]
    cost = np.zeros(apart.shape)  # of point b (last but one) as marker a (last)
    for k in range(near.shape[1]):
        off = apart[:, :, near[:, k]] - expected[:, k]
        off *= off / spread[:, k] ** 2
        off[:, near[:, k], np.arange(count)] = 0.0
        off[np.isnan(off)] = 0.0
        cost += np.minimum(off, WORST, out=off)
    own = np.einsum("tmm->tm", cost)
    gain = own[:, :, None] + own[:, None] - cost - cost.transpose(0, 2, 1)
    both = ~np.isnan(apart) & (apart >= APART_M)
    return np.asarray((both & (gain > SUSPECT_GAIN)).any(axis=0))


def _squared(frames_m: Array) -> Array:
    """(F, M, M) squared distances between the markers of a frame."""
    middle = frames_m - np.nan_to_num(frames_m).mean(axis=1, keepdims=True)
    inner = middle @ middle.transpose(0, 2, 1)
    own = np.einsum("tmm->tm", inner)
    return np.asarray(own[:, :, None] + own[:, None] - 2.0 * inner)


def _turning(shown_m: Array) -> BoolArray:
    """(M, M) True where the vector from one marker to another reverses from any frame to the next."""
    turning = np.zeros((shown_m.shape[1], shown_m.shape[1]), dtype=bool)
    for first in range(0, len(shown_m) - 1, BLOCK):  # small blocks stay in the processor's cache
        now = shown_m[first : first + BLOCK + 1]
        cross = now[1:] @ now[:-1].transpose(0, 2, 1)
        own = np.einsum("tmm->tm", cross)
        cross += cross.transpose(0, 2, 1)
        turning |= (cross > own[:, :, None] + own[:, None]).any(axis=0)
    return turning


def _chosen(shown_m: Array, distances: Distances, pairs: Indices) -> list[Exchange]:
    """The exchanges of greatest gain, no marker in two of them."""
    gain, left, stored = _gains(shown_m, distances, pairs)
    delta = shown_m[:, pairs[:, 0]] - shown_m[:, pairs[:, 1]]
    turn = np.einsum("tpi,tpi->tp", delta[1:], delta[:-1])  # NaN where one is hidden
    state = _likeliest(gain, turn)
    tried = []
    for p, (a, b) in enumerate(pairs):
        kept = np.zeros(len(shown_m), dtype=bool)
        for first, end in runs(state[:, p]):
            there = slice(first, end)
            looked = stored[there, p] > 0.0
            both = ~np.isnan(delta[there, p, 0])
            if not looked.any() or both.sum() < BOTH_SEEN * looked.sum():
                continue
            ends = [t for t in (first - 1, end - 1) if 0 <= t < len(turn)]
            if any(turn[t, p] >= 0.0 or _kept(delta[:, p], t) for t in ends):
                continue
            reversed_ = bool(ends) and all(turn[t, p] < 0.0 for t in ends)
            least, most = (LEAST_GAIN, MOST_LEFT) if reversed_ else (SURE_GAIN, SURE_MOST_LEFT)
            gained = gain[there, p].sum() >= least * looked.sum()
            kept[there] = gained and left[there, p].sum() <= most * stored[there, p].sum()
        if kept.any():
            tried.append((float(gain[kept, p].sum()), Exchange(int(a), int(b), kept)))
    chosen: list[Exchange] = []
    for _, one in sorted(tried, key=lambda each: -each[0]):
        if not any({one.a, one.b} & {other.a, other.b} for other in chosen):
            chosen.append(one)
    return chosen


def _kept(delta: Array, t: int) -> bool:
    """True where δ (T, 3) keeps its direction over a gap about frames t and t + 1."""
    seen = np.flatnonzero(~np.isnan(delta[:, 0]))
    after = int(np.searchsorted(seen, t, side="right"))
    if not 0 < after < len(seen):
        return False
    one, other = delta[seen[after - 1]], delta[seen[after]]
    return bool(one @ other > KEPT_COS * np.linalg.norm(one) * np.linalg.norm(other))


def _gains(shown_m: Array, distances: Distances, pairs: Indices) -> tuple[Array, Array, Array]:
    """(T, P) gain of exchanging each pair, cost then left, and cost as stored; 0 where both are hidden."""
    shape = (len(shown_m), len(pairs))
    stored, left = np.zeros(shape), np.zeros(shape)
    for p, (a, b) in enumerate(pairs):
        for marker, other in ((a, b), (b, a)):
            spread = distances.sd_m[marker].copy()
            spread[[marker, other]] = np.inf
            near = np.argsort(spread)[: min(NEIGHBOURS, len(spread) - 2)]
            expected, sd = distances.expected_m[marker, near], distances.sd_m[marker, near]
            for point, total in ((marker, stored), (other, left)):
                away = np.sqrt(((shown_m[:, near] - shown_m[:, point, None]) ** 2).sum(axis=2))
                each = np.minimum(((away - expected) / sd) ** 2, WORST)
                total[:, p] += np.nan_to_num(each, nan=0.0).sum(axis=1)
    return stored - left, left, stored


def _likeliest(gain: Array, turn: Array) -> BoolArray:
    """(T, P) True where the names of each pair are exchanged, by gains (T, P) and δ(t)·δ(t+1) (T - 1, P)."""
    frames, pairs = gain.shape
    stay = np.where(np.isnan(turn), 0.0, np.where(turn < 0.0, TURNED, 0.0))
    flip = np.where(np.isnan(turn), FLIPPED, np.where(turn < 0.0, 0.0, TURNED))
    cost = np.array([np.zeros(pairs), FLIPPED - gain[0]])
    came = np.zeros((frames, 2, pairs), dtype=bool)  # True: from the other state
    for t in range(1, frames):
        kept, changed = cost + stay[t - 1], cost[::-1] + flip[t - 1]
        came[t] = changed < kept
        cost = np.minimum(kept, changed)
        cost[1] -= gain[t]
    state = np.zeros((frames, pairs), dtype=bool)
    state[-1] = cost[1] < cost[0]
    every = np.arange(pairs)
    for t in range(frames - 1, 0, -1):
        state[t - 1] = state[t] ^ came[t, state[t].astype(int), every]
    return state
