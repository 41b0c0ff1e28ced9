"""OpenSim's joints as hinges of a body of ours, and joints that have no place there."""

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.osim import read_osim
from mbkf.model.osim_tree import osim_root_angles, osim_tree, osim_zeros_deg
from tests.osim_mechanisms import (
    BACK,
    COUPLER,
    CURVE,
    LINE,
    MULTIPLE,
    STILL,
    joint,
    mechanism,
    spatial_transform,
)

ROOT = joint("FreeJoint", "ground", "root", ("rx", "ry", "rz", "tx", "ty", "tz"))
SHIFTED = "<LinearFunction><coefficients>1 0.3</coefficients></LinearFunction>"


def custom(turns, shifts=(), coordinates=("knee", "twist")):
    return joint("CustomJoint", "root", "shin", coordinates, spatial_transform(turns, shifts))


def model(folder, *joints, constraints=""):
    (folder / "model.osim").write_text(mechanism(joints, constraints), encoding="utf-8")
    return read_osim(folder / "model.osim")


def tree(folder, *joints, constraints=""):
    return osim_tree(model(folder, ROOT, *joints, constraints=constraints))


def test_turns_become_hinges_between_links_without_mass(tmp_path):
    found = tree(tmp_path, custom((("knee", LINE), ("twist", BACK))))
    (first,) = (one for one in found.joints["root"] if one.kind == "revolute")
    (second,) = (one for one in found.joints["shin/knee"] if one.kind == "revolute")
    assert (first.name, first.child, second.name, second.child) == ("knee", "shin/knee", "twist", "shin")
    assert found.inertias["shin/knee"].mass == 0.0 and found.inertias["shin"].mass == 1.0
    assert first.axis == pytest.approx([1.0, 0.0, 0.0]) and second.axis == pytest.approx([0.0, -0.6, -0.8])
    # −x + 0.2 turns by zero where x = 0.2, from where limits of ±2 count
    assert first.limits_rad == pytest.approx([-2.0, 2.0]) and second.limits_rad == pytest.approx([-2.2, 1.8])
    assert osim_zeros_deg(read_osim(tmp_path / "model.osim")) == {"twist": pytest.approx(np.rad2deg(0.2))}


def test_constant_shifts_and_locked_coordinates_are_part_of_the_frames(tmp_path):
    plain = tree(tmp_path, custom((("knee", LINE),), coordinates=("knee",)))
    moved = tree(tmp_path, custom((("knee", LINE),), (("", STILL), ("held", SHIFTED)), ("knee", "held")))
    first, other = (one.joints["root"][0] for one in (plain, moved))
    shift = first.placement.rotation @ (0.07 * np.array([1.0, 0.0, 0.0]) + 0.4 * np.array([0.0, 0.6, 0.8]))
    assert other.placement.translation - first.placement.translation == pytest.approx(shift)


def test_a_weld_fixes_and_markers_are_fixed_links(tmp_path):
    found = tree(tmp_path, joint("WeldJoint", "root", "welded", ()))
    kinds = {one.child: one.kind for one in found.joints["root"]}
    assert kinds == {"welded": "fixed", "on_root": "fixed"}
    assert found.inertias["on_root"].mass == 0.0


def test_the_root_turns_from_y_up_to_z_up(tmp_path):
    (floating,) = tree(tmp_path).joints["ground"]
    assert floating.kind == "floating"
    plain = model(tmp_path, ROOT.replace("0.3 -0.5 0.8", "0 0 0").replace("-0.2 0.4 1.1", "0 0 0"))
    found = osim_root_angles(plain, "root")
    assert found["order"] == "xzy" and found["main"] == "rx"
    assert [one["sign"] for one in found["angle"]] == [1, 1, -1]
    assert [(one["axis"], one["sign"]) for one in found["translation"]] == [("x", 1), ("z", 1), ("y", -1)]
    assert found["opensim_origin_m"] == pytest.approx([0.02, -0.05, -0.1])
    assert osim_root_angles(model(tmp_path, ROOT), "root") is None


@pytest.mark.parametrize(
    ("joints", "constraints", "reason"),
    [
        ((custom((("knee", CURVE),)),), "", "to_shin.*rotation1 is a curve over 'knee'"),
        ((custom((("knee", LINE),), (("knee", MULTIPLE),)),), "", "translation1 is a curve over 'knee'"),
        ((custom((("knee", LINE),), (("twist", LINE),)),), "", "shifts with its coordinate 'twist'"),
        ((custom((("knee", LINE), ("knee", LINE))),), "", "rotation2 is 1 times 'knee'"),
        ((custom((("knee", LINE.replace("1 0", "2 0")),)),), "", "rotation1 is 2 times 'knee'"),
        ((custom((("knee", LINE), ("", STILL))),), "", "constant after its last coordinate"),
        ((custom((("knee", LINE),), coordinates=("knee", "patella")),), COUPLER, "'patella' follows 'knee'"),
        ((joint("EllipsoidJoint", "root", "shin", ("a",)),), "", "EllipsoidJoint"),
    ],
)  # fmt: skip
def test_joints_without_a_place_in_our_bodies_are_refused_by_name(joints, constraints, reason, tmp_path):
    with pytest.raises(InvalidInput, match=reason):
        tree(tmp_path, *joints, constraints=constraints)


@pytest.mark.parametrize(
    ("joints", "reason"),
    [
        ((joint("PinJoint", "ground", "root", ("a",)),), "does not float"),
        ((ROOT, joint("WeldJoint", "ground", "ball", ())), "to_root, to_ball start at the ground"),
    ],
)
def test_a_body_has_one_root_that_floats(joints, reason, tmp_path):
    with pytest.raises(InvalidInput, match=reason):
        osim_tree(model(tmp_path, *joints))
