"""`mbkf imu stride`."""

import argparse
import json
import sys
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.inertial.foot_walks import foot_walk
from mbkf.cli.imu_stride import _settings, options
from mbkf.cli.main import main
from mbkf.imu.key_points import NOISY_WEIGHTS, KeyPointSettings, as_printed

pytestmark = pytest.mark.slow


def write(readings, path, *, units=("m/s^2", "rad/s"), others=()):
    """A table with units in the column names, as a user would have it."""
    sensors = [readings, *others]
    heads = ["time [s]"]
    columns = [readings.time_s]
    for one in sensors:
        for kind, unit, values in (
            ("acc", units[0], one.specific_force_mps2),
            ("gyr", units[1], one.angular_velocity_rad_s),
        ):
            heads += [f"{one.name}_{kind}_{axis} [{unit}]" for axis in "xyz"]
            columns += list(values.T)
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=",".join(heads), comments="", fmt="%.6f")
    return path


@pytest.fixture(scope="module")
def tables(tmp_path_factory):
    folder = tmp_path_factory.mktemp("feet")
    noise = {"force_noise_m_s2": 0.05, "rate_noise_rad_s": 0.01}
    left = foot_walk((1.2, 1.3, 1.1), **noise).readings
    right = foot_walk((1.2, 1.3, 1.1), name="right_foot", wait_s=0.55, **(noise | {"seed": 1})).readings
    chest = foot_walk((1.2, 1.3, 1.1), name="chest", **(noise | {"seed": 2})).readings
    write(left, folder / "left.csv")
    write(right, folder / "right.csv")
    write(left, folder / "body.csv", others=(right, chest))
    return folder


def run(*words):
    return main([str(word) for word in ("imu", "stride", *words)])


def test_both_feet_end_in_one_folder(tables, tmp_path, capsys):
    assert run(tables / "left.csv", tables / "right.csv", "--level", "--out", tmp_path / "out") == 0
    shown = capsys.readouterr().out
    assert "left_foot" in shown
    assert "both feet: 5 steps" in shown
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"strides.csv", "trajectory.csv", "summary.json", "feet.png"}
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    lengths = [foot["length_m_mean"] for foot in summary["feet"].values()]
    assert lengths == pytest.approx([1.2, 1.2], abs=0.02)


def test_without_matplotlib_the_numbers_are_written_and_a_note_says_what_is_missing(
    tables, tmp_path, capsys, monkeypatch
):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for name in [name for name in sys.modules if name.startswith("mbkf.viz.imu")]:
        monkeypatch.delitem(sys.modules, name)
    assert run(tables / "left.csv", "--out", tmp_path / "out") == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "strides.csv",
        "trajectory.csv",
        "summary.json",
    }
    said = capsys.readouterr().err
    assert "feet.png" in said and "matplotlib" in said
    refused = ["imu", "orient", str(tables / "left.csv"), "--frame", "ENU", "--compare", "ekf"]
    assert main([*refused, "--out", str(tmp_path / "o")]) == 2


def test_feet_are_picked_from_a_file_of_many_sensors(tables, tmp_path, refused):
    refused(["imu", "stride", tables / "body.csv", "--out", tmp_path / "x"], "3 sensors", "--sensor")
    words = [tables / "body.csv", "--sensor", "right_foot", "--method", "filter", "--out", tmp_path / "out"]
    assert run(*words) == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert list(summary["feet"]) == ["right_foot"]
    assert summary["method"] == "filter"


def test_key_points_take_their_own_options(tables, tmp_path):
    words = ["--method", "key-points", "--weights", "0.2,0.4,0.4", "--threshold", "2", "--window", "5"]
    assert run(tables / "left.csv", *words, "--out", tmp_path / "out") == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["method"] == "key-points"


def test_the_paper_runs_by_the_letter(tables, tmp_path, refused):
    def settings(*words):
        parser = argparse.ArgumentParser()
        options(parser)
        return _settings(parser.parse_args(["one.csv", "--out", "x", "--method", "key-points", *words]))

    assert settings("--as-printed").key_points == as_printed(NOISY_WEIGHTS)
    assert settings("--as-printed", "--window", "5").key_points == replace(as_printed(), window=5)
    assert settings().key_points == KeyPointSettings()
    refused(
        ["imu", "stride", tables / "left.csv", "--as-printed", "--out", tmp_path / "x"],
        "--as-printed belongs to --method key-points",
    )


def test_bad_input_is_refused(tables, tmp_path, refused):
    left, out = tables / "left.csv", ["--out", tmp_path / "x"]
    walk = foot_walk((1.2, 1.3)).readings
    wrong = write(walk, tmp_path / "wrong.csv", units=("g", "rad/s"))
    refused(["imu", "stride", wrong, *out], "acc=m/s2")
    refused(["imu", "stride", tmp_path / "none.csv", *out], "no such file")
    refused(["imu", "stride", left, "--sensor", "left_fot", *out], "did you mean left_foot")
    refused(["imu", "stride", left, "--weights", "1,2,3", *out], "--weights belongs to --method key-points")
    refused(["imu", "stride", left, "--method", "key-points", "--weights", "1,2", *out], "three numbers")
    refused(["imu", "stride", left, "--method", "key-points", "--weights", "a,b,c", *out], "three numbers")
    refused(["imu", "stride", left, "--method", "key-points", "--level", *out], "--level")
    refused(["imu", "stride", left], "--out")
