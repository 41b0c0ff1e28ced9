"""Variances of clinical coordinates and of their rates, from covariances of a body's dofs.

θ̇ = E v, and no coordinate mixes two joints: what is needed of a covariance are its blocks joint by joint, and diagonals
for joints of one or two angles, each of which is one dof.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.model.clinical import ClinicalAngles


class CoordinateVariances:
    """Reads them.

    Attributes:
        dofs: (n + 1, 3) dofs of the joints with three angles, last those of the root's position.
    """

    def __init__(self, clinical: ClinicalAngles) -> None:
        """Args: the coordinates, read in the body file's own axes."""
        self._clinical, turns = clinical, clinical.root_turns.start
        self.dofs = np.vstack([clinical.ball_turns, np.arange(turns - 3, turns)])
        self._columns = np.vstack([clinical.ball_columns, np.flatnonzero(~clinical.rotational)])
        self._rows, self._joints = self._columns[:, :, None], self.dofs[:, None, :]
        self._single = np.setdiff1d(np.arange(len(clinical.names)), self._columns)
        # Such a coordinate is one dof in every posture, up to its sign.
        E = clinical.rate_matrix(clinical.model.neutral())
        self._single_dofs = np.abs(E[self._single]).argmax(axis=1)

    def of(self, q: Array, blocks: Sequence[Array], diagonals: Sequence[Array]) -> Array:
        """(k, A) for k covariances of the dofs.

        Args:
            q: (nq,) configuration.
            blocks: k times (n + 1, 3, 3), the covariances' blocks of :attr:`dofs`.
            diagonals: k times (nv,), their diagonals.
        """
        E = self._clinical.rate_matrix(q)[self._rows, self._joints]
        found = np.empty((len(blocks), len(self._clinical.names)))
        found[:, self._columns] = ((E @ np.array(blocks)) * E).sum(axis=-1)
        found[:, self._single] = np.array(diagonals)[:, self._single_dofs]
        return found
