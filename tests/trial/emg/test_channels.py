"""Channels of a capture that hold electromyograms."""

from dataclasses import replace

import numpy as np

from mbkf.io.records import AnalogChannel
from mbkf.trial.emg.channels import electromyograms
from mbkf.trial.emg.settings import EmgSettings

NOISE = np.random.default_rng(1).standard_normal(2000)
SOLEUS = AnalogChannel("R_soleus", NOISE, "mV", 1000.0)


def names(*channels):
    return [one.name for one in electromyograms(channels, EmgSettings())[0]]


def test_units_become_volts():
    units = (("V", 1.0), ("mV", 1e-3), ("uV", 1e-6), ("µV", 1e-6), ("", 1.0))
    for unit, factor in units:
        (found,), _ = electromyograms([replace(SOLEUS, unit=unit)], EmgSettings())
        np.testing.assert_allclose(found.volts, factor * NOISE)


def test_channels_by_name_unit_and_content():
    assert names(SOLEUS, replace(SOLEUS, name="L TA"), replace(SOLEUS, name="EMG4")) == [
        "soleus_r", "tibialis_anterior_l", "emg_4",
    ]  # fmt: skip
    flat = replace(SOLEUS, values=np.full(2000, 3.0))
    broken = replace(SOLEUS, values=np.where(np.arange(2000) == 7, np.nan, NOISE))
    short = replace(SOLEUS, values=NOISE[:400])
    force, turned = replace(SOLEUS, name="Fx1"), replace(SOLEUS, unit="deg")
    assert names(flat, broken, short, force, turned) == []
    assert electromyograms([replace(flat, name="R TA"), short], EmgSettings())[1] == (
        "EMG: R TA hold gaps or one value alone: their envelopes are not shown; check the electrodes",
        "EMG: R_soleus last less than 0.5 s, too short for the filters: their envelopes are not shown; record longer "
        "trials",
    )


def test_a_recording_may_begin_and_end_inside_the_trial():
    values = np.concatenate([np.full(300, np.nan), NOISE[:1000], np.full(200, np.nan)])
    ((found,), remarks) = electromyograms([replace(SOLEUS, values=values)], EmgSettings())
    assert found.delay_s == 300 / SOLEUS.rate_hz and len(found.volts) == 1000 and not remarks


def test_two_channels_of_a_muscle_keep_a_name_each():
    assert names(SOLEUS, replace(SOLEUS, name="Right Soleus")) == ["soleus_r", "soleus_2_r"]


def test_slow_channels_are_left_out_and_named():
    found, remarks = electromyograms([replace(SOLEUS, rate_hz=100.0), SOLEUS], EmgSettings())
    assert len(found) == 1 and len(remarks) == 1
    assert "R_soleus" in remarks[0] and "100 samples a second" in remarks[0] and "500" in remarks[0]
