"""The search for the minimum of scaling: first poses, a first body, Levenberg–Marquardt.

From the expected body far postures are found badly, and the factors' first steps follow the postures' errors. So where
a person stands in some frames and moves in others, a few standing frames give a body first, and the moving frames'
poses are fitted to that body, each frame by itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.numerics.levenberg_marquardt import Solution, minimise
from mbkf.scaling.frames import MIN_MARKERS
from mbkf.scaling.problem import ScalingProblem
from mbkf.scaling.records import ScalingState
from mbkf.sensors.pose_fit import fit_most_markers, segment_by_segment

MAX_ITERATIONS = 60
FINE, COARSE = 1e-4, 3e-3
"""Relative decreases of the cost below which a search ends; the coarse one where another search follows."""

FIRST_FRAMES = 5
"""Number of standing frames that give the first body."""

Progress = Callable[[int, int], None]
"""Called with accepted iterations and their greatest number."""


def minimum(
    problem: ScalingProblem, start: ScalingState, progress: Progress | None = None, tolerance: float = FINE
) -> Solution[ScalingState]:
    """The minimum near a state.

    Args:
        problem: The problem.
        start: The state.
        progress: Called with accepted iterations and their greatest number.
        tolerance: Relative decrease of the cost below which the search ends.
    """
    report = None if progress is None else lambda done: progress(done, MAX_ITERATIONS)
    return minimise(
        start,
        problem.linearise,
        problem.cost,
        problem.move,
        tolerance=tolerance,
        max_iterations=MAX_ITERATIONS,
        on_iteration=report,
    )


def first_state(problem: ScalingProblem) -> ScalingState:
    """State with which the search starts: the expected body, or that of a few standing frames where others move.

    Args:
        problem: The problem.
    """
    standing = np.flatnonzero(problem.weights.standing)
    if not len(standing) or len(standing) == len(problem.weights.standing):
        return problem.start(first_poses(problem))
    few = problem.of_frames(standing[:: -(-len(standing) // FIRST_FRAMES)])
    found = minimum(few, few.start(first_poses(few)), tolerance=COARSE).state
    return replace(found, poses=_poses_of(problem, found))


def first_poses(problem: ScalingProblem) -> Array:
    """(N, nq) poses from the markers whose place is known beforehand, and all markers of a segment without any."""
    state = problem.start(np.zeros((0, problem.posture.model.nq)))
    sensor = problem.sensor(state)
    anatomical = np.array([m.kind != "technical" for m in problem.markers])
    tracked = {m.segment for m in problem.markers if m.kind != "technical"}
    placed = anatomical | np.array([m.segment not in tracked for m in problem.markers])
    enough = (placed & problem.seen).sum(axis=1) >= MIN_MARKERS
    shown = placed | ~enough[:, None]
    return segment_by_segment(sensor, np.where(shown[:, :, None], problem.measured_m, np.nan))


def _poses_of(problem: ScalingProblem, state: ScalingState) -> Array:
    """(N, nq) poses of the body and the markers of a state, frame by frame."""
    sensor = problem.sensor(state)
    poses = segment_by_segment(sensor, problem.measured_m)
    frames = zip(problem.measured_m, poses, strict=True)
    return np.array([fit_most_markers(sensor, problem.posture, m, problem.noise_m, q).q for m, q in frames])
