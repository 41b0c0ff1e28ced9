"""Report of a filter: its states read as motion, loads and standard deviations, and the smoother that suits it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, Generic, NamedTuple, cast

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.body_errors import BodyErrorRoots
from mbkf.filters.estimate import NO_WRENCH, Posterior, Prediction
from mbkf.filters.filter import Filter, Step
from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.plant import StateT
from mbkf.filters.spread import Spread, SpreadReader
from mbkf.numerics.smoothing import BackwardPass
from mbkf.sensors.block import Frame
from mbkf.sensors.marker_sensor import MarkerPrediction, MarkerReading
from mbkf.sensors.markers import Markers


class FirstMotion(NamedTuple):
    """Motion that a filter starts from.

    Attributes:
        state: Configuration and velocity with their covariance.
        accelerations: (n, nv) accelerations of the first n frames, while the filter settles.
    """

    state: KinematicState
    accelerations: Array


class StateReport(ABC, Generic[StateT]):
    """Reads the estimates of a filter.

    Attributes:
        kalman: The filter.
        model: The body.
        reader: Reads standard deviations off covariances.
    """

    def __init__(self, kalman: Filter[StateT]) -> None:
        self.kalman, self.model = kalman, kalman.plant.model
        self.reader = SpreadReader(self.model)

    @abstractmethod
    def first(self, motion: FirstMotion, frame: Frame) -> Posterior:
        """The estimate of a frame from a known motion, and from those readings of the frame that say more."""

    @abstractmethod
    def posterior(self, step: Step[StateT], before: Posterior, frame: Frame) -> Posterior:
        """The estimate that a step led to.

        Args:
            step: The step.
            before: Estimate of the frame before.
            frame: The readings.

        Raises:
            numpy.linalg.LinAlgError: The numbers cannot be read, and :meth:`unsolved` knows what to do.
        """

    def unsolved(self, error: Exception, before: Posterior, frame: Frame) -> Posterior:
        """The estimate of a frame whose step cannot be computed; most filters raise the error.

        Args:
            error: The numerical error.
            before: Estimate of the frame before.
            frame: The readings.
        """
        raise error

    @abstractmethod
    def moved(self, estimate: Posterior, state: StateT, before: StateT | None) -> Posterior:
        """An estimate whose state later frames have corrected.

        Args:
            estimate: The filter's own.
            state: The corrected state.
            before: Corrected state of the frame before, for differences over time; None at a start.
        """

    @abstractmethod
    def spread(
        self,
        estimate: Posterior,
        torques: bool = True,
        levels: bool = False,
        body: BodyErrorRoots | None = None,
    ) -> Spread:
        """Standard deviations at an estimate.

        Args:
            estimate: The estimate.
            torques: False where those of the generalised forces may be NaN.
            levels: Those of the trunk's moments are wanted, too.
            body: Roots of the errors by the person's body; None where they are not known.
        """

    def covariance(self, estimate: Posterior) -> Array:
        """(2 nv, 2 nv) covariance of (q, v)."""
        motion, P = self.kalman.layout.motion, estimate.record.state.P
        return np.asarray(P[motion, motion])

    def wrench_sd(self, estimate: Posterior) -> Array:
        """(2, 6) standard deviations of the feet's wrenches, NaN where the filter estimates none."""
        return NO_WRENCH

    def support_sd(self, estimate: Posterior) -> Array:
        """(B, 6) standard deviations of the wrenches on parts besides the feet, NaN where the filter has none."""
        return np.full((len(self.model.description.bearings), 6), np.nan)

    def predict(self, before: Posterior) -> Prediction:
        """The frame after an estimate by the filter's own plant: what a labeller needs before the correction."""
        prior, q = self.kalman.predict(before.record.state, before.record.memory), self.kalman.layout.q
        reading = cast("MarkerReading", self.kalman.prepared_by(Markers, prior))
        markers = MarkerPrediction(reading, prior.state.P[q, q])
        return Prediction(prior.state.q, markers, prior)

    def smooth(self, run: Sequence[Posterior], wanted: int) -> list[Posterior]:
        """The first ``wanted`` estimates of a run in the light of all of them, linearised about the filter's course.

        Args:
            run: Estimates of consecutive frames without a restart among them.
            wanted: Number of estimates to return.
        """
        states = self.smoothed_states(run, wanted, BackwardPass(self.kalman.layout.size))
        befores = [None, *states]
        return [self.moved(*one) for one in zip(run, states, befores, strict=False)]

    def kept(self, estimate: Posterior) -> Posterior:
        """An estimate that waits for later frames, without what neither smoothing nor going on from it reads.

        Args:
            estimate: The filter's own.
        """
        return estimate

    def smoothed_states(self, run: Sequence[Posterior], wanted: int, back: BackwardPass) -> list[StateT]:
        """The first ``wanted`` states of a run by one linear pass from its end.

        Args:
            run: Estimates of consecutive frames.
            wanted: Number of states to return.
            back: A pass that has seen nothing yet.
        """
        plant, states = self.kalman.plant, []
        for k in range(len(run) - 1, -1, -1):
            record = run[k].record
            if k < wanted:
                states.append(plant.retract(record.state, *back.corrected(record.state.P)))
            if k and record.step is not None:
                known, predicted = record.step.readings, record.step.prior.state
                transition = plant.step_transition(run[k - 1].record.state, predicted)
                parts = known.matrix, known.rows, known.whole_vector
                back.through_frame(record.state.P, *parts, transition)
        return states[::-1]


AnyReport = StateReport[Any]
"""A report of any filter."""
