"""Smoother of the dynamic filter: later frames correct earlier ones, iterated until Newton's law holds.

The first round takes the filter's own linearisation. Each further one is an exact linear smoother around the trajectory
of the round before: the iterated Kalman smoother, a Gauss–Newton method (B. M. Bell, SIAM Journal on Optimization
4 (1994) 626–636). Long trials are smoothed in windows that look a little beyond their ends
(:mod:`mbkf.filters.fixed_lag`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.dynamic.filter import DynamicFilter
from mbkf.filters.dynamic.information_pass import InformationPass, NoiseMemory, information_pass
from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.filter import Decisions, Readings, Step
from mbkf.kernel.covariance import informed_with_rows
from mbkf.kernel.smoothing import LinearReadings, SparseBackwardPass, linear_step
from mbkf.numerics.transition import Transition

FURTHEST_RAD = 0.5
"""A round corrects no joint by more than this."""


class _Frame(NamedTuple):
    """One frame of a forward pass.

    Attributes:
        P: (N, N) posterior covariance.
        delta: (N,) correction of the mean.
        readings: The readings; None in the first frame, whose state is taken as it is.
        vector: (N,) HᵀR⁻¹y with the innovation y of the prior.
        transition: Φ from the frame before; None in the first frame.
    """

    P: Array
    delta: Array
    readings: Readings | None
    vector: Array
    transition: Transition | None


class _CovariancePass(NamedTuple):
    """A forward pass that keeps covariances.

    Attributes:
        frames: Its frames.
        asked: One of them.
    """

    frames: Sequence[_Frame]
    asked: int

    @property
    def kept(self) -> tuple[Array, Array]:
        """(N,) correction and (N, N) covariance of the frame ``asked`` by readings up to it."""
        return self.frames[self.asked].delta, self.frames[self.asked].P

    def backward(self, covariances: int) -> Iterator[tuple[Array, Array | None]]:
        """From the last frame to the first: correction of the mean, and the smoothed covariance where it is wanted.

        Args:
            covariances: Of how many frames, from the first on, it is.
        """
        return _backward(self.frames, covariances)


class WindowMemory:
    """Memory that windows of one run share.

    Attributes:
        covariances: Arrays (N, N) to work in: fresh memory costs as much as the products that go there.
        noises: Memory of passes that keep information.
    """

    def __init__(self) -> None:
        self.covariances: list[Array] = []
        self.noises = NoiseMemory()
        self._kept: tuple[DynamicState, DynamicState] | None = None

    def grow(self, frames: int, shape: tuple[int, ...]) -> Sequence[Array]:
        """Covariances for as many frames at least."""
        self.covariances += [np.empty(shape) for _ in range(len(self.covariances), frames)]
        return self.covariances

    def keep(self, filtered: DynamicState, linearised: DynamicState) -> None:
        """Keeps the last round's forward estimate of a frame, from which the next window's forward pass goes on.

        Args:
            filtered: The filter's own estimate of the frame.
            linearised: The last round's.
        """
        self._kept = filtered, linearised

    def forget(self) -> None:
        """Lets the next window begin with the filter's own estimate."""
        self._kept = None

    def start(self, filtered: DynamicState) -> DynamicState:
        """The estimate of a window's first frame from which its forward pass goes on."""
        if self._kept is not None and self._kept[0] is filtered:
            return self._kept[1]
        return filtered


