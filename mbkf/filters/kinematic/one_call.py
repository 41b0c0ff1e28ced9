"""A frame of the kinematic filter by one call of the compiled kernel, while every marker in sight is near.

The step is that of :class:`mbkf.filters.filter.Filter` with the blocks of the kinematic filter, in which nothing is to
be decided then: all markers count, every segment with markers shows one, and the posture prior has its full weight. In
other frames the call gives the prediction alone, and the blocks decide.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.kinematic.plant import KinematicState, WhiteAccelerationPlant
from mbkf.numerics.kalman import Information
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.markers import Markers
from mbkf.sensors.posture import PosturePrior


class Followed(NamedTuple):
    """A frame, predicted and corrected.

    Attributes:
        prior, posterior: State before and after the frame.
        innovation_m: (M, 3) measured minus predicted markers, NaN where missing.
        squared_m2: (M,) its squared length, 0 of missing ones.
        seen: (M,) markers in sight, all of which count.
        markers: Information of the markers.
        matrix, vector: (nv, nv), (nv,) the same with the posture prior's.
    """

    prior: KinematicState
    posterior: KinematicState
    innovation_m: Array
    squared_m2: Array
    seen: BoolArray
    markers: Information
    matrix: Array
    vector: Array


class _Called(NamedTuple):
    """Results of the kernel (:meth:`mbkf.kernel.tracking_functions.TrackingFunctions.follow_markers`)."""

    follows: bool
    P_before: Array
    q_before: Array
    innovation_m: Array
    squared_m2: Array
    seen: BoolArray
    by_markers: Array
    towards_markers: Array
    matrix: Array
    vector: Array
    P: Array
    q: Array
    v: Array
    size: float


class OneCall:
    """Steps of a kinematic filter by the kernel."""

    def __init__(self, plant: WhiteAccelerationPlant, markers: Markers, posture: PosturePrior) -> None:
        """Hands the constants over.

        Args:
            plant: Motion of the state.
            markers: Markers with white noise of their own.
            posture: Posture prior.
        """
        tree, compiled, s = plant.model.tree, markers.sensor.compiled, markers.settings
        assert tree is not None and compiled is not None
        self._call = partial(
            tree.kernel.follow_markers,
            tree.handle,
            plant.joint_ranges,
            plant.dt_s,
            plant.diagonals,
            compiled.joint_ids,
            compiled.local_m,
            markers.noise_m**-2.0,
            s.gate_radius_m,
            s.min_markers,
            plant.model.neutral(),
            posture.weights,
        )

    @classmethod
    def where_possible(
        cls, plant: WhiteAccelerationPlant, markers: Markers, posture: PosturePrior
    ) -> OneCall | None:
        """As the constructor; None without a kernel, or where markers slide on their segments.

        Args:
            plant: Motion of the state.
            markers: Markers with white noise of their own.
            posture: Posture prior.
        """
        plain = type(markers.sensor) is MarkerSensor and markers.sensor.compiled is not None
        return cls(plant, markers, posture) if plain and posture.sensor.tree is not None else None

    def __call__(self, state: KinematicState, measured_m: Array) -> Followed | KinematicState:
        """The frame; the predicted state alone where blocks have to decide.

        Args:
            state: Posterior of the frame before.
            measured_m: (M, 3) markers, NaN where missing.
        """
        read = np.ascontiguousarray
        found = _Called(*self._call(state.P, read(state.q), read(state.v), read(measured_m, dtype=float)))
        prior = KinematicState(found.q_before, state.v, found.P_before.T)
        if not found.follows:
            return prior
        seen = found.seen
        return Followed(
            prior,
            KinematicState(found.q, found.v, found.P.T),
            found.innovation_m,
            found.squared_m2,
            seen,
            Information(found.by_markers, found.towards_markers, found.size, 3 * seen.tobytes().count(1)),
            found.matrix,
            found.vector,
        )
