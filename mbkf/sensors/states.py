"""Protocols of states with more than positions and velocities: accelerations, foot wrenches, forces."""

from __future__ import annotations

from typing import Protocol

from mbkf.conventions import Array
from mbkf.sensors.block import State


class AcceleratedState(State, Protocol):
    """A state with accelerations."""

    @property
    def a(self) -> Array:
        """(nv,) acceleration."""


class LoadedState(AcceleratedState, Protocol):
    """A state with accelerations and the feet's wrenches."""

    @property
    def w(self) -> Array:
        """(12,) wrench of the ground on right and left foot: force N, moment N m about the world's origin."""

    @property
    def extra(self) -> Array:
        """(m,) states that blocks add."""


class ForceState(State, Protocol):
    """A state with generalised forces."""

    @property
    def u(self) -> Array:
        """(nu,) forces of a forced body (:mod:`mbkf.model.forced_body`): N m, N."""

    @property
    def given(self) -> Array:
        """(12,) wrenches of the feet that are known inputs, NaN for unknown ones; (0,) where they are among u."""

    @property
    def forces(self) -> Array:
        """All that moves the body: u followed by the given wrenches."""
