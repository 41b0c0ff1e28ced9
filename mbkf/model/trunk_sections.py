"""Net moment of the trunk at levels of the spine: the wrench through a section of the root segment.

A section parts the body. The wrench by the lower part on the upper one follows from the motion of the upper part and
the loads on it (top-down), or from the motion of the lower part and the loads on it (bottom-up). Both are
Newton–Euler's equations of one part. The root's six equations are linear in the segments' inertias: with W the upper
part's and r the whole body's, the residual,

    top-down: W,    bottom-up: W − r.

About the section's middle p the moment is m − p × f. It is given in the axes of the segment above, as a torque of its
joint is. The root segment's part above the level moves with the root.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pinocchio as pin

from mbkf.conventions import Array
from mbkf.kernel.tree import CompiledTree, SectionTable
from mbkf.model.body import Body
from mbkf.model.description import TrunkLevel
from mbkf.model.human import HumanModel
from mbkf.model.newton_euler import ROOT, NewtonEuler
from mbkf.numerics.cardan import quaternion_matrices, rotation_matrix
from mbkf.numerics.rotations import skew

WAYS = ("top_down", "bottom_up")
"""Ways to the moment, in the order of every array's axis."""


@dataclass(frozen=True)
class SectionState:
    """Loads at the levels with their derivatives.

    Attributes:
        wrench: (2, L, 6) wrench on the upper part by way and level, about the root's origin in its axes, N and N m.
        moment: (2, L, 3) moment about the level, axes of the segment above, N m.
        by_state: (2, L, 3, N) derivative of the moment by q (in the tangent space), v, a and the feet's wrenches.
        by_root: (L, 3, 6) moment about the level, axes of the segment above, by a wrench about the root's origin in its
            axes.
    """

    wrench: Array
    moment: Array
    by_state: Array
    by_root: Array


