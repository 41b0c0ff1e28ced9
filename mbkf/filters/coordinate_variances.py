"""Variances of clinical coordinates and of their rates, from covariances of a body's dofs.

θ̇ = E v, and no coordinate mixes two joints: what is needed of a covariance are its blocks joint by joint, and diagonals
for joints of one or two angles, each of which is one dof.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.kernel.loading import library
from mbkf.model.clinical import ClinicalAngles


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
        self._columns = np.concatenate([where.columns.ravel(), where.single_columns])
        self._quaternions = np.array(where.quaternions, dtype=np.int32)
        self._order = np.array(where.order, dtype=np.int32)
        self._signs = np.column_stack([where.parity, where.signs]).astype(float)
        self._axes = np.ascontiguousarray(where.root_axes, dtype=float)

    def of(self, q: Array, blocks: Sequence[Array], diagonals: Sequence[Array]) -> Array:
        """(k, A) for k covariances of the dofs.

        Args:
            q: (nq,) configuration.
            blocks: k times (n + 1, 3, 3), the covariances' blocks of :attr:`dofs`.
            diagonals: k times (nv,), their diagonals.
        """
        covariance, where, kernel = np.array(blocks), self._layout, library()
        if kernel is None:
            E = self._clinical.rate_matrix(q)[where.columns[:, :, None], where.dofs[:, None, :]]
            variance = ((E @ covariance) * E).sum(axis=-1)
        else:
            variance = kernel.joint_variances(
                q, self._quaternions, self._order, self._signs, where.root_quaternion, self._axes, covariance
            )
        found = np.empty((len(covariance), len(self._columns)))
        joined = variance.reshape(len(covariance), -1)
        found[:, self._columns[: joined.shape[1]]] = joined
        for own, diagonal in zip(found, diagonals, strict=True):
            own[self._layout.single_columns] = diagonal[self._layout.single_dofs]
        return found
