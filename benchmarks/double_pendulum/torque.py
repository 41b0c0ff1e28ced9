"""The thesis's dynamic filter on the double pendulum (thesis 3.3.2): the human's plant and update on another body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy.linalg

from benchmarks.double_pendulum.forced_bodies import WithIdleStates
from benchmarks.double_pendulum.motions import MARKER_BARS, MARKER_SHARES
from benchmarks.double_pendulum.pendulum import DoublePendulum, PendulumShape
from benchmarks.double_pendulum.trials import Estimate, Trial
from mbkf.conventions import Array
from mbkf.errors import UnknownName
from mbkf.filters.torque.plant import ForcedPrediction, ForcedState, Scheme, TorquePlant
from mbkf.model.forced_body import ForcedBody
from mbkf.numerics.kalman import Information, correct, information
from mbkf.numerics.smoothing import BackwardPass

SENSORS = ("m1", "m2", "m3", "m4", "tau_1", "F_x", "F_y", "T_2")
"""Markers from top to bottom, then efforts (thesis eq. 3.61)."""

STANDARD_SENSORS = tuple(name for name in SENSORS if name != "tau_1")
"""All but the torque sensor at the joint, which no laboratory has."""

START_VARIANCE = (1e-4, 1e-2, 10.0, 1e-6)
"""Variances of z, ż, T_e and residual efforts at the start, each component; the thesis does not state them."""


@dataclass(frozen=True)
class Artefact:
    """Marker artefacts as states.

    Attributes:
        sd_m: Stationary standard deviation.
        cutoff_hz: Of the low pass that makes them.
        order: 1: Gauss–Markov, ṡ = −ω s + w̃; 2: its rate fades as well, which is what a Butterworth low-pass does.
    """

    sd_m: float = 1e-2
    cutoff_hz: float = 0.5
    order: int = 1

    @property
    def drift(self) -> Array:
        """(order, order) of one coordinate, A of ẋ = A x + w̃."""
        w = 2.0 * np.pi * self.cutoff_hz
        return np.array([[-w]]) if self.order == 1 else np.array([[0.0, 1.0], [-(w**2), -np.sqrt(2.0) * w]])

    @property
    def density(self) -> Array:
        """(order,) spectral density of w̃."""
        w, variance = 2.0 * np.pi * self.cutoff_hz, self.sd_m**2
        return variance * (
            np.array([2.0 * w]) if self.order == 1 else np.array([0.0, 2.0 * np.sqrt(2.0) * w**3])
        )

    @property
    def variance(self) -> Array:
        """(order,) stationary variance."""
        w = 2.0 * np.pi * self.cutoff_hz
        return self.sd_m**2 * np.array([1.0, w**2][: self.order])


@dataclass(frozen=True)
class PendulumSettings:
    """Noise and structure of the dynamic filter; efforts change with the spectral density σ².

    Attributes:
        scheme: Integrator, propagation, covariance, F.
        effort_noise: σ_P of τ_1, F_x, F_y and T_2, N/√s and N m/√s.
        residual_noise: σ of the residual efforts; None where T_e has none.
        marker_m, force_n, moment_nm: Standard deviations of the sensors.
        sensors: Those in use, of :data:`SENSORS`.
        artefact: Marker artefacts as states; None for the thesis's filter, which has none.
    """

    scheme: Scheme = field(default_factory=Scheme)
    effort_noise: float = 1000.0
    residual_noise: float | None = 1e-3
    marker_m: float = 1e-3
    force_n: float = 0.3
    moment_nm: float = 0.3
    sensors: tuple[str, ...] = STANDARD_SENSORS
    artefact: Artefact | None = None


@dataclass(frozen=True)
class Step:
    """One step: posterior ``state``, its ``prediction``, the ``evidence`` between them and its ``nis``."""

    state: ForcedState
    prediction: ForcedPrediction
    evidence: Information
    nis: float


class PendulumFilter:
    """Extended Kalman filter of the pendulum.

    Attributes:
        body: The pendulum, with artefacts as idle states where they are modelled.
        plant: Its discretised dynamics.
        settings: The settings.
    """

    def __init__(self, shape: PendulumShape, dt_s: float, settings: PendulumSettings) -> None:
        """A filter of one pendulum.

        Args:
            shape: Lengths, masses and inertias.
            dt_s: Time step, s.
            settings: Discretisation, sensors and noise settings.
        """
        for name in settings.sensors:
            if name not in SENSORS:
                raise UnknownName("pendulum sensor", name, SENSORS)
        self.settings = settings
        self.pendulum = DoublePendulum(shape, settings.residual_noise is not None)
        artefact, forces = settings.artefact, self.pendulum.nu
        idle = 0 if artefact is None else 8 * artefact.order
        self.body: ForcedBody = WithIdleStates(self.pendulum, idle) if idle else self.pendulum
        size = 8 + self.body.nu
        density = np.zeros(size)
        density[8:12] = settings.effort_noise**2
        density[12 : 8 + forces] = (settings.residual_noise or 0.0) ** 2
        drift: Array | None = None
        if artefact is not None:
            density[8 + forces :] = np.tile(artefact.density, 8)
            drift = scipy.linalg.block_diag(np.zeros((forces, forces)), *[artefact.drift] * 8)
        matrix = np.diag(density)
        self.plant = TorquePlant(self.body, dt_s, lambda _: matrix, settings.scheme, drift)
        moment, force = settings.moment_nm, settings.force_n
        self._sd = np.array([settings.marker_m] * 8 + [moment, force, force, moment])
        used = [name in settings.sensors for name in SENSORS]
        self._used = np.concatenate([np.repeat(used[:4], 2), used[4:]])
        self._H = np.zeros((12, size))
        self._H[8:, 8:12] = np.eye(4)
        if artefact is not None:
            self._H[np.arange(8), 8 + forces + artefact.order * np.arange(8)] = 1.0

    def start(self, q: Array, v: Array, efforts: Array) -> ForcedState:
        """The initial state at known coordinates, with the covariance of :data:`START_VARIANCE`.

        Args:
            q: (4,) coordinates z.
            v: (4,) velocities ż.
            efforts: (4,) efforts T_e.
        """
        u = np.zeros(self.body.nu)
        u[:4] = efforts
        counts = (4, 4, 4, self.pendulum.nu - 4)
        variance = np.repeat(START_VARIANCE, counts)
        if self.settings.artefact is not None:
            variance = np.concatenate([variance, np.tile(self.settings.artefact.variance, 8)])
        return ForcedState(q, v, u, np.diag(variance))

    def step(self, state: ForcedState, markers_m: Array, efforts: Array) -> Step:
        """Prediction and correction by one frame.

        Args:
            state: State of the frame before.
            markers_m: (8,) markers, NaN where missing.
            efforts: (4,) measured efforts, NaN where not measured.
        """
        prior = self.plant.predict(state)
        seen = self.pendulum.on_bars(prior.q, MARKER_SHARES, MARKER_BARS)
        H = self._H.copy()
        H[:8, :4] = seen.jacobian
        expected = H[:, 8:] @ prior.u
        expected[:8] += seen.positions_m
        innovation = np.concatenate([markers_m, efforts]) - expected
        rows = self._used & ~np.isnan(innovation)
        evidence = information(innovation[rows], H[rows], self._sd[rows])
        found = correct(prior.P, evidence)
        after = self.plant.retract(prior, found.step, found.covariance)
        return Step(after, prior, evidence, found.nis)


@dataclass(frozen=True)
class TorqueMethod:
    """The dynamic filter as a method: the ``shape`` it assumes, its ``settings``, and whether it looks back."""

    shape: PendulumShape
    settings: PendulumSettings
    smooth: bool = False

    def run(self, trial: Trial) -> Estimate:
        """Follows a trial; frames after a breakdown are NaN."""
        states, steps = self.follow(trial)
        frames, nis = len(trial.motion.times_s), np.full(len(trial.motion.times_s), np.nan)
        x = np.full((frames, 12), np.nan)
        if self.smooth and len(states) == frames:
            states = smoothed(states, steps)
        for t, state in enumerate(states):
            x[t] = np.concatenate([state.q, state.v, state.u[:4]])
        nis[1 : len(steps) + 1] = [step.nis for step in steps]
        return Estimate(x[:, :4], x[:, 4:8], x[:, 8:], nis)

    def follow(self, trial: Trial) -> tuple[list[ForcedState], list[Step]]:
        """States of the frames, and the steps between them; fewer than frames where the filter broke down."""
        kalman = PendulumFilter(self.shape, trial.dt_s, self.settings)
        truth, read = trial.motion, trial.read
        states, steps = [kalman.start(truth.q[0], truth.v[0], truth.efforts[0])], []
        for t in range(1, len(truth.times_s)):
            try:
                with np.errstate(over="ignore", invalid="ignore"):
                    step = kalman.step(states[-1], read.markers_m[t], read.efforts[t])
            except (np.linalg.LinAlgError, ValueError):
                break
            if not np.isfinite(step.state.q).all():
                break
            states.append(step.state)
            steps.append(step)
        return states, steps


def smoothed(states: Sequence[ForcedState], steps: Sequence[Step]) -> list[ForcedState]:
    """Every frame corrected by all later ones (smoother), linearised about the filter's own estimates."""
    back = BackwardPass(len(states[0].P), covariances=False)
    found = []
    for t in range(len(states) - 1, -1, -1):
        here = states[t]
        dx = back.step(here.P)
        found.append(ForcedState(here.q + dx[:4], here.v + dx[4:8], here.u + dx[8:], here.P))
        if t:
            step = steps[t - 1]
            back.through_readings(here.P, step.evidence.matrix, step.evidence.vector)
            back.through_plant(step.prediction.phi)
    return found[::-1]
