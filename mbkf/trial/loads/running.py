"""Unexplained loads while a motion goes on: the windows of a trial, each ending now.

A force is stated as soon as its mean over one of the windows exceeds the window's limit, and until it is below half of
all limits. A load above 9 % of body weight is stated within half a second after it begins.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.trial.loads.balance import BRIDGE_S, GRAVITY, Window
from mbkf.trial.loads.flags import LIMITS, READ_SHARE

RELEASE = 0.5
"""A force that was stated acts until all means are below this share of their limits."""

HELD_S = 1.0
"""A force that was stated stays so for this long where no plate reads a foot's load."""


class RunningLoad(NamedTuple):
    """Judgement of one frame.

    Attributes:
        force_n: (3,) mean force over the last half second that acts besides weight and contacts, N; NaN where that is
            not judged.
        acts: True while an unexplained force is stated: loads are not to be used.
    """

    force_n: Array
    acts: bool


class RunningBalance:
    """Takes frames in order, one by one."""

    def __init__(self, mass_kg: float, rate_hz: float) -> None:
        """Args: the body's mass, and the frame rate."""
        self._mass_kg, self._weight_n = mass_kg, mass_kg * GRAVITY_M_S2
        self._windows = [Window.of(limit.duration_s, rate_hz) for limit in LIMITS]
        self._limits_n = np.array([limit.share for limit in LIMITS]) * self._weight_n
        self._most = max(len(window) for window in self._windows)
        self._kept = np.zeros((4 * self._most, 6))
        self._first = self._after = 0
        self._bridged, self._held = round(BRIDGE_S * rate_hz), round(HELD_S * rate_hz)
        self._unread, self._acts, self._level = 0, False, False

    def push(self, centre_m: Array, contacts_n: Array, judged: bool) -> RunningLoad:
        """The next frame.

        Args:
            centre_m: (3,) centre of mass; NaN where the body is not tracked.
            contacts_n: (3,) sum of the forces of all contacts.
            judged: Plates read every loaded foot.
        """
        frame = np.concatenate([centre_m, contacts_n])
        self._unread = 0 if judged else self._unread + 1
        if not np.isfinite(frame).all() or self._unread > self._bridged:
            self._first = self._after
            self._acts = self._acts and self._unread <= self._held
            return RunningLoad(np.full(3, np.nan), self._acts)
        self._level = self._level or bool(np.abs(contacts_n[:2]).max() > READ_SHARE * self._weight_n)
        self._keep(frame)
        known = [
            self._missing(window) for window in self._windows if len(window) <= self._after - self._first
        ]
        if not known:
            return RunningLoad(np.full(3, np.nan), self._acts)
        sizes = np.abs(known)[:, slice(None) if self._level else slice(2, None)].max(axis=1)
        limits = self._limits_n[-len(known) :]
        self._acts = bool((sizes > (RELEASE if self._acts else 1.0) * limits).any())
        return RunningLoad(known[-1], self._acts)

    def cut(self) -> None:
        """Begins anew after a gap or a restart of the filter."""
        self._first = self._after

    def _keep(self, frame: Array) -> None:
        if self._after == len(self._kept):
            held = min(self._after - self._first, self._most)
            self._kept[:held] = self._kept[self._after - held : self._after]
            self._first, self._after = 0, held
        self._kept[self._after] = frame
        self._after += 1

    def _missing(self, window: Window) -> Array:
        """(3,) mean force over the window that ends now."""
        held = self._kept[self._after - len(window) : self._after]
        required = window.by_position @ held[:, :3] - GRAVITY
        return np.asarray(self._mass_kg * required - window.by_force @ held[:, 3:])
