"""`mbkf imu motion`: from tables of readings to a result folder, and what is asked for where a person is not told."""

import pytest

from mbkf.cli.main import main
from mbkf.io.imu.mount import read_mounts
from mbkf.io.imu.write import write_imu_csv
from mbkf.io.results_folder import read_reconstruction, read_summary
from mbkf.io.subject import write_subject
from tests.worn import worn


@pytest.fixture(scope="module", autouse=True)
def look_briefly():
    """Less than a second of each way of wearing the sensors tells them apart here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("mbkf.trial.inertial.misfit.LOOKED_AT_S", 0.8)
        yield


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("worn")
    squat = worn("squat", 1.2)
    write_imu_csv(squat.moving, folder / "squat.csv")
    write_imu_csv(squat.standing, folder / "stand.csv")
    write_subject(squat.subject, folder / "subject.toml")
    return folder


def test_readings_become_a_result(files, tmp_path, capsys):
    out = tmp_path / "result"
    command = ["imu", "motion", str(files / "squat.csv"), "--standing", str(files / "stand.csv")]
    assert main([*command, "--subject", str(files / "subject.toml"), "--causal", "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert "knee_angle_r" in said and "path of the pelvis" in said
    assert "exchanged" not in said and "the other way round" not in said
    found, summary = read_reconstruction(out), read_summary(out)
    assert summary["protocol"] == "inertial sensors" and found.frames == len(worn("squat", 1.2).motion.q)
    assert next(mount.name for mount in read_mounts(out / "mounts.toml")) == "pelvis"


def test_a_person_is_asked_for(files, tmp_path, capsys):
    command = ["imu", "motion", str(files / "squat.csv"), "--out", str(tmp_path / "none")]
    assert main(command) == 2 and "--mass KG and --height M" in capsys.readouterr().err
    assert main([*command, "--subject", str(files / "subject.toml"), "--mass", "70"]) == 2
    assert "give one of both" in capsys.readouterr().err
