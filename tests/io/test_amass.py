"""Files of AMASS: the three models' widths and both spellings of the rate; one line for what is no motion."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError, InvalidInput, ShapeError
from mbkf.io.amass import JOINTS, PARENTS, SmplMotion, read_amass
from tests.smpl_files import RATE_HZ, walked, waves, write_amass


@pytest.mark.parametrize(
    ("joints", "key"), [(24, "mocap_framerate"), (52, "mocap_framerate"), (55, "mocap_frame_rate")]
)
def test_the_body_of_each_model_is_read(tmp_path, joints, key):
    made = waves(0.2)
    found = read_amass(write_amass(tmp_path / "a.npz", made, joints=joints, rate_key=key))
    np.testing.assert_array_equal(found.rotations, made)
    np.testing.assert_array_equal(found.trans_m, walked(len(made)))
    assert found.rate_hz == RATE_HZ


def test_parts_of_smpl_x_stand_for_the_poses(tmp_path):
    made = waves(0.2)
    parts = {"root_orient": made[:, 0], "pose_body": made[:, 1:].reshape(len(made), -1), "poses": None}
    np.testing.assert_array_equal(read_amass(write_amass(tmp_path / "a.npz", made, **parts)).rotations, made)
    parts["pose_body"] = parts["pose_body"][1:]
    with pytest.raises(FileFormatError, match="differ in length"):
        read_amass(write_amass(tmp_path / "b.npz", made, **parts))


def test_joints_follow_their_parents():
    assert len(PARENTS) == len(JOINTS) == 22
    assert all(parent < joint for joint, parent in enumerate(PARENTS))
    assert [JOINTS[PARENTS[JOINTS.index(name)]] for name in ("left_knee", "right_wrist", "head")] == [
        "left_hip",
        "right_elbow",
        "neck",
    ]


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"poses": None}, r"holds no 'poses' \(found: betas, dmpls, gender"),
        ({"trans": None}, "holds no 'trans'"),
        ({"mocap_framerate": None}, "states no frame rate"),
        ({"mocap_framerate": np.array(0.0)}, "between 10 and 1000 Hz"),
        ({"poses": np.zeros((20, 63))}, "66 columns or more"),
        ({"poses": np.full((20, 66), np.nan)}, "is missing"),
        ({"trans": np.zeros((19, 3))}, "trans_m"),
        ({"poses": np.array([{"a": 1}], dtype=object)}, "damaged, or no AMASS file"),
    ],
)
def test_a_file_without_motion_is_refused_in_one_line(tmp_path, changes, told):
    with pytest.raises(FileFormatError, match=told) as end:
        read_amass(write_amass(tmp_path / "a.npz", waves(0.2), **changes))
    assert "\n" not in str(end.value)
    assert "a.npz" in str(end.value)


def test_damaged_bytes_are_refused(tmp_path):
    content = write_amass(tmp_path / "a.npz", waves(0.2)).read_bytes()
    for part in (
        b"",
        content[:2000],
        b"PK\x03\x04" + content[100:],
        content[:90] + b"x" * 40 + content[130:],
    ):
        (tmp_path / "b.npz").write_bytes(part)
        with pytest.raises(FileFormatError, match="damaged"):
            read_amass(tmp_path / "b.npz")
    with pytest.raises(FileFormatError, match="AMASS"):
        read_amass(tmp_path / "none.npz")


def test_a_motion_checks_itself():
    with pytest.raises(ShapeError):
        SmplMotion(100.0, np.zeros((5, 21, 3)), np.zeros((5, 3)))
    with pytest.raises(InvalidInput, match="Hz"):
        SmplMotion(np.nan, np.zeros((5, 22, 3)), np.zeros((5, 3)))
