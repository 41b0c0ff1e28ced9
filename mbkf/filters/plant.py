"""One protocol for the motion between frames: prediction, transition, noise and memory.

A state x with covariance P moves from one frame to the next by

    x⁻ = f(x),   P⁻ = Φ P Φᵀ + Q,   Φ = ∂f/∂x along the tangent spaces of x and x⁻

A plant of one's own derives from :class:`Plant` and needs three methods: ``move`` (f), ``transition`` (Φ) and
``noise`` (Q).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Generic, NamedTuple, Protocol, Self, TypeVar, cast

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body
from mbkf.model.layout import Layout
from mbkf.numerics.transition import DenseTransition, Transition
from mbkf.sensors.block import Notes, State


class TangentState(State, Protocol):
    """A state that moves along its tangent space, a frozen dataclass with the covariance ``P``."""

    def retracted(self, model: Body, step: Array, P: Array) -> Self:
        """The state moved by a tangent vector.

        Args:
            model: The body, on whose manifold q lies.
            step: (N,) tangent vector.
            P: (N, N) covariance of the moved state.
        """

    def minus(self, model: Body, origin: Self) -> Array:
        """(N,) tangent vector from the mean of another state to this one's."""


StateT = TypeVar("StateT", bound=TangentState)
NoiseT = TypeVar("NoiseT")
MemoryT = TypeVar("MemoryT")


class DofNoise(NamedTuple):
    """Independent noise of each dof of a state (q, its rates of rising order, the rest).

    Attributes:
        share: (k + 1,) by which a dof's noise moves its position and each of k rates.
        sd: (nv,) standard deviations.
    """

    share: Array
    sd: Array


class Plant(ABC, Generic[StateT, NoiseT, MemoryT]):
    """Motion of a state from one frame to the next.

    The order of calls in a frame is ``noise``, ``predict`` (before the frame comes), ``retract`` (by the update),
    ``remember``. A smoother calls ``predict`` again at other states with the same noise, and ``step_transition``.

    Attributes:
        model: The body.
        layout: Slices of the tangent state.
        dt_s: Time step Δt.
    """

    def __init__(self, model: Body, layout: Layout, dt_s: float) -> None:
        """Keeps body, layout and time step.

        Args:
            model: The body.
            layout: Slices of the tangent state.
            dt_s: Time step Δt.
        """
        self.model, self.layout, self.dt_s = model, layout, dt_s
        self._walk = layout.walk_variance(dt_s)

    @abstractmethod
    def move(self, state: StateT) -> StateT:
        """f(x): the mean one step later, with the covariance unchanged."""

    @abstractmethod
    def transition(self, state: StateT) -> Array:
        """(N, N) Φ at a state."""

    @abstractmethod
    def noise(self, memory: MemoryT) -> NoiseT:
        """Process noise of the next step as :meth:`predict` takes it: (N, N) Q, unless a plant predicts by itself.

        The layout's added states are random walks; their noise is added besides.
        """

    def begin(self) -> MemoryT:
        """Memory before the first frame."""
        return None  # type: ignore[return-value]

    def remember(self, posterior: StateT, notes: Notes, memory: MemoryT) -> MemoryT:
        """Memory for the next frame.

        Args:
            posterior: Corrected state.
            notes: Notes that the blocks left on the frame.
            memory: Of the frame before.
        """
        return memory

    def predict(self, state: StateT, noise: NoiseT) -> StateT:
        """The state one step later, P⁻ = Φ P Φᵀ + Q exactly symmetric, new and in Fortran order."""
        phi = self.transition(state)
        P = phi @ state.P @ phi.T + cast("Array", noise)
        P = 0.5 * (P + P.T)
        self.add_walk(P)
        return replace(self.move(state), P=P.T)  # type: ignore[type-var]

    def dof_noise(self, noise: NoiseT) -> DofNoise | None:
        """Process noise as one number per dof, besides that of the added states; None where it is not of this form.

        With it and a transition by its parts, a smoother needs a third of the products.

        Args:
            noise: Result of :meth:`noise`.
        """
        return None

    def add_walk(self, P: Array) -> None:
        """Adds the noise of added states, the last ones, to a covariance in place."""
        if len(self._walk):
            np.einsum("ii->i", P)[-len(self._walk) :] += self._walk

    def step_transition(self, before: StateT, predicted: StateT) -> Transition:
        """Φ of a step that :meth:`predict` took, in the form that costs a smoother least.

        Args:
            before: The state that the step began with.
            predicted: The state that it led to.
        """
        return DenseTransition(self.transition(before))

    def retract(self, state: StateT, step: Array, P: Array) -> StateT:
        """The state moved along its tangent space.

        Args:
            state: The state.
            step: (N,) tangent vector.
            P: (N, N) covariance of the moved state.
        """
        return state.retracted(self.model, step, P)

    def difference(self, origin: StateT, state: StateT) -> Array:
        """(N,) tangent vector from one state's mean to another's."""
        return state.minus(self.model, origin)


PlantOf = Plant[StateT, Any, Any]
"""A plant of a kind of state."""

AnyPlant = Plant[Any, Any, Any]
"""A plant of any kind."""

PlantMaker = Callable[[Body, Layout, float, BoolArray], AnyPlant]
"""Makes a plant from body, layout, time step in s, and (nv,) dofs to hold still: those that no instrument shows.

The class of a plant with a constructor of this form will do.
"""
