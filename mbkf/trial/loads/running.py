"""Unexplained loads while a motion goes on: windows as those of a trial, each ending now.

A causal estimate lags behind in quick motion, so that the missing force swings with the steps of a run, and a window
that does not hold whole steps reads some of it. The impulse of a load is the same in every window that holds it. So a
force is stated where the missing impulse exceeds that of a limit in all windows from its duration to half as much
again: one of these holds whole steps, nearly. A load above 9 % of body weight is stated within half a second after it
begins, one above 20 % within a third.
"""

from __future__ import annotations

from math import isfinite
from typing import NamedTuple

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.kernel.loading import library
from mbkf.model.body import Body
from mbkf.sensors.contact.plates import force_read
from mbkf.trial.loads.balance import BRIDGE_S, GRAVITY, CentreOfMass, LoadBalance, Window
from mbkf.trial.loads.flags import LIMITS, READ_SHARE, Limit

RUNNING_LIMITS = (*LIMITS, Limit(0.25, 0.16))
"""Limits of a trial, and a shorter one of the same impulse as the second: a large load is stated sooner."""

HALF = 1
"""The limit of half a second among these: its mean force is reported."""

LONGER = (1.0, 1.1, 1.2, 1.3, 1.4, 1.5)
"""Durations of windows over that of their limit."""

SWINGS = 3.0
"""A mean force over half a second that is above so many limits is stated, even if it comes and goes with steps: plates
with another clock, or the wrong foot on a plate."""

RELEASE = 0.5
"""A force that was stated acts until all impulses are below this share of their limits, that of one second left out."""

QUIET_S = 0.1
"""They have to be for so long."""

HELD_S = 1.0
"""A force that was stated stays so for this long where no plate reads a foot's load, if it was stated for longer than
:data:`~mbkf.trial.loads.balance.BRIDGE_S` before."""


STRAY_SHARE, STRAY_S = 0.05, 0.3
"""Where plates read so much more than the feet are given, as a share of body weight, for less than this time, a foot is
on them that is not recognised yet; for longer, something else."""


class StrayLoad:
    """The load of a plate on which a foot is not recognised yet; takes frames in order.

    Attributes:
        reads: True while it counts.
    """

    def __init__(self, mass_kg: float, rate_hz: float) -> None:
        """Args: the body's mass, and the frame rate."""
        self._least_n, self._most = STRAY_SHARE * mass_kg * GRAVITY_M_S2, round(STRAY_S * rate_hz)
        self._frames, self.reads = 0, False

    def counted(self, on_feet_n: Array, plates: Array) -> Array:
        """(3,) force on the feet: that of all plates while one of them has just been loaded by no foot.

        Args:
            on_feet_n: (3,) force on the feet by the contacts that were decided.
            plates: (K, 6) wrenches that the plates read.
        """
        _, read_n = force_read(plates)
        stray = read_n[2] - on_feet_n[2] > self._least_n
        self._frames = self._frames + 1 if stray else 0
        self.reads = 0 < self._frames <= self._most
        return np.asarray(read_n if self.reads else on_feet_n)


class RunningLoad(NamedTuple):
    """Judgement of one frame.

    Attributes:
        force_n: (3,) mean force over the last half second that acts besides weight and contacts, N; NaN where that is
            not judged.
        acts: True while an unexplained force is stated: loads are not to be used.
    """

    force_n: Array
    acts: bool


UNKNOWN_N = np.full(3, np.nan)


