"""Places and speeds of the parts of a body that may carry load besides its feet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body
from mbkf.model.description import Bearing
from mbkf.model.motion_frames import motion_frames
from mbkf.model.sides import mirrored


@dataclass(frozen=True)
class BearingPoints:
    """The parts at a configuration.

    Attributes:
        points_m: (B, 3) their middles in the world.
        speeds_m_s: (B,) speeds of the middles.
    """

    points_m: Array
    speeds_m_s: Array


class BearingParts:
    """The parts of a body that may carry load besides its feet, in the order of the body file.

    Attributes:
        model: The body.
        parts: The parts.
        joint_ids: Index of the joint that carries each one's segment.
        radii_m: (B,) from their middles to the skin.
        levers_m: (B,) largest distance of a part's centre of pressure from its middle.
        grips: True for a part at the end of a limb, which may hold something: a hand.
        seat: Place among them of the part on the root, which may sit; -1 without one.
        placed: (B,) True for a part whose place markers show: a hand is not where they show no forearm.
    """

    def __init__(self, model: Body, unobservable: BoolArray | None = None) -> None:
        """Finds the parts of a body.

        Args:
            model: The body.
            unobservable: (nv,) dofs that move no marker; None: markers show every dof.
        """
        self.model = model
        self.parts: tuple[Bearing, ...] = tuple(model.description.bearings.values())
        scales = [model.axis_scale(model.description.segment(one.segment)) for one in self.parts]
        size = np.array([float(by.mean()) for by in scales])
        self.joint_ids = [model.joint(one.segment).joint_id for one in self.parts]
        self._local = np.array([one.position_m * by for one, by in zip(self.parts, scales, strict=True)])
        self.radii_m = np.array([one.radius_m for one in self.parts]) * size
        self.levers_m = np.array([one.lever_m for one in self.parts]) * size
        self._moves = model.supports[self.joint_ids].astype(float)
        parents = {segment.parent for segment in model.description.segments}
        self.grips = [one.segment not in parents for one in self.parts]
        sits = [k for k, one in enumerate(self.parts) if one.segment == model.roles.root]
        self.seat = sits[0] if sits else -1
        self.placed = np.ones(len(self.parts), dtype=bool)
        if unobservable is not None:
            for k in np.flatnonzero(self.grips):
                before = model.description.segment(self.parts[k].segment).parent
                self.placed[k] = not unobservable[model.joint(before).v].all()

    def __len__(self) -> int:
        return len(self.parts)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parts."""
        return tuple(one.name for one in self.parts)

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """Right and left parts of the same kind."""
        at = {one.name: k for k, one in enumerate(self.parts)}
        both = [(at[name], at[mirrored(name)]) for name in at if mirrored(name) in at]
        return [(first, second) for first, second in both if first < second]

    def at(self, q: Array, v: Array) -> BearingPoints:
        """The parts at a configuration q (nq,) with velocity v (nv,)."""
        rotations, origins, jacobian = self.model.placements_and_jacobian(q)
        return self._moving(rotations[self.joint_ids], origins[self.joint_ids], jacobian, v)

    def course(self, q: Array, v: Array) -> BearingPoints:
        """The parts of T frames, points (T, B, 3) and speeds (T, B); NaN where a configuration is.

        Args:
            q: (T, nq) configurations.
            v: (T, nv) velocities.
        """
        frames, jacobians = motion_frames(self.model, q)
        parts = frames[:, self.joint_ids]
        return self._moving(parts[:, :, :3].swapaxes(2, 3), parts[:, :, 3], jacobians, v)

    def _moving(self, rotations: Array, origins: Array, jacobians: Array, v: Array) -> BearingPoints:
        """Points and speeds of one frame, or of many along a first axis.

        Args:
            rotations: (…, B, 3, 3) axes of the parts' segments.
            origins: (…, B, 3) their origins.
            jacobians: (…, 6, nv) spatial Jacobian of the body.
            v: (…, nv) velocity.
        """
        points = origins + (rotations @ self._local[:, :, None])[..., 0]
        twists = (self._moves * v[..., None, :]) @ np.swapaxes(jacobians, -1, -2)
        speeds = np.linalg.norm(twists[..., :3] + np.cross(twists[..., 3:], points), axis=-1)
        return BearingPoints(points, speeds)
