"""Muscles of a trial: envelopes at the frames, bursts by the capture's clock."""

import numpy as np

from mbkf.io.records import AnalogChannel
from mbkf.trial.emg.envelope import envelope
from mbkf.trial.emg.muscles import muscles_of
from mbkf.trial.emg.settings import EmgSettings
from tests.trial.emg.trains import train

SETTINGS = EmgSettings()


def test_envelopes_stand_at_the_frames_and_bursts_on_the_clock_of_the_capture():
    signal, true_s = train(1000.0, 20.0, seed=8)
    channels = (AnalogChannel("Fz1", signal, "N", 1000.0), AnalogChannel("L TA", signal, "V", 1000.0))
    times_s = 12.0 + np.arange(450) / 100.0
    found, remarks = muscles_of(channels, 12.0, times_s, SETTINGS)
    assert found.muscle_names == ("tibialis_anterior_l",) and remarks == () and found.emg_rate_hz == 1000.0
    np.testing.assert_allclose(found.emg_envelope[:, 0], envelope(signal, 1000.0, SETTINGS)[::10], atol=1e-12)
    times = [(one.from_s, one.to_s) for one in found.muscle_bursts]
    np.testing.assert_allclose(times, 12.0 + true_s, atol=0.010)


def test_envelopes_are_known_while_the_recording_lasts():
    """A recording of 2 s that begins 0.5 s after the trial: its envelope is that of the recording alone."""
    signal, _ = train(1000.0, 20.0, seed=8)
    late = np.concatenate([np.full(500, np.nan), signal[:2000]])
    times_s = 12.0 + np.arange(400) / 100.0
    found, _ = muscles_of((AnalogChannel("L TA", late, "V", 1000.0),), 12.0, times_s, SETTINGS)
    known = np.flatnonzero(np.isfinite(found.emg_envelope[:, 0]))
    assert (known[0], known[-1]) == (50, 250)
    expected = envelope(signal[:2000], 1000.0, SETTINGS)
    np.testing.assert_allclose(found.emg_envelope[50:250, 0], expected[::10], atol=1e-12)
    alone, _ = muscles_of((AnalogChannel("L TA", signal[:2000], "V", 1000.0),), 12.5, times_s, SETTINGS)
    assert found.muscle_bursts == alone.muscle_bursts


def test_a_capture_without_electromyograms_has_no_muscles():
    found, _ = muscles_of((), 0.0, np.arange(3.0), SETTINGS)
    assert found.muscle_names == () and found.emg_envelope is None and found.muscle_bursts == ()
