"""Rates in words above a table, in the spellings of several programs."""

from pathlib import Path

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.stated_rate import rate_above
from mbkf.io.imu.table_text import split_table

NAMES = "acc_x [g],acc_y [g],acc_z [g]\n0,0,1\n0,0,1\n"


@pytest.mark.parametrize(
    ("line", "rate_hz"),
    [
        ("// Sample rate: 50.0Hz", 50.0),
        ("Sample Rate:,128,Hz", 128.0),
        ("Frequency: 100", 100.0),
        ("# sampling_rate = 51.2", 51.2),
        ("Sampling Frequency (Hz),60", 60.0),
        ("Device,IMU,Frequency [Hz],100", 100.0),
        ("Heart rate: 70", None),
        ("# Cutoff frequency: 6", None),
        ("Filter,Low-pass frequency (Hz),15", None),
        ("# sample rate: 50\n# output rate: 100", None),
    ],
)
def test_a_rate_in_words(tmp_path, line, rate_hz):
    text = split_table(Path("a.csv"), f"{line}\n{NAMES}")
    assert rate_above(text, 0 if line.startswith(("#", "//")) else 1) == rate_hz
    path = tmp_path / "a.csv"
    path.write_text(f"{line}\n{NAMES}")
    if rate_hz is None:
        with pytest.raises(InvalidInput, match="--rate"):
            read_imu(path)
    else:
        np.testing.assert_allclose(np.diff(read_imu(path)[0].time_s), 1.0 / rate_hz)
