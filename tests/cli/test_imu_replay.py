"""`mbkf imu replay` refuses what it cannot play in one line; what it plays arrives (test_imu_live)."""

import pytest

from mbkf.cli.main import main


@pytest.fixture
def recording(tmp_path):
    lines = [
        "time,pelvis_acc_x [m/s2],pelvis_acc_y [m/s2],pelvis_acc_z [m/s2],"
        "pelvis_gyr_x [rad/s],pelvis_gyr_y [rad/s],pelvis_gyr_z [rad/s]"
    ]
    lines += [f"{k / 100.0},0,0,9.81,0,0,0.1" for k in range(20)]
    path = tmp_path / "pelvis.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def test_without_a_receiver_it_is_played_all_the_same(recording, capsys):
    words = ["imu", "replay", str(recording), "--wait", "0", "--speed", "10", "--loss", "0.5"]
    assert main(words) == 0
    printed = capsys.readouterr().out
    assert "at 1000 Hz" in printed and "0 left out" not in printed


@pytest.mark.parametrize(
    ("more", "message"),
    [(["--speed", "0"], "--speed"), (["--loss", "2"], "--loss"), (["--units", "acc"], "--units")],
)
def test_bad_options_are_one_line(more, message, recording, refused):
    refused(["imu", "replay", str(recording), *more], message)


def test_a_file_that_is_none_is_one_line(tmp_path, refused):
    refused(["imu", "replay", str(tmp_path / "none.csv")], "no such file")
