"""Every combination of the thesis's settings on its double pendulum, over the first second of its motion.

With plates as inputs F_x, F_y and T_2 are known and the state is [z, ż, τ_1, residual] (thesis 3.2.3). Noise of mbkf's
own, "stable", is for the body alone.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from benchmarks.double_pendulum.forced_bodies import PlainCoordinates
from benchmarks.double_pendulum.motions import MARKER_BARS, MARKER_SHARES
from benchmarks.double_pendulum.pendulum import DoublePendulum
from benchmarks.double_pendulum.thesis import STUDY_RECIPE
from benchmarks.double_pendulum.trials import Trial
from benchmarks.settings.design import BASE, Choices, every_combination, single_changes
from mbkf.conventions import Array
from mbkf.filters.torque.plant import ForcedState, Scheme, TorquePlant
from mbkf.model.forced_body import LinearAcceleration
from mbkf.numerics.kalman import correct, information

MOST, UNIT = 0.0522, "rad"
"""Largest RMS error of both angles: twice the thesis's 0.0261 of Table A.2."""

FRAMES, QUICK_FRAMES = 100, 40
EFFORT_NOISE, RESIDUAL_NOISE = {"density": 1000.0, "per frame": 200.0}, 1.0
"""Effort noise, N m/√s and N m, near the one at which the thesis's curves are lowest; residual noise, N m/√s."""

REACTIONS, REST = [1, 2, 3], [0, 4, 5, 6]
"""Places of F_x, F_y, T_2 and of τ_1 and the residual among the pendulum's efforts."""

MARKER_SD_M, EFFORT_SD = 0.001, 0.3


class GivenReactions(PlainCoordinates):
    """The pendulum with known reactions: u = [τ_1, residual], in arguments followed by F_x, F_y and T_2.

    Attributes:
        pendulum: The pendulum with all its efforts.
        nv, nu: Degrees of freedom, forces.
    """

    nv, nu = 4, len(REST)

    def __init__(self, pendulum: DoublePendulum) -> None:
        self.pendulum = pendulum

    def acceleration(self, q: Array, v: Array, u: Array) -> Array:
        """(4,) under all efforts.

        Args:
            q: (4,) coordinates.
            v: (4,) velocity.
            u: (nu + 3,) forces and reactions.
        """
        return self.pendulum.acceleration(q, v, _efforts(u))

    def linearise(self, q: Array, v: Array, u: Array) -> LinearAcceleration:
        """The acceleration with its derivatives, of the efforts those by the forces alone.

        Args:
            q: (4,) coordinates.
            v: (4,) velocity.
            u: (nu + 3,) forces and reactions.
        """
        found = self.pendulum.linearise(q, v, _efforts(u))
        return LinearAcceleration(found.a, found.by_q, found.by_v, found.by_u[:, REST])

    def force_response(self, q: Array) -> Array:
        """(4, nu) derivative of the acceleration by the forces."""
        return self.pendulum.force_response(q)[:, REST]


def _efforts(u: Array) -> Array:
    """(7,) the pendulum's efforts of forces and reactions."""
    efforts = np.empty(7)
    efforts[REST], efforts[REACTIONS] = u[: len(REST)], u[len(REST) :]
    return efforts


def runs(quick: bool) -> Mapping[Choices, float]:
    """RMS error of the angles, rad, of every combination; infinite where the filter broke down."""
    trial = STUDY_RECIPE.trial(0)
    frames = QUICK_FRAMES if quick else FRAMES
    return {one: _error(trial, followed(trial, one, frames)) for one in every_combination("stable")}


def acting() -> list[bool]:
    """For each single change of the base: it changes the result."""
    trial = STUDY_RECIPE.trial(0)
    base = followed(trial, BASE, QUICK_FRAMES)
    found = [followed(trial, one, QUICK_FRAMES) for one in single_changes("stable")]
    return [not np.allclose(one, base, rtol=1e-9) for one in found]


def _error(trial: Trial, q: Array) -> float:
    error = q[:, 2:] - trial.motion.q[: len(q), 2:]
    return float(np.sqrt(np.mean(error**2))) if np.isfinite(q).all() else np.inf


def followed(trial: Trial, choices: Choices, frames: int) -> Array:
    """(frames, 4) coordinates estimated with a combination, NaN after a breakdown.

    Args:
        trial: Truth and readings.
        choices: Words of the factors, noise other than "stable".
        frames: How many of the trial's.
    """
    integrator, propagation, covariance, complete, noise, plates = choices
    pendulum, given = DoublePendulum(trial.motion.shape, residual=True), plates == "inputs"
    body = GivenReactions(pendulum) if given else pendulum
    density = EFFORT_NOISE[noise] ** 2 / (trial.dt_s if noise == "per frame" else 1.0)
    forces = (
        np.r_[[density], [RESIDUAL_NOISE**2] * 3] if given else np.r_[[density] * 4, [RESIDUAL_NOISE**2] * 3]
    )
    matrix = np.diag(np.r_[np.zeros(8), forces])
    scheme = Scheme(integrator, propagation, covariance, complete == "true")
    plant = TorquePlant(body, trial.dt_s, lambda _: matrix, scheme)
    truth, read = trial.motion, trial.read
    efforts = np.r_[truth.efforts[0], np.zeros(3)]
    P = np.diag(np.r_[np.repeat([1e-4, 1e-2], 4), [10.0] * (1 if given else 4), [1e-2] * 3])
    state = ForcedState(truth.q[0], truth.v[0], efforts[REST] if given else efforts, P)
    found = np.full((frames, 4), np.nan)
    for t in range(frames):
        if t:
            prior = plant.predict(state)
            seen = pendulum.on_bars(prior.q, MARKER_SHARES, MARKER_BARS)
            y, H, sds = (
                [read.markers_m[t] - seen.positions_m],
                np.zeros((8, plant.layout.size)),
                [MARKER_SD_M] * 8,
            )
            H[:, :4] = seen.jacobian
            if not given:
                y.append(read.efforts[t, 1:] - prior.u[1:4])
                H, sds = np.vstack([H, np.eye(3, plant.layout.size, 9)]), sds + [EFFORT_SD] * 3
            better = correct(prior.P, information(np.concatenate(y), H, np.array(sds)))
            state = plant.retract(prior, better.step, better.covariance)
        if given:
            state = ForcedState(state.q, state.v, state.u, state.P, given=read.efforts[t, 1:])
        found[t] = state.q
    return found
