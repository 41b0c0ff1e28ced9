"""One driver of every filter, frame by frame: start, prediction, step, and correction by later frames."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.body_errors import BodyErrorRoots
from mbkf.filters.estimate import Posterior, Prediction, Recording
from mbkf.filters.innovations import Innovations
from mbkf.filters.limb_mend import LimbMend, with_limb
from mbkf.filters.report import AnyReport, FirstMotion
from mbkf.filters.spread import Spread
from mbkf.numerics.later_frames import LinearStep
from mbkf.numerics.smoothing import BackwardPass
from mbkf.sensors.limb_fit import LimbFits


class Start(Protocol):
    """Finds the motion from which a filter starts.

    Attributes:
        restart_after_s: Time without enough readings after which the filter starts anew.
        placed: Instruments show at once where the body is.
        limbs: Judges and fits limbs by their markers; None for a start without markers.
    """

    restart_after_s: float
    placed: bool

    @property
    def limbs(self) -> LimbFits | None:
        """Limbs by their markers."""

    def __call__(self, recording: Recording, t: int, guess: Array | None) -> FirstMotion | None:
        """The motion at a frame, with a velocity known from the next frames.

        Args:
            recording: The readings.
            t: The frame.
            guess: (nq,) configuration near which the body may be; None where it may be anywhere.

        Returns:
            None where the frame's markers do not fit the body.
        """


class Widening(Protocol):
    """A filter that has the states of another one and more, and goes on from its estimates.

    Attributes:
        report: Reads its states.
    """

    @property
    def report(self) -> AnyReport:
        """Reads the wide filter's states."""

    def widened(self, estimate: Posterior) -> Posterior:
        """An estimate of the narrow filter, from which the wide one goes on."""


