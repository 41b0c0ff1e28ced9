"""Faults that are put into clean captures: a wrong mass, a late clock, half a step beside a plate, a load.

A load that acts on the body takes as much from the plates; it does not change the motion, which is that of the person
who was recorded. Plates keep their centres of pressure.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.io.records import Capture, PlateReadings
from mbkf.io.subject import Subject
from mbkf.numerics.runs import runs

VERTICAL = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 0.0])
"""Components of a wrench about a point of the surface that a vertical force changes."""

RAMP_S = 0.1
"""Time in which a load comes and goes."""

LEAST_STANCE_S, STANCE_N = 0.3, 20.0
"""Least duration and vertical force of a stance."""

With = tuple[Capture, Subject, Array | None]
"""Capture and person with a fault, and (T, 3) force that nothing reads, N; None for a wrong mass, clock or plate."""


class Fault(Protocol):
    """A fault."""

    @property
    def label(self) -> str:
        """Its name in rows."""

    def put_into(self, capture: Capture, subject: Subject) -> With:
        """The capture and the person with the fault."""


@dataclass(frozen=True)
class Mass:
    """The person is said to have another mass.

    Attributes:
        factor: Stated over true mass.
    """

    factor: float

    @property
    def label(self) -> str:
        """Its name in rows."""
        return f"mass {100.0 * (self.factor - 1.0):+.0f} %"

    def put_into(self, capture: Capture, subject: Subject) -> With:
        """The person with that mass."""
        return capture, replace(subject, mass_kg=self.factor * subject.mass_kg), None


@dataclass(frozen=True)
class Clock:
    """The plates are late.

    Attributes:
        late_s: By so much.
    """

    late_s: float

    @property
    def label(self) -> str:
        """Its name in rows."""
        return f"plates {1e3 * abs(self.late_s):.0f} ms {'late' if self.late_s > 0 else 'early'}"

    def put_into(self, capture: Capture, subject: Subject) -> With:
        """The capture with its plates at another time."""
        plates = [replace(one, start_time_s=one.start_time_s + self.late_s) for one in capture.plates]
        return replace(capture, plates=tuple(plates)), subject, None


@dataclass(frozen=True)
class Beside:
    """One step stands partly beside its plate, which reads a share of it: the longest stance of all plates.

    Attributes:
        share: The share.
    """

    share: float

    @property
    def label(self) -> str:
        """Its name in rows."""
        return f"{100.0 * (1.0 - self.share):.0f} % of a step beside the plate"

    def put_into(self, capture: Capture, subject: Subject) -> With:
        """The capture with that step."""
        found = [
            ((after - first) / plate.rate_hz, p, first, after)
            for p, plate in enumerate(capture.plates)
            for first, after in runs(plate.force_n[:, 2] > STANCE_N)
            if (after - first) / plate.rate_hz > LEAST_STANCE_S
        ]
        _, p, first, after = max(found)
        plates = list(capture.plates)
        gain = np.ones(len(plates[p].force_n))
        gain[first:after] = self.share
        plates[p] = scaled(plates[p], gain, np.ones(6))
        return replace(capture, plates=tuple(plates)), subject, None


@dataclass(frozen=True)
class Load:
    """A vertical force acts on the body for a part of the trial; plates read that much less.

    Attributes:
        name: Its name.
        share: Share of body weight, upward.
        span: When it begins and ends, as shares of the trial's duration.
    """

    name: str
    share: float
    span: tuple[float, float]

    @property
    def label(self) -> str:
        """Its name in rows."""
        return f"{self.name} of {100.0 * abs(self.share):.0f} % of body weight"

    def put_into(self, capture: Capture, subject: Subject) -> With:
        """The capture with the load; a load never exceeds what the plates read."""
        times = capture.markers.times_s
        begin, end = (times[0] + share * (times[-1] - times[0]) for share in self.span)
        most_n = self.share * subject.mass_kg * GRAVITY_M_S2
        read = sum(_vertical(plate, times) for plate in capture.plates)

        def load(t: Array) -> Array:
            ramp = np.clip(np.minimum(t - begin, end - t) / RAMP_S + 0.5, 0.0, 1.0)
            return np.minimum(most_n * ramp, np.interp(t, times, read))

        plates = []
        for plate in capture.plates:
            total = np.maximum(np.interp(plate.times_s, times, read), STANCE_N)
            plates.append(scaled(plate, 1.0 - load(plate.times_s) / total, VERTICAL))
        unread = load(times)[:, None] * [0.0, 0.0, 1.0]
        return replace(capture, plates=tuple(plates)), subject, unread


def _vertical(plate: PlateReadings, times_s: Array) -> Array:
    """(T,) vertical force of a plate at times."""
    return np.asarray(np.interp(times_s, plate.times_s, np.nan_to_num(plate.force_n[:, 2])))


def scaled(plate: PlateReadings, gain: Array, components: Array) -> PlateReadings:
    """A plate with components of its wrench times a gain (S,).

    Args:
        plate: The plate.
        gain: The gain.
        components: (6,) 1 for components that it applies to, 0 for others.
    """
    each = 1.0 + np.outer(gain - 1.0, components)
    return replace(plate, force_n=plate.force_n * each[:, :3], moment_nm=plate.moment_nm * each[:, 3:])
