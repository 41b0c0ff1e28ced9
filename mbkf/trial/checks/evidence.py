"""Both sides of Newton's law: the wrench that a motion of markers requires, and that of the plates, averaged alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.records import PlateReadings
from mbkf.model.body import Body
from mbkf.numerics.runs import stretches
from mbkf.numerics.windows import dilated, slopes
from mbkf.sensors.contact.offline import assign_feet
from mbkf.sensors.contact.plates import plate_wrenches
from mbkf.sensors.supports.momentum import LEAST_WINDOW, WholeBody
from mbkf.trial.preparation.markers_alone import Motion

WINDOW_S = 0.1
"""Duration over which rates of momentum and plates are taken."""

BRIDGE_S = 0.1
"""A shorter stretch of frames in which a foot seems to stand beside the plates is one of landing or leaving. It counts,
since unequal clocks show nowhere else."""

MATCHES = 0.25
"""Frames count in which the plates' vertical force is that of the motion to this share, up to one gain."""


@dataclass(frozen=True)
class Evidence:
    """Both sides of Newton's law over a trial.

    Attributes:
        times_s: (T,) times of the frames.
        rate_hz: Frame rate.
        mass_kg: The mass that the body was given.
        plates: The plates, P of them.
        centre_m: (T, 3) centre of mass.
        momentum: (T, 6) of the body, about it.
        asked: (T, 6) force N and moment N m about the centre of mass that the motion requires besides weight.
        given: (T, P, 6) wrench of each plate about the centre of mass, averaged as ``asked`` is.
        raw: (T, P, 6) plates' wrenches about the world's origin, frame by frame; NaN where not recorded.
        accounted: (T,) frames in which every loaded foot stands on a plate.
        floor_m: Height of the floor as the soles show it.
    """

    times_s: Array
    rate_hz: float
    mass_kg: float
    plates: tuple[PlateReadings, ...]
    centre_m: Array
    momentum: Array
    asked: Array
    given: Array
    raw: Array
    accounted: BoolArray
    floor_m: float

    @classmethod
    def of(
        cls,
        model: Body,
        motion: Motion,
        times_s: Array,
        rate_hz: float,
        plates: Sequence[PlateReadings],
        wrench: Array | None = None,
    ) -> Evidence:
        """Of a trial.

        Args:
            model: The body.
            motion: Its motion from markers alone.
            times_s: (T,) times of the frames.
            rate_hz: Frame rate.
            plates: The plates.
            wrench: (T, P, 6) their wrenches over the frames, where they are known.
        """
        body = WholeBody.of(model, motion.q, motion.v)
        raw = plate_wrenches(tuple(plates), times_s, rate_hz) if wrench is None else wrench
        loads = assign_feet(model, motion.q, times_s, rate_hz, tuple(plates), raw)
        asked = body.missing_wrench(np.zeros_like(body.momentum), rate_hz, WINDOW_S)
        known = ~np.isnan(body.momentum).any(axis=1) & ~np.isnan(raw).any(axis=(1, 2)) & (len(plates) > 0)
        return cls(
            times_s,
            rate_hz,
            model.mass_kg,
            tuple(plates),
            body.centre_m,
            body.momentum,
            asked,
            _averaged(_about(raw, body.centre_m), rate_hz),
            raw,
            known & _bridged(loads.valid, round(BRIDGE_S * rate_hz)),
            loads.floor_m,
        )

    @property
    def weight_n(self) -> float:
        """Weight of the mass that the body was given."""
        return self.mass_kg * GRAVITY_M_S2

    @cached_property
    def total(self) -> Array:
        """(T, 6) wrench of all plates together."""
        return np.asarray(self.given.sum(axis=1))

    @property
    def clear(self) -> BoolArray:
        """(T,) accounted frames whose averaging window holds accounted frames only."""
        return self.known & self.accounted & ~dilated(~self.accounted, round(0.5 * WINDOW_S * self.rate_hz))

    @cached_property
    def known(self) -> BoolArray:
        """(T,) frames in which both sides are known."""
        return np.asarray(~np.isnan(self.asked[:, 0]) & ~np.isnan(self.given).any(axis=(1, 2)))

    @cached_property
    def carried(self) -> BoolArray:
        """(T,) frames in which plates carry the force that the motion requires, up to one gain."""
        asked, total = self.asked[:, 2], self.total[:, 2]
        bears = self.known & (asked > 0.3 * self.weight_n) & (total > 0.3 * asked)
        if not bears.any():
            return bears
        share = np.where(bears, total / np.where(bears, asked, 1.0), np.nan)
        return np.asarray(bears & (np.abs(share / np.nanmedian(share) - 1.0) < MATCHES))

    def gives(self, plates: Sequence[PlateReadings]) -> Array:
        """(T, P, 6) :attr:`given` of other readings of the plates."""
        return self.averaged(plate_wrenches(tuple(plates), self.times_s, self.rate_hz))

    def averaged(self, raw: Array) -> Array:
        """(T, K, 6) wrenches as :attr:`given`, of others (T, K, 6) as :attr:`raw`."""
        return _averaged(_about(raw, self.centre_m), self.rate_hz)

    def with_plate(self, p: int, plate: PlateReadings, wrench: Array) -> Evidence:
        """The same with other readings of plate ``p`` and the same accounted frames.

        Args:
            p: The plate.
            plate: Its other readings.
            wrench: (T, 6) them as :attr:`raw`.
        """
        plates, given, raw = list(self.plates), self.given.copy(), self.raw.copy()
        plates[p], given[:, p], raw[:, p] = plate, self.averaged(wrench[:, None])[:, 0], wrench
        return replace(self, plates=tuple(plates), given=given, raw=raw)

    def restricted(self, frames: BoolArray) -> Evidence:
        """The same with these frames (T,) accounted for."""
        return replace(self, accounted=frames)

    def without(self, frames: BoolArray) -> Evidence:
        """The same with some frames (T,) not accounted for."""
        return replace(self, accounted=self.accounted & ~frames)


def _about(raw: Array, centre_m: Array) -> Array:
    """(T, P, 6) wrenches about the centre of mass (T, 3)."""
    moved = raw.copy()
    moved[..., 3:] -= np.cross(centre_m[:, None], raw[..., :3])
    return moved


def _averaged(series: Array, rate_hz: float) -> Array:
    """(T, P, 6) means over the window, weighted as slopes of momentum are; NaN where a window is not known."""
    window = max(2 * round(0.5 * WINDOW_S * rate_hz) + 1, LEAST_WINDOW)
    flat = series.reshape(len(series), -1)
    found = np.full(flat.shape, np.nan)
    if not flat.shape[1]:
        return found.reshape(series.shape)
    for run in stretches(np.asarray(~np.isnan(flat).any(axis=1))):
        if len(run) >= window:
            found[run] = slopes(np.cumsum(flat[run], axis=0) - 0.5 * flat[run], window, 1.0)
    return found.reshape(series.shape)


def _bridged(mask: BoolArray, frames: int) -> BoolArray:
    """(T,) mask in which shorter gaps between two stretches are filled."""
    found = mask.copy()
    for run in stretches(~mask):
        if len(run) <= frames and run[0] > 0 and run[-1] < len(mask) - 1:
            found[run] = True
    return found
