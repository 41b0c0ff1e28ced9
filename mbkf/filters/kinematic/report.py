"""Report of the kinematic filter: accelerations are differences of velocities (thesis eq. 3.7).

Departs from thesis eq. 3.7 where later frames are known: smoothed accelerations are central differences.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.body_errors import BodyErrorRoots
from mbkf.filters.estimate import NO_WRENCH, Posterior, Record
from mbkf.filters.filter import Step
from mbkf.filters.kinematic.filter import KinematicFilter, VelocityStep
from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.report import FirstMotion, StateReport
from mbkf.filters.spread import Spread
from mbkf.kernel.smoothing import SparseBackwardPass
from mbkf.sensors.block import Frame


class Differences(NamedTuple):
    """Further record of a frame, for accelerations.

    Attributes:
        before: The filter's state of the frame before, None at a start.
        settling: (n, nv) accelerations of the first frames after a start, by the warm start.
        since: Frames since the start.
    """

    before: KinematicState | None
    settling: Array
    since: int

    @property
    def settled(self) -> bool:
        """True where the acceleration is a difference of the filter's velocities."""
        return self.since >= len(self.settling)


class KinematicReport(StateReport[KinematicState]):
    """Reads a :class:`KinematicFilter`."""

    kalman: KinematicFilter

    def __init__(self, kalman: KinematicFilter, smoothed_covariances: bool = True) -> None:
        """Makes the report.

        Args:
            kalman: The filter.
            smoothed_covariances: Smoothed estimates get covariances of their own, which cost far more than means;
                without, they keep the filter's, which are never smaller.
        """
        super().__init__(kalman)
        self._covariances = smoothed_covariances

    def first(self, motion: FirstMotion, frame: Frame) -> Posterior:
        """The motion itself; its readings are used already."""
        (state, settling), kept = motion, self.kalman.begin()
        record = Record(state, None, kept, Differences(None, settling, 0))
        refused = np.zeros(len(frame.markers_m), dtype=bool)
        return Posterior(state.q, state.v, settling[0], NO_WRENCH, None, refused, True, True, record)

    def posterior(self, step: Step[KinematicState], before: Posterior, frame: Frame) -> Posterior:
        """The estimate that a step led to."""
        was, state, (_, settling, since) = before.record.state, step.state, _differences(before)
        now = Differences(was, settling, since + 1)
        a = (state.v - was.v) / self.kalman.plant.dt_s if now.settled else settling[now.since]
        record, seen = Record(state, step, None, now), (step.refused, step.tracked, False)
        return Posterior(state.q, state.v, a, NO_WRENCH, None, *seen, record, lost=step.lost)

    def moved(self, estimate: Posterior, state: KinematicState, before: KinematicState | None) -> Posterior:
        """An estimate with a corrected state; torques keep the filter's standard deviations, which are larger."""
        a = estimate.a
        if before is not None and _differences(estimate).settled:
            a = (state.v - before.v) / self.kalman.plant.dt_s
        return estimate._replace(q=state.q, v=state.v, a=a, record=estimate.record._replace(state=state))

    def smooth(self, run: Sequence[Posterior], wanted: int) -> list[Posterior]:
        """By one linear pass about the filter's own course; accelerations are central differences.

        Args:
            run: Estimates of consecutive frames without a restart among them.
            wanted: Number of estimates to return.
        """
        back = SparseBackwardPass(self.kalman.layout.size, self._covariances)
        states = self.smoothed_states(run, wanted + 1, back)  # one more, for the last difference
        v = np.array([state.v for state in states])
        a = np.gradient(v, self.kalman.plant.dt_s, axis=0) if len(v) > 1 else np.zeros_like(v)
        pairs = list(zip(run, states, a, strict=False))[:wanted]
        return [self.moved(estimate, state, None)._replace(a=acc) for estimate, state, acc in pairs]

    def spread(
        self,
        estimate: Posterior,
        torques: bool = True,
        levels: bool = False,
        body: BodyErrorRoots | None = None,
    ) -> Spread:
        """Standard deviations; torques as far as accelerations cause them, NaN at a start."""
        state, step, before = estimate.record.state, estimate.record.step, _differences(estimate).before
        layout, torque = self.kalman.layout, np.full(self.model.nv, np.nan)
        if torques and step is not None and before is not None:
            change = VelocityStep(before, step, self.kalman.plant).covariance
            torque = self.reader.torque_variance(state.q, change, self.kalman.plant.dt_s)
        variance, q, v = np.diagonal(state.P), layout.q, layout.v
        parts = partial(self.reader.parts, state.q, state.P[q, q])
        return Spread(self.reader, state.q, variance[q], variance[v], torque, parts, body)


def _differences(estimate: Posterior) -> Differences:
    return estimate.record.detail  # type: ignore[return-value]
