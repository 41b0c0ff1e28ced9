"""Turning of errors in the joints' own axes while a body moves: δ̇ = −ad(v) δ + δv, joint by joint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.model.body import Body

_MINUS_CROSSED = (
    (0, 1, 2, 1.0), (0, 2, 1, -1.0), (1, 0, 2, -1.0), (1, 2, 0, 1.0), (2, 0, 1, 1.0), (2, 1, 0, -1.0)
)  # fmt: skip
"""Row, column, component and sign of −[w]×."""


@dataclass(frozen=True)
class Turning:
    """Entries of −ad(v): their flat ``places`` in (nv, nv), ``signs``, and the ``dofs`` of v that they hold."""

    nv: int
    places: NDArray[np.intp]
    signs: Array
    dofs: NDArray[np.intp]

    @classmethod
    def of(cls, model: Body) -> Turning:
        """Of a body: the root's blocks, and one of each spherical joint."""
        root = model.root.v.start
        blocks = [(root, root, root + 3), (root + 3, root + 3, root + 3), (root, root + 3, root)]
        blocks += [(joint.v.start,) * 3 for joint in model.joints.values() if joint.kind == "spherical"]
        entries = [
            ((row + i) * model.nv + column + j, sign, first + k)
            for row, column, first in blocks
            for i, j, k, sign in _MINUS_CROSSED
        ]
        places, signs, dofs = zip(*entries, strict=True)
        return cls(model.nv, np.array(places), np.array(signs), np.array(dofs))

    def at(self, v: Array) -> Array:
        """(nv, nv) −ad(v) at a velocity v (nv,)."""
        found = np.zeros(self.nv * self.nv)
        found[self.places] = self.signs * v[self.dofs]
        return found.reshape(self.nv, self.nv)
