"""A URDF file with its side file is a body like any other; what the side file lacks has a default or is demanded."""

import numpy as np
import pytest

from mbkf.cli.main import main
from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.c3d_write import write_c3d
from mbkf.model.body_file import load_body, parse_body
from mbkf.model.human import HumanModel
from mbkf.model.urdf_body import SPREADS, side_path
from tests.captures import made_capture
from tests.urdf_files import SIDE, biped, written


def test_roles_soles_and_defaults(tmp_path):
    body = load_body(written(tmp_path, biped()))
    assert (body.name, body.reference_mass_kg, body.reference_height_m) == ("small", 33.0, 1.2)
    assert (body.roles.root, body.roles.feet) == ("pelvis", ("right_foot", "left_foot"))
    assert [sole.outer_y_m for sole in body.roles.soles] == [-0.04, 0.04]
    assert body.scale_factors == ("size",)
    knee = body.segment("left_shank")
    np.testing.assert_array_equal(knee.acceleration_sd, SPREADS[""]["acceleration_sd"])
    assert HumanModel.scaled({"size": 1.1}, 40.0, body).nv == 12


def test_a_suffix_in_capitals_is_the_same(tmp_path):
    path = written(tmp_path, biped())
    capitals = path.with_suffix(".URDF")
    side_path(path).rename(side_path(capitals))
    assert load_body(path.rename(capitals)).name == "small"


def test_the_side_file_overrides_and_adds(tmp_path):
    side = SIDE.replace("reference", 'scale_factors = ["trunk", "legs"]\nname = "my robot"\nreference', 1) + """
[left_sole]
height_m = -0.05
heel_x_m = -0.07
ball_x_m = 0.1
toe_x_m = 0.16
inner_y_m = -0.04
outer_y_m = 0.05

[[segment]]
name = "left_shank"
scale = ["legs", "legs", "legs"]
length_factor = "legs"
movement_sd = [300.0]

[[clinical_joint]]
name = "knee_r"
mirror = true
proximal = "right_thigh"
distal = "right_shank"
order = "y"
main = "knee_angle_r"
angle = [{ name = "knee_angle_r", title = "Knee flexion", axis = "y", sign = 1 }]
"""  # fmt: skip
    body = load_body(written(tmp_path, biped(), side))
    assert body.name == "my robot"
    assert body.roles.soles[1].outer_y_m == 0.05 and body.roles.soles[1].heel_x_m == -0.07
    shank = body.segment("left_shank")
    assert (shank.length_index, body.segment("left_thigh").length_index) == (1, 0)
    assert shank.movement_sd[0] == 300.0
    assert [joint.main for joint in body.clinical_joints if "shank" in joint.distal] == [
        "knee_angle_r",
        "knee_angle_l",
    ]


def test_links_may_have_names_of_their_own(tmp_path):
    side = SIDE + '[names]\nRightSole = "right_foot"\nmarker = "right_knee"\n'
    parts = [
        part.replace('"right_foot"', '"RightSole"').replace("right_sensor", "marker") for part in biped()
    ]
    body = load_body(written(tmp_path, parts, side))
    assert body.roles.feet[0] == "right_foot" and "right_knee" in body.landmarks


def test_its_text_is_a_body_file_that_subjects_carry(tmp_path):
    body = load_body(written(tmp_path, biped()))
    again = parse_body(body.text, "the subject")
    for one, other in zip(body.segments, again.segments, strict=True):
        np.testing.assert_array_equal(one.inertia_matrix_kg_m2, other.inertia_matrix_kg_m2)
        np.testing.assert_array_equal(one.origin_m, other.origin_m)


def test_a_missing_side_file_is_asked_for(tmp_path):
    path = written(tmp_path, biped(), side=None)
    with pytest.raises(FileFormatError, match=r"needs a side file small.urdf.toml .* roles, sole"):
        load_body(path)
    with pytest.raises(FileFormatError, match="no such file"):
        load_body(tmp_path / "none.urdf")


@pytest.mark.parametrize(
    ("change", "error", "said"),
    [
        (("[sole]", "[soles]"), UnknownName, "small.urdf.toml, line 6: unknown entry 'soles'"),
        (("reference_height_m = 1.2", ""), FileFormatError, "small.urdf.toml: lacks reference_height_m"),
        (('"left_foot"', '"left_hoof"'), UnknownName, "left_hoof"),
        (('feet = ["right_foot", "left_foot"]', ""), FileFormatError, "feet must name two segments"),
        (("heel_x_m", "reference_mass_kg"), UnknownName, "reference_mass_kg"),
        (("[roles]", "[roles"), FileFormatError, "small.urdf.toml"),
        (("[roles]", '[[segment]]\nname = "tail"\n[roles]'), UnknownName, "unknown segment 'tail'"),
        (("[roles]", '[[segment]]\nname = "pelvis"\nmass_kg = 3\n[roles]'), UnknownName, "segment entry 'mass_kg'"),
        (("toe_x_m = 0.16", "toe_x_m = 0.06"), FileFormatError, "must grow"),
    ],
)  # fmt: skip
def test_a_wrong_side_file_is_refused(tmp_path, change, error, said):
    path = written(tmp_path, biped(), SIDE.replace(*change))
    with pytest.raises(error, match=said) as caught:
        load_body(path)
    assert "\n" not in str(caught.value)


def test_commands_end_with_one_line_and_two(tmp_path, capsys):
    write_c3d(made_capture(5, 0.0), tmp_path / "static.c3d")
    path = written(tmp_path, [part for part in biped() if "left_ankle" not in part])
    words = ["scale", tmp_path / "static.c3d", "--body", path, "--mass", 40, "--out", tmp_path / "s.toml"]
    assert main([str(word) for word in words]) == 2
    said = capsys.readouterr().err.strip()
    assert "2 roots (pelvis, left_foot)" in said and "\n" not in said
    assert not (tmp_path / "s.toml").exists()


def test_the_side_file_stands_beside_the_file(tmp_path):
    assert side_path(tmp_path / "a.b.urdf") == tmp_path / "a.b.urdf.toml"
