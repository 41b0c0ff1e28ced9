"""Muscles of a trial: the envelope of each electromyogram at the frames, and its bursts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mbkf.conventions import Array
from mbkf.io.muscle_bursts import MuscleBurst
from mbkf.io.records import AnalogChannel
from mbkf.io.result_groups import Muscles
from mbkf.trial.emg.bursts import bursts
from mbkf.trial.emg.channels import Electromyogram, electromyograms
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
    envelopes = [_at(times_s, start_s + one.delay_s, one, settings) for one in found]
    active = tuple(
        MuscleBurst(one.name, *(start_s + one.delay_s + float(at) for at in burst))
        for one in found
        for burst in bursts(one.volts, one.rate_hz, settings)
    )
    rate_hz = min(one.rate_hz for one in found)
    names = tuple(one.name for one in found)
    return Muscles(
        muscle_names=names, emg_envelope=np.array(envelopes).T, muscle_bursts=active, emg_rate_hz=rate_hz
    ), remarks


def _at(times_s: Array, first_s: float, one: Electromyogram, settings: EmgSettings) -> Array:
    """(T,) the envelope at times; NaN where it was not recorded, but for half a frame at both ends."""
    sampled_s = first_s + np.arange(len(one.volts)) / one.rate_hz
    values = np.interp(times_s, sampled_s, envelope(one.volts, one.rate_hz, settings))
    slack_s = 0.5 * float(np.median(np.diff(times_s))) if len(times_s) > 1 else 0.0
    values[(times_s < sampled_s[0] - slack_s) | (times_s > sampled_s[-1] + slack_s)] = np.nan
    return values
