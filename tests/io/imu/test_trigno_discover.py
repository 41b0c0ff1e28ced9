"""Exports of Trigno Discover: the layouts of its versions, each with its rate of a channel."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.imu.files import read_imu

AXES = [f"{kind} {axis}" for kind in ("ACC", "GYRO") for axis in "XYZ"]
SENSORS = ("EMG 01 (54717)", "EMG 01 (54717)", "Analog 12 (62202)")
HEAD = [
    "Application:, Trigno Discover (1.4.2)",
    "Date/Time:, 4/12/2022 5:23:09 PM",
    "Collection Length (seconds):, 0.08",
]


def export(path, form, rows=12, samples=10, rate="148.1481"):
    """Two sensors whose EMG is sampled more often, and one without accelerometer; inertial columns end earlier.

    Args:
        form: "titles": rates in titles; "rates": rates in a row below; "times": columns of times and that row.
    """
    sensors, titles, rates, columns = [], [], [], []
    for sensor in SENSORS:
        channels = ["EMG 1", *(AXES if "EMG" in sensor else [])]
        for k, channel in enumerate(channels):
            own_rate = float(rate) if k else 1000.0
            count = samples if k else rows
            values = [1.0 + k + 0.1 * row if row < count else "" for row in range(rows)]
            unit = "mV" if not k else "G" if "ACC" in channel else "deg/s"
            if form == "times":
                titles.append(f"{channel} Time Series (s)")
                rates.append("")
                columns.append([row / own_rate if row < count else "" for row in range(rows)])
            titles.append(f"{channel} ({own_rate:g}Hz)" if form == "titles" else f"{channel} ({unit})")
            rates.append(f"{own_rate} Hz")
            columns.append(values)
        sensors += [sensor, *[""] * (len(titles) - len(sensors) - 1)]
    modes = ["sensor mode: 55" if cell else "" for cell in sensors]
    table = [sensors, modes, titles, *([] if form == "titles" else [rates]), *zip(*columns, strict=True)]
    path.write_text("\n".join([*HEAD, *(", ".join(map(str, row)) for row in table)]) + "\n")
    return path


@pytest.mark.parametrize("form", ["titles", "rates", "times"])
def test_channels_are_read_at_their_own_rate_in_si_units(tmp_path, form):
    first, second = read_imu(export(tmp_path / "a.csv", form))
    assert (first.name, second.name) == ("EMG 01 (54717)", "EMG 01 (54717) 2")
    assert first.samples == second.samples == 10
    assert first.rate_hz == pytest.approx(148.1481, rel=1e-4)
    np.testing.assert_allclose(first.specific_force_mps2[1], 9.80665 * np.array([2.1, 3.1, 4.1]))
    np.testing.assert_allclose(second.angular_velocity_rad_s[1], np.radians([5.1, 6.1, 7.1]))


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda text: text.replace("ACC", "FSR").replace("GYRO", "FSR"), "no channels of an accelerometer"),
        (lambda text: text.replace("ACC Z", "FSR Z"), "of some axes only"),
        (lambda text: text.replace(" (148.148Hz)", " (Hz)"), "states no rate"),
        (lambda text: text.replace("3.1", "x"), "'x' is not a number"),
    ],
)
def test_faults_are_named(tmp_path, change, told):
    path = export(tmp_path / "a.csv", "titles")
    path.write_text(change(path.read_text()))
    with pytest.raises(FileFormatError, match=told):
        read_imu(path)


@pytest.mark.parametrize("form", ["titles", "rates", "times"])
def test_a_blank_cell_is_a_missing_sample_and_moves_no_other(tmp_path, form):
    path = export(tmp_path / "a.csv", form)
    path.write_text(path.read_text().replace(" 2.4,", " ,"))  # ACC X in the fifth row
    first, _ = read_imu(path)
    force = first.specific_force_mps2[:, 0] / 9.80665
    np.testing.assert_allclose(force, [2.0, 2.1, 2.2, 2.3, np.nan, 2.5, 2.6, 2.7, 2.8, 2.9])


def test_a_rate_that_is_no_number_counts_as_not_stated(tmp_path):
    path = export(tmp_path / "a.csv", "rates")
    path.write_text(path.read_text().replace("148.1481 Hz", "148.1.481 Hz"))
    with pytest.raises(FileFormatError, match="states no rate"):
        read_imu(path)
