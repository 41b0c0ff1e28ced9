"""Names of the parts of a filter's tangent state, and where they lie; sizes of the state are stated here alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput, UnknownName

WRENCH = "wrench"
"""Name of the slice of the feet's wrenches, right and left: force N, moment N m about the world's origin."""

SUPPORT = "support"
"""Name of the slice of the wrench on all other parts: force N, moment N m about the world's origin."""

FOOT, FEET = 6, 12
"""Components of a foot's wrench, and of both feet's."""

UNSEEN_MOMENT = "unseen moment"
"""Name of the slice of the moment of what no instrument shows: N m about the root's origin, in its axes."""


ROOT_RESIDUAL = "root residual"
"""Name of the slice of the load at the root that nothing explains: force N, moment N m about the root's origin, in its
axes."""


class ExtraState(NamedTuple):
    """States that a block adds: a bias, a wrench at a chair, a length. They are random walks.

    Attributes:
        name: Name of its slice in the layout.
        start: (k,) mean before the first reading.
        start_sd: (k,) standard deviation of that.
        walk_sd: (k,) standard deviation of the change in a second, unit/√s.
    """

    name: str
    start: Array
    start_sd: Array
    walk_sd: Array


@dataclass(frozen=True)
class Layout:
    """Named slices of a tangent state of ``size`` components, in order and without gaps.

    Attributes:
        nv: Dofs of the body.
        slices: Slice of each part by its name.
        size: Components in all, N.
        extras: States that blocks add, the last slices.
    """

    nv: int
    slices: dict[str, slice]
    size: int
    extras: tuple[ExtraState, ...] = field(default=())

    @classmethod
    def of(cls, nv: int, **sizes: int) -> Layout:
        """A layout of parts with these sizes, in this order; ``nv`` is the number of the body's dofs."""
        slices, first = {}, 0
        for name, size in sizes.items():
            slices[name] = slice(first, first + size)
            first += size
        return cls(nv, slices, first)

    @classmethod
    def kinematic(cls, nv: int) -> Layout:
        """State of the kinematic filter: q, v."""
        return cls.of(nv, q=nv, v=nv)

    @classmethod
    def dynamic(cls, nv: int, extras: Sequence[ExtraState] = ()) -> Layout:
        """State of the dynamic filter: q, v, a, wrenches of the feet, and states that blocks add."""
        return cls.of(nv, q=nv, v=nv, a=nv, **{WRENCH: FEET}).with_extras(extras)

    @classmethod
    def forced(cls, nv: int, nu: int, wrenches: bool = False) -> Layout:
        """State of the torque filter: q, v, u.

        Args:
            nv: Dofs of the body.
            nu: Forces u.
            wrenches: The last forces are the wrenches of the feet.
        """
        layout = cls.of(nv, q=nv, v=nv, u=nu)
        if wrenches:
            layout.slices[WRENCH] = slice(layout.size - FEET, layout.size)
        return layout

    def with_extras(self, extras: Sequence[ExtraState]) -> Layout:
        """The layout with further states at its end.

        Raises:
            InvalidInput: Two parts have the same name.
        """
        slices, first = dict(self.slices), self.size
        for extra in extras:
            if extra.name in slices:
                raise InvalidInput(f"two blocks add a state '{extra.name}'; give each its own name")
            slices[extra.name] = slice(first, first + len(extra.start))
            first += len(extra.start)
        return Layout(self.nv, slices, first, (*self.extras, *extras))

    def __getitem__(self, name: str) -> slice:
        """The slice of a part.

        Raises:
            UnknownName: The state has no such part.
        """
        if name not in self.slices:
            raise UnknownName("part of the state", name, self.slices)
        return self.slices[name]

    def __contains__(self, name: str) -> bool:
        return name in self.slices

    @property
    def q(self) -> slice:
        """Positions, nv."""
        return self.slices["q"]

    @property
    def v(self) -> slice:
        """Velocities, nv."""
        return self.slices["v"]

    @property
    def a(self) -> slice:
        """Accelerations, nv."""
        return self.slices["a"]

    @property
    def motion(self) -> slice:
        """Positions and velocities, 2 nv."""
        return slice(self.q.start, self.v.stop)

    @property
    def wrench(self) -> slice:
        """Wrenches of right and left foot, 12."""
        return self.slices[WRENCH]

    @property
    def feet(self) -> tuple[slice, slice]:
        """Wrench of the right foot, and of the left one, 6 each."""
        first = self.wrench.start
        return slice(first, first + FOOT), slice(first + FOOT, first + FEET)

    @property
    def extra(self) -> slice:
        """States that blocks add."""
        return slice(self.size - sum(len(extra.start) for extra in self.extras), self.size)

    def extra_index(self, name: str) -> slice:
        """Where a part added by a block lies in the vector of all such parts (``state.extra``)."""
        first, own = self.extra.start, self[name]
        return slice(own.start - first, own.stop - first)

    def start(self) -> tuple[Array, Array]:
        """Mean (m,) and standard deviation (m,) of all added states before the first reading."""
        return _joined([e.start for e in self.extras]), _joined([e.start_sd for e in self.extras])

    def walk_variance(self, dt_s: float) -> Array:
        """(m,) variance that a time step adds to the added states."""
        return _joined([e.walk_sd for e in self.extras]) ** 2 * dt_s


def parted(vector: Array, *like: Array) -> list[Array]:
    """Views of a vector's consecutive parts, each as long as its pattern."""
    parts, first = [], 0
    for pattern in like:
        parts.append(vector[first : first + len(pattern)])
        first += len(pattern)
    return parts


def _joined(parts: Sequence[Array]) -> Array:
    return np.concatenate([np.asarray(part, dtype=float) for part in parts]) if parts else np.zeros(0)
