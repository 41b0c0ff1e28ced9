"""Load transfer from foot to foot in walking, as a block: the foot behind unloads as it rolls over its toes.

    0 = (1 − s) F_behind − s F_ahead + r,   s = (1 − x)^γ,   x = (φ − φ₀) / (φ₁ − φ₀),   r ~ N(0, (σ m g)²)

φ is the pitch of the foot behind, φ₀ that at which the other foot landed, φ₁ that at which it leaves the floor: as the
last time, and ``leaving_pitch_rad`` before the first. Newton's law shares a load between two feet by the moment of the
whole body; without sensors on arms and head that is uncertain by a fifth of the weight, and the heights of soles, which
share it between markers (:mod:`mbkf.sensors.contact.sharing`), by a centimetre. A foot's pitch is known to a degree.
Load passes in a smooth and similar way in every walk (L. Ren, R. K. Jones and D. Howard, Journal of Biomechanics 41
(2008) 2750–2759, as a function of time).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, hypot, radians
from typing import NamedTuple

import numpy as np

from mbkf.model.body import Body
from mbkf.sensors.block import Block, Frame, Notes, OperatingPoint, Rows
from mbkf.sensors.contact.feet import FeetMotion, FeetOnBody
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.states import LoadedState


@dataclass(frozen=True)
class LoadTransferSettings:
    """Course of the load from foot to foot.

    Set on the double supports of Rajagopal's walk, gait2354 and Rehazenter's, whose plates follow it to 0.05; shown on
    HC032A, HC044A and gaitalytics, 0.14.

    Attributes:
        transfer_power: γ.
        transfer_sd, transfer_memory_s: σ, spread of a foot's force in body weights, and correlation time of its error.
        leaving_pitch_rad: φ₁ before a foot has left the floor for the first time.
        stood_s: Least time for which the foot behind has stood alone.
        transfer_within_s: Longest transfer.
        least_pitching_rad_s: Least angular velocity of the foot behind; slower, the person comes to a stand.
    """

    transfer_power: float = 1.6
    transfer_sd: float = 0.12
    transfer_memory_s: float = 0.08
    leaving_pitch_rad: float = radians(65.0)
    stood_s: float = 0.15
    transfer_within_s: float = 0.5
    least_pitching_rad_s: float = 0.5


LEAST_ROLL_RAD = 0.2
"""Least pitch φ₁ − φ₀ over which a foot unloads."""

LEAVING_RAD = radians(35.0), radians(85.0)
"""Least and greatest pitch at which feet leave the floor."""


class Transfer(NamedTuple):
    """A double support that began when one foot landed while the other stood.

    Attributes:
        behind: The foot that stood, 0 right and 1 left.
        landed_rad: Its pitch when the other foot landed.
        pitch_rad: Its pitch now.
        lasted_s: Duration for which both have stood.
    """

    behind: int
    landed_rad: float
    pitch_rad: float
    lasted_s: float


class Walk(NamedTuple):
    """State carried from one frame to the next.

    Attributes:
        alone_s: Duration for which right and left foot have stood alone.
        transfer: The double support; None outside one, or in one that began otherwise.
        leaving_rad: Pitch at which each foot has last left the floor; None before the first time.
    """

    alone_s: tuple[float, float] = (0.0, 0.0)
    transfer: Transfer | None = None
    leaving_rad: tuple[float | None, float | None] = (None, None)


class TransferDecision(NamedTuple):
    """The foot behind and its share of both feet's load, None outside a transfer; and the memory."""

    share: tuple[int, float] | None
    walk: Walk


