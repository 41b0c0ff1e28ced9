"""Start of the torque-state filter: forces by inverse dynamics from a known motion and the ground's reactions."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from mbkf.conventions import Array
from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.torque.noise import Conditioned, condition, load_variance, residual_variance
from mbkf.filters.torque.plant import ForcedState, TorquePlant
from mbkf.filters.torque.settings import TorqueSettings
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.model.layout import Layout
from mbkf.sensors.foot_plates import FootReading

NOTHING = np.zeros(0)


class TorqueStart:
    """Makes a first state.

    Torques follow by inverse dynamics under the reactions (thesis eq. 3.12); so does their covariance. With consistent
    noise, motion and reactions are first made to agree on a small residual, unless a foot's wrench is an unknown input:
    the missing load is then part of the residual.

    Attributes:
        body: The forced body.
        plant: Its plant, whose noise spreads the forces where noise is independent.
        settings: Noise of reactions and residual.
    """

    def __init__(
        self, body: HumanDynamics, plant: TorquePlant, settings: TorqueSettings, residual_sd: Array
    ) -> None:
        """Makes the start.

        Args:
            body: The forced body.
            plant: Its plant.
            settings: Noise of reactions and residual.
            residual_sd: (6,) spread of the residual about 0, infinite where it is a random walk alone.
        """
        self.body, self.plant, self.settings = body, plant, settings
        mass = body.model.mass_kg
        # A vertical force of its own variance counts as one along the pelvis's axis here: people begin upright.
        walk = residual_variance(settings, mass)
        self._residual = np.where(np.isfinite(residual_sd), residual_sd**2, walk)
        self._unmeasured = np.sqrt(load_variance(settings, mass))

    def state(
        self,
        motion: KinematicState,
        acceleration: Array,
        feet: FootReading,
        plate_sd: Array,
        given: Array = NOTHING,
    ) -> ForcedState:
        """The first state.

        Args:
            motion: Positions and velocities with their covariance.
            acceleration: (nv,) estimate.
            feet: What is known of the ground's reactions.
            plate_sd: (12,) standard deviations of that, infinite where nothing is known.
            given: (12,) wrenches that are known inputs, or (0,).
        """
        a = np.where(self.body.kinematic, 0.0, acceleration)
        loads = np.nan_to_num(given).reshape(2, -1) if len(given) else feet.wrench
        u = self.body.forces(motion.q, motion.v, a, loads)
        if self.settings.noise == "independent":
            return ForcedState(motion.q, motion.v, u, self._plain_covariance(motion, u), given=given)
        load_sd = np.where(np.isfinite(plate_sd), plate_sd, self._unmeasured)
        return self._agreed(ForcedState(motion.q, motion.v, u, motion.P, given=given), load_sd)

    def _agreed(self, motion: ForcedState, load_sd: Array) -> ForcedState:
        """Motion and reactions made to agree; ``motion`` has the covariance of (q, v) alone."""
        body, q, v, u = self.body, motion.q, motion.v, motion.forces
        layout, torque = Layout.dynamic(body.nv), body.joint_forces(q, v, u)
        motion_part = layout.motion
        linear = body.linearise(q, v, u)
        mass = body.model.mass_matrix(q)[body.torque_dofs]
        rows = np.zeros((body.nu, layout.size))
        rows[: len(mass), motion_part] = -mass @ np.hstack([linear.by_q, linear.by_v])
        rows[:, layout.a.start :] = body.force_rows(q)
        residual = torque.by_u[:6] @ rows
        residual[:, motion_part] += np.hstack([torque.by_q, torque.by_v])[:6]
        spread = np.where(body.kinematic, 0.0, body.model.acceleration_sd)
        free = scipy.linalg.block_diag(motion.P, np.diag(spread**2), np.diag(load_sd**2))
        if np.isnan(motion.given).any():
            bound = Conditioned(np.zeros(layout.size), free)
        else:
            bound = condition(free, residual, self._residual, -torque.torque[:6])
        whole = np.vstack([np.eye(motion_part.stop, layout.size), rows])
        return self.plant.retract(motion, whole @ bound.shift, whole @ bound.covariance @ whole.T)

    def _plain_covariance(self, motion: KinematicState, u: Array) -> Array:
        """Forces known as well as a second of their own noise leaves them."""
        own = self.plant.spectral_density(ForcedState(motion.q, motion.v, u, motion.P))
        return scipy.linalg.block_diag(motion.P, own[self.plant.layout["u"], self.plant.layout["u"]])
