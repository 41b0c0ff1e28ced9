"""A linear smoother about a trajectory that keeps information: forward Y = P⁻¹, backward each step's noise and S.

    Y⁻ = M − M G (D⁻¹ + GᵀM G)⁻¹ GᵀM,   M = Φ⁻ᵀ Y Φ⁻¹,   Y = Y⁻ + Λ

A step's noise G n, n ~ N(0, D), is the only link between frames, so a smoothed frame is the next one without the noise
that the next one makes likely (Bierman 1977): sums of positive matrices, while a covariance smoother subtracts nearly
equal ones. One noise per dof and a few for the wrenches are less than half of the state, and readings are added to Y as
they are: 8 million multiplications per frame of 52 dofs instead of 22.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, Int32Array
from mbkf.filters.dynamic.filter import DynamicFilter
from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.filter import Decisions
from mbkf.kernel.loading import Library, library
from mbkf.numerics.positive import regular_inverse
from mbkf.numerics.transition import RateTransition

LEAST_PIVOT = 1e-11
"""Covariances whose correlations have a smaller pivot are not inverted: components are certain, or depend on others.

Rounding, 1e-16 of a component, then stays below 1e-5 of what the others leave of it. Moments about the world's origin
make pivots small far from it: 70 m away they are 1e-9."""


class _Step(NamedTuple):
    """A step of the forward pass, from which the backward pass returns.

    Attributes:
        offset: (N,) from the trajectory to its prediction.
        transition: Φ.
        share: (orders + 1,) by which a dof's noise moves its position and rates.
        active: (K,) components with noise of their own.
        gain, spread, mean: (N, r), (r, r) and (r,) of the step's r noises, given the next frame's error.
    """

    offset: Array
    transition: RateTransition
    share: Array
    active: Int32Array
    gain: Array
    spread: Array
    mean: Array


class InformationPass(NamedTuple):
    """The forward pass through a window.

    Attributes:
        kernel: The compiled kernel.
        steps: Steps between its frames.
        last: (N,) error and (N, N) covariance of the last frame.
        kept: (N,) and (N, N) of the frame that was asked for, by readings up to it.
    """

    kernel: Library
    steps: Sequence[_Step]
    last: tuple[Array, Array]
    kept: tuple[Array, Array]

    def backward(self, covariances: int) -> Iterator[tuple[Array, Array | None]]:
        """From the last frame to the first: correction of the mean, and the smoothed covariance where it is wanted.

        Args:
            covariances: Of how many frames, from the first on, it is.

        Raises:
            numpy.linalg.LinAlgError: A transition has no inverse.
        """
        (d, S), spare = self.last, np.empty((2, *self.last[1].shape))
        yield d, S if len(self.steps) < covariances else None
        for k in range(len(self.steps) - 1, -1, -1):
            one = self.steps[k]
            before = np.empty(S.shape) if k < covariances else spare[k % 2]
            of_noise = one.share, one.active, one.gain, one.spread, one.mean
            failed, d = self.kernel.information_backward(S, d, one.offset, *one.transition, *of_noise, before)
            if failed:
                raise np.linalg.LinAlgError("a step between frames cannot be taken back")
            S = before
            yield d, S if k < covariances else None


class NoiseMemory:
    """Memory of forward passes, one after the other: fresh memory costs as much as the products that go there."""

    def __init__(self) -> None:
        self._noise: dict[int, tuple[Array, Array]] = {}

    def of(self, frame: int, size: int, noises: int) -> tuple[Array, Array]:
        """(N, r) and (r, r) for gain and spread of a frame's noises.

        Args:
            frame: The frame.
            size: Components N of the state.
            noises: Their number r.
        """
        found = self._noise.get(frame)
        if found is None or found[0].shape != (size, noises):
            found = self._noise[frame] = np.empty((size, noises)), np.empty((noises, noises))
        return found


def information_pass(
    kalman: DynamicFilter,
    begin: DynamicState,
    means: Sequence[DynamicState],
    decided: Sequence[Decisions],
    kept: int,
    memory: NoiseMemory,
) -> InformationPass | None:
    """The filter in corrections of the trajectory ``means``.

    Args:
        kalman: The filter.
        begin: The first state.
        means: The trajectory.
        decided: Decisions on each frame's readings.
        kept: Frame whose estimate by readings up to it is asked for.
        memory: Memory to work in.

    Returns:
        None without the compiled kernel, where a plant's noise is not :meth:`~mbkf.filters.plant.Plant.dof_noise`, and
        where rounding would decide an inverse, as of certain components: a covariance smoother takes all of these.
    """
    plant, Y = kalman.plant, regular_inverse(begin.P, LEAST_PIVOT)
    kernel, delta = library(), plant.difference(means[0], begin)
    if kernel is None or Y is None:
        return None
    size, y, steps = len(Y), Y @ delta, []
    asked: tuple[Array, Array] | None = (delta, begin.P)
    spare = np.empty((2, *Y.shape))
    noise, nothing = np.zeros(Y.shape), np.zeros(size)
    for k, (before, mean, decisions) in enumerate(
        zip(means[:-1], means[1:], decided[1:], strict=True), start=1
    ):
        of_dofs, prior = plant.dof_noise(decisions.noise), plant.move(before)
        transition = plant.step_transition(before, prior)
        if of_dofs is None or not isinstance(transition, RateTransition):
            return None
        noise.fill(0.0)
        plant.add_walk(noise)
        kalman.inflate(noise, decisions.blocks)
        active = np.flatnonzero(noise.diagonal()).astype(np.int32)
        offset, room = plant.difference(mean, prior), memory.of(k, size, len(of_dofs.sd) + len(active))
        readings = kalman.linearise(mean, decisions)
        known = readings.matrix, readings.vector, np.ascontiguousarray(readings.rows), readings.values
        added = nothing if readings.added is None else readings.added
        after, of_step = spare[k % 2], (*of_dofs, noise, active)
        failed, y, mean_noise = kernel.information_forward(
            Y, y, offset, *transition, *of_step, *known, added, after, *room
        )
        if failed:
            return None
        Y = after
        steps.append(_Step(offset, transition, of_dofs.share, active, *room, mean_noise))
        if k == kept:
            asked = _estimate(Y, y)
    last = _estimate(Y, y) if steps else asked
    return None if last is None or asked is None else InformationPass(kernel, steps, last, asked)


def _estimate(Y: Array, y: Array) -> tuple[Array, Array] | None:
    """(N,) error and (N, N) covariance; None where Y has no inverse."""
    P = regular_inverse(Y, LEAST_PIVOT)
    return None if P is None else (P @ y, P)
