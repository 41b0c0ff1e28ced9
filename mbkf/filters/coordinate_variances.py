"""Standard deviations of clinical coordinates and of their rates, from covariances of a body's dofs.

θ̇ = E v, and no coordinate mixes two joints: what is needed of a covariance are its blocks joint by joint, and diagonals
for joints of one or two angles, each of which is one dof.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.kernel.loading import library
from mbkf.model.clinical import ClinicalAngles


class DofVariances(NamedTuple):
    """Of covariances of a body's dofs, that of the configuration and that of the velocity.

    The filter's velocities are independent, so that only their diagonal is known.

    Attributes:
        position: (nv,) diagonal of the first.
        velocity: (nv,) diagonal of the second.
        blocks: (n + 1, 3, 3) blocks of the first, those of :attr:`CoordinateVariances.dofs`.
        velocity_blocks: (n + 1, 3, 3) blocks of the second; None for independent velocities.
    """

    position: Array
    velocity: Array
    blocks: Array
    velocity_blocks: Array | None


_NO_OFFSET = (None, None, None, None)


class CoordinateVariances:
    """Reads them.

    Attributes:
        dofs: (n + 1, 3) dofs of the joints with three angles, last those of the root's position.
    """

    def __init__(self, clinical: ClinicalAngles) -> None:
        """Args: the coordinates, read in the body file's own axes."""
        self._clinical, self._layout = clinical, clinical.rate_layout
        where = self._layout
        self.dofs = where.dofs
        self._zero = np.array(clinical.zero_variance)
        self._places = (
            np.array(where.quaternions, dtype=np.int32),
            np.array(where.order, dtype=np.int32),
            np.column_stack([where.parity, where.signs]).astype(float),
            where.root_quaternion,
            np.ascontiguousarray(where.root_axes, dtype=float),
            where.dofs.astype(np.int32),
            where.columns.astype(np.int32),
            where.single_dofs.astype(np.int32),
            where.single_columns.astype(np.int32),
            self._zero,
        )

    def deviations(self, q: Array, own: DofVariances, offset: DofVariances | None) -> Array:
        """(4, A) of coordinates and of their rates, and the offset's part of both.

        Args:
            q: (nq,) configuration.
            own: By the filter.
            offset: By the person's body, independent of it, and beside each coordinate's zero; None where the offset is
                not known.
        """
        kernel = library()
        if kernel is not None:
            position, velocity, blocks = (np.ascontiguousarray(one) for one in own[:3])
            further = _NO_OFFSET if offset is None else offset
            return kernel.coordinate_deviations(q, *self._places, position, velocity, blocks, *further)
        found = np.zeros((4, len(self._zero)))
        found[:2] = self._variances(q, own)
        if offset is not None:
            found[2:] = np.maximum(self._variances(q, offset), 0.0)
            found[2] += self._zero
        found[:2] = np.maximum(found[:2], 0.0) + found[2:]
        return np.sqrt(found, out=found)

    def _variances(self, q: Array, of: DofVariances) -> Array:
        """(2, A) of coordinates and of their rates."""
        where, velocity = self._layout, of.velocity_blocks
        if velocity is None:
            velocity = np.zeros(of.blocks.shape)
            np.einsum("bii->bi", velocity)[:] = of.velocity[where.dofs]
        E = self._clinical.rate_matrix(q)[where.columns[:, :, None], where.dofs[:, None, :]]
        found = np.empty((2, len(self._zero)))
        found[:, where.columns] = ((E @ np.array([of.blocks, velocity])) * E).sum(axis=-1)
        found[:, where.single_columns] = np.array([of.position, of.velocity])[:, where.single_dofs]
        return found
