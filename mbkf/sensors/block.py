"""The protocol of blocks: instruments, physical laws and priors turn a frame into information on the state.

A filter has a state x with mean and covariance P⁻ before a frame. A block turns the frame's readings into a statement
about x, in one of two forms:

    Information   HᵀR⁻¹H and HᵀR⁻¹y of readings z = h(x) + r, r ~ N(0, R), on the first components of the state
    Rows          R^(-1/2) H and R^(-1/2) y of such readings, on any contiguous components

with innovation y = z − h(x⁻) and H = ∂h/∂x along the tangent space. The filter adds them up and updates once.
A user's block derives from :class:`Block` and needs ``linearise``; an instrument decides on its readings, too.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, NamedTuple, Protocol, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body
from mbkf.model.layout import ExtraState, Layout
from mbkf.numerics.kalman import Information
from mbkf.sensors.contact.records import ContactDecision

NO_DOFS = np.zeros(0, dtype=np.intp)
"""An empty list of dofs."""

NO_READINGS: Mapping[str, Array] = {}
"""Readings of a frame without user-defined instruments."""


class State(Protocol):
    """State of any filter: configuration q (nq,), velocity v (nv,), covariance P (N, N)."""

    @property
    def q(self) -> Array:
        """(nq,) configuration."""

    @property
    def v(self) -> Array:
        """(nv,) velocity."""

    @property
    def P(self) -> Array:  # noqa: N802
        """(N, N) covariance in the tangent space."""


class Frame(NamedTuple):
    """Readings of the instruments in a frame.

    Attributes:
        markers_m: (M, 3) positions in the world, NaN where missing.
        plates: (K, 6) force N and moment N m about the world's origin per plate; NaN where not recorded.
        imus: (S, 6) angular velocity rad/s and specific force m/s² per inertial sensor; None without sensors.
        readings: Of user-defined instruments, by a name that their block knows.
    """

    markers_m: Array
    plates: Array
    imus: Array | None = None
    readings: Mapping[str, Array] = NO_READINGS


NO_MARKERS = np.zeros(0, dtype=bool)
"""Flags of no markers."""


@dataclass(slots=True)
class Notes:
    """Findings on a frame that blocks share; complete when all of them have decided.

    Attributes:
        seen: (M,) markers seen.
        trusted: (M,) markers used: seen, and inside their gate.
        unmarked: Dofs of joints whose segment shows no used marker.
        unobserved: Unmarked dofs that no inertial sensor observes either.
        observed: True if enough instruments read for the body to count as tracked.
        lost: True if most markers lie far from the predicted body.
        squared_m2: (M,) squared length of the innovation of used markers, 0 of others; None without markers.
        lasting: Mean square of the markers' lasting errors over that of their assumed noise.
        imus: (S, 6) inertial readings that are used; None without any.
        contact: Contact of the feet; None without a block that decides it.
        coordinated: Dofs that the coordination prior predicts.
        supports: Parts besides the feet that carry load, by their place among the body's bearings.
    """

    # Arrays here are replaced, never written into, so that the defaults can be shared.
    seen: BoolArray = field(default_factory=lambda: NO_MARKERS)
    trusted: BoolArray = field(default_factory=lambda: NO_MARKERS)
    unmarked: NDArray[np.intp] = field(default_factory=lambda: NO_DOFS)
    unobserved: NDArray[np.intp] = field(default_factory=lambda: NO_DOFS)
    observed: bool = False
    lost: bool = False
    squared_m2: Array | None = None
    lasting: float = 1.0
    imus: Array | None = None
    contact: ContactDecision | None = None
    coordinated: NDArray[np.intp] = field(default_factory=lambda: NO_DOFS)
    supports: tuple[int, ...] = ()


class Rows(NamedTuple):
    """Whitened readings on some components of the state.

    Attributes:
        jacobian: (k, n) R^(-1/2) H.
        innovation: (k,) R^(-1/2) y.
        first: Component of the state of the first column.
        readings: Number of rows, the first ones, that are readings, which NIS and likelihood count; others are priors.
        vector: (n,) HᵀR⁻¹y of priors if the block rounds it less than the product does; None for the product.
    """

    jacobian: Array
    innovation: Array
    first: int = 0
    readings: int = 0
    vector: Array | None = None


class Channels(NamedTuple):
    """A frame's innovations by channel: readings whose spread is the same.

    Attributes:
        mean_square: (n,) mean of their squares; any finite number in a channel that did not read.
        readings: (n,) number of readings of each channel.
    """

    mean_square: Array
    readings: Array


Statement = Information | Rows | Sequence[Rows] | None
"""Statement of a block in a frame; None without one."""

StateT = TypeVar("StateT", bound=State)
PreparedT = TypeVar("PreparedT")
DecisionT = TypeVar("DecisionT")
MemoryT = TypeVar("MemoryT")


class OperatingPoint(NamedTuple, Generic[StateT, PreparedT]):
    """A state at which a block is linearised, with the block's own preparation there, made without the frame."""

    state: StateT
    prepared: PreparedT


