"""FCDI on the double pendulum: the human's white-acceleration plant and update, then inverse dynamics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, cast

import numpy as np

from benchmarks.double_pendulum.motions import MARKER_BARS, MARKER_SHARES
from benchmarks.double_pendulum.pendulum import DoublePendulum, PendulumShape
from benchmarks.double_pendulum.torque import START_VARIANCE
from benchmarks.double_pendulum.trials import Estimate, Trial
from mbkf.conventions import Array
from mbkf.filters.kinematic.plant import KinematicState, WhiteAccelerationPlant
from mbkf.model.body import SegmentJoint
from mbkf.model.human import HumanModel
from mbkf.numerics.kalman import correct, information

TORQUE_ROW = 3
"""τ_1 is what the equation of θ_2 asks for; residual efforts take what is left of the other three (thesis eq. 3.12)."""


@dataclass(frozen=True)
class PlainManifold:
    """What the kinematic plants ask of a body, for plain coordinates: a stand-in for the human's manifold.

    Attributes:
        movement_sd: (4,) typical accelerations of the coordinates z.
        joints: One slider per coordinate.
        tree: None: the compiled kernel knows no sliders.
    """

    movement_sd: Array
    nv: ClassVar[int] = 4
    tree: ClassVar[None] = None
    joints: ClassVar[Mapping[str, SegmentJoint]] = {
        f"z{k}": SegmentJoint(f"z{k}", "slider", "", k + 1, slice(k, k + 1), slice(k, k + 1))
        for k in range(4)
    }

    def integrate(self, q: Array, dv: Array) -> Array:
        """(4,) q + dv."""
        return q + dv

    def integration_derivatives(self, q: Array, dv: Array) -> tuple[Array, Array]:
        """Identities (4, 4)."""
        del q, dv
        return np.eye(4), np.eye(4)

    @classmethod
    def as_model(cls, movement_sd: Array) -> HumanModel:
        """Itself, under the type that the plants are annotated with; they use no more than this of it."""
        return cast(HumanModel, cls(movement_sd))


def joint_torque(body: DoublePendulum, q: Array, v: Array, a: Array, plate: Array) -> float:
    """τ_1 by inverse dynamics (thesis eq. 3.12), N m.

    Args:
        body: The pendulum.
        q: (4,) coordinates z.
        v: (4,) velocities ż.
        a: (4,) accelerations z̈.
        plate: (3,) measured wrench of the plate F_x, F_y, T_2.
    """
    row = TORQUE_ROW
    wanted: float = body.inertial(q, v, a).force[row] - body.effort_matrix(q)[row, 1:4] @ plate
    return float(wanted)


@dataclass(frozen=True)
class KinematicMethod:
    """FCDI as a method.

    Attributes:
        shape: The pendulum it assumes.
        acceleration: σ_a of every component of z, rad/s² and m/s².
        marker_m: Standard deviation of a marker coordinate.
    """

    shape: PendulumShape
    acceleration: float = 30.0
    marker_m: float = 1e-3

    def run(self, trial: Trial) -> Estimate:
        """Follows a trial; accelerations are differences of filtered velocities (thesis eq. 3.7)."""
        body, dt, truth = DoublePendulum(self.shape, residual=False), trial.dt_s, trial.motion
        spread = np.full(4, self.acceleration)
        plant = WhiteAccelerationPlant(PlainManifold.as_model(spread), dt, spread)
        state = KinematicState(truth.q[0], truth.v[0], np.diag(np.repeat(START_VARIANCE[:2], 4)))
        frames = len(truth.times_s)
        q, v, nis = np.empty((frames, 4)), np.empty((frames, 4)), np.full(frames, np.nan)
        q[0], v[0] = state.q, state.v
        efforts = trial.read.efforts.copy()
        efforts[0, 0] = truth.efforts[0, 0]
        for t in range(1, frames):
            prior = plant.predict(state)
            seen = body.on_bars(prior.q, MARKER_SHARES, MARKER_BARS)
            innovation = trial.read.markers_m[t] - seen.positions_m
            rows = ~np.isnan(innovation)
            sd = np.full(int(rows.sum()), self.marker_m)
            found = correct(prior.P, information(innovation[rows], seen.jacobian[rows], sd))
            state = KinematicState(prior.q + found.step[:4], prior.v + found.step[4:], found.covariance)
            q[t], v[t], nis[t] = state.q, state.v, found.nis
            efforts[t, 0] = joint_torque(body, q[t], v[t], (v[t] - v[t - 1]) / dt, trial.read.efforts[t, 1:])
        return Estimate(q, v, efforts, nis)
