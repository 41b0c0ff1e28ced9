"""Labels from frame to frame, between a filter's prediction and its correction (thesis section 4.1.3).

Besides the filter's prediction the labeller uses the offset of each marker from the body when last seen (skin and
placement, which outlive a short gap), and the label of each point's own track. Every few frames labels are also
computed without this memory: where they contradict it twice in a row, the memory is wrong, and exchanged labels are
corrected.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.labelling.assignment import HIDDEN, AssignmentSettings, Indices, assign, marker_of_point, pair_costs
from mbkf.sensors.marker_sensor import MarkerPrediction

MOST_CONTRADICTED = 0.2
"""Share of the labelled markers far from the corrected body above which the pose is wrong, and not the labels."""


@dataclass(frozen=True)
class RunningSettings:
    """Memory of a labeller from frame to frame, and when it is overruled.

    Attributes:
        assignment: Gate, radius and the bonus of a known track.
        memory_s: Time constant in which an offset from the body is forgotten while a marker is not seen.
        learning_s: Time constant in which it is learnt.
        offset_sd_m: Spread of a marker about its remembered offset while it is seen.
        unseen_sd_m: Further spread of a marker that was not seen since the start.
        miss_sds: Greatest distance of a point from its remembered place on the corrected body, in standard deviations.
        every: Frames between two updates of the memory; labels without memory are then computed as well.
        doubt_margin: Least difference of cost by which labels without memory contradict those with it.
        doubts: Contradictions in a row that overrule the memory.
    """

    assignment: AssignmentSettings = field(default_factory=lambda: AssignmentSettings(radius_m=0.10))
    memory_s: float = 0.3
    learning_s: float = 0.05
    offset_sd_m: float = 0.004
    unseen_sd_m: float = 0.015
    miss_sds: float = 3.5
    every: int = 4
    doubt_margin: float = 9.0
    doubts: int = 2


class RunningLabeller:
    """Assigns the points of one frame after the other.

    Attributes:
        noise_m: (M,) marker noise, m.
        placement_m: (M,) standard deviation of a marker's place on the body, m.
        settings: Gates and memory.
        repaired: Number of markers so far whose labels were taken back from a wrong point.
    """

    def __init__(
        self, noise_m: Array, placement_m: Array, dt_s: float, settings: RunningSettings | None = None
    ) -> None:
        """Creates a labeller without memory.

        Args:
            noise_m: (M,) marker noise, m.
            placement_m: (M,) standard deviation of a marker's place on the body, m.
            dt_s: Time between frames.
            settings: Gates and memory.
        """
        self.noise_m, self.placement_m = noise_m, placement_m
        self._forgotten = noise_m**2 + placement_m**2
        self.settings = settings or RunningSettings()
        self.repaired = 0
        lesson_s = dt_s * self.settings.every
        self._keep = math.exp(-lesson_s / self.settings.memory_s)
        self._learn = 1.0 - math.exp(-lesson_s / self.settings.learning_s)
        self._forgetting = (1.0 - self._keep**2) * self._forgotten
        self._patient = replace(self.settings.assignment, known_bonus=0.0)
        self.restart()

    def restart(self) -> None:
        """Forgets offsets and tracks; :meth:`remember` gives the labels of the next frame."""
        self._offset_m = np.zeros((len(self.noise_m), 3))
        self._variance = self._forgotten + self.settings.unseen_sd_m**2
        self._before = (np.full(len(self.noise_m), HIDDEN, dtype=np.intp), 0)
        self._doubted = np.zeros(len(self.noise_m), dtype=int)
        self._frames = 0

    @property
    def learns(self) -> bool:
        """True where the memory learns from the frame last labelled: the first few, then every so many."""
        every = self.settings.every
        return self._frames <= 2 * every or self._frames % every == 0

    def label(
        self, prediction: MarkerPrediction, points_m: Array, follows: Callable[[], Indices] | None = None
    ) -> Indices:
        """(M,) the point of every marker in this frame, ``HIDDEN`` where it has none.

        Args:
            prediction: The filter's predicted markers.
            points_m: (N, 3) measured points in any order, none missing.
            follows: Gives the point of the frame before that each continues (N,), ``HIDDEN`` where unknown; called only
                where labels are in dispute.
        """

        def known() -> Indices | None:
            before = None if follows is None or not self._before[1] else follows()
            if before is None or before.max(initial=HIDDEN) == HIDDEN:
                return None
            return np.where(before != HIDDEN, marker_of_point(*self._before)[before], HIDDEN)

        def covariance(chosen: BoolArray) -> Array:
            return _with_own(prediction.spread(chosen), self._variance[chosen])

        predicted = prediction.positions_m + self._offset_m
        labels = assign(predicted, points_m, covariance, self.settings.assignment, known)
        self._frames += 1
        if self._frames % self.settings.every == 0:
            labels = self._doubt(labels, prediction, points_m)
        return labels

    def contradicted(self, labels: Indices, points_m: Array, on_body_m: Array) -> BoolArray:
        """(M,) True where a marker's point does not fit the pose corrected by all points: ghosts near a marker.

        The prediction of a whole limb may be a centimetre off; the residual after the correction is that of each marker
        alone. Where many residuals are large, the pose is wrong, and all are False.

        Args:
            labels: (M,) the point of every marker.
            points_m: (N, 3) the frame's points.
            on_body_m: (M, 3) markers on the body in the filter's corrected pose.
        """
        seen = labels != HIDDEN
        far = np.zeros(len(labels), dtype=bool)
        if seen.any():
            away = points_m[labels] - on_body_m - self._offset_m
            squared = np.einsum("ij,ij->i", away, away)
            far = seen & (squared > self.settings.miss_sds**2 * (self._variance + 0.5 * self.noise_m**2))
        few = np.count_nonzero(far) <= MOST_CONTRADICTED * np.count_nonzero(seen)
        return far if few else np.zeros_like(far)

    def remember(self, labels: Indices, points_m: Array, on_body_m: Array) -> None:
        """Learns from a frame once the filter has used it.

        Args:
            labels: (M,) the point of every marker.
            points_m: (N, 3) the frame's points.
            on_body_m: (M, 3) markers on the body in the filter's corrected pose.
        """
        self._before = (labels, len(points_m))
        if not self.learns:
            return
        seen, variance, fixed = labels != HIDDEN, self._variance, self.settings.offset_sd_m**2
        faded = self._keep * self._offset_m
        if len(points_m):
            gain = np.where(variance > 2.0 * fixed, 0.5, self._learn)[:, None]
            learnt = self._offset_m + gain * (points_m[labels] - on_body_m - self._offset_m)
            self._offset_m = np.where(seen[:, None], learnt, faded)
        else:
            self._offset_m = faded
        # A marker never seen is more uncertain than a forgotten one, and stays so.
        forgetting = np.maximum(variance, self._keep**2 * variance + self._forgetting)
        self._variance = np.where(seen, np.maximum(fixed, 0.3 * variance), forgetting)

    def _doubt(self, labels: Indices, prediction: MarkerPrediction, points_m: Array) -> Indices:
        """The labels, or those without memory where these were much more likely several times in a row."""

        def covariance(chosen: BoolArray) -> Array:
            return _with_own(prediction.spread(chosen), self._forgotten[chosen])

        other = assign(prediction.positions_m, points_m, covariance, self._patient)
        changed = (other != labels) & (other != HIDDEN)
        if not changed.any():
            self._doubted[:] = 0
            return labels
        affected = (other != labels) & (changed | np.isin(labels, other[changed]))
        offsets = points_m - prediction.positions_m[affected][:, None]
        costs = np.minimum(pair_costs(offsets, covariance(affected), self._patient), 0.0)
        gain = _total(costs, labels[affected]) - _total(costs, other[affected])
        if gain < self.settings.doubt_margin:
            self._doubted[:] = 0
            return labels
        self._doubted = np.where(affected, self._doubted + 1, 0)
        overruled = affected & (self._doubted >= self.settings.doubts)
        if not overruled.any():
            return labels
        self.repaired += int((overruled & (labels != HIDDEN) & (other != HIDDEN)).sum())
        self._doubted[overruled] = 0
        self._offset_m[overruled] = 0.0
        self._variance = np.where(overruled, self._forgotten, self._variance)
        return np.where(affected, other, labels)


def _with_own(spread: Array, variance: Array) -> Array:
    spread[:, np.arange(3), np.arange(3)] += variance[:, None]
    return spread


def _total(costs: Array, labels: Indices) -> float:
    """Cost of the labels (m,) of the rows; a hidden marker costs nothing."""
    seen = np.flatnonzero(labels != HIDDEN)
    return float(costs[seen, labels[seen]].sum())