class RunningBalance:
    """Takes frames in order, one by one."""

    def __init__(self, mass_kg: float, rate_hz: float) -> None:
        """Args: the body's mass, and the frame rate."""
        self._mass_kg, self._weight_n = mass_kg, mass_kg * GRAVITY_M_S2
        windows = [
            Window.of(longer * limit.duration_s, rate_hz) for limit in RUNNING_LIMITS for longer in LONGER
        ]
        self._lengths = np.array([len(window) for window in windows], dtype=np.int32)
        self._most, self._least = int(self._lengths.max()), int(self._lengths.min())
        self._by_position = np.array([np.pad(w.by_position, (self._most - len(w), 0)) for w in windows])
        self._by_force = np.array([np.pad(w.by_force, (self._most - len(w), 0)) for w in windows])
        limits_n = [limit.share * self._weight_n / longer for limit in RUNNING_LIMITS for longer in LONGER]
        self._limits_n = np.array(limits_n).reshape(len(RUNNING_LIMITS), len(LONGER))
        self._kept = np.zeros((4 * self._most, 6))
        self._first = self._after = self._most
        self._bridged, self._held, self._rest = (round(s * rate_hz) for s in (BRIDGE_S, HELD_S, QUIET_S))
        self._unread, self._acting, self._quiet, self._level = 0, 0, 0, False

    def push(self, centre_m: Array, contacts_n: Array, judged: bool) -> RunningLoad:
        """The next frame.

        Args:
            centre_m: (3,) centre of mass; NaN where the body is not tracked.
            contacts_n: (3,) sum of the forces of all contacts.
            judged: Plates read every loaded foot.
        """
        frame = np.concatenate([centre_m, contacts_n])
        self._unread = 0 if judged else self._unread + 1
        if not isfinite(float(frame @ frame)) or self._unread > self._bridged:
            self._first = self._after
            # A foot that comes down beside its plate lacks its load before it is seen to stand there.
            return self._stated(UNKNOWN_N, self._unread <= self._held and self._acting > 2 * self._bridged)
        if not self._level:
            x, y, _ = contacts_n.tolist()
            self._level = max(abs(x), abs(y)) > READ_SHARE * self._weight_n
        self._keep(frame)
        if self._after - self._first < self._least:
            return self._stated(UNKNOWN_N, self._acting > 0)
        return self._judged(judged)

    def cut(self) -> None:
        """Begins anew after a gap or a restart of the filter."""
        self._first = self._after

    def explained(self) -> None:
        """Begins anew without a force: a contact has opened or closed that gives what was missing."""
        self._first = self._after
        self._acting = self._quiet = 0

    def _judged(self, new: bool) -> RunningLoad:
        """The frame that was kept last; a force is stated anew only if ``new``."""
        missing_n, exceeded, swings = self._missing()
        swing = swings[HALF]
        goes_on = max(exceeded[HALF:]) > RELEASE or swing > RELEASE * SWINGS
        begins = new and goes_on and (max(exceeded) > 1.0 or swing > SWINGS)
        half = HALF * len(LONGER)
        fits = self._lengths[half] <= self._after - self._first
        self._quiet = 0 if goes_on or not fits else self._quiet + 1
        return self._stated(
            missing_n[half] if fits else UNKNOWN_N,
            bool(begins or (self._acting > 0 and self._quiet <= self._rest)),
        )

    def _stated(self, force_n: Array, acts: bool) -> RunningLoad:
        self._acting = self._acting + 1 if acts else 0
        return RunningLoad(force_n, acts)

    def _keep(self, frame: Array) -> None:
        if self._after == len(self._kept):
            held = min(self._after - self._first, self._most)
            self._kept[: self._most] = self._kept[self._after - self._most :]
            self._first, self._after = self._most - held, self._most
        self._kept[self._after] = frame
        self._after += 1

    def _missing(self) -> tuple[Array, list[float], list[float]]:
        """(w, 3) mean forces over all windows that end now, 0 over those that the frames kept do not fill.

        Of each limit, the share that all of its windows exceed in one direction, and the largest share of the first.
        """
        held, known = self._kept[self._after - self._most : self._after], self._after - self._first
        kernel = library()
        if kernel is not None:
            weights = self._by_position, self._by_force, self._lengths, self._limits_n
            found = kernel.missing_forces(*weights, held, known, self._mass_kg, GRAVITY, self._level)
            return found[0], found[1].tolist(), found[2].tolist()
        required = self._by_position @ held[:, :3] - GRAVITY
        missing_n = self._mass_kg * required - self._by_force @ held[:, 3:]
        missing_n[self._lengths > known] = 0.0
        shares = missing_n.reshape(*self._limits_n.shape, 3) / self._limits_n[:, :, None]
        shares = shares[:, :, slice(None) if self._level else slice(2, None)]
        exceeded = np.maximum(shares.min(axis=1), -shares.max(axis=1)).max(axis=1)
        return missing_n, exceeded.tolist(), np.abs(shares[:, 0]).max(axis=1).tolist()


class RunningLoads:
    """Judges a motion with its contacts, one frame after another.

    Attributes:
        balance: Newton's law over the latest frames.
        centre_m: (3,) centre of mass in the latest frame; NaN where the body is not tracked.
    """

    def __init__(self, model: Body, rate_hz: float) -> None:
        """Args: the body, and the frame rate."""
        self._mass_kg, self._rate_hz, self._centre = model.mass_kg, rate_hz, CentreOfMass(model)
        self.forget()

    def forget(self) -> None:
        """Begins anew: the next frame follows none of those before."""
        self.balance = RunningBalance(self._mass_kg, self._rate_hz)
        self._stray, self.centre_m = StrayLoad(self._mass_kg, self._rate_hz), UNKNOWN_N

    @property
    def strays(self) -> bool:
        """True where the latest frame counts the load of a plate on which a foot is not recognised yet."""
        return self._stray.reads

    def push(
        self, q: Array | None, on_feet_n: Array | None, others_n: Array, plates: Array, judged: bool
    ) -> RunningLoad:
        """The next frame.

        Args:
            q: (nq,) configuration; None where the body is not tracked.
            on_feet_n: (3,) force on the feet by the contacts that were decided; None where they were not.
            others_n: (3,) force on other parts.
            plates: (K, 6) wrenches that the plates read.
            judged: Plates read every loaded foot.
        """
        self.centre_m = UNKNOWN_N if q is None else self._centre.at(q)
        contacts_n = UNKNOWN_N if on_feet_n is None else self._stray.counted(on_feet_n, plates) + others_n
        return self.balance.push(self.centre_m, contacts_n, judged)


def stated_frames(balance: LoadBalance) -> BoolArray:
    """(T,) frames of a trial in which a live run would state a force.

    Args:
        balance: Positions and contacts of the trial.
    """
    running = RunningBalance(balance.mass_kg, balance.rate_hz)
    centre_m = np.where(balance.judged[:, None], balance.centre_m, np.nan)
    frames = zip(centre_m, balance.feet_n.sum(axis=1) + balance.others_n, balance.judged, strict=True)
    return np.array([running.push(*frame).acts for frame in frames], dtype=bool)
