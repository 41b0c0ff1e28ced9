"""Clinical joint angles of a posture, their rates and the joint moments conjugate to them.

A joint of the model is a rotation; people read angles about named axes, which the body file defines.
θ̇ = E v with the tangent velocity v, v = B θ̇, and m = Bᵀ τ, so that Σ m θ̇ = τᵀ v joint by joint.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray, read_only
from mbkf.errors import InvalidInput, ShapeError, UnknownName
from mbkf.model.angle_reading import AngleReading, JointAxes
from mbkf.model.body import Body
from mbkf.model.clinical_table import Angle, ClinicalJoint
from mbkf.numerics.cardan import (
    cardan_angles,
    follow,
    near_singularity,
    quaternion_matrices,
    rate_map,
    velocity_map,
)

AXES = {"x": 0, "y": 1, "z": 2}


def dof_names(model: Body) -> tuple[str, ...]:
    """Names of the nv tangent dofs: ``<segment>_<axis>`` turns about it, ``pelvis_t<axis>`` moves along it.

    Free and spherical joints: axes of the segment's own frame. Others: the axes they turn about, in turn.
    """
    return _joint_names(model, ("x", "y", "z"))


def configuration_names(model: Body) -> tuple[str, ...]:
    """Names of the nq numbers of a configuration: as :func:`dof_names`, and ``_qx`` to ``_qw`` of quaternions."""
    return _joint_names(model, ("qx", "qy", "qz", "qw"))


def _joint_names(model: Body, turns: tuple[str, ...]) -> tuple[str, ...]:
    """Names by joint; those of the rotation of a joint with three angles are given."""
    axes = {"free": ("tx", "ty", "tz", *turns), "spherical": turns}
    return tuple(
        f"{joint.segment}_{axis}"
        for joint in model.joints.values()
        for axis in axes.get(joint.kind, tuple(joint.axes))
    )


class RateLayout(NamedTuple):
    """Where the rates' matrix E of θ̇ = E v is not zero: joint by joint.

    Attributes:
        quaternions: (n,) first number in q of the quaternions of joints with three angles.
        order: (n, 3) their axes.
        parity: (n,) +1 where these are an even permutation of x, y, z, else −1.
        signs: (n, 3) signs of their angles.
        columns: (n + 1, 3) their columns, last those of the root's position.
        dofs: (n + 1, 3) their dofs, ascending.
        single_columns: (m,) columns of the other angles, each ± one dof.
        single_dofs: (m,) those dofs.
        root_quaternion: First number in q of the root's.
        root_axes: (3, 3) what takes the root's position to the axes it is stated in.
    """

    quaternions: NDArray[np.intp]
    order: NDArray[np.intp]
    parity: Array
    signs: Array
    columns: NDArray[np.intp]
    dofs: NDArray[np.intp]
    single_columns: NDArray[np.intp]
    single_dofs: NDArray[np.intp]
    root_quaternion: int
    root_axes: Array


class ClinicalAngles:
    """Clinical coordinates of a body: angles of every joint, and the pelvis's position in OpenSim's axes.

    As many coordinates as tangent dofs (A = nv). Angles are in rad, the pelvis's translations in m.

    Attributes:
        model: The body.
        reading: The axes that angles are read in.
        joints: The joints' entries of the body file, in the model's order.
        names: (A,) coordinate names, OpenSim's where it has them.
        units: (A,) "rad" or "m".
        rotational: (A,) True for angles, False for the pelvis's translations.
        zero_variance: (A,) variances of a coordinate's zero among persons, rad².
        root_angles: (3,) columns of the root's angles; they are stated against the world's axes.
        root_turns: Where the root's rotation stands in the tangent space.
        ball_turns: (n, 3) where the rotations of the joints with three angles do, in the model's order.
        ball_columns: (n, 3) columns of these joints' angles.
    """

    def __init__(self, model: Body, reading: AngleReading | None = None) -> None:
        """Args: the body, and the axes that angles are read in; the body file's own when None."""
        self.model, self.reading = model, reading or AngleReading()
        self.joints: tuple[ClinicalJoint, ...] = model.description.clinical_joints
        self.names: tuple[str, ...] = tuple(c.name for joint in self.joints for c in joint.coordinates)
        column = {name: i for i, name in enumerate(self.names)}
        translations = [c.name for joint in self.joints for c in joint.translations]
        self.rotational: BoolArray = read_only([name not in translations for name in self.names], dtype=bool)
        zero_sd = [np.deg2rad(c.zero_sd_deg) for joint in self.joints for c in joint.coordinates]
        self.zero_variance: Array = read_only(np.square(zero_sd))
        self.units: tuple[str, ...] = tuple("rad" if turns else "m" for turns in self.rotational)
        self._place_balls(column)
        self._place_dofs(column)
        self._place_root(column)

    def _place_balls(self, column: dict[str, int]) -> None:
        """Rotations by three angles: n of them, each with its order, signs, columns and places in q and v."""
        found = [(joint, self.model.joints[joint.distal]) for joint in self.joints if len(joint.order) == 3]
        read: list[JointAxes | None] = [self.reading.joints.get(joint.name) for joint, _ in found]
        self._axes = [(n, axes) for n, axes in enumerate(read) if axes is not None]
        orders = [
            axes.order if axes and axes.order else joint.order
            for (joint, _), axes in zip(found, read, strict=True)
        ]
        angles = [
            [joint.angles[joint.order.index(axis)] for axis in order]
            for (joint, _), order in zip(found, orders, strict=True)
        ]
        self._order = np.array([[AXES[axis] for axis in order] for order in orders])
        self._parity = np.array([np.linalg.det(np.eye(3)[order]) for order in self._order]).round()
        self._ball_sign = np.array([[angle.sign for angle in of_joint] for of_joint in angles], dtype=float)
        self.ball_columns = np.array([[column[angle.name] for angle in of_joint] for of_joint in angles])
        self._ball_q = np.array([np.arange(place.q.stop - 4, place.q.stop) for _, place in found])
        self.ball_turns = np.array([np.arange(place.v.stop - 3, place.v.stop) for _, place in found])
        self._ball_v = np.take_along_axis(self.ball_turns, self._order, axis=1)
        self._winds = np.array([place.kind == "free" for _, place in found])

    def _place_dofs(self, column: dict[str, int]) -> None:
        """Hinges and universal joints: every angle is one dof, up to its sign."""
        rows: list[tuple[int, int, int, Angle]] = []
        for joint in self.joints:
            place = self.model.joints[joint.distal]
            if len(joint.order) < 3:
                rows += [
                    (place.q.start + i, place.v.start + i, column[a.name], a)
                    for i, a in enumerate(joint.angles)
                ]
        self._dof_q, self._dof_v, self._dof_column = (
            np.array([row[i] for row in rows], int) for i in range(3)
        )
        self._dof_sign = np.array([float(row[3].sign) for row in rows])

    def _place_root(self, column: dict[str, int]) -> None:
        """The root's translations: S (3, 3) takes its world position to the table's axes."""
        root = next(joint for joint in self.joints if joint.proximal == "world")
        place = self.model.joints[root.distal]
        self._root_columns = np.array([column[c.name] for c in root.translations])
        self._root_axes = np.array([c.sign * np.eye(3)[AXES[c.axis]] for c in root.translations])
        self._root_v = np.arange(place.v.start, place.v.start + 3)
        self._root_q = slice(place.q.start, place.q.start + 3)
        self._root_quaternion = slice(place.q.start + 3, place.q.start + 7)
        self.root_angles = read_only([column[angle.name] for angle in root.angles], dtype=int)
        self.root_turns = slice(place.v.start + 3, place.v.stop)

    @property
    def rate_layout(self) -> RateLayout:
        """Where :meth:`rate_matrix` is not zero, and what it is made of, in the body file's own axes."""
        return RateLayout(
            self._ball_q[:, 0],
            self._order,
            self._parity,
            self._ball_sign,
            np.vstack([self.ball_columns, self._root_columns]),
            np.vstack([self.ball_turns, self._root_v]),
            self._dof_column,
            self._dof_v,
            self._root_quaternion.start,
            self._root_axes,
        )

    def against(self, heading_rad: Array, q: Array) -> Array:
        """Configurations as seen from axes that are turned about the vertical; positions stay in the world's axes.

        Only the root's orientation changes. Angles of the result are those against the turned axes; with them,
        :meth:`rate_matrices` and :meth:`moments` of ``q`` itself belong to these angles.

        Args:
            heading_rad: (T,) angle by which the axes are turned, anticlockwise from above, rad.
            q: (T, nq) configurations.
        """
        q = self._checked("q", q, self.model.nq).copy()
        x, y, z, w = q[:, self._root_quaternion].T
        sine, cosine = np.sin(-0.5 * heading_rad), np.cos(0.5 * heading_rad)
        turned = (cosine * x - sine * y, cosine * y + sine * x, cosine * z + sine * w, cosine * w - sine * z)
        q[:, self._root_quaternion] = np.column_stack(turned)
        return q

    def vertical(self, q: Array) -> Array:
        """(T, 3) the world's vertical in the root's own axes, for configurations (T, nq)."""
        return self._root_rotation(self._checked("q", q, self.model.nq))[:, 2]

    def value(self, name: str, q: Array) -> float:
        """One coordinate at one configuration.

        Args:
            name: Name of the coordinate, e.g. ``"knee_angle_r"``; all are in :attr:`names`.
            q: (nq,) configuration.

        Returns:
            Rad; m for a translation of the pelvis.

        Raises:
            UnknownName: The body has no such coordinate.
        """
        return float(self.angles(np.asarray(q)[None])[0, self._column(name)])

    def jacobian(self, name: str, q: Array) -> Array:
        """(nv,) derivative of :meth:`value` in the tangent space of q (nq,); very large at a singularity."""
        return np.asarray(self.rate_matrix(q)[self._column(name)])

    def rate(self, name: str, q: Array, v: Array) -> float:
        """Rate of :meth:`value`, rad/s; m/s for a translation.

        Args:
            name: Name of the coordinate.
            q: (nq,) configuration.
            v: (nv,) velocity.
        """
        return float(self.jacobian(name, q) @ v)

    def _column(self, name: str) -> int:
        if name not in self.names:
            raise UnknownName("clinical coordinate", name, self.names)
        return self.names.index(name)

    def angles(self, q: Array, start: Array | None = None) -> Array:
        """Coordinates of a motion, continuous in time (see :func:`mbkf.numerics.cardan.follow`).

        Args:
            q: (T, nq) configurations; NaN frames give NaN.
            start: (A,) coordinates of the frame before, to continue a stream frame by frame.

        Returns:
            (T, A) rad, and m for translations.

        Raises:
            ShapeError: q is not (T, nq).
        """
        q = self._checked("q", q, self.model.nq)
        coordinates = np.empty((len(q), len(self.names)))
        R = quaternion_matrices(q[:, self._ball_q])
        for n, axes in self._axes:
            R[:, n] = axes.rotations(R[:, n])
        joints = np.arange(len(self._order))[:, None, None]
        R_ijk = R[:, joints, self._order[:, :, None], self._order[:, None, :]]
        before = None if start is None else self._ball_sign * np.asarray(start)[self.ball_columns]
        cardan = follow(cardan_angles(R_ijk, self._parity), self._winds, before)
        coordinates[:, self.ball_columns] = self._ball_sign * cardan
        coordinates[:, self._dof_column] = self._dof_sign * q[:, self._dof_q]
        coordinates[:, self._root_columns] = q[:, self._root_q] @ self._root_axes.T
        return coordinates

    def singular(self, angles: Array) -> BoolArray:
        """(T, A) True for all angles of a joint within 10° of its singularity (poorly determined there).

        Args:
            angles: (T, A) coordinates as :meth:`angles` gives them.
        """
        angles = self._checked("angles", angles, len(self.names))
        flags = np.zeros(angles.shape, dtype=bool)
        flags[:, self.ball_columns] = near_singularity(self._cardan(angles))[..., None]
        return flags

    def rate_matrix(self, q: Array, angles: Array | None = None) -> Array:
        """E (A, nv) of θ̇ = E v at one configuration q (nq,); see :meth:`rate_matrices`."""
        return self.rate_matrices(np.asarray(q)[None], None if angles is None else np.asarray(angles)[None])[
            0
        ]

    def rate_matrices(self, q: Array, angles: Array | None = None) -> Array:
        """Matrices that take the tangent velocity to the rates of the coordinates.

        Args:
            q: (T, nq) configurations.
            angles: (T, A) their coordinates; computed from q as one motion when None. Beyond a singularity
                two sets of angles describe one posture, and the rates must belong to the set that is shown.

        Returns:
            (T, A, nv) E of θ̇ = E v; very large at a singularity (see :meth:`singular`).
        """
        q, angles = self._with_angles(q, angles)
        E = np.zeros((len(q), len(self.names), self.model.nv))
        blocks = self._rate_blocks(q, angles)
        E[:, self.ball_columns[:, :, None], self._ball_v[:, None, :]] = blocks
        E[:, self._dof_column, self._dof_v] = self._dof_sign
        E[:, self._root_columns[:, None], self._root_v] = self._root_axes @ self._root_rotation(q)
        return E

    def ball_spread(self, q: Array, angles: Array, covariance: Array) -> Array:
        """Standard deviations of the angles of joints with three of them; NaN for other coordinates.

        Args:
            q: (T, nq) configurations.
            angles: (T, A) their coordinates.
            covariance: (T, n, 3, 3) covariances of these joints' rotations in their distal segments' axes, in the order
                of the model's joints, rad².
        """
        E = self._rate_blocks(
            self._checked("q", q, self.model.nq), self._checked("angles", angles, len(self.names))
        )
        joints = np.arange(len(self._order))[:, None, None]
        P = covariance[:, joints, self._order[:, :, None], self._order[:, None, :]]
        spread = np.full(angles.shape, np.nan)
        spread[:, self.ball_columns] = np.sqrt(np.maximum(np.einsum("tnai,tnij,tnaj->tna", E, P, E), 0.0))
        return spread

    def ball_rates(self, q: Array, angles: Array) -> Array:
        """(T, n, 3, 3) rates of the angles :attr:`ball_columns` per angular velocity about their distal segment's axes.

        Args:
            q: (T, nq) configurations.
            angles: (T, A) their coordinates.
        """
        order = np.argsort(self._order, axis=1)[None, :, None, :]
        return np.take_along_axis(self._rate_blocks(q, angles), order, axis=3)

    def moments(self, q: Array, tau: Array, angles: Array | None = None) -> Array:
        """Generalised moments conjugate to the coordinates, m = Bᵀ τ: power m·θ̇ equals τ·v in every joint.

        Args:
            q: (T, nq) configurations.
            tau: (…, T, nv) generalised forces in the tangent space.
            angles: (T, A) coordinates, as for :meth:`rate_matrices`.

        Returns:
            (…, T, A) N m, and N for translations; regular at singularities.

        Raises:
            InvalidInput: The angles are read in other axes than the body's own.
        """
        q, angles = self._with_angles(q, angles)
        return self._conjugate(q, np.asarray(tau, dtype=float), angles, 1)

    def moments_sd(self, q: Array, tau_sd: Array, angles: Array | None = None) -> Array:
        """(…, T, A) standard deviations √Σ B² sd² of the moments, for independent forces.

        Args:
            q: (T, nq) configurations.
            tau_sd: (…, T, nv) standard deviations of the generalised forces.
            angles: (T, A) coordinates, as for :meth:`rate_matrices`.
        """
        q, angles = self._with_angles(q, angles)
        return np.asarray(np.sqrt(self._conjugate(q, np.square(tau_sd), angles, 2)))

    def _conjugate(self, q: Array, forces: Array, angles: Array, power: int) -> Array:
        """(…, T, A) sums of forces (…, T, nv) by the elements of Bᵀ to a power."""
        if self._axes:
            raise InvalidInput("moments belong to the angles in the body's own axes")
        if forces.shape[-2:] != (len(q), self.model.nv):
            name = "tau" if power == 1 else "tau_sd"
            raise ShapeError(name, f"(…, {len(q)}, {self.model.nv})", forces.shape)
        B = velocity_map(self._cardan(angles), self._parity) ** power
        of_root = (self._root_axes @ self._root_rotation(q)) ** power
        found = np.empty((*forces.shape[:-1], len(self.names)))
        balls = np.einsum("tnij,...tni->...tnj", B, forces[..., self._ball_v])
        found[..., self.ball_columns] = self._ball_sign**power * balls
        found[..., self._dof_column] = self._dof_sign**power * forces[..., self._dof_v]
        found[..., self._root_columns] = np.einsum("tij,...tj->...ti", of_root, forces[..., self._root_v])
        return found

    def _rate_blocks(self, q: Array, angles: Array) -> Array:
        """(T, n, 3, 3) rates of a ball's angles per angular velocity about the axes of its order."""
        blocks = np.asarray(self._ball_sign[:, :, None] * rate_map(self._cardan(angles), self._parity))
        for n, axes in self._axes:
            order = self._order[n]
            turning = axes.velocities(quaternion_matrices(q[:, self._ball_q[n]]))
            blocks[:, n] = blocks[:, n] @ turning[:, order[:, None], order[None, :]]
        return blocks

    def _cardan(self, angles: Array) -> Array:
        return self._ball_sign * angles[:, self.ball_columns]

    def _root_rotation(self, q: Array) -> Array:
        return quaternion_matrices(q[:, self._root_quaternion])

    def _with_angles(self, q: Array, angles: Array | None) -> tuple[Array, Array]:
        q = self._checked("q", q, self.model.nq)
        angles = self.angles(q) if angles is None else self._checked("angles", angles, len(self.names))
        if len(angles) != len(q):
            raise ShapeError("angles", f"({len(q)}, {len(self.names)})", angles.shape)
        return q, angles

    @staticmethod
    def _checked(name: str, values: Array, width: int) -> Array:
        values = np.asarray(values, dtype=float)
        if values.ndim != 2 or values.shape[1] != width:
            raise ShapeError(name, f"(T, {width})", values.shape)
        return values
