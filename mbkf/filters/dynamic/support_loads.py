"""Loads on parts of the body besides the feet, read off a state of the dynamic filter, and their torques."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.error_covariance import ErrorCovariance
from mbkf.model.body import Body
from mbkf.model.layout import SUPPORT, Layout
from mbkf.model.newton_euler import JointTorques, NewtonEuler
from mbkf.sensors.supports.bearings import BearingParts
from mbkf.sensors.supports.sharing import Shares, shares


class Loads(NamedTuple):
    """Parts that bear in a frame and how they share the wrench of all."""

    parts: tuple[int, ...]
    shares: Shares


class SupportLoads:
    """Reads the wrenches of a body's bearings.

    Attributes:
        bearings: The parts that may bear.
        slice: Slice of the wrench on all of them in the state; None where the state has no such part.
    """

    def __init__(self, model: Body, layout: Layout) -> None:
        self.bearings, self._nv = BearingParts(model), model.nv
        known = SUPPORT in layout
        self.slice = layout[SUPPORT] if known else None
        self._extra = layout.extra_index(SUPPORT) if known else slice(0)

    def of(self, parts: tuple[int, ...], state: DynamicState) -> Loads | None:
        """Loads on some parts (``notes.supports``) at a state; None where only feet bear."""
        if not parts or self.slice is None:
            return None
        points, chosen = self.bearings.at(state.q, state.v).points_m, list(parts)
        grips = [self.bearings.grips[k] for k in parts]
        levers = self.bearings.levers_m[chosen]
        return Loads(parts, shares(state.extra[self._extra], points[chosen], levers, grips))

    def wrench(self, loads: Loads | None) -> Array | None:
        """(B, 6) wrench on each part about the world's origin; None where the state has no such part."""
        if self.slice is None:
            return None
        found = np.zeros((len(self.bearings), 6))
        if loads is not None:
            found[list(loads.parts)] = loads.shares.wrench
        return found

    def whole(self, state: DynamicState) -> Array:
        """(6,) wrench on all parts together; (0,) where the state has no such part."""
        return state.extra[self._extra]

    def sd(self, loads: Loads | None, errors: ErrorCovariance | None) -> Array:
        """(B, 6) standard deviations of :meth:`wrench`, for the errors of the state; 0 on parts that bear nothing."""
        found = np.zeros((len(self.bearings), 6))
        if loads is not None and errors is not None and self.slice is not None:
            rows = np.zeros((6 * len(loads.parts), self.slice.stop))
            rows[:, self.slice] = loads.shares.by_whole.reshape(-1, 6)
            variance = errors.variance_of(rows) + np.diag(loads.shares.covariance)
            found[list(loads.parts)] = np.sqrt(np.maximum(variance, 0.0)).reshape(-1, 6)
        return found

    def torques(
        self, balance: NewtonEuler, torque: JointTorques, loads: Loads | None
    ) -> tuple[Array, Array | None]:
        """Derivative (nv, n) of the generalised forces by the state, and (nv,) variance by how parts share the load.

        The variance is None where only feet bear.

        Args:
            balance: The equations, last asked for these torques.
            torque: Torques for the feet's wrenches; the others' are counted in, in place.
            loads: Loads on other parts; None where only feet bear.
        """
        if loads is None or self.slice is None:
            return torque.by_state, None
        ids = [self.bearings.joint_ids[k] for k in loads.parts]
        by_joint: dict[int, Array] = {}
        for joint, wrench in zip(ids, loads.shares.wrench, strict=True):
            by_joint[joint] = by_joint.get(joint, np.zeros(6)) + wrench
        balance.loaded(torque, by_joint)
        J = np.vstack([balance.jacobian(joint) for joint in ids])
        by_state = np.zeros((self._nv, self.slice.stop), order="F")
        by_state[:, : torque.by_state.shape[1]] = torque.by_state
        by_state[:, self.slice] = -J.T @ loads.shares.by_whole.reshape(-1, 6)
        return by_state, np.einsum("ij,ik,kj->j", J, loads.shares.covariance, J)
