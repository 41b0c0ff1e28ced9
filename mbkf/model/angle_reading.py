"""Conventions of joint angles: constant anatomical axes on the segments, and the order of the rotations.

A segment's frame is the body file's. A convention turns it: A_p and A_d are the anatomical axes of a joint's proximal
and distal segment, in those segments' frames, and the angles are those of A_pᵀ R A_d with R the joint's rotation.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from mbkf.conventions import Array
from mbkf.numerics.cardan import cardan_angles, rate_map, velocity_map

LINE_ORDER = np.array([1, 2, 0])
"""Of the angles of a segment that is known by a line only: about y, about z, and about the line itself (x)."""


@dataclass(frozen=True)
class Line:
    """A distal segment of which only a line is read; its turn about the line follows the proximal segment.

    With U = G_pᵀ R G_d = R_y(a) R_z(b) R_x(c), c is taken as 0. The feet of Plug-in Gait are read so: their frames
    are made of the line from ankle to forefoot and the flexion axis of the shank.

    Attributes:
        proximal, distal: (3, 3) G_p and G_d, in the segments' frames; x of G_d is the line, y of G_p what it follows.
    """

    proximal: Array
    distal: Array


@dataclass(frozen=True)
class JointAxes:
    """Anatomical axes of the two segments of a joint, in those segments' frames.

    Attributes:
        proximal, distal: (3, 3) rotations A_p and A_d; A_p of a root's joint is not used.
        order: Axes of the successive rotations, e.g. "yxz"; "" for those of the body file.
        line: The line, where only a line of the distal segment is read.
    """

    proximal: Array
    distal: Array
    order: str = ""
    line: Line | None = None

    def rotations(self, R: Array) -> Array:
        """A_pᵀ R A_d of joint rotations R (…, 3, 3)."""
        if self.line is None:
            return self.proximal.T @ R @ self.distal
        from_line, to_line = self.proximal.T @ self.line.proximal, self.line.distal.T @ self.distal
        a, b, _ = np.moveaxis(self._line_angles(R), -1, 0)
        return from_line @ _about_y_and_z(a, b) @ to_line

    def velocities(self, R: Array) -> Array:
        """W (…, 3, 3): angular velocity in the anatomical axes per one in the distal segment's frame.

        Args:
            R: (…, 3, 3) joint rotations.
        """
        if self.line is None:
            return np.broadcast_to(self.distal.T, R.shape)
        angles = self._line_angles(R)
        straight = angles * np.array([1.0, 1.0, 0.0])
        to_rates = rate_map(angles, np.array(1.0))
        kept = velocity_map(straight, np.array(1.0)) * np.array([1.0, 1.0, 0.0])
        in_order = np.eye(3)[LINE_ORDER]
        turning = in_order.T @ kept @ to_rates @ in_order
        return self.distal.T @ self.line.distal @ turning @ self.line.distal.T

    def _line_angles(self, R: Array) -> Array:
        """(…, 3) angles a, b, c of the line."""
        assert self.line is not None
        U = self.line.proximal.T @ R @ self.line.distal
        return cardan_angles(U[..., LINE_ORDER[:, None], LINE_ORDER[None, :]], np.array(1.0))


@dataclass(frozen=True)
class AngleReading:
    """A convention of joint angles.

    Attributes:
        name: "model" for the body file's own axes, or the convention's name.
        joints: Axes by the name of the joint; others are read in the body file's axes.
        trunk: (3, 3) axes of the trunk in its segment's frame, for its attitude in the world; None: that frame's.
    """

    name: str = "model"
    joints: Mapping[str, JointAxes] = field(default_factory=dict)
    trunk: Array | None = None


def _about_y_and_z(a: Array, b: Array) -> Array:
    """(…, 3, 3) R_y(a) R_z(b)."""
    zero, cos_a, sin_a, cos_b, sin_b = np.zeros_like(a), np.cos(a), np.sin(a), np.cos(b), np.sin(b)
    rows = (
        (cos_a * cos_b, -cos_a * sin_b, sin_a),
        (sin_b, cos_b, zero),
        (-sin_a * cos_b, sin_a * sin_b, cos_a),
    )
    return np.stack([np.stack(row, -1) for row in rows], -2)
