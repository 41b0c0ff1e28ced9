"""`mbkf imu live` follows sensors and leaves what `mbkf imu motion` writes; `mbkf imu replay` plays them."""

import json
import threading
import uuid

import h5py
import numpy as np
import pytest

from mbkf.cli.main import main
from mbkf.io.imu.write import write_imu_csv
from mbkf.io.results_folder import RESULT_FILES
from mbkf.io.subject import write_subject
from tests.worn import worn


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Sensors of a person who stands and then turns round, and the person."""
    folder, turn = tmp_path_factory.mktemp("worn"), worn("turn", 14.0)
    short = [
        type(one)(
            one.name, one.time_s[:500], one.specific_force_mps2[:500], one.angular_velocity_rad_s[:500],
            None, one.rate_hz,
        )
        for one in turn.moving
    ]  # fmt: skip
    write_imu_csv(short, folder / "turn.csv")
    write_subject(turn.subject, folder / "subject.toml")
    return folder


def run(files, out, *more):
    return main(["imu", "live", "--subject", str(files / "subject.toml"), "--out", str(out), *more])


@pytest.fixture(scope="module")
def played(files, tmp_path_factory):
    """Folder of a recording that was played as a stream, its log kept, and the configurations found."""
    out = tmp_path_factory.mktemp("played")
    assert run(files, out, "--from", f"file:{files / 'turn.csv'}", "--speed", "0", "--keep-log") == 0
    return out, configurations(out)


def configurations(folder):
    with h5py.File(folder / "motion.h5") as file:
        return file["q"][:]


def test_a_recording_played_as_a_stream_leaves_a_results_folder(files, tmp_path, capsys):
    assert run(files, tmp_path, "--from", f"file:{files / 'turn.csv'}", "--speed", "0", "--seconds", "1") == 0
    printed = capsys.readouterr()
    assert "frames: 100 received, 0 lost" in printed.out and "8 sensors calibrated" in printed.err
    assert {path.name for path in tmp_path.iterdir()} >= {
        "live.json",
        "mounts.toml",
        "summary.json",
        "motion.h5",
    }
    assert {path.name for path in tmp_path.iterdir()} <= {*RESULT_FILES, "live.json", "mounts.toml"}
    told = json.loads((tmp_path / "live.json").read_text())
    assert told["state"] == "finished" and told["calibration"]["sensors"]["pelvis"] == "pelvis"
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["protocol"] == "inertial sensors" and summary["frames"] == 100
    with h5py.File(tmp_path / "motion.h5") as file:
        assert np.isfinite(file["q"][:]).all() and file["times_s"][0] == pytest.approx(2.0)


def test_a_run_that_broke_off_is_recovered_from_its_log(played, capsys):
    folder, before = played
    (folder / "motion.h5").unlink()
    assert main(["live", "--recover", str(folder)]) == 0
    assert "300 frames recovered" in capsys.readouterr().out
    np.testing.assert_array_equal(configurations(folder), before)


@pytest.mark.slow
def test_through_lab_streaming_layer_the_results_are_the_same(files, played, tmp_path, capsys):
    name = f"mbkf-test-{uuid.uuid4().hex[:8]}"
    replayed = threading.Thread(
        target=main, args=(["imu", "replay", str(files / "turn.csv"), "--name", name],)
    )
    replayed.start()
    assert run(files, tmp_path, "--from", "lsl", "--stream", name, "--seconds", "2") == 0
    replayed.join()
    np.testing.assert_array_equal(configurations(tmp_path)[:200], played[1][:200])
    assert "frames sent at 100 Hz" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--from", "natnet"], "natnet"),
        (["--from", "file:"], "names no file"),
        (["--from", "file:nowhere.csv"], "no such file"),
        (["--from", "xsens:mvn"], "write xsens:9763"),
        (["--from", "xsens:0", "--up", "aslant"], "aslant"),
        (["--from", "xsens:0", "--local", "203.0.113.7"], "cannot be listened at"),
        (["--from", "xsens:0", "--character", "-1"], "a whole number of zero or more"),
        (["--from", "lsl", "--seconds", "-1"], "--seconds"),
        (["--from", "lsl", "--mass", "70"], "--mass and --height are for a person who is not scaled"),
    ],
)
def test_bad_input_is_one_line(words, message, files, tmp_path, refused):
    refused(
        ["imu", "live", "--subject", str(files / "subject.toml"), "--out", str(tmp_path / "out"), *words],
        message,
    )
