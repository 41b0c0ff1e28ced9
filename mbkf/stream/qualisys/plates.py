"""Forces of QTM's plates as force of the plate on the body about the plate's centre, world axes.

QTM states the force on the plate, in the plate's axes (z down) or, by a setting, in the laboratory's. Which of them
follows from the first load: its moment gives the point of application that QTM states beside it.

Source: Qualisys Track Manager, section Force data information of its manual.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.io.plate_corners import plate_axes
from mbkf.stream.qualisys.packets import PlateForces
from mbkf.stream.qualisys.parameters import MM, QtmDescription
from mbkf.stream.source import PlateSamples

LOADED_N = 50.0
"""From this force normal to a plate on, its axes are decided."""

LOCAL, LABORATORY, LABORATORY_ORIGIN = "plate", "laboratory", "laboratory, about its origin"
"""Axes, and point of the moments, in which QTM may state forces."""


class PlateForceReader:
    """Turns samples of plates into a run's.

    Attributes:
        axes: Axes of the forces, one of this file's names; None until a plate was loaded.
    """

    def __init__(self, described: QtmDescription) -> None:
        """Args: the stream's description."""
        plates = described.stream.plates
        self.axes: str | None = None
        self._ids = described.plate_ids
        self._rotation = described.rotation
        corners = [plate.corners_m for plate in plates if plate.corners_m is not None]
        self._plate_axes = [plate_axes(one) for one in corners]
        self._turns: dict[tuple[int, str | None], Array] = {}
        self._centres = [one.mean(axis=0) for one in corners]

    def samples(self, forces: Sequence[PlateForces]) -> PlateSamples:
        """(S, K, 6) samples of all plates, NaN where a plate has none."""
        known = [one for one in forces if one.plate in self._ids and len(one.samples)]
        count = len(self._ids)
        if not known:
            return PlateSamples.none(count)
        first = min(one.first for one in known)
        last = max(one.first + len(one.samples) for one in known)
        most = max(len(one.samples) for one in known)
        if last - first > 4 * most:  # counts of plates that have nothing to do with each other
            known, first, last = known[:1], known[0].first, known[0].first + len(known[0].samples)
        wrench = np.full((last - first, count, 6), np.nan)
        for one in known:
            k, at = self._ids.index(one.plate), one.first - first
            if self.axes is None:
                self._decide(one, k)
            wrench[at : at + len(one.samples), k] = self._wrench(one, k, self.axes)
        return PlateSamples(np.arange(first, last, dtype=np.int64), wrench)

    def _wrench(self, one: PlateForces, k: int, axes: str | None) -> Array:
        """(S, 6) force and moment of the plate on the body."""
        if (k, axes) not in self._turns:
            self._turns[k, axes] = self._to_body(k, axes)
        return np.asarray(one.samples[:, :6] @ self._turns[k, axes])

    def _to_body(self, k: int, axes: str | None) -> Array:
        """(6, 6) matrix that takes rows of force and moment on a plate to those on the body."""
        turn = self._plate_axes[k] if axes in (None, LOCAL) else self._rotation
        found = np.zeros((6, 6))
        found[:3, :3] = found[3:, 3:] = -turn.T
        if axes == LABORATORY_ORIGIN:
            found[:3, 3:] = -np.cross(self._centres[k], found[:3, :3])
        return found

    def _decide(self, one: PlateForces, k: int) -> None:
        """Decides the axes by the first loaded sample: those whose moment gives its point of application."""
        values = one.samples.astype(float)
        normal = self._plate_axes[k][:, 2]
        for row in range(len(values)):
            ways = {}
            for axes in (LOCAL, LABORATORY, LABORATORY_ORIGIN):
                wrench = self._wrench(PlateForces(one.plate, one.first, one.samples[row : row + 1]), k, axes)[
                    0
                ]
                pressing = -float(wrench[:3] @ normal)
                if not pressing >= LOADED_N:  # NaN, hardly loaded, or a person who pulls at the plate
                    continue
                found = self._centres[k] + np.cross(normal, wrench[3:]) / (wrench[:3] @ normal)
                stated = self._point(values[row, 6:], k, axes)
                ways[axes] = float(np.linalg.norm(found - stated)) if np.isfinite(stated).all() else np.inf
            if ways:
                self.axes = min(ways, key=lambda axes: ways[axes])
                return

    def _point(self, point_mm: Array, k: int, axes: str) -> Array:
        """(3,) stated point of application on the plate's surface, world axes."""
        if axes == LOCAL:
            return np.asarray(self._centres[k] + self._plate_axes[k] @ (MM * point_mm))
        return np.asarray(self._rotation @ (MM * point_mm))
