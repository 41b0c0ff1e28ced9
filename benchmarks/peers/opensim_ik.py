"""OpenSim's inverse kinematics frame by frame, as its InverseKinematicsTool runs it, without files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from benchmarks.peers.required import opensim
from mbkf.conventions import Array

ACCURACY = 1e-5
"""The tool's default; constraints are imposed (weight ∞), by default, too."""


class Pose:
    """A model that is moved to a trial's markers.

    Attributes:
        model: The model.
        state: Its pose.
    """

    def __init__(
        self,
        model: Any,
        names: Sequence[str],
        lab_m: Array,
        times_s: Array,
        weights: Mapping[str, float] | None = None,
    ) -> None:
        """A trial to follow.

        Args:
            model: The model.
            names: (M,) markers.
            lab_m: (T, M, 3) their positions in OpenSim's axes, m; NaN where not seen.
            times_s: (T,) times of the frames.
            weights: Weights of the markers; 1 for all by default.
        """
        osim = opensim()
        self.model, self._times = model, [float(t) for t in times_s]
        self.state = model.initSystem()
        own = osim.SetMarkerWeights()
        for name in names:
            own.cloneAndAppend(osim.MarkerWeight(name, float((weights or {}).get(name, 1.0))))
        self._reference = osim.MarkersReference(_table(names, lab_m, self._times), own)
        self._solver = osim.InverseKinematicsSolver(
            model, self._reference, osim.SimTKArrayCoordinateReference(), float("inf")
        )
        self._solver.setAccuracy(ACCURACY)
        self._started = False

    def solve(self, t: int) -> None:
        """Moves the model to a frame; from its pose in the frame before, but for the first one."""
        self.state.setTime(self._times[t])
        if not self._started:
            self._solver.assemble(self.state)
            self._started = True
        self._solver.track(self.state)

    def coordinates(self) -> Array:
        """(C,) values of the coordinates in the model's order, rad and m."""
        return np.array([c.getValue(self.state) for c in self.model.getCoordinateSet()])

    def markers(self, names: Sequence[str]) -> Array:
        """(M, 3) markers of the model, m."""
        self.model.realizePosition(self.state)
        found = [self.model.getMarkerSet().get(name).getLocationInGround(self.state) for name in names]
        return np.array([[place.get(k) for k in range(3)] for place in found])


def _table(names: Sequence[str], lab_m: Array, times_s: Sequence[float]) -> Any:
    osim = opensim()
    table = osim.TimeSeriesTableVec3()
    table.setColumnLabels(list(names))
    for time, frame in zip(times_s, lab_m.tolist(), strict=True):
        row = osim.RowVectorVec3(len(names))
        for k, place in enumerate(frame):
            row[k] = osim.Vec3(*place)
        table.appendRow(time, row)
    table.addTableMetaDataString("Units", "m")
    return table


def follow(model: Any, names: Sequence[str], lab_m: Array, times_s: Array) -> tuple[Array, Array]:
    """(T, C) coordinates and (T, M, 3) markers of a trial.

    Args:
        model: The model.
        names: (M,) markers.
        lab_m: (T, M, 3) their positions in OpenSim's axes, m; NaN where not seen.
        times_s: (T,) times of the frames.
    """
    pose = Pose(model, names, lab_m, times_s)
    coordinates, markers = [], []
    for t in range(len(times_s)):
        pose.solve(t)
        coordinates.append(pose.coordinates())
        markers.append(pose.markers(names))
    return np.array(coordinates), np.array(markers)
