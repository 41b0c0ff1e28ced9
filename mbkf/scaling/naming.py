"""Names of trajectories, judged by the cost of the person scaled from all of them together.

Scaling from wrong names absorbs the error in the offsets of the markers, at a cost: that of scaling itself (thesis
eq. 4.1), with the normalisation of its densities, so that names can be compared:

    E = C(poses, factors, offsets) + Σ 6 ln σ_p − Σ 2 ln P

over the markers of the trajectories, with placement σ_p and the probability P that a marker is worn in a moving trial;
twice the negative logarithm of the posterior, up to a constant. At fixed poses and factors E is a sum over pairs of a
trajectory and a marker.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.io.records import MarkerTrajectories
from mbkf.model.protocol import Protocol
from mbkf.numerics.levenberg_marquardt import minimise
from mbkf.scaling.fit import scaling_problem
from mbkf.scaling.frames import ScalingFrames, choose_frames
from mbkf.scaling.records import ScalingSettings, ScalingState
from mbkf.scaling.search import first_poses

Indices = NDArray[np.intp]

FRAMES = 12
"""Frames by which names are judged; skin moves slowly, so that a short trial has few independent observations."""

SETTINGS = ScalingSettings(dynamic_posture_frames=10.0, dynamic_marker_frames=FRAMES)
"""Weights for the comparison of names: markers and posture count fully."""

STILL_WORN = 0.05
"""Probability that a marker of static trials only is worn in a moving one."""

FAR = 4.0
"""Distance from its marker's place, in placement standard deviations, beyond which a trajectory's name is doubtful."""

TOLERANCE = 1e-3
"""Relative decrease of the cost below which the fit of a person ends."""


@dataclass(frozen=True)
class Naming:
    """Names of U trajectories, and the person scaled from them.

    Attributes:
        marker: (U,) marker of every trajectory, no marker twice.
        state: Poses, factors and offsets of all M markers.
        cost: E.
        misfit: C per measured coordinate: about ¼ for a person, more than 1 for other points.
    """

    marker: Indices
    state: ScalingState
    cost: float
    misfit: float


class NamingProblem:
    """U trajectories, and the M markers that they may be.

    Attributes:
        markers: The protocol's, without computed ones. All have the same noise: skin movement does not depend on the
            name, and a name must not gain by a larger or smaller noise.
        first: (U,) the names to begin with.
        body: The reference body.
    """

    def __init__(
        self,
        shown: MarkerTrajectories,
        protocol: Protocol,
        *,
        height_m: float | None = None,
        settings: ScalingSettings | None = None,
    ) -> None:
        """Prepares the frames that names are compared on.

        Args:
            shown: Trajectories under the names to begin with.
            protocol: The marker protocol.
            height_m: Body height, if known.
            settings: Weights of the priors.

        Raises:
            NotObservable: Too few markers of the protocol.
        """
        frames = choose_frames([shown], protocol, FRAMES)
        worn = [marker for marker in protocol.markers if marker.kind != "computed"]
        noise = float(np.median([marker.noise_m for marker in worn]))
        self.markers = tuple(replace(marker, noise_m=noise) for marker in worn)
        names = [marker.name for marker in self.markers]
        self.first = np.array([names.index(marker.name) for marker in frames.markers], dtype=np.intp)
        self._shown_m = frames.measured_m
        self._samples = np.maximum((~np.isnan(self._shown_m[:, :, 0])).sum(axis=0), 1)
        nothing = np.full((len(self._shown_m), len(names), 3), np.nan)
        every = ScalingFrames(self.markers, nothing, frames.trial, {})
        self._problem = scaling_problem(every, 0, protocol, height_m, settings or SETTINGS)
        self.body = self._problem.body
        self._noise_m = noise
        self._placement_m = np.array([marker.placement_sd_m for marker in self.markers])
        rare = np.array([marker.static_only for marker in self.markers])
        self._worn = 6.0 * np.log(self._placement_m) - 2.0 * math.log(STILL_WORN) * rare

    def fitted(self, marker: Indices, start: ScalingState | None, steps: int) -> Naming:
        """The person scaled from names.

        Args:
            marker: (U,) marker of every trajectory.
            start: State nearby to start from; None for first poses of its own.
            steps: Greatest number of iterations.
        """
        named = np.full((len(self._shown_m), len(self.markers), 3), np.nan)
        named[:, marker] = self._shown_m
        problem = self._problem.with_measurements(named)
        found = minimise(
            problem.start(first_poses(problem)) if start is None else start,
            problem.linearise,
            problem.cost,
            problem.move,
            tolerance=TOLERANCE,
            max_iterations=steps,
        )
        cost = found.equations.cost
        misfit = cost / (3.0 * float(self._samples.sum()))
        return Naming(marker, found.state, cost + float(self._worn[marker].sum()), misfit)

    def shares(self, state: ScalingState) -> tuple[Array, Array]:
        """(U, M) share of each pair of trajectory and marker in E at fixed poses and factors, and its offset (U, M, 3).

        The offset δ minimises n |ȳ − δ|² / σ² + |δ|² / σ_p², with mean ȳ of n samples about the protocol's place.
        """
        sensor = self._problem.sensor(state)
        expected = self._problem.local_m(state.factors, np.zeros_like(state.offsets_m))
        placed = [sensor.model.placements(q) for q in state.poses]
        rotations = np.array([rotation for rotation, _ in placed])[:, sensor.joint_ids]
        origins = np.array([origin for _, origin in placed])[:, sensor.joint_ids]
        away = self._shown_m[:, :, None] - origins[:, None]
        local = np.einsum("tmji,tumj->tumi", rotations, away) - expected
        samples = self._samples[:, None]
        mean = np.nansum(local, axis=0) / samples[:, :, None]
        scatter = np.nansum((local - mean) ** 2, axis=(0, 3))
        spread = self._placement_m**2 + self._noise_m**2 / samples
        share = scatter / self._noise_m**2 + (mean**2).sum(axis=2) / spread + self._worn
        return share, mean * (self._placement_m**2 / spread)[:, :, None]

    def offsets_m(self, naming: Naming) -> Array:
        """(U,) distance of each trajectory from the protocol's place of its marker."""
        return np.asarray(np.linalg.norm(naming.state.offsets_m[naming.marker], axis=1))

    def far(self, naming: Naming) -> BoolArray:
        """(U,) True for trajectories further from their markers' places than the protocol allows."""
        return np.asarray(self.offsets_m(naming) > FAR * self._placement_m[naming.marker])
