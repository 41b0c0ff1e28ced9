"""Electromyograms: channels found in captures, the envelope against scipy by hand, onsets of bursts against the truth.

The thresholds were chosen on trains of the seeds 0 to 9 and 100 to 107; these rows are of others.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.signal import butter, filtfilt, sosfilt

from benchmarks.checks import Check, information
from mbkf.conventions import Array
from mbkf.io.capture import read_capture
from mbkf.io.emg_file import read_emg
from mbkf.io.emg_on_capture import with_emg
from mbkf.io.records import Capture, MarkerTrajectories
from mbkf.trial.emg.bursts import bursts
from mbkf.trial.emg.channels import electromyograms
from mbkf.trial.emg.envelope import envelope
from mbkf.trial.emg.muscles import muscles_of
from mbkf.trial.emg.settings import EmgSettings

CHANNELS = {
    "rehazenter_walk/2014001_C1_01.c3d": 8,
    "unipd_walk/Walking1.c3d": 15,
    "gaitalytics_walk/overground_fullbody_4plates.c3d": 14,
    "biomechzoo_walk_turn/HC032A_Straight_HC032A03.c3d": 10,
    "landings/doubleLegLanding.c3d": 4,
    "biobuddy_functional/static.c3d": 0,
    "flywheel_squat/S1_FlywheelSquat.c3d": 0,
    "cgm24_lowerlimb_walk/CGM24_Walking01.c3d": 0,
}
"""Channels named as muscles in each capture, counted by eye; two of biomechzoo's are spare, those of
biobuddy's hold no numbers."""

SHARE, ONSET_MS = 1e-9, 10.0
RATES_HZ = (1000.0, 1500.0, 2000.0)
FIRST_SEED, TRAINS = 2000, 10


class Train(NamedTuple):
    """A made electromyogram: (S,) samples, and (B, 2) begins and ends of its bursts, s."""

    samples: Array
    bursts_s: Array


def emg_rows(data: Path, quick: bool, out: Path) -> Iterator[Check]:
    """Rows of channels, envelopes and onsets.

    Args:
        data: Folder of the captures.
        quick: Fewer trains.
        out: Folder for tables.
    """
    settings = EmgSettings()
    wrong = 0
    for name, count in CHANNELS.items():
        found, _ = electromyograms(read_capture(data / name).analog, settings)
        wrong += abs(len(found) - count)
    yield Check(f"channels found too many or too few in {len(CHANNELS)} captures", wrong, 0, "<=")
    capture = read_capture(data / "rehazenter_walk/2014001_C1_01.c3d")
    found, _ = electromyograms(capture.analog, settings)
    apart = [
        _apart(envelope(one.volts, one.rate_hz, settings), _by_hand(one.volts, one.rate_hz)) for one in found
    ]
    yield Check("envelope of rehazenter_walk against scipy by hand", max(apart), SHARE, "<=", "of the peak")
    yield from _table_rows(out)
    trains = range(FIRST_SEED, FIRST_SEED + (2 if quick else TRAINS))
    for louder_db, bounded in ((20.0, 100.0), (16.0, 100.0), (12.0, 95.0), (8.0, None)):
        errors, lost = _onset_errors(louder_db, trains, settings)
        name = f"onset of bursts {louder_db:g} dB above the noise"
        yield Check(f"{name}: bursts lost, split or added", lost, 0 if bounded else np.inf, "<=")
        if bounded is None:
            yield information(f"{name}: error of 95 %", float(np.percentile(errors, 95.0)), "ms")
        else:
            what = "largest error" if bounded == 100.0 else f"error of {bounded:g} %"
            yield Check(f"{name}: {what}", float(np.percentile(errors, bounded)), ONSET_MS, "<=", "ms")


