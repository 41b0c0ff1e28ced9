"""A limb of two links, thigh and shank or upper arm and forearm, that reaches from its near to its far end.

The distance of the ends gives the flexion by the law of cosines. The upper link's rotation is F Lᵀ: F the frame of the
span between the ends in the world, L the frame of the same span as the upper link sees it.
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


class TwoLinks:
    """Links along −z of their frames; the middle joint is Ry(flexion) Rx(x) Rz(z) with small x and z.

    Attributes:
        lengths: Of the upper and the lower link, m.
        small: (T, 3, 3) Rx(x) Rz(z) of the middle joint.
        bends: Sign of flexion about the middle joint's y axis: 1 knee, −1 elbow.
    """

    def __init__(self, lengths: tuple[float, float], x: Dual, z: Dual, bends: float = 1.0) -> None:
        """Links whose small rotations are given.

        Args:
            lengths: Of the upper and the lower link, m.
            x: (T,) rotation of the middle joint about x, rad.
            z: (T,) its rotation about z, rad.
            bends: Sign of flexion about y.
        """
        upper, lower = self.lengths = lengths
        self.bends = bends
        self.small = dual_numbers.rotation(0, x) @ dual_numbers.rotation(2, z)
        self._twice = dual_numbers.cos(x) * (2 * upper * lower)
        self._tip = self.small.apply(np.array([0.0, 0.0, -lower]))

    def bend(self, span: Dual, across: Dual) -> Bend:
        """The limb with its ends ``span`` apart.

        Args:
            span: (T, 3) from the near to the far end, m.
            across: (T, 3) near which the axis of the middle joint lies.
        """
        upper, lower = self.lengths
        square = dual_numbers.dot(span, span)
        cosine = (square - (upper**2 + lower**2)) / self._twice
        limit = float(np.cos(STRAIGHT_RAD))
        free = np.abs(cosine.value) < limit
        cosine = dual_numbers.where(free, cosine, Dual.constant(np.clip(cosine.value, -limit, limit)))
        sine = dual_numbers.sqrt(1.0 - cosine * cosine) * self.bends
        local = _about_y(cosine, sine, self._tip) + np.array([0.0, 0.0, -upper])
        middle = Dual.constant(np.zeros_like(span.value) + np.array([0.0, 1.0, 0.0]))
        length = np.sqrt(square.value)
        rate = np.where(free, -2.0 * length / (sine.value * self._twice.value), 0.0)
        used = length / (upper + lower)
        return Bend(self, cosine, sine, Frame(span, across), Frame(local, middle), used, rate)


class Frame:
    """Right-handed frame whose first axis is ``along`` and whose second is nearest to ``across``.

    Attributes:
        along, across: (T, 3) vectors that make it.
        axes: Its three axes (T, 3).
    """

    def __init__(self, along: Dual, across: Dual) -> None:
        self.along, self.across = along, across
        first = dual_numbers.unit(along)
        third = dual_numbers.unit(dual_numbers.cross(first, across))
        self.axes = first, dual_numbers.cross(third, first), third

    def coordinates(self, vector: Dual) -> tuple[Dual, ...]:
        """Coordinates (T,) of a (T, 3) vector in the frame."""
        return tuple(dual_numbers.dot(vector, axis) for axis in self.axes)

    def value(self) -> Array:
        """(T, 3, 3) matrix of the axes in columns."""
        return np.stack([axis.value.T for axis in self.axes]).T

    def turning_by_along(self, fixed: Array) -> Array:
        """(T, 3, 3) derivative of a vector fixed in the frame by ``along``, both in the frame's coordinates.

        Moved sideways, ``along`` turns the frame about the two other axes, and about itself as far as ``across``
        leans to it.

        Args:
            fixed: (3, T) coordinates of the vector.
        """
        (first, second, third), none = fixed, np.zeros_like(fixed[0])
        u, v, _ = (axis.value for axis in self.axes)
        lean = (self.across.value * u).sum(axis=-1) / (self.across.value * v).sum(axis=-1)
        columns = [
            [none, none, none],
            [-second, first, none],
            [-third, lean * third, first - lean * second],
        ]
        length = np.sqrt((self.along.value**2).sum(axis=-1))
        return (np.array(columns) / length).T


@dataclass(frozen=True)
class Bend:
    """One posture of two links.

    Attributes:
        links: The links.
        cosine, sine: (T,) of the flexion, with its sign.
        outer: Frame of the span in the world.
        inner: Frame of the span in the upper link's frame.
        used: (T,) distance of the ends over the length of the limb.
        flexion_by_distance: (T,) derivative of the flexion by the distance of the ends, rad/m.
    """

    links: TwoLinks
    cosine: Dual
    sine: Dual
    outer: Frame
    inner: Frame
    used: Array
    flexion_by_distance: Array

    @property
    def flexion(self) -> Array:
        """(T,) rad."""
        return np.asarray(np.arccos(self.cosine.value))

    def rotations(self) -> tuple[Dual, Dual]:
        """(T, 3, 3) world rotations of the upper and the lower link."""
        outer, inner = (dual_numbers.stack(frame.axes) for frame in (self.outer, self.inner))
        upper = outer @ inner.transposed()
        return upper, upper @ (dual_numbers.turned(1, self.cosine, self.sine) @ self.links.small)

    def carried_by_span(self, upper: Array, lower: Dual) -> tuple[Dual, Array]:
        """(T, 3) sum of a vector of each link, in the world, and its (T, 3, 3) derivative by the span of the ends.

        Args:
            upper: (3,) in the upper link's frame.
            lower: (T, 3) in the lower link's frame, turned by ``links.small``.
        """
        turned = _about_y(self.cosine, self.sine, lower)
        seen = self.inner.coordinates(turned + upper)
        parts = (axis * along[..., None] for axis, along in zip(self.outer.axes, seen, strict=True))
        carried = sum(parts, start=Dual.constant(np.zeros(3)))
        fixed = np.array([x.value for x in seen])
        inner, outer = self.inner.value(), self.outer.value()
        middle = self.inner.along.value + np.array([0.0, 0.0, self.links.lengths[0]])
        swung, moved = (
            np.einsum("tji,tj->ti", inner, np.column_stack([x[:, 2], 0.0 * x[:, 1], -x[:, 0]]))
            for x in (turned.value, middle)
        )
        by_flexion = swung - np.einsum("tij,tj->ti", self.inner.turning_by_along(fixed), moved)
        by_span = self.outer.turning_by_along(fixed)
        by_span[:, :, 0] += by_flexion * self.flexion_by_distance[:, None]
        return carried, outer @ by_span @ outer.transpose(0, 2, 1)


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

    def moment_by_pelvis(self, pelvis: Dual) -> tuple[Dual, Array]:
        """(T, 3) first moment of mass, kg m, and its (T, 3, 3) derivative by the place of the pelvis, kg.

        The derivative takes ``across`` as it is.

        Args:
            pelvis: (T, 3) the pelvis's origin, m.
        """
        near = pelvis + self.near
        span = self.span(near)
        links, by_span = self.links.bend(span, self.across(near)).carried_by_span(self.upper, self.lower)
        moment = near * self.mass + links + (near + span) * self.carried_kg
        own = self.mass + self.carried_kg * (1.0 - self.held)
        return moment, own[:, None, None] * np.eye(3) - self.held[:, None, None] * by_span


def _about_y(cosine: Dual, sine: Dual, vector: Dual) -> Dual:
    """(T, 3) vector turned about y by an angle whose (T,) cosine and sine are known."""
    x, y, z = (vector[..., k] for k in range(3))
    return dual_numbers.stack([cosine * x + sine * z, y, cosine * z - sine * x])
