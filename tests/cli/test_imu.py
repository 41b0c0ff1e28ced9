"""`mbkf imu`: what each command writes and prints, and how bad input ends."""

import json

import numpy as np
import pytest

from mbkf.cli import imu_angles, imu_orient, imu_synth, imu_tune
from mbkf.cli.imu import SUBCOMMANDS, parse_units
from mbkf.cli.main import main
from mbkf.io.imu.files import read_imu
from mbkf.io.imu.mount import read_mounts
from mbkf.io.imu.write import write_imu_csv
from mbkf.io.storage import read_storage
from tests.imu.turning import apart_deg, turning
from tests.smpl_files import marching as marching_skeleton
from tests.smpl_files import write_amass
from tests.trial.inertial.test_angles import SAGITTAL, marching


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("imu")
    write_imu_csv([turning(4.0, rate_rad_s=2.0).readings("thigh")], folder / "thigh.csv")
    still = turning(4.0, still_s=99.0)
    noise = np.random.default_rng(0).normal(0.0, 0.01, still.gyro.shape)
    write_imu_csv([still.readings("rest", gyro=still.gyro + noise)], folder / "rest.csv")
    write_imu_csv(marching()[0], folder / "legs.csv")
    lines = (folder / "thigh.csv").read_text().replace("rad/s", "deg/s")
    (folder / "wrong.csv").write_text(lines)
    return folder


@pytest.mark.slow
def test_orient_writes_tables_pictures_and_numbers(files, tmp_path, capsys):
    words = [
        "imu",
        "orient",
        str(files / "thigh.csv"),
        "--frame",
        "ENU",
        "--compare",
        "madgwick",
        "--out",
        str(tmp_path),
    ]
    assert main(words) == 0
    shown = capsys.readouterr().out
    assert "thigh: 400 samples, smooth in ENU; error" in shown
    table = np.genfromtxt(tmp_path / "thigh.csv", delimiter=",", skip_header=2)
    assert table.shape == (400, 14)
    np.testing.assert_allclose(np.linalg.norm(table[:, 1:5], axis=1), 1.0, atol=1e-6)
    assert (tmp_path / "thigh_compare.png").is_file()
    summary = json.loads((tmp_path / "orientation.json").read_text())
    assert summary["sensors"][0]["error_deg"]["total"] < 6.0


@pytest.mark.slow
def test_madgwick_beside_a_sensors_own_quaternions(tmp_path, capsys):
    """As the source did with its Technaid sensors: names with blanks, no times, units and rate by option."""
    made = turning(3.0, still_s=1.0)
    columns = {" Acc": made.force, "Gyr": made.gyro, "Mag": made.field}
    names = ",".join(f"{kind} {axis} " for kind in columns for axis in "XYZ")
    table = np.hstack(list(columns.values()))
    np.savetxt(tmp_path / "walk_capp.csv", table, "%.6f", ",", header=names, comments="")
    own = made.truth[:, [3, 0, 1, 2]]
    np.savetxt(tmp_path / "walk_capq.csv", own, "%.7f", ",", header=" qW , qX, qY, qZ ", comments="")
    words = ["imu", "orient", str(tmp_path / "walk_capp.csv"), "--frame", "NWU", "--filter", "madgwick"]
    stated = ["--units", "acc=m/s2,gyr=rad/s,mag=uT", "--rate", "100"]
    compared = ["--compare", str(tmp_path / "walk_capq.csv"), "--initial", "compared"]
    assert main([*words, *stated, *compared, "--beta", "0.35", "--out", str(tmp_path / "o")]) == 0
    told = capsys.readouterr().out
    assert "walk_capq.csv differs by" in told
    assert "those of NWU" in told
    table = np.genfromtxt(tmp_path / "o" / "walk_capp_compare.csv", delimiter=",", skip_header=2)
    assert table.shape == (300, 15)
    assert apart_deg(table[:, 1:5], made.truth).max() < 1e-4
    np.testing.assert_allclose(table[0, 5:], 0.0, atol=1e-5)
    assert 0.1 < table[:, 12].max() < 30.0
    assert (tmp_path / "o" / "walk_capp_compare.png").is_file()
    assert main([*words, "--rate", "100", "--out", str(tmp_path / "p")]) == 2
    assert "--units acc=m/s2,gyr=rad/s,mag=" in capsys.readouterr().err


def test_a_first_orientation_is_four_numbers_or_a_word(files, tmp_path, capsys):
    words = ["imu", "orient", str(files / "thigh.csv"), "--frame", "NWU", "--out", str(tmp_path / "o")]
    assert main([*words, "--filter", "ekf", "--initial", "1,0,0,0"]) == 0
    first = json.loads((tmp_path / "o" / "orientation.json").read_text())["initial"]["thigh"]
    assert first == pytest.approx([0.0, 0.0, 0.0, 1.0])
    for bad, told in (("1,0,0", "four numbers"), ("a", "four numbers")):
        with pytest.raises(SystemExit) as end:
            main([*words, "--initial", bad])
        assert end.value.code == 2
        assert told in capsys.readouterr().err
    assert main([*words, "--initial", "5,0,0,0"]) == 2
    assert main([*words, "--compare", "kalman"]) == 2
    assert "madgwick" in capsys.readouterr().err.splitlines()[-1]


