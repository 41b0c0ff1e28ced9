"""Settings of the electromyograms: the band of SENIAM, and a burst that needs more than one pair."""

from mbkf.trial.emg.settings import EmgSettings


def test_the_bands_lie_in_each_other():
    chosen = EmgSettings()
    assert chosen.envelope_hz < chosen.low_hz < chosen.burst_low_hz < chosen.high_hz < chosen.least_rate_hz
    assert 1 < chosen.needed <= chosen.pairs and chosen.order % 2 == chosen.burst_order % 2 == 0
