"""Expected readings of plates, from the wrenches that a filter holds at the feet (thesis eqs. 4.10–4.13)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from mbkf.conventions import Array
from mbkf.model.human_dynamics import HumanDynamics


@dataclass(frozen=True)
class WrenchReading:
    """Predicted readings of right and left foot and their derivatives.

    Attributes:
        wrench: (12,) force N and moment N m about the plates' points, world axes; right, then left.
        by_q: (12, nv) derivative along the tangent space of q, D_z T_p of thesis eq. 4.13.
        by_state: (12, 12) derivative by the wrench states, D of thesis eq. 4.13.
    """

    wrench: Array
    by_q: Array
    by_state: Array


class FootWrenchSensor:
    """Rigid transfer of foot wrenches to points on the plates: p = [f, n + r̃ f], r from the point to the foot.

    Attributes:
        dynamics: The body, which defines the frames of wrench states.
        ids: Pinocchio joints of right and left foot.
    """

    def __init__(self, dynamics: HumanDynamics) -> None:
        self.dynamics = dynamics
        self.ids = [dynamics.model.joint(name).joint_id for name in dynamics.model.roles.feet]

    def reading(self, q: Array, state: Array, points_m: Array) -> WrenchReading:
        """Expected readings of plates under both feet.

        Args:
            q: (nq,) configuration.
            state: (12,) wrench states of right and left foot.
            points_m: (2, 3) points in the world about which the moments are taken.
        """
        if (compiled := self.dynamics.compiled) is not None:
            found = compiled.wrenches(q, state, points_m)
            return WrenchReading(found.wrench, found.by_q, found.by_state)
        rotations, origins, jacobian = self.dynamics.model.placements_and_jacobian(q)
        local, by_state, by_q = self.dynamics.local_wrench(q, state)
        wrench = np.empty(12)
        through, turned = np.zeros((12, 12)), np.zeros((12, len(jacobian[0])))
        for side, joint in enumerate(self.ids):
            force, moment = slice(6 * side, 6 * side + 3), slice(6 * side + 3, 6 * side + 6)
            A, arm = rotations[joint], pin.skew(origins[joint] - points_m[side])
            f, n = A @ local[force], A @ local[moment]
            wrench[force], wrench[moment] = f, n + arm @ f
            through[force, force], through[moment, moment] = A, A
            through[moment, force] = arm @ A
            moves = np.where(self.dynamics.model.supports[joint], jacobian, 0.0)
            linear, angular = moves[:3] - pin.skew(origins[joint]) @ moves[3:], moves[3:]
            turned[force] = -pin.skew(f) @ angular
            turned[moment] = -pin.skew(n) @ angular - arm @ pin.skew(f) @ angular - pin.skew(f) @ linear
        return WrenchReading(wrench, turned + through @ by_q, through @ by_state)
