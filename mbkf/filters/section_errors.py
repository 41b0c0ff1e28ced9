"""Errors of the trunk's moments at levels of the spine, caused by errors of the person's body.

Errors of the motion, of sizes and of segment masses enter the wrench on the part above a level as they enter
generalised forces (:mod:`mbkf.filters.body_errors`). Bottom-up, the residual's error is taken off. Two errors are the
section's own: its place in the pelvis, and the mass of the pelvis's part above it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.inertia_errors import InertiaErrors
from mbkf.model.body import Body
from mbkf.model.inertial_regressor import PER_SEGMENT
from mbkf.model.newton_euler import ROOT
from mbkf.model.trunk_sections import WAYS, SectionState, TrunkSections
from mbkf.numerics.rotations import skew

PART_SD = 0.3
"""Standard deviation of the mass of the root's part above a level, relative: sources differ by so much."""


class SectionErrors:
    """Errors of the moments at a body's L levels."""

    def __init__(self, model: Body, varied: Sequence[Body], along: Array, inertia: InertiaErrors) -> None:
        """Makes it.

        Args:
            model: The body.
            varied: The body with other sizes, n of them.
            along: (n, r) root of the errors of sizes, in units of these bodies' differences.
            inertia: Errors by segment masses and centres of mass.
        """
        self._sections, self._along, self._inertia = TrunkSections(model), along, inertia
        self._varied = [TrunkSections(one) for one in varied]
        here = self._sections.transports
        self._moved = [
            np.array([one.transports[k] for one in self._varied]).reshape(-1, *here[k].shape) - here[k]
            for k in range(len(here))
        ]
        self._columns = [self._shares(model, k) for k in range(len(self._sections.levels))]

    def _shares(self, model: Body, k: int) -> tuple[Array, Array]:
        """(10 J,) share of every segment's parameters above the k-th level, and the parameters of the root's part."""
        sections = self._sections
        share = np.zeros((model.pin_model.njoints - 1, PER_SEGMENT))
        share[[joint - 1 for joint in sections.joints_above(sections.levels[k])]] = 1.0
        root, part = model.root.joint_id, sections.part(k)
        share[root - 1] = part.mass / model.pin_model.inertias[root].mass
        own = np.zeros(share.shape)
        own[root - 1] = part.toDynamicParameters()
        return share.ravel(), own.ravel()

    def at(
        self,
        motion: tuple[Array, Array, Array],
        errors: Array,
        residual_errors: Array,
        residual: tuple[Array, Array],
    ) -> Array:
        """(2, L, 3, r + k + 4) roots of the moments' errors by way and level.

        Args:
            motion: q, v and a.
            errors: (3 nv, r) roots of their errors.
            residual_errors: (6, r + k) root of the residual's errors.
            residual: (6,) the residual, and its derivative (6, N) by the state.
        """
        q, v, a = motion
        levels, r = self._sections.levels, errors.shape[1]
        state = self._sections.state(q, v, a, np.zeros((len(levels), ROOT)), *residual)
        Y = self._inertia.regressor(q, v, a)[:ROOT]
        sized, moved = self._sizes(q, v, a, state)
        found = np.zeros((len(WAYS), len(levels), 3, residual_errors.shape[1] + 4))
        by_motion = state.by_state[..., : len(errors)].reshape(-1, len(errors)) @ errors
        by_motion = by_motion.reshape(*found.shape[:3], r)
        # The motion's part of the residual is among the moment's derivatives.
        of_residual = self._without_motion(residual_errors, errors, residual[1])
        for k, level in enumerate(levels):
            share, part = self._columns[k]
            upper = np.hstack([sized[k] @ self._along, (Y * share) @ self._inertia.root])
            by_part = PART_SD * state.by_root[k] @ (Y @ part)
            R = state.by_root[k][:, 3:]
            for way in range(len(WAYS)):
                rows = found[way, k]
                rows[:, :-4] = state.by_root[k] @ (upper - of_residual if way else upper)
                rows[:, :r] += by_motion[way, k]
                rows[:, :r] += (moved[k] @ state.wrench[way, k]).T @ self._along
                rows[:, -4:-1] = R @ skew(state.wrench[way, k, :3]) * level.sd_m
                rows[:, -1] = by_part
        return found

    @staticmethod
    def _without_motion(residual_errors: Array, errors: Array, by_state: Array) -> Array:
        """(6, r + k) the residual's errors without those that the motion's cause."""
        own = residual_errors.copy()
        own[:, : errors.shape[1]] -= by_state[:, : len(errors)] @ errors
        return own

    def _sizes(self, q: Array, v: Array, a: Array, state: SectionState) -> tuple[list[Array], list[Array]]:
        """Change from the body to each varied one, by level: of the wrench on the upper part, and of its transport.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
            state: Loads on the body.

        Returns:
            (6, n) changes of the wrench, and (n, 3, 6) of the moment by a wrench, each by level.
        """
        levels = range(len(self._sections.levels))
        here = q[None], v[None], a[None]
        there = [one.upper_wrenches(*here) for one in self._varied]
        upper = np.concatenate([np.zeros((0, len(levels), ROOT)), *there])
        changes = [(upper[:, k] - state.wrench[0, k]).T for k in levels]
        return changes, [state.by_root[k][:, 3:] @ self._moved[k] for k in levels]
