"""One protocol for everything that speaks of a frame: instruments, physical laws and priors are blocks.

A filter has a state x with mean and covariance P⁻ before a frame. A block turns the frame's readings into a statement
about x, in one of two forms:

    Information   HᵀR⁻¹H and HᵀR⁻¹y of readings z = h(x) + r, r ~ N(0, R), on the first components of the state
    Rows          R^(-1/2) H and R^(-1/2) y of such readings, on any contiguous components

with innovation y = z − h(x⁻) and H = ∂h/∂x along the tangent space. The filter adds them up and updates once.
A block of one's own derives from :class:`Block` and needs two methods, ``decide`` and ``linearise``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body
from mbkf.numerics.kalman import Information
from mbkf.sensors.contact.records import ContactDecision
from mbkf.sensors.layout import ExtraState, Layout

NO_DOFS = np.zeros(0, dtype=np.intp)
"""An empty list of dofs."""

NO_READINGS: Mapping[str, Array] = {}
"""Readings of a frame in which no instrument of one's own takes part."""


class State(Protocol):
    """What every filter's state has: configuration q (nq,), velocity v (nv,), covariance P (N, N)."""

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
    """What the instruments read in a frame.

    Attributes:
        markers_m: (M, 3) positions in the world, NaN where missing.
        plates: (K, 6) force N and moment N m about the world's origin per plate; NaN where not recorded.
        imus: (S, 6) angular velocity rad/s and specific force m/s² per inertial sensor; None where there are none.
        readings: Of instruments of one's own, by a name that their block knows.
    """

    markers_m: Array
    plates: Array
    imus: Array | None = None
    readings: Mapping[str, Array] = NO_READINGS


NO_MARKERS = np.zeros(0, dtype=bool)
"""Flags of no markers."""


@dataclass(slots=True)
class Notes:
    """What blocks share about a frame; complete when all of them have decided.

    Attributes:
        seen: (M,) markers seen.
        trusted: (M,) markers used: seen, and inside their gate.
        unmarked: Dofs of joints whose segment shows no used marker.
        unobserved: Those of them that no inertial sensor observes either.
        observed: Whether enough instruments read for the body to count as tracked.
        lost: Whether most markers lie far from the predicted body.
        lasting: Mean square of what lasts in the markers' errors, over what their noise is taken for.
        imus: (S, 6) inertial readings that are used; None where there are none.
        contact: What the feet stand on; None where no block asks.
        coordinated: Dofs that the coordination prior predicts.
        supports: Parts besides the feet that bear load, by their place among the body's bearings.
    """

    # Arrays here are replaced, never written into, so that the defaults can be shared.
    seen: BoolArray = field(default_factory=lambda: NO_MARKERS)
    trusted: BoolArray = field(default_factory=lambda: NO_MARKERS)
    unmarked: NDArray[np.intp] = field(default_factory=lambda: NO_DOFS)
    unobserved: NDArray[np.intp] = field(default_factory=lambda: NO_DOFS)
    observed: bool = False
    lost: bool = False
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
        first: Component of the state that the first column stands for.
        readings: How many of the rows, the first ones, are readings that NIS and likelihood count; others are priors.
        vector: (n,) HᵀR⁻¹y of priors where the block rounds it less than the product does; None for the product.
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
        readings: (n,) how many numbers each channel read, 0 for none.
    """

    mean_square: Array
    readings: NDArray[np.int_]


Statement = Information | Rows | Sequence[Rows] | None
"""What a block says in a frame; None for nothing."""

StateT = TypeVar("StateT", bound=State)
PreparedT = TypeVar("PreparedT")
DecisionT = TypeVar("DecisionT")
MemoryT = TypeVar("MemoryT")


class OperatingPoint(NamedTuple, Generic[StateT, PreparedT]):
    """A state at which a block is linearised, with what the block worked out there without the frame."""

    state: StateT
    prepared: PreparedT


class Block(ABC, Generic[StateT, PreparedT, DecisionT, MemoryT]):
    """An instrument, a law or a prior: what a frame's readings are taken to be, and what they then say of the state.

    The order of calls in a frame is ``prepare`` (before the frame comes), ``decide``, ``inflate``, ``linearise``,
    ``review``, ``remember``. A smoother calls ``prepare`` and ``linearise`` again at another state.

    Attributes:
        prior: Whether the block is a prior rather than an instrument or a law; priors count in no NIS.
        kind: Which of :data:`mbkf.conventions.READING_KINDS` its readings are.
        quantities: Its readings alternate in threes between so many quantities with a spread of their own: force and
            moment.
    """

    prior: bool = False
    kind: str = "other"
    quantities: int = 1

    def states(self) -> Sequence[ExtraState]:
        """States that the block adds to the filter's."""
        return ()

    def bind(self, layout: Layout, body: Body) -> None:
        """Called once by the filter; a block keeps what it needs.

        Args:
            layout: Slices of the filter's tangent state, added states among them.
            body: The body that moves.
        """

    def begin(self) -> MemoryT:
        """Memory before the first frame."""
        return None  # type: ignore[return-value]

    def prepare(self, state: StateT, memory: MemoryT | None) -> PreparedT:
        """What can be worked out at a state before the frame is there.

        Args:
            state: The predicted state, or that at which a smoother linearises.
            memory: Of the frame before; None where a smoother asks.
        """
        return None  # type: ignore[return-value]

    @abstractmethod
    def decide(
        self, at: OperatingPoint[StateT, PreparedT], frame: Frame, memory: MemoryT, notes: Notes
    ) -> DecisionT:
        """What the frame's readings are taken to be; with it they can be linearised at another state.

        Args:
            at: The predicted state.
            frame: The readings.
            memory: Of the frame before.
            notes: What blocks share: those before this one in the filter's list have decided.
        """

    def inflate(self, P: Array, decision: DecisionT) -> None:
        """Process noise that depends on the decision, added in place to the predicted covariance P (N, N)."""

    @abstractmethod
    def linearise(self, at: OperatingPoint[StateT, PreparedT], decision: DecisionT) -> Statement:
        """What the readings say of the state, linearised at a state."""

    def review(self, posterior: StateT, decision: DecisionT) -> DecisionT | None:
        """Another decision where the posterior shows the first to be wrong, None where it stands; asked once."""
        return None

    def remember(
        self, posterior: StateT, at: OperatingPoint[StateT, PreparedT], decision: DecisionT, memory: MemoryT
    ) -> MemoryT:
        """Memory for the next frame.

        Args:
            posterior: Corrected state.
            at: The predicted state.
            decision: What was decided.
            memory: Of the frame before.
        """
        return memory

    def expected_spread(self) -> Array | None:
        """(n,) expected spread of one reading by channel; None where channels are the whitened ``quantities``."""
        return None

    def channels(self, decision: DecisionT) -> Channels | None:
        """The frame's innovations by channel; None where they are those of the whitened readings."""
        return None

    def log_noise(self, decision: DecisionT) -> float:
        """Log det R of the readings that NIS and likelihood count."""
        return 0.0


AnyBlock = Block[Any, Any, Any, Any]
"""A block of any kind, as lists of blocks hold them."""
