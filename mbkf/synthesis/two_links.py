"""A limb of two links, thigh and shank or upper arm and forearm, that reaches from its near to its far end.

With the middle joint at u in the upper link's frame and the far end at w beyond it, in axes that turn by the flexion θ
about y, the distance s of the ends gives the flexion:

    s² = |u|² + |w|² + 2 u_y w_y + 2 ρ cos(θ − φ),   (ρ cos φ, ρ sin φ) = (u_x w_x + u_z w_z, u_x w_z − u_z w_x),

the law of cosines, where joints need not lie on the links' z axes. The upper link's rotation is F Lᵀ: F the frame of
the span between the ends in the world, L the frame of the same span as the upper link sees it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.synthesis import dual_numbers
from mbkf.synthesis.dual_numbers import Dual

STRAIGHT_RAD = np.deg2rad(2.5)
"""The middle joint never gets straighter than this; a limb asked to reach further stays short."""


MIDDLE = np.array([0.0, 1.0, 0.0])
"""Axis of the middle joint in the upper link's frame."""


class TwoLinks:
    """Links that hang down, about along −z of their frames; the middle joint is Ry(flexion) Rx(x) Rz(z), x and z small.

    Attributes:
        ends: (3,) far end of the upper and of the lower link, in its own frame, m.
        lengths: Of both links, m.
        small: (T, 3, 3) Rx(x) Rz(z) of the middle joint.
        bends: Sign of flexion about the middle joint's y axis: 1 knee, −1 elbow.
    """

    def __init__(self, ends: tuple[Array, Array], x: Dual, z: Dual, bends: float = 1.0) -> None:
        """Links whose small rotations are given.

        Args:
            ends: (3,) far end of the upper and of the lower link, in its own frame, m.
            x: (T,) rotation of the middle joint about x, rad.
            z: (T,) its rotation about z, rad.
            bends: Sign of flexion about y.
        """
        upper, lower = self.ends = ends
        self.lengths = float(np.linalg.norm(upper)), float(np.linalg.norm(lower))
        self.bends = bends
        self.small = dual_numbers.rotation(0, x) @ dual_numbers.rotation(2, z)
        self._tip = self.small.apply(lower)
        tip_x, tip_y, tip_z = (self._tip[..., k] for k in range(3))
        along, beside = tip_x * upper[0] + tip_z * upper[2], tip_z * upper[0] - tip_x * upper[2]
        size = dual_numbers.sqrt(along * along + beside * beside)
        self._phase = along / size, beside / size
        self._by_square = 1.0 / (size * 2.0)
        self._fixed = tip_y * (2.0 * upper[1]) + float(upper @ upper + lower @ lower)

    def bend(self, span: Dual, across: Dual) -> Bend:
        """The limb with its ends ``span`` apart.

        Args:
            span: (T, 3) from the near to the far end, m.
            across: (T, 3) near which the axis of the middle joint lies.
        """
        square = dual_numbers.dot(span, span)
        cosine = (square - self._fixed) * self._by_square
        limit = float(np.cos(STRAIGHT_RAD))
        free = np.abs(cosine.value) < limit
        if not free.all():
            cosine = dual_numbers.where(free, cosine, Dual.constant(np.clip(cosine.value, -limit, limit)))
        sine = self.bends * np.sqrt(1.0 - cosine.value**2)
        beyond = cosine.chain(sine, -cosine.value / sine, -(sine**-3))
        c, s = self._phase
        bent = cosine * c - beyond * s, beyond * c + cosine * s
        turned = dual_numbers.turned(1, *bent)
        local = turned.apply(self._tip) + self.ends[0]
        length = np.sqrt(square.value)
        rate = np.where(free, -2.0 * length * self._by_square.value / sine, 0.0)
        flexion = np.arctan2(self.bends * bent[1].value, bent[0].value)
        outer, inner = Frame(span, across), Frame(local, MIDDLE)
        return Bend(self, flexion, turned, outer, inner, length / sum(self.lengths), rate)


class Frame:
    """Right-handed frame whose first axis is ``along`` and whose second is nearest to ``across``.

    Attributes:
        along, across: (T, 3) vectors that make it, ``across`` also a constant (3,).
        axes: (T, 3, 3) its three axes in columns.
    """

    def __init__(self, along: Dual, across: Dual | Array) -> None:
        self.along, self.across = along, across
        first = dual_numbers.unit(along)
        third = dual_numbers.unit(dual_numbers.cross(first, across))
        self.axes = dual_numbers.stack([first, dual_numbers.cross(third, first), third])

    def coordinates(self, vector: Dual) -> Dual:
        """(T, 3) coordinates of a (T, 3) vector in the frame."""
        return self.axes.transposed().apply(vector)

    def turning(self, fixed: Array) -> Array:
        """(2, T, 3, 3) derivatives of a vector fixed in the frame by ``along`` and ``across``, in its coordinates.

        Moved sideways, ``along`` turns the frame about the two other axes, and about itself as far as ``across``
        leans to it; moved along the third axis, ``across`` turns it about the first.

        Args:
            fixed: (T, 3) coordinates of the vector.
        """
        x, y, z = fixed.T
        across = self.across.value if isinstance(self.across, Dual) else self.across
        along, beside, _ = np.einsum("...ij,...i->j...", self.axes.value, across)
        lean, length = along / beside, np.sqrt(np.einsum("ti,ti->t", self.along.value, self.along.value))
        by_along, by_across = both = np.zeros((2, 3, 3, len(x)))
        by_along[0, 1], by_along[1, 1] = -y, x
        by_along[0, 2], by_along[1, 2], by_along[2, 2] = -z, lean * z, x - lean * y
        by_across[1, 2], by_across[2, 2] = -z / beside, y / beside
        by_along /= length
        return both.transpose(0, 3, 1, 2)


