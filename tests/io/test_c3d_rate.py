"""The frame rate is the one that two of three entries state; an impossible one is never used."""

from pathlib import Path

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.c3d import read_c3d
from mbkf.io.c3d_rate import frame_rate
from mbkf.io.capture_options import CaptureOptions
from tests.io.c3d_builder import standing_points
from tests.io.c3d_bytes import INTEL, c3d_bytes, floats

PATH = Path("x.c3d")


@pytest.mark.parametrize(
    ("stated", "header", "analog", "rate", "remark"),
    [
        (100.0, 100.0, 100.0, 100.0, ""),
        (100.0, 0.0, 0.0, 100.0, ""),
        (0.0, 100.0, 0.0, 100.0, ""),
        (0.0, 0.0, 100.0, 100.0, "is 100 Hz by ANALOG:RATE over the samples per frame"),
        (59.94, 60.0, 60.0, 59.94, ""),
        (100.0, 100.0, 77.0, 100.0, ""),
        (77.0, 100.0, 100.0, 100.0, "not used: POINT:RATE 77 Hz"),
        (100.0, 77.0, 100.0, 100.0, "not used: its header 77 Hz"),
        (77.0, 100.0, 0.0, 77.0, "not used: its header 100 Hz"),
        (-5.0, 100.0, 0.0, 100.0, "not used: POINT:RATE -5 Hz"),
        (np.nan, 100.0, 0.0, 100.0, "not used: POINT:RATE nan Hz"),
        (np.inf, np.nan, 50.0, 50.0, "not used: POINT:RATE inf Hz, its header nan Hz"),
    ],
)
def test_two_entries_that_agree_decide(stated, header, analog, rate, remark):
    found, remarks = frame_rate(PATH, stated, header, analog)
    assert found == rate and (remark in remarks[0] if remark else not remarks)


@pytest.mark.parametrize("rate", [0.0, -1.0, np.nan, 1e30])
def test_a_file_without_a_possible_rate_is_refused_with_the_remedy(rate):
    with pytest.raises(FileFormatError, match="write the frame rate into POINT:RATE"):
        frame_rate(PATH, rate, 0.0, 0.0)


def test_markers_and_analog_channels_have_the_settled_rate(tmp_path):
    wrong = ((1, "RATE", 4, (), floats([77.0], INTEL)),)
    path = tmp_path / "x.c3d"
    path.write_bytes(c3d_bytes(standing_points(12, 5), np.ones((12, 3, 2)), extra=wrong))
    capture = read_c3d(path, CaptureOptions())
    assert capture.markers.rate_hz == 100.0 and capture.analog[0].rate_hz == 300.0
    assert any("not used: POINT:RATE 77 Hz" in note for note in capture.notes)
