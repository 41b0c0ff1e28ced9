"""The benchmark of electromyograms: its trains are as loud and as long as it says."""

import numpy as np
import pytest

from benchmarks.clinic.emg import train


def test_a_train_is_louder_in_its_bursts():
    made = train(2000.0, 12.0, 7)
    at = np.arange(len(made.samples)) / 2000.0
    inside = ((at[:, None] >= made.bursts_s[:, 0]) & (at[:, None] < made.bursts_s[:, 1])).any(axis=1)
    gained = made.samples[inside].var() - made.samples[~inside].var()
    assert 10.0 * np.log10(gained / made.samples[~inside].var()) == pytest.approx(12.0, abs=1.0)
    lengths, pauses = made.bursts_s[:, 1] - made.bursts_s[:, 0], made.bursts_s[1:, 0] - made.bursts_s[:-1, 1]
    assert lengths.min() >= 0.15 and lengths.max() <= 0.45 and pauses.min() >= 0.3