class TrackingFilter:
    """A filter as trials, streams and smoothers drive it.

    Attributes:
        report: Reads the filter's states.
        kalman: The filter.
        model: The body; ``clinical``: its clinical coordinates.
        dt_s: Time between frames.
        restart_after_s: Time without enough readings after which the filter starts anew.
        limbs: Judges and fits limbs by their markers; None for a filter without markers.
        smooth: Method of the report.
    """

    def __init__(self, report: AnyReport, start: Start, widening: Widening | None = None) -> None:
        """Makes it.

        Args:
            report: Reads the filter's states.
            start: Finds the motion from which the filter starts.
            widening: Gives estimates room for contacts of other parts than the feet; None where they have it from the
                start, or the filter knows none.
        """
        self.report, self.kalman, self.model = report, report.kalman, report.model
        self.clinical, self.dt_s = report.reader.clinical, report.kalman.plant.dt_s
        self.restart_after_s, self._start, self._placed = start.restart_after_s, start, start.placed
        self.limbs, self.smooth, self._widening = start.limbs, report.smooth, widening
        self._size = report.kalman.layout.size

    def report_of(self, estimate: Posterior) -> AnyReport:
        """The report that reads an estimate: the wide filter's, where the estimate has room for other contacts."""
        if self._widening is None or len(estimate.record.state.P) == self._size:
            return self.report
        return self._widening.report

    def widened(self, estimate: Posterior) -> Posterior:
        """The estimate with room for contacts of other parts than the feet, from which the wide filter goes on."""
        if self._widening is None or len(estimate.record.state.P) != self._size:
            return estimate
        return self._widening.widened(estimate)

    def covariance(self, estimate: Posterior) -> Array:
        """(2 nv, 2 nv) covariance of (q, v)."""
        return self.report_of(estimate).covariance(estimate)

    def spread(
        self,
        estimate: Posterior,
        torques: bool = True,
        levels: bool = False,
        body: BodyErrorRoots | None = None,
    ) -> Spread:
        """Standard deviations at an estimate. Args: as for :meth:`mbkf.filters.report.StateReport.spread`."""
        return self.report_of(estimate).spread(estimate, torques, levels, body)

    def wrench_sd(self, estimate: Posterior) -> Array:
        """(2, 6) standard deviations of the feet's wrenches, NaN where the filter estimates none."""
        return self.report_of(estimate).wrench_sd(estimate)

    def support_sd(self, estimate: Posterior) -> Array:
        """(B, 6) standard deviations of the wrenches on parts besides the feet, NaN where the filter has none."""
        return self.report_of(estimate).support_sd(estimate)

    def predict(self, before: Posterior) -> Prediction:
        """The frame after an estimate by the filter's own plant."""
        return self.report_of(before).predict(before)

    def start(self, recording: Recording, t: int, guess: Array | None) -> Posterior | None:
        """An estimate at a frame that already knows its velocity.

        Args:
            recording: The readings.
            t: The frame.
            guess: (nq,) configuration near which the body may be; None where it may be anywhere.

        Returns:
            None where the frame's markers do not fit the body.
        """
        motion = self._start(recording, t, guess)
        return None if motion is None else self.report.first(motion, recording.frame(t))

    def step(
        self, before: Posterior, recording: Recording, t: int, prediction: Prediction | None = None
    ) -> Posterior:
        """The estimate of frame t from that of the frame before.

        Args:
            before: Estimate of the frame before.
            recording: The readings.
            t: The frame.
            prediction: Result of :meth:`predict` for ``before``, where it is known; good for one step.
        """
        was, frame, report = before.record, recording.frame(t), self.report_of(before)
        prior = None if prediction is None else prediction.prior
        try:
            step = report.kalman.step(was.state, was.memory, frame, prior)
            found = report.posterior(step, before, frame)
        except (np.linalg.LinAlgError, ValueError) as error:
            found = report.unsolved(error, before, frame)
        return found if self._placed else found._replace(placed=False)

    def mended(
        self, before: Posterior | None, recording: Recording, t: int, mend: LimbMend
    ) -> Posterior | None:
        """The estimate of frame t with a limb in a new pose, while the rest goes on; smoothing does not pass it.

        Args:
            before: Estimate of the frame before; None where the filter starts in frame t.
            recording: The readings.
            t: The frame.
            mend: The limb.
        """
        if before is None or "u" in self.kalman.layout:  # torques as states belong to the old pose
            return self.start(recording, t, mend.q)
        was, frame, report = before.record, recording.frame(t), self.report_of(before)
        kalman = report.kalman
        prior = kalman.predict(was.state, was.memory)
        state = with_limb(self.model, prior.state, kalman.layout, mend)
        step = kalman.correct(kalman.prepared(state, prior.noise, was.memory), was.memory, frame)
        found = report.posterior(step, before, frame)
        a = found.a.copy()
        a[mend.dofs] = 0.0
        return found._replace(a=a, started=True, tracked=True, lost=False)

    def kept(self, estimate: Posterior) -> Posterior:
        """An estimate that waits for later frames, without what neither smoothing nor going on from it reads."""
        return self.report_of(estimate).kept(estimate)

    def innovations(self, estimate: Posterior) -> Innovations | None:
        """Innovations of an estimate's frame against their expected spread; None at a start."""
        step = estimate.record.step
        return None if estimate.started or step is None else step.innovations

    def linear_step(self, before: Posterior, estimate: Posterior) -> LinearStep:
        """The step into a frame, linearised as the filter did; identity where no step could be computed.

        Args:
            before: Estimate of the frame before.
            estimate: The frame's own, not a start.
        """
        state, step = estimate.record.state, estimate.record.step
        N = len(state.P)
        if step is None:
            return LinearStep(state.P, np.zeros((N, N)), np.zeros(N), np.eye(N))
        plant = self.report_of(estimate).kalman.plant
        transition = plant.step_transition(before.record.state, step.prior.state)
        known = step.readings
        return LinearStep(state.P, known.whole_matrix, known.whole_vector, transition.matrix(N))

    def corrected(
        self, estimate: Posterior, later: BackwardPass | None, before: Posterior | None
    ) -> Posterior:
        """An estimate in the light of later frames, by one linear pass.

        Args:
            estimate: The filter's own.
            later: Information of the later frames; None where there are none.
            before: Corrected estimate of the frame before, None at a start; for differences over time.
        """
        state, report = estimate.record.state, self.report_of(estimate)
        if later is not None:
            state = report.kalman.plant.retract(state, *later.corrected(state.P))
        return report.moved(estimate, state, None if before is None else before.record.state)
