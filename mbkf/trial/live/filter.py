"""The filter on a live stream: frames in as they come, estimates out, with the same steps as on a whole trial.

A start looks a quarter of a second ahead, so the frames it needs are awaited and then caught up with; from then on each
frame is answered at once, or with a fixed lag when the frames of the lag have followed it. Where no frame was lost the
results are the causal ones of ``reconstruct`` on the same frames; only standard deviations stay those without a lag.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, MbkfError
from mbkf.filters.contact_opening import ContactWatch
from mbkf.filters.estimate import Posterior, Prediction, Recording
from mbkf.filters.kinematic.warm_start import warm_up_frames
from mbkf.filters.lag import FixedLag
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.filters.tracking_loop import TrackingLoop
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.records import MarkerTrajectories, PlateReadings
from mbkf.io.subject import Subject, match_names
from mbkf.sensors.block import Frame
from mbkf.trial.preparation.filters import FilterInputs
from mbkf.trial.preparation.inputs import FilterSettings, trial_inputs
from mbkf.trial.preparation.selection import subject_markers
from mbkf.trial.preparation.settings import ReconstructSettings

NUMERICAL = (np.linalg.LinAlgError, ArithmeticError, ValueError, MbkfError)
"""Errors of arithmetic on unusable readings; the filter then starts anew."""


def live_settings(settings: ReconstructSettings) -> ReconstructSettings:
    """The settings as a live filter takes them: causal, or with their lag.

    Raises:
        InvalidInput: Smoothing is asked for.
    """
    if settings.smooth:
        raise InvalidInput(
            "smooth=True needs frames that a live filter has not seen yet; leave it out, or give a lag (lag_s)"
        )
    return replace(settings, smooth=False)


class LiveStep(NamedTuple):
    """The answer to one frame.

    Attributes:
        number: The frame.
        estimate: Of that frame, None as long as no start has succeeded.
        awaited: Whether a start, which needs later frames, kept the frame waiting.
        seconds: Computing time.
        trouble: The numerical error, None without one.
    """

    number: int
    estimate: Posterior | None
    awaited: bool
    seconds: float
    trouble: str | None = None


class LiveFilter:
    """Takes frames in order, one by one, and gives back the steps that are due.

    Attributes:
        loop: The filter's way through the stream; it knows nothing of the lag.
    """

    def __init__(
        self, filter: TrackingFilter, lag_s: float = 0.0, contacts: ContactWatch | None = None
    ) -> None:
        """Prepares the filter.

        Args:
            filter: The filter.
            lag_s: How long answers wait for readings that correct them; covariances stay those without a lag.
            contacts: Opens contacts of other parts than the feet; None: only feet bear.
        """
        self.loop = TrackingLoop(filter, contacts)
        self._filter, self._lag = filter, FixedLag(filter, lag_s, covariances=False)
        self._lagging: deque[LiveStep] = deque()
        self._ahead = warm_up_frames(filter.dt_s)
        self._waiting: deque[tuple[int, Frame]] = deque()
        self._predicting_s = 0.0
        self._pushed: int | None = None
        self._skipped = 0  # frames of the stream that the loop was never given
        self._ended: list[LimbDoubt] = []

    def limb_doubts(self) -> tuple[LimbDoubt, ...]:
        """Limbs that were in doubt, and those that have been for long; times in s since the first frame pushed."""
        watch = self.loop.watch
        if watch is None:
            return ()
        found = watch.so_far(self.loop.frames)
        ended = len(watch.doubts)
        self._ended += [self._in_stream(one) for one in found[len(self._ended) : ended]]
        return (*self._ended, *(self._in_stream(one) for one in found[ended:]))

    @property
    def limb_doubts_ended(self) -> int:
        """Number of the first doubts that will not change any more."""
        return 0 if self.loop.watch is None else len(self.loop.watch.doubts)

    def _in_stream(self, one: LimbDoubt) -> LimbDoubt:
        """A doubt by the time of the stream, which has gaps that the loop did not see."""
        gap_s = self._skipped * self._filter.dt_s
        right = None if one.right_from_s is None else one.right_from_s + gap_s
        return replace(one, from_s=one.from_s + gap_s, to_s=one.to_s + gap_s, right_from_s=right)

    @property
    def lag_frames(self) -> int:
        """Delay of an answer in frames."""
        return self._lag.frames

    @property
    def latest(self) -> Posterior | None:
        """The estimate of the frame pushed last; None while there is none, or the next frame has to start anew."""
        if self._waiting or self.loop.must_start:
            return None
        return self.loop.estimate

    def predict(self) -> Prediction | None:
        """Prediction of the frame pushed next; None while that cannot be answered at once.

        Asked before that frame is there, it takes prediction and linearisation off the time the frame waits.
        """
        if self._waiting:
            return None
        begin = time.perf_counter()
        try:
            with np.errstate(all="ignore"):
                found = self.loop.predict()
        except NUMERICAL:  # the step raises it again
            return None
        self._predicting_s += time.perf_counter() - begin
        return found

    def push(self, number: int, frame: Frame) -> list[LiveStep]:
        """The next frame.

        Args:
            number: Its number.
            frame: Its readings.

        Returns:
            Answers to this frame and to those that waited for it.
        """
        if self._pushed is not None:
            self._skipped += max(number - self._pushed - 1, 0)
        self._pushed = number
        self._waiting.append((number, frame))
        return self._lagged(self._due(self._ahead))

    def finish(self) -> list[LiveStep]:
        """Answers to the frames that still wait, when no more follow."""
        steps = self._lagged(self._due(0)) + self._corrected(None)
        if self.loop.watch is not None:
            self.loop.watch.finish(self.loop.frames)
            self.limb_doubts()  # by the gaps before them
        return steps

    def cut(self) -> list[LiveStep]:
        """The same, before a gap that cannot be bridged: what follows starts anew."""
        steps = self.finish()
        self.loop.forget()
        return steps

    def _lagged(self, steps: Sequence[LiveStep]) -> list[LiveStep]:
        """The steps that are due when these are made; a frame without an estimate tells nothing of those before."""
        if not self._lag.frames:
            return list(steps)
        due: list[LiveStep] = []
        for step in steps:
            if step.estimate is None:
                due += [*self._corrected(None), step]
            else:
                due += self._corrected(step)
        return due

    def _corrected(self, step: LiveStep | None) -> list[LiveStep]:
        """Steps whose lag is over with this one; all that wait, for None."""
        begin = time.perf_counter()
        try:
            with np.errstate(all="ignore"):
                if step is None or step.estimate is None:
                    found = self._lag.finish()
                else:
                    self._lagging.append(step)
                    found = self._lag.push(step.number, step.estimate)
        except NUMERICAL as error:
            return self._uncorrected(str(error))
        seconds = (time.perf_counter() - begin) / max(len(found), 1)
        given = [(self._lagging.popleft(), estimate) for _, estimate in found]
        return [one._replace(estimate=estimate, seconds=one.seconds + seconds) for one, estimate in given]

    def _uncorrected(self, trouble: str) -> list[LiveStep]:
        """All that waits as the filter found it, where a correction cannot be computed; what follows starts anew."""
        *others, last = self._lagging
        self._lagging.clear()
        self._lag = FixedLag(self._filter, self._lag.frames * self._filter.dt_s, covariances=False)
        self.loop.forget()
        return [*others, last._replace(trouble=trouble)]

    def _due(self, ahead: int) -> list[LiveStep]:
        awaited, steps = len(self._waiting) > 1, []
        while self._waiting:
            if self.loop.must_start and len(self._waiting) <= ahead:
                break
            step = self._step(awaited or self.loop.must_start)
            if step is not None:
                steps.append(step)
        return steps

    def _step(self, awaited: bool) -> LiveStep | None:
        """Answer to the first frame that waits; None where it goes on waiting, to start anew with those after it."""
        begin, self._predicting_s = time.perf_counter() - self._predicting_s, 0.0
        number = self._waiting[0][0]
        waiting = list(self._waiting) if self.loop.must_start else [self._waiting[0]]
        recording = Recording.of([frame for _, frame in waiting], self._filter.dt_s)
        try:
            with np.errstate(all="ignore"):  # what comes of it is looked at
                estimate = self.loop.advance(recording, 0)
            if self.loop.again:
                self._predicting_s = time.perf_counter() - begin
                return None
            if self.loop.implausible:
                raise ArithmeticError("the estimate is implausible: check units and marker names")
        except NUMERICAL as error:
            self._waiting.popleft()
            self.loop.forget()
            return LiveStep(number, None, awaited, time.perf_counter() - begin, str(error))
        self._waiting.popleft()
        return LiveStep(number, estimate, awaited, time.perf_counter() - begin)


@dataclass(frozen=True)
class LiveInputs:
    """Inputs of a stream's filter.

    Attributes:
        names: (M,) the subject's markers that are tracked.
        columns: (M,) where they stand among the stream's markers.
        inputs: Body, markers, plates and settings.
    """

    names: tuple[str, ...]
    columns: Array
    inputs: FilterInputs


def live_inputs(
    stream_names: tuple[str, ...],
    rate_hz: float,
    plates: tuple[PlateReadings, ...],
    subject: Subject,
    settings: FilterSettings,
) -> LiveInputs:
    """Body, markers and plates of a stream.

    Every marker of the subject that the stream names counts for what can be observed: it may appear at any time.

    Args:
        stream_names: Markers of the stream, or those that are looked for among its points.
        rate_hz: Its frame rate.
        plates: Its plates; their readings are not looked at.
        subject: The person.
        settings: Settings of the filters.

    Raises:
        NotObservable: Too few of the subject's markers are among the stream's.
    """
    subject = subject.in_neutral_posture()
    everywhere = MarkerTrajectories(stream_names, np.zeros((1, len(stream_names), 3)), rate_hz)
    shown = subject_markers(everywhere, subject)
    columns = np.array([stream_names.index(name) for name in match_names(stream_names, subject.markers)])
    inputs, _ = trial_inputs(shown, plates, subject, settings)
    return LiveInputs(shown.names, columns, inputs)
