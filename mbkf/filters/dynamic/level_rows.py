"""Derivatives of the trunk's moments at levels of the spine by the state of the dynamic filter."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.filters.dynamic.plant import DynamicState
from mbkf.filters.dynamic.support_loads import Loads, SupportLoads
from mbkf.model.body import Body
from mbkf.model.newton_euler import ROOT
from mbkf.model.trunk_sections import WAYS, TrunkSections


class LevelRows:
    """Rows of the moments at a body's L levels.

    Attributes:
        sections: The body's sections.
        shape: (2, L, 3), ways, levels and axes.
    """

    def __init__(self, model: Body, loads: SupportLoads) -> None:
        """Args: the body, and the reader of loads on parts besides the feet."""
        self._model, self._loads, self.sections = model, loads, TrunkSections(model)
        self._above = [np.array(self.sections.bears_above(level)) for level in self.sections.levels]
        self.shape = (len(WAYS), len(self._above), 3)

    def at(
        self, state: DynamicState, loads: Loads | None, tau: Array, by_state: Array
    ) -> tuple[Array, Array]:
        """(6 L, n) derivatives by the state, and (6 L,) variances by how parts share a load.

        Args:
            state: The state.
            loads: Loads on parts besides the feet; None where only feet bear.
            tau: (nv,) generalised forces with these loads.
            by_state: (nv, n) their derivatives by the state.
        """
        carried = np.zeros((self.shape[1], ROOT))
        if loads is None:
            rows = self.sections.state(
                state.q, state.v, state.a, carried, tau[:ROOT], by_state[:ROOT]
            ).by_state
            return rows.reshape(-1, rows.shape[-1]), np.zeros(rows[..., 0].size)
        parts = list(loads.parts)
        for k, above in enumerate(self._above):
            carried[k] = loads.shares.wrench[above[parts]].sum(axis=0)
        found = self.sections.state(state.q, state.v, state.a, carried, tau[:ROOT], by_state[:ROOT])
        rows, variance = found.by_state, np.zeros(self.shape)
        root = -self._model.spatial_jacobian(state.q)[:, :ROOT].T
        for k, above in enumerate(self._above):
            for way in range(len(WAYS)):
                # The upper part's loads count top-down; bottom-up they leave the residual, and the lower part's stay.
                sign, counted = (1.0, above[parts]) if way == 0 else (-1.0, ~above[parts])
                by_parts = np.hstack([sign * one * found.by_root[k] @ root for one in counted.astype(float)])
                by_whole = by_parts @ loads.shares.by_whole.reshape(-1, ROOT)
                rows[way, k][:, self._loads.slice] = by_whole
                variance[way, k] = np.einsum("ij,jk,ik->i", by_parts, loads.shares.covariance, by_parts)
        return rows.reshape(-1, rows.shape[-1]), variance.ravel()