class LoadTransfer(Block[LoadedState, None, TransferDecision, Walk]):
    """A row on the vertical forces of both feet, where neither has a plate."""

    prior = True

    def __init__(
        self, model: Body, dt_s: float, settings: LoadTransferSettings = LoadTransferSettings()
    ) -> None:
        """Args: model: the body; dt_s: time between frames; settings: course of the load."""
        self.settings = settings
        self._feet, self._dt_s, self._vertical = FeetOnBody(model), dt_s, [2, 8]
        weight_n = -float(model.pin_model.gravity.linear[2]) * model.mass_kg
        self._sd_n = settings.transfer_sd * weight_n * max(settings.transfer_memory_s / dt_s, 1.0) ** 0.5

    def begin(self) -> Walk:
        """Memory before any foot has stood."""
        return Walk()

    def decide(
        self, at: OperatingPoint[LoadedState, None], frame: Frame, memory: Walk, notes: Notes
    ) -> TransferDecision:
        """Share of the foot behind by its roll since the other one landed."""
        contact = notes.contact
        if contact is None:
            return TransferDecision(None, memory)
        stands = tuple(kind != Contact.AIR for kind in contact.contacts)
        feet = self._feet.at(at.state.q, at.state.v)
        if not all(stands):
            return TransferDecision(None, self._after(memory, stands))
        transfer = (
            self._begun(memory, feet) if memory.transfer is None else self._went_on(memory.transfer, feet)
        )
        walk = Walk((0.0, 0.0), transfer, memory.leaving_rad)
        read = set(contact.contacts) != {Contact.UNMEASURED}
        if transfer is None or read or not self._rolls(transfer, feet):
            return TransferDecision(None, walk)
        return TransferDecision((transfer.behind, self._share(transfer, memory)), walk)

    def linearise(self, at: OperatingPoint[LoadedState, None], decision: TransferDecision) -> Rows | None:
        """One row on both wrenches."""
        if decision.share is None:
            return None
        behind, share = decision.share
        row = np.zeros((1, 12))
        row[0, self._vertical[behind]], row[0, self._vertical[1 - behind]] = 1.0 - share, -share
        row /= self._sd_n
        return Rows(row, -row @ at.state.w, self.layout.wrench.start)

    def remember(
        self,
        posterior: LoadedState,
        at: OperatingPoint[LoadedState, None],
        decision: TransferDecision,
        memory: Walk,
    ) -> Walk:
        """The decision's memory."""
        return decision.walk

    def _begun(self, memory: Walk, feet: FeetMotion) -> Transfer | None:
        """The transfer to a foot that has landed beside one that stood."""
        stood = [foot for foot in (0, 1) if memory.alone_s[foot] > self.settings.stood_s]
        if not stood:
            return None
        pitch = pitch_of(feet, stood[0])
        return Transfer(stood[0], pitch, pitch, 0.0)

    def _went_on(self, transfer: Transfer, feet: FeetMotion) -> Transfer:
        """The transfer a frame later."""
        pitch = pitch_of(feet, transfer.behind)
        return transfer._replace(pitch_rad=pitch, lasted_s=transfer.lasted_s + self._dt_s)

    def _after(self, memory: Walk, stands: tuple[bool, ...]) -> Walk:
        """Memory after a frame in which at most one foot stands."""
        leaving, transfer = list(memory.leaving_rad), memory.transfer
        if transfer is not None and not stands[transfer.behind]:
            leaving[transfer.behind] = float(np.clip(transfer.pitch_rad, *LEAVING_RAD))
        right, left = (
            known + self._dt_s if stands[foot] else 0.0 for foot, known in enumerate(memory.alone_s)
        )
        return Walk((right, left), None, (leaving[0], leaving[1]))

    def _rolls(self, transfer: Transfer, feet: FeetMotion) -> bool:
        """True while the foot behind unloads by rolling."""
        s = self.settings
        return transfer.lasted_s < s.transfer_within_s and (
            pitching(feet, transfer.behind) > s.least_pitching_rad_s
        )

    def _share(self, transfer: Transfer, memory: Walk) -> float:
        """Share of both feet's load on the foot behind."""
        own, other = (memory.leaving_rad[foot] for foot in (transfer.behind, 1 - transfer.behind))
        usual = other if other is not None else self.settings.leaving_pitch_rad
        rolls = (own if own is not None else usual) - transfer.landed_rad
        done = (transfer.pitch_rad - transfer.landed_rad) / max(rolls, LEAST_ROLL_RAD)
        return float((1.0 - min(max(done, 0.0), 1.0)) ** self.settings.transfer_power)


def pitch_of(feet: FeetMotion, foot: int) -> float:
    """Pitch of a foot (0 right, 1 left), rad: descent angle of its sole from heel to ball."""
    heel, ball, _ = feet.soles[foot]
    return atan2(heel[2] - ball[2], hypot(heel[0] - ball[0], heel[1] - ball[1]))


def pitching(feet: FeetMotion, foot: int) -> float:
    """Angular velocity of a foot (0 right, 1 left) about its side-to-side axis, rad/s; positive as its heel rises."""
    heel, ball, _ = feet.soles[foot]
    x, y = ball[0] - heel[0], ball[1] - heel[1]
    _, _, _, turn_x, turn_y, _ = feet.twists[foot]
    return float((x * turn_y - y * turn_x) / max(hypot(x, y), 1e-9))