def _table_rows(out: Path) -> Iterator[Check]:
    """Onsets in trains that Noraxon's and Trigno Discover's layouts hold, 0.25 s after a trial's first frame."""
    made = train(1000.0, 20.0, FIRST_SEED)
    times_s = np.arange(len(made.samples)) / 1000.0
    heads = {
        "Noraxon": "Type\tRaw\nDate\t1\n\nTime,s\tRT TIB.ANT.,uV\tMarker\n",
        "Trigno Discover": "Application:,Trigno Discover (1.7.0)\nTA R (5),,\nmode: 1,,\n"
        "EMG 1 Time Series (s),EMG 1 (mV),ACC X (G)\n,1000 Hz,148 Hz\n",
    }
    markers = MarkerTrajectories(("A",), np.zeros((1000, 1, 3)), 100.0, start_time_s=3.0)
    for maker, head in heads.items():
        mark = "\t" if maker == "Noraxon" else ","
        rows = [f"{t:.6g}{mark}{v:.9g}{mark}0.5" for t, v in zip(times_s, made.samples, strict=True)]
        file = out / f"{maker}.csv"
        file.write_text(head + "\n".join(rows) + "\n", encoding="utf-8")
        capture = with_emg(Capture("", markers), read_emg(file), 3.25)
        frames_s = 3.0 + np.arange(1000) / 100.0
        found, _ = muscles_of(capture.analog, 3.0, frames_s, EmgSettings())
        begins = np.array([one.from_s for one in found.muscle_bursts]) - 3.25
        wrong = float("inf")
        if found.muscle_names == ("tibialis_anterior_r",) and len(begins) == len(made.bursts_s):
            wrong = 1e3 * float(np.abs(begins - made.bursts_s[:, 0]).max())
        yield Check(
            f"table of {maker}, offset by 0.25 s: largest error of an onset", wrong, ONSET_MS, "<=", "ms"
        )


def _by_hand(volts: Array, rate_hz: float) -> Array:
    """The envelope by transfer functions, number for number as the documentation states it."""
    band = butter(2, [20.0, min(450.0, 0.45 * rate_hz)], "bandpass", fs=rate_hz)
    low = butter(2, 6.0, "lowpass", fs=rate_hz)
    return np.asarray(filtfilt(*low, np.abs(filtfilt(*band, volts - volts.mean()))))


def _apart(one: Array, other: Array) -> float:
    return float(np.abs(one - other).max() / np.abs(other).max())


def _onset_errors(louder_db: float, seeds: range, settings: EmgSettings) -> tuple[Array, int]:
    """Absolute errors of the onsets in ms, and the number of bursts too few and too many."""
    errors, lost = [], 0
    for rate_hz in RATES_HZ:
        for seed in seeds:
            made = train(rate_hz, louder_db, seed)
            found = bursts(made.samples, rate_hz, settings)
            lost += abs(len(found) - len(made.bursts_s))
            for begin, end in made.bursts_s:
                meets = (found[:, 0] < end) & (found[:, 1] > begin)
                if meets.any():
                    errors.append(1e3 * abs(found[meets][0, 0] - begin))
    return np.array(errors), lost


def train(rate_hz: float, louder_db: float, seed: int, seconds: float = 8.0) -> Train:
    """Bursts of 0.15 to 0.45 s with pauses of 0.3 to 0.7 s: filtered noise (30-300 Hz) over white noise.

    Args:
        rate_hz: Sample rate.
        louder_db: The muscle's variance over the noise's, dB.
        seed: Of what is drawn.
        seconds: Length.
    """
    rng = np.random.default_rng(seed)
    edges, at = [], 0.4
    while at + 0.6 < seconds:
        edges.append((at, at + rng.uniform(0.15, 0.45)))
        at = edges[-1][1] + rng.uniform(0.3, 0.7)
    count = round(seconds * rate_hz)
    sections = butter(2, [30.0, 300.0], "bandpass", fs=rate_hz, output="sos")
    muscle = sosfilt(sections, rng.standard_normal(count + 1000))[1000:]
    active = np.zeros(count)
    for begin, end in edges:
        active[int(begin * rate_hz) : int(end * rate_hz)] = 1.0
    loud = 10.0 ** (louder_db / 20.0) * active * muscle / muscle.std()
    return Train(loud + rng.standard_normal(count), np.array(edges))
