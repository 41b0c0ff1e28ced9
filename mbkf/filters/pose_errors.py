"""Error of a pose that markers on a wrong body determine, from sums over the markers of each segment.

In a posture q, markers that are weighed with R = diag(σ_m²), beside a prior of information Π, put the pose wrong by

    δq = −(Hᵀ R⁻¹ H + Π)⁻¹ Hᵀ R⁻¹ δ,

δ the errors of the markers' places. The markers of a segment move with its twist ξ = Z δq about its origin, in its own
axes: H_m δq = A J_m ξ with J_m = [I, −m̄×] and A the axes of the segment. With M = Σ J_mᵀ J_m / σ_m² and
f = Σ J_mᵀ δ_m / σ_m² in its axes, Hᵀ R⁻¹ H = Σ Zᵀ M Z and Hᵀ R⁻¹ δ = Σ Zᵀ f over the segments: a rigid body's
inertia and the forces on it (Featherstone 2008). M is the same in all postures. So is f of errors of places, and of
displacements by flexion but for their share f(θ_d), which all markers of a segment have in common. An origin that
errors of sizes displace by δo adds M [Aᵀ δo, 0].

The prior draws every joint to neutral, while a person may hold it otherwise, by h in the whole trial. A filter that
takes the prior for a new reading in every frame does not count this: δq = −(Hᵀ R⁻¹ H + Π)⁻¹ Π h, which is small where
markers show the joint. It is large where a narrower prior decides, beside segments without markers
(:mod:`mbkf.sensors.holes`): Π is that prior's, while people hold such joints as differently as any other.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from mbkf.conventions import Array, BoolArray
from mbkf.model.scale_derivatives import OriginLevers
from mbkf.numerics.rotations import skew
from mbkf.sensors.flexed_skin import FlexedSkin
from mbkf.sensors.marker_sensor import MarkerSensor

LOOSE = 1e-6
"""Information on every dof besides markers and posture, 1/rad²: what nothing determines has no error by the body."""


class PoseErrors:
    """Roots of the errors of poses by h and by a root L of the covariance of sizes, places and displacements."""

    def __init__(
        self,
        sensor: MarkerSensor,
        noise_m: Array,
        root: Array,
        skin: FlexedSkin | None,
        held_rad: Array | None = None,
        posture_sd_rad: Array | None = None,
    ) -> None:
        """Sums over the markers.

        Args:
            sensor: The M markers on the body, at ``local_m`` in their segments in every posture.
            noise_m: (M,) standard deviation that the filter weighs each marker with, m.
            root: (K + E + 3 M (1 + D), r) L of scale factors, displacements of joint centres, marker places and
                displacements by flexion.
            skin: Shares of these displacements; None where no skin is known (D = 0).
            held_rad: (nv,) standard deviation of h, rad; 0 by default. Its dofs follow L in the roots' columns.
            posture_sd_rad: (nv,) spread of the prior that draws to neutral, 0 without; by default the body's table.
        """
        model = sensor.model
        self._model, self._origins = model, OriginLevers(model)
        self._levers = np.concatenate([self._origins.levers, self._origins.centre_levers], axis=2)
        posture = np.asarray(model.posture_sd if posture_sd_rad is None else posture_sd_rad)
        self._prior = LOOSE + np.where(posture > 0.0, 1.0 / np.where(posture > 0.0, posture, 1.0) ** 2, 0.0)
        held = np.zeros(model.nv) if held_rad is None else held_rad
        dofs = np.flatnonzero(held > 0.0)
        self._pulls = np.zeros((root.shape[1] + len(dofs), model.nv))
        self._pulls[root.shape[1] + np.arange(len(dofs)), dofs] = -((self._prior - LOOSE) * held)[dofs]
        root = np.hstack([root, np.zeros((len(root), len(dofs)))])
        self._joints, of_marker = np.unique(sensor.joint_ids, return_inverse=True)
        self._moves = model.supports[self._joints].astype(float)[:, None]
        members = (of_marker == np.arange(len(self._joints))[:, None]).astype(float)
        markers, columns = len(noise_m), root.shape[1]
        twists = np.concatenate([np.tile(np.eye(3), (markers, 1, 1)), -skew(sensor.local_m)], axis=2)
        weighed = (twists / noise_m[:, None, None] ** 2).transpose(0, 2, 1)
        self._inertias = np.tensordot(members, weighed @ twists, 1)
        count = self._levers.shape[2]
        self.sizes, moved = root[:count], root[count:].reshape(-1, markers, 3, columns)
        self._skin = None
        if skin is None:
            moved = moved[:1]
        else:
            carried = skin.carried
            moved = moved * np.insert(carried.T, 0, True, axis=0)[:, :, None, None]
            self._skin = skin.only(_shown_by(members, carried))
        self._forces = np.einsum("gm,dmcr->gdcr", members, weighed @ moved)

    def onto(self, directions: Array) -> None:
        """Replaces L, and the dofs of h beside it, by its product with directions (r, n)."""
        self.sizes, self._forces = self.sizes @ directions, self._forces @ directions
        self._pulls = directions.T @ self._pulls

    def roots(self, poses: Array) -> list[Array]:
        """Roots (nv, r) of the pose's error at each of the configurations (N, nq).

        Raises:
            numpy.linalg.LinAlgError: Markers and posture do not determine a pose.
        """
        placed = [self._model.placements_and_jacobian(q) for q in poses]
        rotations, origins, jacobians = (np.array(one) for one in zip(*placed, strict=True))
        axes = rotations[:, self._joints].swapaxes(2, 3)
        twists = self._twists(axes, origins[:, self._joints], jacobians)
        pulled = self._inertias @ twists
        levers = axes @ self._origins.summed(rotations, self._levers, self._joints)
        by_sizes = _flat(levers).swapaxes(1, 2) @ _flat(pulled[:, :, :3])
        twists = _flat(twists)
        force = self._force(poses).swapaxes(1, 2) @ -twists - self.sizes.T @ by_sizes + self._pulls
        information = _flat(pulled).swapaxes(1, 2) @ twists
        np.einsum("nii->ni", information)[:] += self._prior
        return [_solved(*equations) for equations in zip(information, force, strict=True)]

    def _twists(self, axes: Array, origins: Array, jacobians: Array) -> Array:
        """(N, S, 6, nv) Z of the segments: velocity of the origin, and turn, in the segment's axes.

        Args:
            axes: (N, S, 3, 3) from the world's axes to the segment's.
            origins: (N, S, 3) the segments' origins in the world, m.
            jacobians: (N, 6, nv) each dof's spatial velocity at the world's origin.
        """
        to_segment = np.zeros((*axes.shape[:2], 6, 6))
        to_segment[..., :3, :3] = to_segment[..., 3:, 3:] = axes
        to_segment[..., :3, 3:] = -axes @ skew(origins)
        moved = _flat(to_segment) @ jacobians
        found: Array = moved.reshape(*axes.shape[:2], 6, -1) * self._moves
        return found

    def _force(self, poses: Array) -> Array:
        """(N, 6 S, r) forces on the segments by places and displacements at configurations (N, nq)."""
        count, flexions, _, columns = self._forces.shape
        if self._skin is None:
            return self._forces.reshape(1, -1, columns)
        shares = np.ones((len(poses), count, flexions))
        shares[:, :, 1:] = [self._skin.shares(q) for q in poses]
        found = shares[:, :, None] @ self._forces.reshape(count, flexions, -1)
        return found.reshape(len(poses), -1, columns)


def _solved(information: Array, force: Array) -> Array:
    """(nv, r) deflection of a pose by forces (r, nv); the information (nv, nv) is overwritten.

    Raises:
        numpy.linalg.LinAlgError: The information is not positive.
    """
    _, found, failed = lapack.dposv(information.T, force.T, overwrite_a=True, overwrite_b=True)
    if failed:
        raise np.linalg.LinAlgError("markers and posture do not determine the pose")
    return np.asarray(found)


def _flat(by_segment: Array) -> Array:
    """(N, S, k, n) as (N, S k, n)."""
    return by_segment.reshape(len(by_segment), -1, by_segment.shape[3])


def _shown_by(members: Array, carried: BoolArray) -> NDArray[np.intp]:
    """(S,) a marker of each segment that skin carries, where it has one.

    Args:
        members: (S, M) 1 for the markers of a segment.
        carried: (M, D) True where a flexion moves a marker.
    """
    return np.asarray(np.argmax(members * (1.0 + carried.sum(axis=1)), axis=1))