def smooth(
    kalman: DynamicFilter,
    run: Sequence[Step[DynamicState]],
    rounds: int,
    wanted: int | None = None,
    memory: WindowMemory | None = None,
) -> Iterator[DynamicState]:
    """Smoothed states of a window, in order.

    Args:
        kalman: The filter that ran through it.
        run: Its steps; the first one's state is taken as it is.
        rounds: Number of linearisations, the filter's own among them.
        wanted: Only the first ``wanted`` frames are returned; the others are looked at.
        memory: Memory of the windows before; what is returned does not lie in it.
    """
    memory = WindowMemory() if memory is None else memory
    begin, decided = memory.start(run[0].state), [step.decisions for step in run]
    means = [step.state for step in run]
    wanted = len(run) if wanted is None else wanted
    found: _CovariancePass | InformationPass = _CovariancePass(_filtered(kalman, run), wanted - 1)
    for _ in range(rounds - 1):
        steps = [step for step, _ in found.backward(0)]
        share = _damping(steps, kalman.layout.nv)
        means = [
            kalman.plant.retract(x, share * step, x.P) for x, step in zip(means, reversed(steps), strict=True)
        ]
        by_information = information_pass(kalman, begin, means, decided, wanted - 1, memory.noises)
        found = by_information or _CovariancePass(
            _forward(kalman, begin, means, decided, memory.grow(len(run), begin.P.shape)), wanted - 1
        )
    if rounds > 1:
        delta, P = found.kept
        memory.keep(run[wanted - 1].state, kalman.plant.retract(means[wanted - 1], delta, P.copy()))
    steps_and_covariances = list(found.backward(wanted))[::-1]
    for mean, (step, P_smoothed) in list(zip(means, steps_and_covariances, strict=True))[:wanted]:
        if P_smoothed is not None:
            yield kalman.plant.retract(mean, step, P_smoothed)


def _damping(steps: Sequence[Array], nv: int) -> float:
    """Share of a round's steps to take, so that no joint turns further than a linearisation reaches."""
    furthest = max(float(np.abs(step[:nv]).max()) for step in steps)
    return min(1.0, FURTHEST_RAD / furthest) if furthest > 0.0 else 1.0


def _filtered(kalman: DynamicFilter, run: Sequence[Step[DynamicState]]) -> list[_Frame]:
    """The filter's own pass: its posteriors are the trajectory, so that it corrects nothing."""
    nothing = np.zeros(kalman.layout.size)
    passed = [_Frame(run[0].state.P, nothing, None, nothing, None)]
    for last, step in pairwise(run):
        readings, transition = step.readings, kalman.plant.step_transition(last.state, step.prior.state)
        passed.append(_Frame(step.state.P, nothing, readings, readings.whole_vector, transition))
    return passed


def _forward(
    kalman: DynamicFilter,
    begin: DynamicState,
    means: Sequence[DynamicState],
    decided: Sequence[Decisions],
    memory: Sequence[Array],
) -> list[_Frame]:
    """The filter in corrections δ of the trajectory ``means``.

    Args:
        kalman: The filter.
        begin: The first state.
        means: The trajectory.
        decided: Decisions on each frame's readings.
        memory: (N, N) for each frame's covariance.
    """
    plant = kalman.plant
    delta, P = plant.difference(means[0], begin), begin.P
    nothing = np.zeros_like(delta)
    passed = [_Frame(P, delta, None, nothing, None)]
    for last, mean, decisions, room in zip(
        means[:-1], means[1:], decided[1:], memory[: len(means) - 1], strict=True
    ):
        before = DynamicState(last.q, last.v, last.a, last.w, P, last.extra)
        prior = plant.predict(before, decisions.noise)
        transition = plant.step_transition(before, prior)
        kalman.inflate(prior.P, decisions.blocks)
        readings = kalman.linearise(mean, decisions)
        P = informed_with_rows(prior.P, readings.matrix, readings.rows, room)
        known = LinearReadings(
            readings.matrix, readings.vector, readings.rows, readings.values, readings.added
        )
        vector, delta = linear_step(P, delta, plant.difference(mean, prior), known, transition)
        passed.append(_Frame(P, delta, readings, vector, transition))
    return passed


def _backward(forward: Sequence[_Frame], covariances: int = 0) -> Iterator[tuple[Array, Array | None]]:
    """From the last frame to the first: correction of the mean, and the smoothed covariance where it is wanted.

    Args:
        forward: The forward pass.
        covariances: Of how many frames, from the first on, it is.
    """
    back = SparseBackwardPass(len(forward[0].delta), covariances > 0)
    for k in range(len(forward) - 1, -1, -1):
        here = forward[k]
        P = back.covariance(here.P) if k < covariances else None
        if here.readings is None or here.transition is None:
            later = back.step(here.P)
        else:
            known = here.readings.matrix, here.readings.rows, here.vector
            later = back.through_frame(here.P, *known, here.transition)
        yield here.delta + later, P
