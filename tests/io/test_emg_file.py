"""Tables of electromyograms of several makers hold one signal; faults are named."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.emg_file import read_emg
from mbkf.io.muscle_names import muscle_of
from tests.io.emg_tables import FORMS, RATE_HZ, TIBIALIS, VASTUS, noraxon, plain, rows

VOLTS = {"V": 1.0, "mV": 1e-3, "uV": 1e-6, "": 1.0}


@pytest.mark.parametrize("form", FORMS)
def test_muscles_times_and_units_are_those_of_every_form(tmp_path, form):
    (tmp_path / "emg.csv").write_text(FORMS[form]())
    found = read_emg(tmp_path / "emg.csv")
    muscles = [muscle_of(one.name) for one in found.channels]
    assert muscles == [("tibialis_anterior", "r"), ("vastus_lateralis", "l")]
    for one, values in zip(found.channels, (TIBIALIS, VASTUS), strict=True):
        assert one.rate_hz == pytest.approx(RATE_HZ)
        np.testing.assert_allclose(VOLTS[one.unit] * one.values, values, atol=1e-12)
    assert found.starts_s == ((None, None) if form == "plain" else (0.0, 0.0))
    assert found.offset_s == (0.25 if form == "plain" else 0.0)


def test_times_in_milliseconds(tmp_path):
    t = np.arange(100.0, 1100.0)
    (tmp_path / "e.csv").write_text("Time (ms),EMG soleus L\n" + rows(t, VASTUS))
    found = read_emg(tmp_path / "e.csv")
    assert found.starts_s == (0.1,) and found.channels[0].rate_hz == pytest.approx(1000.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (noraxon().replace("RT TIB.ANT.", "A").replace("LT VLO", "B"), "no column is named after a muscle"),
        (plain().replace("# sampling rate: 1000\n", ""), "neither times nor a rate"),
        (noraxon().replace("0.005\t", "0.05\t", 1), "not evenly spaced"),
        (plain().replace(";0.0", ";x0.0", 1).replace(";-0.0", ";x", 1), "not a number|no column"),
        ("a;b\nc;d\ne;f\n", "no rows of numbers"),
    ],
)
def test_faults_are_named(tmp_path, text, message):
    (tmp_path / "e.csv").write_text(text)
    with pytest.raises(FileFormatError, match=message):
        read_emg(tmp_path / "e.csv")
