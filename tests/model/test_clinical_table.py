"""The table of clinical angles: complete, mirrored, and strict about damage."""

import pytest

from mbkf.errors import FileFormatError
from mbkf.model import clinical_table
from mbkf.model.clinical_table import load_clinical_joints
from mbkf.model.description import load_body


def test_every_joint_of_the_body_stands_in_the_table_with_its_parent():
    body = load_body()
    joints = {joint.distal: joint for joint in load_clinical_joints()}
    assert set(joints) == {segment.name for segment in body.segments}
    for segment in body.segments:
        assert joints[segment.name].proximal == segment.parent
        assert len(joints[segment.name].order) == {"hinge": 1, "universal": 2}.get(segment.joint, 3)


def test_left_signs_mirror_the_right_ones():
    joints = {joint.name: joint for joint in load_clinical_joints()}
    for name, right in joints.items():
        if name.endswith("_r"):
            left = joints[name.removesuffix("_r") + "_l"]
            assert [a.name for a in left.angles] == [a.name.removesuffix("_r") + "_l" for a in right.angles]
            for one, other in zip(right.angles, left.angles, strict=True):
                assert other.sign == (one.sign if one.axis == "y" else -one.sign)
                assert bool(one.opensim) == bool(other.opensim)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('order = "yxz"', 'order = "xyz"'), "follow its order"),
        (('main = "lumbar_extension"', 'main = "lumbar"'), "main angle lumbar"),
        (("[[joint]]", "[[joint"), "not a table"),
        (("distal =", "distant ="), "not a table"),
    ],
)
def test_a_damaged_table_is_refused(tmp_path, change, message):
    text = (clinical_table.data_folder("models") / "clinical_angles.toml").read_text(encoding="utf-8")
    path = tmp_path / "table.toml"
    path.write_text(text.replace(*change), encoding="utf-8")
    with pytest.raises(FileFormatError, match=message):
        clinical_table._parse(path)


def test_a_missing_table_is_refused(tmp_path):
    with pytest.raises(FileFormatError, match="cannot be read"):
        clinical_table._parse(tmp_path / "none.toml")
