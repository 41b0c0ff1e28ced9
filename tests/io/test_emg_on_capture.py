"""EMG on the trial's clock: earlier samples are left out, later starts are NaN, other times are refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.capture import read_capture
from mbkf.io.emg_file import EmgFile
from mbkf.io.emg_on_capture import emg_beside, with_emg
from mbkf.io.records import AnalogChannel, Capture, MarkerTrajectories
from mbkf.io.trc import write_trc
from tests.io.emg_tables import noraxon

MARKERS = MarkerTrajectories(("A",), np.zeros((101, 1, 3)), 100.0, start_time_s=2.0)
CAPTURE = Capture("walk.c3d", MARKERS, analog=(AnalogChannel("R TA", np.zeros(9), "V", 1000.0),))
VALUES = np.arange(3000.0)


def emg(start, offset=0.0):
    return EmgFile(Path("e.csv"), (AnalogChannel("R TA", VALUES, "uV", 1000.0),), (start,), offset)


@pytest.mark.parametrize(
    ("start", "stated", "given", "first"),
    [(0.0, 0.0, None, 2000.0), (None, 0.0, None, 0.0), (1.0, 0.5, None, 500.0), (1.0, 0.5, 0.0, 1000.0),
     (None, 0.0, -0.5, 500.0)],
)  # fmt: skip
def test_the_first_sample_is_that_of_the_first_frame(start, stated, given, first):
    found = with_emg(CAPTURE, emg(start, stated), given)
    (channel,) = found.analog
    assert channel.values[0] == first and channel.unit == "uV"
    assert "EMG from e.csv: 1 channels" in found.notes[-1]


def test_time_before_the_recording_is_missing():
    (channel,) = with_emg(CAPTURE, emg(2.25)).analog
    assert np.isnan(channel.values[:250]).all() and channel.values[250] == 0.0


@pytest.mark.parametrize("start", [3.5, -4.0])
def test_another_time_is_refused(start):
    with pytest.raises(InvalidInput, match="state the time between both clocks"):
        with_emg(CAPTURE, emg(start))


def test_the_file_beside_a_capture_is_read_with_it(tmp_path):
    markers = replace(MARKERS, start_time_s=0.0)
    write_trc(markers, tmp_path / "walk.trc")
    assert emg_beside(tmp_path / "walk.trc") is None
    (tmp_path / "Walk_EMG.txt").write_text(noraxon())
    found = read_capture(tmp_path / "walk.trc")
    assert [one.name for one in found.analog] == ["RT TIB.ANT.", "LT VLO"]
    moved = read_capture(tmp_path / "walk.trc", emg=tmp_path / "Walk_EMG.txt", emg_offset_s=-0.1)
    np.testing.assert_array_equal(moved.analog[0].values, found.analog[0].values[100:])