def test_tune_at_rest_and_by_search(files, tmp_path, capsys):
    assert main(["imu", "tune", str(files / "rest.csv"), "--out", str(tmp_path / "g.json")]) == 0
    row = json.loads((tmp_path / "g.json").read_text())["sensors"][0]
    assert row["beta"] == pytest.approx(0.75**0.5 * 0.01, rel=0.05)
    words = ["imu", "tune", str(files / "thigh.csv"), "--search", "--frame", "NWU"]
    assert main([*words, "--out", str(tmp_path / "h.json")]) == 0
    row = json.loads((tmp_path / "h.json").read_text())["sensors"][0]
    assert row["error_deg"] == pytest.approx(min(one["error_deg"] for one in row["trials"]))
    assert f"differ least from the reference: {row['error_deg']:.2f} deg" in capsys.readouterr().out


@pytest.mark.slow
def test_a_sweep_tries_all_pairs_and_is_drawn(files, tmp_path, capsys):
    words = ["imu", "tune", str(files / "thigh.csv"), "--frame", "NWU", "--betas", "0.1:0.5:3"]
    sweep = [*words, "--search", "--zetas", "0:0.01:2", "--initial", "compared"]
    assert main([*sweep, "--out", str(tmp_path / "g.json"), "--figure", str(tmp_path / "s.png")]) == 0
    row = json.loads((tmp_path / "g.json").read_text())["sensors"][0]
    assert [(one["beta"], one["zeta"]) for one in row["trials"]] == [
        (pytest.approx(beta), zeta) for beta in (0.1, 0.3, 0.5) for zeta in (0.0, 0.01)
    ]
    assert row["error_deg"] == min(one["error_deg"] for one in row["trials"])
    assert (tmp_path / "s.png").read_bytes()[:4] == b"\x89PNG"
    capsys.readouterr()
    assert main(words) == 2
    assert "--betas belongs to --search" in capsys.readouterr().err
    assert main([*words, "--search", "--against", str(files / "none.csv")]) == 2
    for bad in ("1:0.5:3", "0:1", "0:1:0", "-1:1:2"):
        with pytest.raises(SystemExit) as end:
            main(["imu", "tune", "x.csv", "--search", f"--zetas={bad}"])
        assert end.value.code == 2
    several = ["imu", "tune", str(files / "legs.csv"), "--search", "--figure", str(tmp_path / "t.png")]
    assert main(several) == 2
    assert "choose one with --sensor" in capsys.readouterr().err


@pytest.mark.slow
def test_angles_writes_what_opensim_opens(files, tmp_path):
    words = ["imu", "angles", str(files / "legs.csv"), "--standing", "0:1.8", "--out", str(tmp_path / "a")]
    assert main(words) == 0
    table = read_storage(tmp_path / "a" / "angles.mot")
    assert table.in_degrees
    truth = marching()[1]
    for name in SAGITTAL:
        assert np.sqrt(((table.column(name) - truth[name]) ** 2).mean()) < 3.0
    assert len(read_mounts(tmp_path / "a" / "mounts.toml")) == 8
    assert json.loads((tmp_path / "a" / "angles.json").read_text())["samples"] == 300


@pytest.mark.slow
def test_synth_writes_readings_and_mounts(tmp_path):
    assert main(["synth", "--motion", "squat", "--seconds", "1.2", "--out", str(tmp_path / "s")]) == 0
    words = [
        "imu",
        "synth",
        str(tmp_path / "s" / "truth.h5"),
        "--segments",
        "torso,left_foot",
        "--rate",
        "60",
    ]
    assert main([*words, "--gyro-noise", "0", "--out", str(tmp_path / "i.csv")]) == 0
    torso, foot = read_imu(tmp_path / "i.csv")
    assert (torso.name, foot.name) == ("torso", "left_foot")
    assert foot.rate_hz == pytest.approx(60.0)
    assert [mount.segment for mount in read_mounts(tmp_path / "i.toml")] == ["torso", "left_foot"]
    words = [
        "reconstruct",
        str(tmp_path / "s" / "trial.c3d"),
        "--subject",
        str(tmp_path / "s" / "subject.toml"),
    ]
    words += [
        "--imu",
        str(tmp_path / "i.csv"),
        "--imu-mounts",
        str(tmp_path / "i.toml"),
        "--hide",
        "LASI@0.5:0.7",
    ]
    code = main([*words[:-2], "--causal", "--out", str(tmp_path / "r")])
    assert code == 0
    assert json.loads((tmp_path / "r" / "summary.json").read_text())["marker_rms_mm"] < 10.0