@dataclass(frozen=True)
class Bend:
    """One posture of two links.

    Attributes:
        links: The links.
        flexion: (T,) of the middle joint, rad.
        turned: (T, 3, 3) rotation by the flexion.
        outer: Frame of the span in the world.
        inner: Frame of the span in the upper link's frame.
        used: (T,) distance of the ends over the length of the limb.
        flexion_by_distance: (T,) derivative of the flexion by the distance of the ends, rad/m.
    """

    links: TwoLinks
    flexion: Array
    turned: Dual
    outer: Frame
    inner: Frame
    used: Array
    flexion_by_distance: Array

    def rotations(self) -> tuple[Dual, Dual]:
        """(T, 3, 3) world rotations of the upper and the lower link."""
        upper = self.outer.axes @ self.inner.axes.transposed()
        return upper, upper @ (self.turned @ self.links.small)

    def carried(self, upper: Array, lower: Dual) -> tuple[Dual, Array]:
        """(T, 3) sum of a vector of each link, in the world, and its (2, T, 3, 3) derivatives by span and ``across``.

        Args:
            upper: (3,) in the upper link's frame.
            lower: (T, 3) in the lower link's frame, turned by ``links.small``.
        """
        turned = self.turned.apply(lower)
        seen = self.inner.coordinates(turned + upper)
        inner, outer = self.inner.axes.value, self.outer.axes.value
        middle = self.inner.along.value - self.links.ends[0]
        swung, moved = (
            np.einsum("tji,jt->ti", inner, np.array([x[:, 2], 0.0 * x[:, 1], -x[:, 0]]))
            for x in (turned.value, middle)
        )
        by_flexion = swung - np.einsum("tij,tj->ti", self.inner.turning(seen.value)[0], moved)
        by_ends = self.outer.turning(seen.value)
        by_ends[0, :, :, 0] += by_flexion * self.flexion_by_distance[:, None]
        by_ends = np.einsum("tij,ntjk->ntik", outer, np.einsum("ntij,tkj->ntik", by_ends, outer))
        return self.outer.axes.apply(seen), by_ends


@dataclass(frozen=True)
class Limb:
    """Two links that hang on the pelvis's origin or the torso and reach for something.

    Attributes:
        links: The links.
        near: (T, 3) near end relative to the pelvis's origin, m.
        span: (T, 3) near end in the world to the (T, 3) way from it to the far end, m.
        across: (T, 3) near end in the world to the (T, 3) direction near which the middle joint's axis lies.
        mass: Of both links, kg.
        upper: (3,) first moment of mass of the upper link, with the lower one at its far end, kg m.
        lower: (T, 3) first moment of mass of the lower link, turned by ``links.small``, kg m.
        carried_kg: Mass that goes with the far end.
        held: (T,) part of the near end's way that the span loses: 1 with the far end in place, 0 where it hangs.
        swing: (T, 3) s where a step d of the near end changes ``across`` by d × s; None: ``across`` does not change.
    """

    links: TwoLinks
    near: Dual
    span: Callable[[Dual], Dual]
    across: Callable[[Dual], Dual]
    mass: float
    upper: Array
    lower: Dual
    carried_kg: float
    held: Array
    swing: Array | None = None

    def moment_by_pelvis(self, pelvis: Dual) -> tuple[Dual, Array]:
        """(T, 3) first moment of mass, kg m, and its (T, 3, 3) derivative by the place of the pelvis, kg.

        Args:
            pelvis: (T, 3) the pelvis's origin, m.
        """
        near = pelvis + self.near
        span = self.span(near)
        links, (by_span, by_across) = self.links.bend(span, self.across(near)).carried(self.upper, self.lower)
        moment = near * self.mass + links + (near + span) * self.carried_kg
        by_pelvis = -self.held[:, None, None] * by_span
        by_pelvis[:, range(3), range(3)] += (self.mass + self.carried_kg * (1.0 - self.held))[:, None]
        if self.swing is not None:
            by_pelvis += np.cross(self.swing[:, None], by_across)
        return moment, by_pelvis
