"""The path of a foot from its filter's run, as filtered or smoothed by later rests, and its certainty.

The smoother gives the estimate of Rauch, Tung and Striebel in the form of Bryson and Frazier, which inverts nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.imu.foot_filter import READ, SIZE, FootRun, FootState, FootStep, P
from mbkf.imu.frames import matrix_quaternion
from mbkf.numerics.runs import runs
from mbkf.numerics.smoothing import BackwardPass


@dataclass(frozen=True)
class FootTrack:
    """Where a foot's sensor was; NaN before the first rest.

    Attributes:
        position_m, velocity_m_s: (T, 3) world, z up; origin and heading are those of the first rest.
        orientation: (T, 4) sensor → world as quaternions (x, y, z, w).
        gyro_bias_rad_s: (T, 3) sensor axes.
        still: (T,) samples in which the foot stands.
        displacement_covariances_m2: (n − 1, 3, 3) of the way from the middle of each of the n rests to the next one's.
    """

    position_m: Array
    velocity_m_s: Array
    orientation: Array
    gyro_bias_rad_s: Array
    still: BoolArray
    displacement_covariances_m2: Array


def rest_middles(still: BoolArray) -> list[int]:
    """Sample in the middle of each run of true values in a mask (T,)."""
    return [(start + stop - 1) // 2 for start, stop in runs(still)]


def filtered_track(run: FootRun) -> FootTrack:
    """The path as the filter had it at each sample, from earlier readings only."""
    none = np.zeros((SIZE, SIZE))
    return _track(run, [step.state for step in run.steps], [none] * len(rest_middles(run.still)))


def smoothed_track(run: FootRun) -> FootTrack:
    """The path by all readings, earlier and later ones."""
    middles = [k - run.first for k in rest_middles(run.still)]
    back = BackwardPass(SIZE)
    curvatures: dict[int, Array] = dict.fromkeys(middles, np.zeros((SIZE, SIZE)))
    states: list[FootState] = []
    for k in range(len(run.steps) - 1, -1, -1):
        step = run.steps[k]
        states.append(step.state.moved(back.step(step.P)))
        if k in curvatures and back.curvature is not None:
            curvatures[k] = back.curvature
        if step.reading is not None:
            matrix, vector = np.zeros((SIZE, SIZE)), np.zeros(SIZE)
            matrix[:READ, :READ], vector[:READ] = step.reading.matrix, step.reading.vector
            back.through_readings(step.P, matrix, vector)
        back.through_plant(step.Phi)
    states.reverse()
    return _track(run, states, [curvatures[k] for k in middles])


def _track(run: FootRun, states: Sequence[FootState], curvatures: Sequence[Array]) -> FootTrack:
    T = len(run.still)

    def column(values: Array) -> Array:
        full = np.full((T, values.shape[1]), np.nan)
        full[run.first :] = values
        return full

    middles = [k - run.first for k in rest_middles(run.still)]
    spans = [
        _displacement_covariance(run.steps[i : j + 1], curvatures[n], curvatures[n + 1])
        for n, (i, j) in enumerate(pairwise(middles))
    ]
    return FootTrack(
        position_m=column(np.array([state.position for state in states])),
        velocity_m_s=column(np.array([state.velocity for state in states])),
        orientation=column(matrix_quaternion(np.array([state.rotation for state in states]))),
        gyro_bias_rad_s=column(np.array([state.gyro_bias for state in states])),
        still=run.still,
        displacement_covariances_m2=np.array(spans).reshape(-1, 3, 3),
    )


def _displacement_covariance(steps: Sequence[FootStep], first: Array, last: Array) -> Array:
    """(3, 3) covariance of the way between the first and the last step.

    With the curvature L of later readings at either end (zero for the filter): errors e_i and e_j of the filter have
    E[e_i e_jᵀ] = P_i Aᵀ, A the product of all (I − K H) Φ between them, and given all readings P_i Aᵀ (I − L_j P_j).
    """
    A = np.eye(SIZE)
    for step in steps[1:]:
        A = step.Phi @ A
        if step.reading is not None:
            A = A - step.P[:, :READ] @ (step.reading.matrix @ A[:READ])
    P_i, P_j = steps[0].P, steps[-1].P
    cross = (P_i @ A.T @ (np.eye(SIZE) - last @ P_j))[P, P]
    here, there = ((M - M @ L @ M)[P, P] for M, L in ((P_i, first), (P_j, last)))
    return here + there - cross - cross.T