@pytest.mark.slow
def test_amass_to_virtual_sensors_to_madgwick_to_angles(tmp_path, capsys):
    """Joint angles come back as the file has them, through sensors and Madgwick's filter."""
    made = marching_skeleton()
    file, sensors = write_amass(tmp_path / "walk_poses.npz", made), tmp_path / "imus.csv"
    person = ["--mass", "70", "--height", "1.75"]
    words = ["imu", "synth", str(file), *person, "--perfect", "--neat"]
    assert main([*words, "--out", str(sensors)]) == 0
    assert "500 samples at 100 Hz of pelvis" in capsys.readouterr().out
    words = ["imu", "orient", str(sensors), "--filter", "madgwick", "--frame", "NWU"]
    assert main([*words, "--out", str(tmp_path / "o")]) == 0
    rows = json.loads((tmp_path / "o" / "orientation.json").read_text())["sensors"]
    assert len(rows) == 8
    assert max(row["error_deg"]["total"] for row in rows) < 6.0
    words = ["imu", "angles", str(sensors), "--filter", "madgwick", "--standing", "0:1.5"]
    assert main([*words, "--out", str(tmp_path / "a")]) == 0
    table = read_storage(tmp_path / "a" / "angles.mot")
    for name, joint, sign in (("hip_flexion_l", 1, -1.0), ("knee_angle_r", 5, 1.0), ("knee_angle_l", 4, 1.0)):
        wanted = sign * np.degrees(made[:, joint, 0])
        found = np.abs(table.column(name)) * np.sign(wanted.mean())
        assert np.sqrt(((found - wanted) ** 2).mean()) < 6.0, name


def test_an_amass_file_needs_motion_and_a_wearer(tmp_path, capsys):
    def refused(*words):
        out = tmp_path / "x.csv"
        assert main(["imu", "synth", *map(str, words), "--out", str(out)]) == 2
        told = capsys.readouterr().err
        assert told.count("\n") == 1
        assert not out.exists()
        return told

    made = marching_skeleton(0.2)
    shape = write_amass(tmp_path / "shape.npz", made, poses=None)
    assert "holds no 'poses'" in refused(shape, "--mass", 70, "--height", 1.75)
    motion = write_amass(tmp_path / "a.npz", made)
    assert "--mass KG and --height M" in refused(motion)
    assert "leave --up out" in refused("motion.h5", "--up", "y")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["orient", "wrong.csv", "--frame", "ENU", "--out", "o"], "--units gyr=rad/s"),
        (["orient", "none.csv", "--frame", "ENU", "--out", "o"], "no such file"),
        (
            ["orient", "thigh.csv", "--frame", "ENU", "--sensor", "foot", "--out", "o"],
            "unknown sensor 'foot'",
        ),
        (["orient", "thigh.csv", "--frame", "ENU", "--units", "acc", "--out", "o"], "QUANTITY=UNIT"),
        (["orient", "thigh.csv", "--frame", "ENU", "--units", "acc=x", "--out", "o"], "unit of acc"),
        (["orient", "thigh.csv", "--frame", "ENU", "--beta", "-1", "--out", "o"], "beta"),
        (["orient", "thigh.csv", "--out", "o"], "--frame"),
        (["tune", "thigh.csv", "--static", "3"], "START:END"),
        (["tune", "rest.csv", "--static", "50:60"], "the recording lasts"),
        (["angles", "thigh.csv", "--out", "o"], "segment of sensor"),
        (["angles", "legs.csv", "--standing", "5:1", "--out", "o"], "START:END"),
        (["angles", "legs.csv", "--sensor", "tail", "--out", "o"], "tail"),
        (["synth", "none.h5", "--out", "i.csv"], "no such file"),
        (["synth", "none.h5", "--out", "i.txt"], ".csv"),
        (["synth", "none.h5", "--seed", "-1", "--out", "i.csv"], "--seed"),
        ([], "COMMAND"),
    ],
)
def test_bad_input_is_one_clear_line(files, tmp_path, monkeypatch, refused, words, told):
    names = [
        str(files / word) if word.endswith((".csv", ".h5")) and word != "i.csv" else word for word in words
    ]
    monkeypatch.chdir(tmp_path)
    refused(["imu", *names], told)


@pytest.mark.slow
def test_reconstruct_refuses_sensors_it_cannot_use(person, files, tmp_path, refused):
    words = ["reconstruct", person.trial, "--subject", person.subject, "--out", tmp_path / "o"]
    refused([*words, "--imu-mounts", "x.toml"], "--imu")
    refused([*words, "--imu", files / "legs.csv", "--filter", "kinematic"], "--filter dynamic")
    refused([*words, "--imu", files / "thigh.csv"], "thigh")


def test_units_are_read_from_the_command_line():
    assert parse_units("acc=g, Gyr=deg/s") == {"acc": "g", "gyr": "deg/s"}
    assert parse_units("") == {}


@pytest.mark.parametrize("name", SUBCOMMANDS)
def test_every_command_explains_itself_with_an_example(name, capsys):
    with pytest.raises(SystemExit) as end:
        main(["imu", name, "--help"])
    assert end.value.code == 0
    assert f"mbkf imu {name} " in capsys.readouterr().out


def test_the_commands_are_the_modules_named_after_them():
    for module, name in (
        (imu_angles, "angles"),
        (imu_orient, "orient"),
        (imu_synth, "synth"),
        (imu_tune, "tune"),
    ):
        assert name in SUBCOMMANDS
        assert callable(module.run)
