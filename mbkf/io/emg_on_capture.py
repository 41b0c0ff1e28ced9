"""Electromyograms of a file of their own on the clock of a capture."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.emg_file import SUFFIXES, EmgFile
from mbkf.io.records import AnalogChannel, Capture

ENDINGS = ("_emg", ".emg", "-emg", " emg")
"""Between a capture's name and the ending of its file of EMG, in small letters."""

MOST_OFFSET_S = 3600.0


def emg_beside(path: Path) -> Path | None:
    """The file of EMG beside a capture, ``walk_emg.csv`` beside ``walk.c3d``; None without.

    Args:
        path: The capture.
    """
    names = {path.stem.lower() + ending + suffix for ending in ENDINGS for suffix in SUFFIXES}
    if not path.parent.is_dir():
        return None
    found = sorted(file for file in path.parent.iterdir() if file.name.lower() in names and file != path)
    return found[0] if found else None


def with_emg(capture: Capture, emg: EmgFile, offset_s: float | None = None) -> Capture:
    """The capture with the channels of a file; its own channels of these names give way.

    Channels begin with the capture's first frame: samples before it are left out, time before the file's first sample
    is filled with NaN. A sample is moved by half a sample at most.

    Args:
        capture: The capture.
        emg: The channels.
        offset_s: Seconds to add to the file's times, which begin with the first frame where it has none; None: as the
            file states.

    Raises:
        InvalidInput: The file and the capture have no time in common.
    """
    offset = emg.offset_s if offset_s is None else offset_s
    markers = capture.markers
    begin_s, last_s = markers.start_time_s, markers.start_time_s + (markers.frames - 1) / markers.rate_hz
    channels = []
    firsts, ends = [], []
    for channel, own_s in zip(emg.channels, emg.starts_s, strict=True):
        first_s = (begin_s if own_s is None else own_s) + offset
        firsts.append(first_s)
        ends.append(first_s + (len(channel.values) - 1) / channel.rate_hz)
        if not abs(offset) <= MOST_OFFSET_S or ends[-1] <= begin_s or first_s >= last_s:
            raise InvalidInput(
                f"{emg.path.name}: EMG lasts from {first_s:.4g} to {ends[-1]:.4g} s, the trial from {begin_s:.4g} to "
                f"{last_s:.4g} s; state the time between both clocks"
            )
        samples = _from(channel.values, round((begin_s - first_s) * channel.rate_hz))
        channels.append(AnalogChannel(channel.name, samples, channel.unit, channel.rate_hz))
    note = (
        f"EMG from {emg.path.name}: {len(channels)} channels from {min(firsts):.4g} to {max(ends):.4g} s, the trial "
        f"from {begin_s:.4g} to {last_s:.4g} s"
    )
    note += f", its times moved by {offset:+.4g} s" if offset else ", its clock taken as the trial's"
    names = {channel.name for channel in channels}
    kept = tuple(channel for channel in capture.analog if channel.name not in names)
    return replace(capture, analog=(*kept, *channels), notes=(*capture.notes, note))


def _from(values: Array, first: int) -> Array:
    """Samples from one on; NaN before the first one."""
    return values[first:] if first >= 0 else np.concatenate([np.full(-first, np.nan), values])