class TrunkSections:
    """Sections of a body at its levels, L of them; none where the body is no :class:`HumanModel`.

    Attributes:
        levels: The levels.
        names: Their names.
        places_m: (L, 3) their middles in the root's frame.
        transports: (L, 3, 6) moment about the level by a wrench about the root's origin, in its axes.
    """

    def __init__(self, model: Body) -> None:
        self._model = model
        self.levels = model.description.levels if isinstance(model, HumanModel) else ()
        self.names = tuple(level.name for level in self.levels)
        scale = model.axis_scale(model.description.segments[0])
        joints = model.pin_model.jointPlacements
        self.places_m = np.array(
            [
                joints[model.joint(level.above).joint_id].translation
                if level.position_m is None
                else scale * level.position_m
                for level in self.levels
            ]
        ).reshape(-1, 3)
        self.transports = np.concatenate(
            [-skew(self.places_m), np.tile(np.eye(3), (len(self.levels), 1, 1))], axis=2
        )
        above = dict.fromkeys(level.above for level in self.levels)
        self._above = [model.joint(level.above).joint_id for level in self.levels]
        self._turns = [model.joint(name).q for name in above]
        self._turned_by = [list(above).index(level.above) for level in self.levels]

    @cached_property
    def _upper(self) -> list[NewtonEuler]:
        """Newton–Euler's equations of the part above each level."""
        model = self._model
        assert isinstance(model, HumanModel)
        found = []
        for k, level in enumerate(self.levels):
            whole, joints = model.pin_model.inertias, self.joints_above(level)
            kept = [one if j in joints else pin.Inertia.Zero() for j, one in enumerate(whole)]
            kept[model.root.joint_id] = self.part(k)
            found.append(NewtonEuler(model.with_inertias(kept)))
        return found

    @cached_property
    def _trees(self) -> list[CompiledTree]:
        """The parts above the levels in compiled code; empty without a kernel."""
        trees = [upper.model.tree for upper in self._upper]
        return [tree for tree in trees if tree is not None]

    @cached_property
    def table(self) -> SectionTable:
        """The sections as compiled code takes them."""
        parts = [self.part(k) for k in range(len(self.levels))]
        rows = [[part.mass, *part.lever, *part.inertia.ravel()] for part in parts]
        return SectionTable(np.array(self._above, np.int32), self.transports, np.array(rows).reshape(-1, 13))

    def joints_above(self, level: TrunkLevel) -> set[int]:
        """Joints whose segments hang on the segment above a level, that one's included."""
        supports = self._model.supports
        of_trunk = self._model.joint(level.above).v.start
        return {int(j) for j in np.flatnonzero(supports[:, of_trunk])}

    def bears_above(self, level: TrunkLevel) -> list[bool]:
        """Of each of the body's bearings, whether it is a part above a level."""
        joints = self.joints_above(level)
        parts = self._model.description.bearings.values()
        return [self._model.joint(part.segment).joint_id in joints for part in parts]

    def part(self, k: int) -> pin.Inertia:
        """The root segment's part above the k-th level, scaled to the person as the whole segment is."""
        model, level = self._model, self.levels[k]
        segment = model.description.segments[0]
        k_m = model.pin_model.inertias[model.root.joint_id].mass / segment.mass_kg
        size = model.scale[segment.length_index]
        inertia = np.diag(k_m * size**2 * level.part_inertia_kg_m2)
        return pin.Inertia(k_m * level.part_mass_kg, model.axis_scale(segment) * level.part_com_m, inertia)

    def upper_wrenches(self, q: Array, v: Array, a: Array) -> Array:
        """(T, L, 6) wrench on the part above each level without loads on it, generalised forces of the root.

        Args:
            q: (T, nq) configurations.
            v: (T, nv) velocities.
            a: (T, nv) accelerations.
        """
        tree = self._model.tree
        if tree is not None:
            return tree.upper_forces(q, v, a, self.table)
        unloaded = np.zeros((len(q), 2 * ROOT))
        return np.stack([part.motion_tau(q, v, a, unloaded)[:, :ROOT] for part in self._upper], axis=1)

    def moments(self, q: Array, v: Array, a: Array, carried: Array, residual: Array) -> Array:
        """(…, 2, L, 3) moments about the levels by way, axes of the segment above, N m.

        Args:
            q: (…, nq) configurations, of one frame or of T.
            v: (…, nv) velocities.
            a: (…, nv) accelerations.
            carried: (…, L, 6) wrench of all loads on the part above each level about the world's origin.
            residual: (…, 6) the root's residual, generalised forces in its axes.
        """
        if q.ndim == 1:
            return np.asarray(self.moments(q[None], v[None], a[None], carried[None], residual[None])[0])
        upper = self.upper_wrenches(q, v, a)
        for loaded in np.flatnonzero(carried.any(axis=(1, 2))):
            upper[loaded] -= carried[loaded] @ self._model.spatial_jacobian(q[loaded])[:, :ROOT]
        wrenches = np.stack([upper, upper - residual[:, None]], axis=1)
        return np.asarray(np.einsum("tkij,twkj->twki", self.by_root(q), wrenches))

    def state(
        self, q: Array, v: Array, a: Array, carried: Array, residual: Array, by_state: Array
    ) -> SectionState:
        """Loads at the levels with their derivatives.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
            carried: (L, 6) wrench of all loads on the part above each level about the world's origin.
            residual: (6,) the root's residual, generalised forces in its axes.
            by_state: (6, N) derivative of the residual.
        """
        found = self._compiled((q, v, a), carried, (residual, by_state))
        if found is not None:
            return found
        shape, by_root = (len(self.levels), *by_state.shape), self.by_root(q)
        wrenches, slopes = np.empty((len(WAYS), *shape[:2])), np.zeros(shape)
        motion = 3 * self._model.nv  # the feet are below
        loads = np.zeros((shape[0], 2 * ROOT))
        loads[:, :ROOT] = carried
        for k, equations in enumerate(self._upper):
            upper = equations.root(q, v, a, loads[k])
            wrenches[0, k], slopes[k, :, :motion] = upper.residual, upper.by_state[:, :motion]
        np.subtract(wrenches[0], residual, out=wrenches[1])
        rows = np.empty((len(WAYS), shape[0], 3, shape[2]))
        np.matmul(by_root, slopes, out=rows[0])
        np.subtract(rows[0], by_root @ by_state, out=rows[1])
        moment = np.matmul(by_root, wrenches[..., None])[..., 0]
        turned = skew(moment)
        for k, level in enumerate(self.levels):  # axes of the segment above turn with its joint
            rows[:, k][..., self._model.joint(level.above).v] += turned[:, k]
        return SectionState(wrenches, moment, rows, by_root)

    def _compiled(
        self, motion: tuple[Array, Array, Array], carried: Array, whole: tuple[Array, Array]
    ) -> SectionState | None:
        """:meth:`state` by the kernel; None where there is none."""
        if not self._trees:
            return None
        residual, by_state = whole[0], np.ascontiguousarray(whole[1])
        ways, levels = len(WAYS), len(self.levels)
        wrench, moment = np.empty((ways, levels, ROOT)), np.empty((ways, levels, 3))
        rows, by_root = np.empty((ways, levels, 3, by_state.shape[1])), np.empty((levels, 3, ROOT))
        for k, tree in enumerate(self._trees):
            wrench[:, k], moment[:, k], rows[:, k], by_root[k] = tree.section(
                motion, carried[k], self.transports[k], self._above[k], (residual, by_state)
            )
        return SectionState(wrench, moment, rows, by_root)

    def by_root(self, q: Array) -> Array:
        """(…, L, 3, 6) moments about the levels, axes of the segment above, by a wrench about the root's origin.

        Args:
            q: (…, nq) configurations.
        """
        joints = [q[..., one] for one in self._turns]
        turns = np.stack(
            [rotation_matrix(one) if one.ndim == 1 else quaternion_matrices(one) for one in joints], axis=-3
        )
        return np.asarray(np.swapaxes(turns, -1, -2)[..., self._turned_by, :, :] @ self.transports)