class Block(ABC, Generic[StateT, PreparedT, DecisionT, MemoryT]):
    """An instrument, a law or a prior: a decision on a frame's readings, and their information on the state.

    The order of calls in a frame is ``prepare`` (before the frame comes), ``decide``, ``inflate``, ``linearise``,
    ``review``, ``remember``. A smoother calls ``prepare`` and ``linearise`` again at another state.

    Attributes:
        prior: True for a prior, False for an instrument or a law; priors count in no NIS.
        kind: Kind of its readings, one of :data:`mbkf.conventions.READING_KINDS`.
        quantities: Number of quantities with a spread of their own between which its readings alternate in threes, as
            force and moment.
    """

    prior: bool = False
    kind: str = "other"
    quantities: int = 1

    def states(self) -> Sequence[ExtraState]:
        """States that the block adds to the filter's."""
        return ()

    def bind(self, layout: Layout, body: Body) -> None:
        """Called once by the filter; the block keeps both, as ``self.layout`` and ``self.body``.

        Args:
            layout: Slices of the filter's tangent state, added states among them.
            body: The body that moves.
        """
        self.layout, self.body = layout, body

    def begin(self) -> MemoryT:
        """Memory before the first frame."""
        return None  # type: ignore[return-value]

    def prepare(self, state: StateT, memory: MemoryT | None) -> PreparedT:
        """Preparation at a state before the frame comes.

        Args:
            state: The predicted state, or that at which a smoother linearises.
            memory: Of the frame before; None for a smoother.
        """
        return None  # type: ignore[return-value]

    def decide(
        self, at: OperatingPoint[StateT, PreparedT], frame: Frame, memory: MemoryT, notes: Notes
    ) -> DecisionT:
        """Decision on the frame's readings; with it they can be linearised at another state. The notes by default.

        Args:
            at: The predicted state.
            frame: The readings.
            memory: Of the frame before.
            notes: Findings of the blocks before this one in the filter's list; its own are added.
        """
        return cast(DecisionT, notes)

    def inflate(self, P: Array, decision: DecisionT) -> None:
        """Process noise that depends on the decision, added in place to the predicted covariance P (N, N).

        It does not depend on P: a smoother adds it to zeros.
        """

    @abstractmethod
    def linearise(self, at: OperatingPoint[StateT, PreparedT], decision: DecisionT) -> Statement:
        """Information of the readings on the state, linearised at a state."""

    def review(self, posterior: StateT, decision: DecisionT) -> DecisionT | None:
        """Another decision if the posterior shows the first to be wrong, else None; called once."""
        return None

    def remember(
        self, posterior: StateT, at: OperatingPoint[StateT, PreparedT], decision: DecisionT, memory: MemoryT
    ) -> MemoryT:
        """Memory for the next frame.

        Args:
            posterior: Corrected state.
            at: The predicted state.
            decision: The decision on the frame.
            memory: Of the frame before.
        """
        return memory

    def expected_spread(self) -> Array | None:
        """(n,) expected spread of one reading by channel; None if channels are the whitened ``quantities``."""
        return None

    def channels(self, decision: DecisionT) -> Channels | None:
        """The frame's innovations by channel; None if they are those of the whitened readings."""
        return None

    def log_noise(self, decision: DecisionT) -> float:
        """Log det R of the readings that NIS and likelihood count."""
        return 0.0


AnyBlock = Block[Any, Any, Any, Any]
"""A block of any kind, as lists of blocks hold them."""
