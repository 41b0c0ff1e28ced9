"""Channels of a capture that hold electromyograms, by name, unit, rate and content."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.io.muscle_names import Muscle, muscle_of
from mbkf.io.records import AnalogChannel
from mbkf.trial.emg.settings import EmgSettings

VOLTS = {"v": 1.0, "volt": 1.0, "volts": 1.0, "mv": 1e-3, "uv": 1e-6, "µv": 1e-6, "μv": 1e-6, "": 1.0}
"""Factor to V by unit in small letters; a file without a unit is taken to hold V."""

SHORTEST_S = 0.5
"""Shorter recordings are left out: the filters' ends would be all of it."""


@dataclass(frozen=True)
class Electromyogram:
    """A channel.

    Attributes:
        name: The muscle with its side at the end, e.g. "tibialis_anterior_r".
        volts: (S,) samples in V.
        rate_hz: Sample rate.
        delay_s: Time of the first sample after that of the channel; a recording may begin later than the trial.
    """

    name: str
    volts: Array
    rate_hz: float
    delay_s: float = 0.0


def electromyograms(
    channels: Iterable[AnalogChannel], settings: EmgSettings
) -> tuple[tuple[Electromyogram, ...], tuple[str, ...]]:
    """The electromyograms among channels, and remarks on those that cannot be used.

    Channels of plates, accelerometers and switches have other names or units.

    Args:
        channels: Channels of a capture.
        settings: The least rate.
    """
    found, remarks, slow, empty, short = [], [], [], [], []
    seen = Counter[Muscle]()
    for channel in channels:
        muscle, factor = muscle_of(channel.name), VOLTS.get(channel.unit.strip().lower())
        if muscle is None or factor is None:
            continue
        if channel.rate_hz < settings.least_rate_hz:
            slow.append(channel)
            continue
        recorded = np.flatnonzero(np.isfinite(channel.values))
        values = channel.values[recorded[0] : recorded[-1] + 1] if len(recorded) else channel.values
        if not _has_signal(values):
            empty.append(channel.name)
        elif len(values) < SHORTEST_S * channel.rate_hz:
            short.append(channel.name)
        else:
            seen[muscle] += 1
            again = f"_{seen[muscle]}" if seen[muscle] > 1 else ""
            name = f"{muscle.name}{again}" + (f"_{muscle.side}" if muscle.side else "")
            found.append(
                Electromyogram(name, factor * values, channel.rate_hz, recorded[0] / channel.rate_hz)
            )
    if empty:
        remarks.append(
            f"EMG: {', '.join(empty)} hold gaps or one value alone: their envelopes are not shown; check the electrodes"
        )
    if short:
        remarks.append(
            f"EMG: {', '.join(short)} last less than {SHORTEST_S:g} s, too short for the filters: their envelopes are "
            "not shown; record longer trials"
        )
    if slow:
        remarks.append(
            f"EMG: {', '.join(one.name for one in slow)} have {slow[0].rate_hz:g} samples a second, at least "
            f"{settings.least_rate_hz:g} are needed: their envelopes are not shown; export the channels unfiltered"
        )
    return tuple(found), tuple(remarks)


def _has_signal(values: Array) -> bool:
    """True for finite samples that are not all the same."""
    return bool(np.isfinite(values).all()) and float(np.ptp(values)) > 0.0
