"""Which slice of a filter's tangent state holds what: positions, velocities, and whatever plant and blocks add."""

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

UNSEEN_MOMENT = "unseen moment"
"""Name of the slice of the moment of what no instrument shows: N m about the root's origin, in its axes."""


class ExtraState(NamedTuple):
    """States that a block adds: a bias, a wrench at a chair, a length. They are random walks.

    Attributes:
        name: Name of its slice in the layout.
        start: (k,) mean before the first reading.
        start_sd: (k,) standard deviation of that.
        walk_sd: (k,) standard deviation of what a second adds, unit/√s.
    """

    name: str
    start: Array
    start_sd: Array
    walk_sd: Array


@dataclass(frozen=True)
class Layout:
    """Named slices of a tangent state of ``size`` components, in order and without gaps.

    A slice may also name the end of another (:meth:`with_last`).

    Attributes:
        nv: Dofs of the body.
        slices: Slice of each part by its name.
        size: Components in all, N.
        extras: What blocks have added, the last slices.
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

    def with_last(self, name: str, size: int) -> Layout:
        """The layout with a name of their own for its last ``size`` components."""
        return Layout(
            self.nv, {**self.slices, name: slice(self.size - size, self.size)}, self.size, self.extras
        )

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
    def wrench(self) -> slice:
        """Wrenches of right and left foot, 12."""
        return self.slices[WRENCH]

    def extra_index(self, name: str) -> slice:
        """Where a part added by a block lies in the vector of all such parts (``state.extra``)."""
        first = self.size - sum(len(extra.start) for extra in self.extras)
        own = self[name]
        return slice(own.start - first, own.stop - first)

    def start(self) -> tuple[Array, Array]:
        """Mean (m,) and standard deviation (m,) of all added states before the first reading."""
        return _joined([e.start for e in self.extras]), _joined([e.start_sd for e in self.extras])

    def walk_variance(self, dt_s: float) -> Array:
        """(m,) variance that a time step adds to the added states."""
        return _joined([e.walk_sd for e in self.extras]) ** 2 * dt_s


def _joined(parts: Sequence[Array]) -> Array:
    return np.concatenate([np.asarray(part, dtype=float) for part in parts]) if parts else np.zeros(0)
