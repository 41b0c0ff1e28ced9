"""Virtual sensors from the files that commands write."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.imu.virtual import ImuErrors
from mbkf.io.subject import write_subject
from mbkf.io.truth import Truth, write_truth
from mbkf.model.clinical import dof_names
from mbkf.trial.inertial.synth import BodyMotion, read_motion, synthesise_imus
from tests.dynamics import trial


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder, one = tmp_path_factory.mktemp("made"), trial("squat")
    m, count = one.motion, len(one.motion.q)
    truth = Truth(
        times_s=m.times_s, q=m.q, v=m.v, a=m.a, tau=m.tau, foot_wrench=m.foot_wrench,
        centre_of_pressure=m.centre_of_pressure, marker_names=(), markers_m=np.zeros((count, 0, 3)),
        dof_names=dof_names(one.model),
    )  # fmt: skip
    write_subject(one.subject, folder / "subject.toml")
    write_truth(truth, folder / "truth.h5")
    return folder, truth


def test_a_truth_is_read_with_the_subject_beside_it(made):
    folder, truth = made
    for path in (folder / "truth.h5", folder):
        motion = read_motion(path)
        np.testing.assert_array_equal(motion.q, truth.q)
    with pytest.raises(FileFormatError):
        read_motion(folder / "other" / "motion.h5")


def test_readings_follow_the_motion(made):
    motion = read_motion(made[0])
    mounts, readings = synthesise_imus(
        motion, segments=("right_foot", "torso"), errors=ImuErrors.none(), rate_hz=60.0
    )
    assert [one.name for one in readings] == [mount.name for mount in mounts] == ["right_foot", "torso"]
    assert readings[0].rate_hz == pytest.approx(60.0)
    assert np.linalg.norm(readings[0].specific_force_mps2, axis=1).mean() == pytest.approx(9.81, rel=0.02)
    placed, again = synthesise_imus(motion, mounts=mounts, errors=ImuErrors.none(), rate_hz=60.0)
    np.testing.assert_array_equal(again[1].angular_velocity_rad_s, readings[1].angular_velocity_rad_s)
    assert placed == mounts
    neat, _ = synthesise_imus(motion, segments=("torso",), careless=False)
    assert np.abs(neat[0].rotation - mounts[1].rotation).max() > 1e-3


def test_a_rate_that_makes_no_sense_is_refused(made):
    with pytest.raises(InvalidInput, match="5 and 5000"):
        synthesise_imus(read_motion(made[0]), rate_hz=0.0)
    assert isinstance(read_motion(made[0]), BodyMotion)
