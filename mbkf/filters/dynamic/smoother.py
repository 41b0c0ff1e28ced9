"""Smoother of the dynamic filter: later frames correct earlier ones, iterated until Newton's law holds.

Each round is an exact linear smoother around the trajectory of the round before: the iterated Kalman smoother, a
Gauss–Newton method (B. M. Bell, SIAM Journal on Optimization 4 (1994) 626–636). Long trials are smoothed in windows
that look a little beyond their ends (:mod:`mbkf.filters.fixed_lag`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.dynamic.filter import DynamicFilter
from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.filter import Decisions, Readings, Step
from mbkf.kernel.covariance import informed_with_rows
from mbkf.kernel.smoothing import SparseBackwardPass
from mbkf.numerics.transition import Transition

FURTHEST_RAD = 0.5
"""A round corrects no joint by more than this."""


@dataclass(frozen=True)
class _Forward:
    """One frame of a forward pass: posterior covariance, correction of the mean, readings, Φ to the next frame."""

    P: Array
    delta: Array
    readings: Readings | None
    vector: Array
    transition: Transition | None


def smooth(
    kalman: DynamicFilter,
    run: Sequence[Step[DynamicState]],
    rounds: int,
    wanted: int | None = None,
    memory: list[Array] | None = None,
) -> Iterator[DynamicState]:
    """Smoothed states of a window, in order.

    Args:
        kalman: The filter that ran through it.
        run: Its steps; the first one's state is taken as it is.
        rounds: Number of linearisations.
        wanted: Only the first ``wanted`` frames are returned; the others are looked at.
        memory: Arrays (N, N) to work in, which may serve one window after another: fresh memory costs as much as the
            products that go there. It grows as it has to; what is returned does not lie in it.
    """
    begin, decided = run[0].state, [step.decisions for step in run]
    means = [step.state for step in run]
    memory = [] if memory is None else memory
    memory += [np.empty(begin.P.shape) for _ in range(len(memory), len(run))]
    for _ in range(rounds - 1):
        forward = _forward(kalman, begin, means, decided, memory)
        steps = [step for step, _ in _backward(forward)]
        share = _damping(steps, kalman.layout.nv)
        means = [
            kalman.plant.retract(x, share * step, x.P) for x, step in zip(means, reversed(steps), strict=True)
        ]
    forward = _forward(kalman, begin, means, decided, memory)
    steps_and_covariances = list(_backward(forward, len(run) if wanted is None else wanted))[::-1]
    for mean, (step, P) in list(zip(means, steps_and_covariances, strict=True))[:wanted]:
        if P is not None:
            yield kalman.plant.retract(mean, step, P)


def _damping(steps: Sequence[Array], nv: int) -> float:
    """Share of a round's steps to take, so that no joint turns further than a linearisation reaches."""
    furthest = max(float(np.abs(step[:nv]).max()) for step in steps)
    return min(1.0, FURTHEST_RAD / furthest) if furthest > 0.0 else 1.0


def _forward(
    kalman: DynamicFilter,
    begin: DynamicState,
    means: Sequence[DynamicState],
    decided: Sequence[Decisions],
    memory: Sequence[Array],
) -> list[_Forward]:
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
    passed = [_Forward(P, delta, None, np.zeros_like(delta), None)]
    for last, mean, decisions, room in zip(
        means[:-1], means[1:], decided[1:], memory[: len(means) - 1], strict=True
    ):
        before = replace(last, P=P)
        prior = plant.predict(before, decisions.noise)
        transition = plant.step_transition(before, prior)
        kalman.inflate(prior.P, decisions.blocks)
        delta = transition.forward(delta) + plant.difference(mean, prior)
        readings = kalman.linearise(mean, decisions)
        P = informed_with_rows(prior.P, readings.matrix, readings.rows, room)
        vector = readings.whole_vector - readings.apply(delta)
        delta = delta + P @ vector
        passed[-1] = replace(passed[-1], transition=transition)
        passed.append(_Forward(P, delta, readings, vector, None))
    return passed


def _backward(forward: Sequence[_Forward], covariances: int = 0) -> Iterator[tuple[Array, Array | None]]:
    """From the last frame to the first: correction of the mean, and the smoothed covariance where it is wanted.

    Args:
        forward: The forward pass.
        covariances: Of how many frames, from the first on, it is.
    """
    back = SparseBackwardPass(len(forward[0].delta), covariances > 0)
    for k in range(len(forward) - 1, -1, -1):
        here = forward[k]
        yield here.delta + back.step(here.P), back.covariance(here.P) if k < covariances else None
        transition = forward[k - 1].transition if k else None
        if here.readings is not None and transition is not None:
            back.through_parts(here.P, here.readings.matrix, here.readings.rows, here.vector)
            back.through_motion(transition)
