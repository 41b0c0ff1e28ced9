"""Muscles of a trial: the envelope of each electromyogram at the frames, and its bursts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.io.muscle_bursts import MuscleBurst
from mbkf.io.records import AnalogChannel
from mbkf.io.result_groups import Muscles
from mbkf.trial.emg.bursts import bursts
from mbkf.trial.emg.channels import electromyograms
from mbkf.trial.emg.envelope import envelope
from mbkf.trial.emg.settings import EmgSettings


def muscles_of(
    channels: Sequence[AnalogChannel], start_s: float, times_s: Array, settings: EmgSettings
) -> tuple[Muscles, tuple[str, ...]]:
    """Muscles of the electromyographic channels, and remarks; empty where a capture has no such channel.

    Args:
        channels: Channels of the capture.
        start_s: Time of their first sample.
        times_s: (T,) times of the frames.
        settings: Band, envelope and thresholds.
    """
    found, remarks = electromyograms(channels, settings)
    if not found:
        return Muscles(), remarks
    envelopes = [
        np.interp(
            times_s,
            start_s + np.arange(len(one.volts)) / one.rate_hz,
            envelope(one.volts, one.rate_hz, settings),
        )
        for one in found
    ]
    active = tuple(
        MuscleBurst(one.name, start_s + float(begin), start_s + float(end))
        for one in found
        for begin, end in bursts(one.volts, one.rate_hz, settings)
    )
    rate_hz = min(one.rate_hz for one in found)
    names = tuple(one.name for one in found)
    return Muscles(
        muscle_names=names, emg_envelope=np.array(envelopes).T, muscle_bursts=active, emg_rate_hz=rate_hz
    ), remarks
