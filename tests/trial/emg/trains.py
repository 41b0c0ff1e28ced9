"""Electromyograms with known bursts: filtered noise, louder where the muscle is active."""

import numpy as np
from scipy.signal import butter, sosfilt


def train(rate_hz, louder_db, seed, bursts_s=((0.5, 0.8), (1.4, 1.75), (2.6, 2.8), (3.3, 3.9)), seconds=4.5):
    """Samples, and the (B, 2) begins and ends."""
    rng = np.random.default_rng(seed)
    count = round(seconds * rate_hz)
    sections = butter(2, [30.0, 300.0], "bandpass", fs=rate_hz, output="sos")
    muscle = sosfilt(sections, rng.standard_normal(count + 1000))[1000:]
    active = np.zeros(count)
    for begin, end in bursts_s:
        active[round(begin * rate_hz) : round(end * rate_hz)] = 1.0
    signal = 10.0 ** (louder_db / 20.0) * active * muscle / muscle.std()
    return signal + rng.standard_normal(count), np.array(bursts_s)
