"""Other contacts, as a block: the wrench s on all parts that carry load besides the feet.

    closed      X s = r            only feet carry load: r so small that s is 0
    open        X s = r            about the middle of the loaded parts: the force is free, its lever and, on a floor or
                                   a seat, its shear are known to a spread

X moves a wrench from the world's origin to that middle, or to the pelvis. Between frames s is a random walk about the
same point. Newton's law (:mod:`mbkf.sensors.newton_euler`) has s among its wrenches; it determines the sum over all
parts only, so that they have one state, which :mod:`mbkf.sensors.supports.sharing` divides.

The loaded parts are found before a trial is filtered (:mod:`mbkf.sensors.supports.search`) and come as a reading of
every frame, flags (B,) under the name :data:`BEARING`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.model.layout import SUPPORT, ExtraState, Layout
from mbkf.sensors.block import Block, Frame, Notes, OperatingPoint, Rows
from mbkf.sensors.states import LoadedState
from mbkf.sensors.supports.bearings import BearingParts, BearingPoints
from mbkf.sensors.supports.sharing import about

BEARING = "bearing"
"""Name of the readings that flag the loaded parts."""


@dataclass(frozen=True)
class SupportSettings:
    """Spreads of other contacts; moments about the middle of the loaded parts.

    Attributes:
        closed_force_n, closed_moment_nm: Of the zero wrench of a body without other contacts.
        support_force, support_moment: Random walk of their wrench, N/√s and N m/√s.
        support_force_n: Of the force about 0, N, against drift.
        support_shear_share: Of the shear on a floor or a seat, as a share of the force.
        support_lever_scale: Factor on the levers of the parts' centres of pressure.
    """

    closed_force_n: float = 0.3
    closed_moment_nm: float = 0.1
    support_force: float = 1500.0
    support_moment: float = 150.0
    support_force_n: float = 2000.0
    support_shear_share: float = 0.15
    support_lever_scale: float = 1.0


class SupportDecision(NamedTuple):
    """Parts that carry load in a frame.

    Attributes:
        parts: The parts, in the order of the body's bearings; empty if only feet carry load.
        fresh: True if contacts begin or end.
        points: Places of all parts.
        about_m: (3,) middle of the loaded parts, else the pelvis's origin.
    """

    parts: tuple[int, ...]
    fresh: bool
    points: BearingPoints
    about_m: Array


class Supports(Block[LoadedState, None, SupportDecision, tuple[int, ...]]):
    """Contacts besides the feet's; its memory holds the parts loaded in the frame before.

    Attributes:
        bearings: Parts that may carry load.
        settings: Spreads.
    """

    prior = True

    def __init__(self, model: Body, dt_s: float, settings: SupportSettings = SupportSettings()) -> None:
        """Args: model: the body; dt_s: time between frames; settings: spreads."""
        self.bearings, self.settings = BearingParts(model), settings
        self._weight_n = -float(model.pin_model.gravity.linear[2]) * model.mass_kg
        s = settings
        self._closed = np.repeat([s.closed_force_n, s.closed_moment_nm], 3)
        self._walk = np.repeat([s.support_force, s.support_moment], 3) * dt_s**0.5
        self._jump = np.repeat([s.support_force_n, 0.1 * s.support_force_n], 3)
        self._slice, self._extra = slice(0), slice(0)

    def states(self) -> list[ExtraState]:
        """The wrench of all other contacts about the world's origin: force N, moment N m."""
        return [ExtraState(SUPPORT, np.zeros(6), self._closed, np.zeros(6))]

    def bind(self, layout: Layout, body: Body) -> None:
        """Keeps the slices of the wrench."""
        self._slice, self._extra = layout[SUPPORT], layout.extra_index(SUPPORT)

    def begin(self) -> tuple[int, ...]:
        """Memory without a loaded part."""
        return ()

    def decide(
        self, at: OperatingPoint[LoadedState, None], frame: Frame, memory: tuple[int, ...], notes: Notes
    ) -> SupportDecision:
        """The parts that the frame flags."""
        flags, state = frame.readings.get(BEARING), at.state
        parts = () if flags is None else tuple(np.flatnonzero(np.asarray(flags) > 0.0).tolist())
        points = self.bearings.at(state.q, state.v)
        middle = points.points_m[list(parts)].mean(axis=0) if parts else state.q[:3]
        notes.supports = parts
        return SupportDecision(parts, bool(parts) != bool(memory), points, middle)

    def inflate(self, P: Array, decision: SupportDecision) -> None:
        """Adds the wrench's random walk about the middle of the loaded parts; wide where a contact begins or ends."""
        if not decision.parts and not decision.fresh:
            return
        shift = about(-decision.about_m) * (self._jump if decision.fresh else self._walk)
        own = P[self._slice, self._slice]
        own += shift @ shift.T

    def linearise(self, at: OperatingPoint[LoadedState, None], decision: SupportDecision) -> Rows:
        """Six rows on the wrench."""
        s = at.state.extra[self._extra]
        sd = self._sd(s, decision) if decision.parts else self._closed
        rows = about(decision.about_m) / sd[:, None]
        return Rows(rows, -rows @ s, self._slice.start)

    def remember(
        self,
        posterior: LoadedState,
        at: OperatingPoint[LoadedState, None],
        decision: SupportDecision,
        memory: tuple[int, ...],
    ) -> tuple[int, ...]:
        """The loaded parts."""
        return decision.parts

    def _sd(self, wrench: Array, decision: SupportDecision) -> Array:
        """(6,) spread of the wrench about the middle of the loaded parts."""
        s, parts = self.settings, list(decision.parts)
        force = max(float(np.linalg.norm(wrench[:3])), 0.1 * self._weight_n)
        points, levers = decision.points.points_m[parts], self.bearings.levers_m[parts]
        apart = ((points - decision.about_m) ** 2).sum(axis=1) + levers**2
        moment = s.support_lever_scale * force * float(np.sqrt(apart.mean()))
        grips = all(self.bearings.grips[k] for k in parts)
        shear = s.support_force_n if grips else s.support_shear_share * force
        return np.array([shear, shear, s.support_force_n, moment, moment, moment])
