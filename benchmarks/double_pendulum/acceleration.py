"""The acceleration-coordinate filter on the double pendulum: state z, ż, z̈ and the plate's wrench.

The human's Singer plant predicts; markers, plate and Newton–Euler correct. The three equations of motion that τ_1 does
not enter are readings of zero; the fourth gives τ_1. The state is the human's own: of its two feet the pendulum stands
on the right one, in the plane, and what stays zero of their twelve components has no variance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.double_pendulum.kinematic import PlainManifold, joint_torque
from benchmarks.double_pendulum.motions import MARKER_BARS, MARKER_SHARES
from benchmarks.double_pendulum.pendulum import ROOT, DoublePendulum, PendulumShape
from benchmarks.double_pendulum.torque import START_VARIANCE
from benchmarks.double_pendulum.trials import Estimate, Trial
from mbkf.conventions import Array
from mbkf.filters.dynamic.plant import DynamicState, SingerPlant, SingerSettings
from mbkf.model.layout import Layout
from mbkf.numerics.kalman import Information, correct, information
from mbkf.numerics.smoothing import BackwardPass

PLATE = np.array([0, 1, 5])
"""F_x, F_y and T_2 among the wrenches of both feet."""

_ON_PLATE = 12 + PLATE
_SIZE = 24

START_ACCELERATION_SD = 5.0
"""Spread of z̈ at the start, rad/s² and m/s²."""


@dataclass(frozen=True)
class AccelerationSettings:
    """Noise settings of the filter.

    Attributes:
        acceleration: σ_a of every component of z, rad/s² and m/s².
        decay_s: How long an acceleration lasts.
        load_noise: Plate wrench as a random walk, N/√s and N m/√s.
        residual: How exactly Newton's law holds, N and N m.
        marker_m, force_n, moment_nm: Standard deviations of the sensors.
    """

    acceleration: float = 30.0
    decay_s: float = 0.3
    load_noise: float = 3000.0
    residual: float = 0.1
    marker_m: float = 1e-3
    force_n: float = 0.3
    moment_nm: float = 0.3


@dataclass(frozen=True)
class _Frame:
    """Posterior ``state``, and what led to it from the one before: ``transition`` (24, 24), ``evidence``, ``nis``."""

    state: DynamicState
    transition: Array
    evidence: Information
    nis: float


class PendulumAccelerationFilter:
    """Extended Kalman filter in acceleration coordinates.

    Attributes:
        body: The pendulum model.
        plant: Decaying accelerations.
        settings: The settings.
    """

    def __init__(self, shape: PendulumShape, dt_s: float, settings: AccelerationSettings) -> None:
        """A filter of one pendulum.

        Args:
            shape: Lengths, masses and inertias.
            dt_s: Time step, s.
            settings: Noise settings.
        """
        self.body, self.settings = DoublePendulum(shape, residual=False), settings
        spread = np.full(4, settings.acceleration)
        held = np.zeros(4, dtype=bool)
        motion = SingerSettings(activity_gain=0.0, decay_s=settings.decay_s)
        self.plant = SingerPlant(PlainManifold.as_model(spread), Layout.dynamic(4), dt_s, held, motion)
        self._walk = settings.load_noise**2 * dt_s
        plate = [settings.force_n, settings.force_n, settings.moment_nm]
        self._sd = np.array([settings.marker_m] * 8 + plate + [settings.residual] * 3)

    def start(self, q: Array, v: Array, a: Array, plate: Array) -> DynamicState:
        """The initial state, at known coordinates.

        Args:
            q: (4,) coordinates z.
            v: (4,) velocities ż.
            a: (4,) accelerations z̈.
            plate: (3,) wrench of the plate F_x, F_y, T_2.
        """
        variance, w = np.zeros(_SIZE), np.zeros(12)
        variance[:12] = np.repeat([*START_VARIANCE[:2], START_ACCELERATION_SD**2], 4)
        variance[_ON_PLATE], w[PLATE] = START_VARIANCE[2], plate
        return DynamicState(q, v, a, w, np.diag(variance))

    def step(self, state: DynamicState, markers_m: Array, plate: Array) -> _Frame:
        """Prediction and correction by one frame.

        Args:
            state: State of the frame before.
            markers_m: (8,) markers, NaN where missing.
            plate: (3,) wrench of the plate F_x, F_y, T_2.
        """
        prior = self.plant.predict(state)
        P = prior.P.copy()
        P[_ON_PLATE, _ON_PLATE] += self._walk
        innovation, H = self._read(prior, markers_m, plate)
        rows = ~np.isnan(innovation)
        found = correct(P, information(innovation[rows], H[rows], self._sd[rows]))
        after = _moved(prior, found.step, found.covariance)
        return _Frame(after, self.plant.transition(state), found.readings, found.nis)

    def _read(self, x: DynamicState, markers_m: Array, plate: Array) -> tuple[Array, Array]:
        """(14,) innovations of markers, plate and Newton–Euler, and their Jacobian (14, 24)."""
        seen = self.body.on_bars(x.q, MARKER_SHARES, MARKER_BARS)
        law = self.body.inertial(x.q, x.v, x.a)
        pull = self.body.effort_matrix(x.q)[:, 1:4]
        # The lever arms of F_x and F_y turn with their bar: ∂(L cos θ F_x + L sin θ F_y)/∂θ.
        swing, L, w = np.zeros((4, 4)), self.body.shape.length_m, x.w[PLATE]
        angles = x.q[2:]
        swing[[2, 3], [2, 3]] = L * (np.cos(angles) * w[1] - np.sin(angles) * w[0])
        H = np.zeros((14, _SIZE))
        H[:8, :4] = seen.jacobian
        H[8:11, _ON_PLATE] = np.eye(3)
        H[11:, :12] = ROOT @ np.hstack([law.by_q - swing, law.by_v, law.by_a])
        H[11:, _ON_PLATE] = -ROOT @ pull
        missing = ROOT @ (pull @ w - law.force)
        return np.concatenate([markers_m - seen.positions_m, plate - w, missing]), H

    def torque(self, x: DynamicState) -> float:
        """τ_1 of a state."""
        return joint_torque(self.body, x.q, x.v, x.a, x.w[PLATE])


def _moved(x: DynamicState, step: Array, P: Array) -> DynamicState:
    return DynamicState(x.q + step[:4], x.v + step[4:8], x.a + step[8:12], x.w + step[12:], P)


@dataclass(frozen=True)
class AccelerationMethod:
    """The filter as a method; ``smooth`` adds the backward smoother."""

    shape: PendulumShape
    settings: AccelerationSettings = AccelerationSettings()
    smooth: bool = False

    def run(self, trial: Trial) -> Estimate:
        """Tracks a trial; frames after a divergence are NaN."""
        kalman = PendulumAccelerationFilter(self.shape, trial.dt_s, self.settings)
        truth, read = trial.motion, trial.read
        states = [kalman.start(truth.q[0], truth.v[0], truth.a[0], truth.efforts[0, 1:])]
        frames: list[_Frame] = []
        for t in range(1, len(truth.times_s)):
            try:
                with np.errstate(over="ignore", invalid="ignore"):
                    frame = kalman.step(states[-1], read.markers_m[t], read.efforts[t, 1:])
            except (np.linalg.LinAlgError, ValueError):
                break
            if not np.isfinite(frame.state.q).all():
                break
            frames.append(frame)
            states.append(frame.state)
        nis = np.full(len(truth.times_s), np.nan)
        nis[1 : len(frames) + 1] = [frame.nis for frame in frames]
        if self.smooth and len(states) == len(nis):
            states = _smoothed(states, frames)
        q, v, efforts = (np.full((len(nis), 4), np.nan) for _ in range(3))
        for t, x in enumerate(states):
            q[t], v[t], efforts[t, 1:] = x.q, x.v, x.w[PLATE]
            efforts[t, 0] = kalman.torque(x)
        return Estimate(q, v, efforts, nis)


def _smoothed(states: Sequence[DynamicState], frames: Sequence[_Frame]) -> list[DynamicState]:
    """Linearly about the filter's own course, as the dynamic filter's smoother begins."""
    back = BackwardPass(len(states[0].P), covariances=False)
    found = []
    for t in range(len(states) - 1, -1, -1):
        here = states[t]
        found.append(_moved(here, back.step(here.P), here.P))
        if t:
            evidence = frames[t - 1].evidence
            back.through_readings(here.P, evidence.matrix, evidence.vector)
            back.through_plant(frames[t - 1].transition)
    return found[::-1]
