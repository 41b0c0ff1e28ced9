"""A URDF file becomes a tree, or one line says why it cannot be one."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.model.urdf_tree import read_urdf_tree
from tests.urdf_files import biped, joint, link, written


def test_links_and_joints_are_read_with_their_frames(tmp_path):
    parts = [link("a", 2.0, (0.1, 0.2, 0.25), (0.01, 0.02, 0.03), "0.1 0.2 0.3", "0 0 1.5707963267948966"),
             link("b"), joint("j", "a", "b", at="0 0 1", axis="0 0 2", turn="0.1 0.2 0.3")]  # fmt: skip
    tree = read_urdf_tree(written(tmp_path, parts))
    assert (tree.name, tree.root) == ("small", "a")
    own = tree.inertias["a"]
    np.testing.assert_allclose(own.lever, [0.1, 0.2, 0.3])
    wanted = [[0.2, -0.01, -0.03], [-0.01, 0.1, 0.02], [-0.03, 0.02, 0.25]]
    np.testing.assert_allclose(own.inertia, wanted, atol=1e-15)
    (one,) = tree.joints["a"]
    np.testing.assert_allclose(one.axis, [0, 0, 1])
    np.testing.assert_allclose(one.placement.translation, [0, 0, 1])
    R, P, Y = (np.cos(0.2), np.sin(0.2), 0.3)
    np.testing.assert_allclose(one.placement.rotation[:, 0], [np.cos(Y) * R, np.sin(Y) * R, -P])
    assert tree.joints["b"] == ()


@pytest.mark.parametrize(
    ("given", "limits"),
    [('upper="2"', [0.0, 2.0]), ('lower="-1"', [-1.0, 0.0]), ("", [-np.inf, np.inf])],
)
def test_a_limit_that_is_left_out_beside_another_is_zero(tmp_path, given, limits):
    """As the format of URDF has it."""
    extra = f'<limit {given} effort="1" velocity="1"/>'
    tree = read_urdf_tree(written(tmp_path, [link("a"), link("b"), joint("j", "a", "b", extra=extra)]))
    np.testing.assert_array_equal(tree.joints["a"][0].limits_rad, limits)


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        (biped(joint("tie", "right_foot", "left_foot")), "child of the joints left_ankle, tie: a closed loop"),
        ([link("a"), link("b"), joint("x", "a", "b"), joint("y", "b", "a")], "form a closed loop"),
        ([link("r"), link("a"), link("b"), joint("x", "a", "b"), joint("y", "b", "a")], "links a, b form a closed"),
        ([link("a"), joint("x", "a", "a")], "form a closed loop"),
        (biped(link("stray")), "2 roots .pelvis, stray."),
        (biped(link("p"), joint("rail", "pelvis", "p", "prismatic")), "joint rail is prismatic; a body's joints are"),
        (biped(link("p"), joint("rail", "pelvis", "p", "magic")), "joint rail is magic"),
        (biped(link("p"), joint("m", "pelvis", "p", extra='<mimic joint="right_hip"/>')), "m mimics another"),
        (biped(joint("m", "pelvis", "ghost")), "names the link ghost, which does not exist"),
        (biped(link("pelvis")), "two links are named pelvis"),
        (biped(link("p"), joint("right_hip", "pelvis", "p")), "two joints are named right_hip"),
        (biped(link("p"), joint("m", "pelvis", "p", axis="0 0 0")), "its axis is 0 0 0"),
        (biped(link("p"), joint("m", "pelvis", "p", at="0 nan 0")), "finite numbers"),
        (biped(link("p", "inf"), joint("m", "pelvis", "p")), "link p: .* not finite"),
        (biped(link("p", -1), joint("m", "pelvis", "p")), "link p: its mass is -1 kg"),
        (biped(link("p"), joint("m", "pelvis", "p", extra='<limit lower="2" upper="1"/>')), "limit 2 must be below"),
        (biped(link("p"), '<joint name="m" type="revolute"><parent link="p"/></joint>'), "joint m lacks <child"),
        (biped('<link name="p"><inertial><mass value="heavy"/></inertial></link>'), "not a valid URDF"),
        (biped("<link/>"), "a <link> .without a name. lacks its name"),
        ([], "it holds 0 links"),
    ],
)  # fmt: skip
def test_a_tree_that_is_none_is_refused(tmp_path, parts, said):
    with pytest.raises(FileFormatError, match=said) as caught:
        read_urdf_tree(written(tmp_path, parts))
    assert "\n" not in str(caught.value) and "small.urdf" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("mass_kg = 3", "not XML"),
        ("<robot name='a'><link name='b'></robot>", "not XML .mismatched tag: line 1"),
        ("<mujoco/>", "not a URDF: its root is <mujoco>"),
        ("<robot/>", "<robot> lacks its name"),
        ("<!DOCTYPE r [<!ENTITY a 'aa'>]><robot name='a'/>", "no document type"),
        ("<robot name='a' xmlns:xacro='http://x.org/xacro'><xacro:leg/></robot>", "macros of xacro"),
        ("\0\1\2", "not XML"),
        ("<?xml version='1.0' encoding='foo'?><robot name='a'/>", "not XML"),
    ],
)
def test_a_file_that_is_no_urdf_is_refused_in_one_line(tmp_path, text, said, capsys):
    path = tmp_path / "x.urdf"
    path.write_text(text, "utf-8")
    with pytest.raises(FileFormatError, match=said) as caught:
        read_urdf_tree(path)
    assert "\n" not in str(caught.value)
    assert capsys.readouterr().err == ""


def test_what_is_drawn_is_not_read(tmp_path):
    shapes = (
        '<visual><geometry/></visual><collision><geometry><mesh filename="none.stl"/></geometry></collision>'
    )
    drawn = f'<link name="a">{shapes}</link>'
    assert read_urdf_tree(written(tmp_path, [drawn])).root == "a"
