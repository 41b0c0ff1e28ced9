"""OpenSim's models of both forms: the same joints, markers, bodies and constraints, and files that are refused."""

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.osim import read_osim
from tests.osim_files import marker_set, osim_3, osim_4, skeleton

MARKERS = [("R.ASIS", "pelvis", (0.01, 0.02, 0.13), True), ("R.Thigh", "femur_r", (0.05, -0.2, 0.03), False)]


@pytest.mark.parametrize("text", [osim_3(skeleton(), MARKERS), osim_4(skeleton(), MARKERS, "0.3 -1.2 0.7")])
def test_both_forms_hold_the_same(text, tmp_path):
    (tmp_path / "model.osim").write_text(text, encoding="utf-8")
    model = read_osim(tmp_path / "model.osim")
    assert model.name == "made"
    assert model.damaged == {}
    assert [(m.name, m.body, tuple(m.position_m), m.fixed) for m in model.markers] == MARKERS
    expected = {(parent, child): at for parent, child, at in skeleton()}
    assert {(j.parent, j.child) for j in model.joints} == set(expected)
    for joint in model.joints:
        pose = np.eye(4)
        pose[:3, 3] = expected[joint.parent, joint.child]
        assert joint.child_in_parent == pytest.approx(pose, abs=1e-12)
        assert joint.centre_m == pytest.approx(np.zeros(3))


def test_a_joint_that_shifts_and_turns_at_zero(tmp_path):
    moved = (
        '<SpatialTransform><TransformAxis name="rotation1"><axis>0 0 1</axis><Constant><value>1.5707963267948966'
        '</value></Constant></TransformAxis><TransformAxis name="translation2"><coordinates/><axis>0 1 0</axis>'
        "<Constant><value>-0.4</value></Constant></TransformAxis></SpatialTransform></CustomJoint>"
    )
    text = osim_3([("pelvis", "femur_r", (0.1, 0.0, 0.0))], MARKERS).replace("</CustomJoint>", moved)
    (tmp_path / "model.osim").write_text(text, encoding="utf-8")
    (joint,) = read_osim(tmp_path / "model.osim").joints
    assert joint.child_in_parent[:3, 3] == pytest.approx([0.1, -0.4, 0.0])
    assert joint.child_in_parent[:3, 0] == pytest.approx([0.0, 1.0, 0.0])


def test_a_marker_on_a_frame_fixed_to_a_body(tmp_path):
    text = osim_4([("pelvis", "femur_r", (0.1, 0.2, 0.3))], [("A", "x/pelvis_offset", (0.0, 0.0, 1.0), True)])
    (tmp_path / "model.osim").write_text(text, encoding="utf-8")
    (marker,) = read_osim(tmp_path / "model.osim").markers
    assert marker.body == "pelvis"
    assert marker.position_m == pytest.approx([0.1, 0.2, 1.3])


def test_markers_that_cannot_be_read_are_told(tmp_path):
    good = marker_set([MARKERS[0], MARKERS[0]], 3)
    bad = (
        "<Marker name='B'><body>pelvis</body><location>1 2</location></Marker>"
        "<Marker name='C'><body>pelvis</body><location>1 2 nan</location></Marker>"
        "<Marker name='D'><location>1 2 3</location></Marker>"
        "<Marker><body>pelvis</body><location>1 2 3</location></Marker></objects>"
    )
    (tmp_path / "set.xml").write_text(good.replace("</objects>", bad), encoding="utf-8")
    model = read_osim(tmp_path / "set.xml")
    assert [marker.name for marker in model.markers] == ["R.ASIS"]
    assert set(model.damaged) == {"R.ASIS (again)", "B", "C", "D", "(no name)"}
    assert model.joints == ()


def test_defaults_are_no_part_of_the_model(tmp_path):
    text = osim_3(skeleton(), MARKERS[:1]).replace(
        "<BodySet>", f"<defaults>{marker_set(MARKERS[1:], 3)}<Body name='x'/></defaults><BodySet>"
    )
    (tmp_path / "model.osim").write_text(text, encoding="utf-8")
    assert [marker.name for marker in read_osim(tmp_path / "model.osim").markers] == ["R.ASIS"]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (osim_4(skeleton(), []), "holds no marker"),
        ("<svg><rect/></svg>", "not an OpenSim model"),
        ("<MarkerSet><Marker name='B'><body>x</body></Marker></MarkerSet>", "no marker that can be read"),
    ],
)
def test_other_files_are_refused(text, reason, tmp_path):
    (tmp_path / "model.osim").write_text(text, encoding="utf-8")
    with pytest.raises(FileFormatError, match=reason):
        read_osim(tmp_path / "model.osim")


def test_hostile_nesting_and_lengths_cost_time_in_proportion_and_are_survived(tmp_path):
    path = tmp_path / "a.osim"
    function = "<function>" * 5000
    axis = f'<TransformAxis name="translation1"><axis>1 0 0</axis>{function}</TransformAxis>'
    path.write_text(
        "<Model><JointSet><objects><PinJoint><socket_parent_frame>pelvis</socket_parent_frame>"
        f"<socket_child_frame>femur_r</socket_child_frame><SpatialTransform>{axis}</SpatialTransform></PinJoint>"
        "</objects></JointSet><MarkerSet>"
        '<Marker name="A"><body>pelvis</body><location>0 0 0.1</location></Marker>'
        '<Marker name="B"><body>pelvis</body><location>0 0 1e300</location></Marker></MarkerSet></Model>'
    )
    found = read_osim(path)
    assert [marker.name for marker in found.markers] == ["A"] and list(found.damaged) == ["B"]
    np.testing.assert_array_equal(found.joints[0].child_in_parent, np.eye(4))


CONSTRAINTS = """<ConstraintSet><objects>
<CoordinateCouplerConstraint name="patella">
<coupled_coordinates_function><LinearFunction><coefficients>2 1</coefficients>
</LinearFunction></coupled_coordinates_function><independent_coordinate_names>knee</independent_coordinate_names>
<dependent_coordinate_name>beta</dependent_coordinate_name><scale_factor>3</scale_factor></CoordinateCouplerConstraint>
<PointConstraint name="strap"/><PointConstraint name="off"><isEnforced>false</isEnforced></PointConstraint>
<WeldConstraint name="old"><isDisabled>true</isDisabled></WeldConstraint></objects></ConstraintSet></Model>"""


def test_constraints_between_coordinates_are_read_and_others_named(tmp_path):
    text = osim_4(skeleton(), MARKERS).replace("</Model>", CONSTRAINTS)
    (tmp_path / "model.osim").write_text(text, encoding="utf-8")
    model = read_osim(tmp_path / "model.osim")
    (coupler,) = model.couplers
    assert (coupler.follower, coupler.leader) == ("beta", "knee")
    assert coupler.value.line == (3.0, 6.0)
    assert model.other_constraints == ("strap (PointConstraint)",)


@pytest.mark.parametrize(
    "inertia",
    [
        "<inertia>1 2 3 0.1 0.2 0.3</inertia>",
        "<inertia_xx>1</inertia_xx><inertia_yy>2</inertia_yy><inertia_zz>3</inertia_zz><inertia_xy>0.1</inertia_xy>"
        "<inertia_xz>0.2</inertia_xz><inertia_yz>0.3</inertia_yz>",
    ],
)
def test_masses_of_both_forms(inertia, tmp_path):
    body = f'<Body name="pelvis"><mass>9</mass><mass_center>0 0.1 0</mass_center>{inertia}</Body>'
    text = f'<Model name="m"><BodySet><objects><Body name="ground"/>{body}</objects></BodySet></Model>'
    (tmp_path / "model.osim").write_text(text, encoding="utf-8")
    (pelvis,) = read_osim(tmp_path / "model.osim", markers_needed=False).bodies
    assert (pelvis.name, pelvis.mass_kg, tuple(pelvis.centre_m)) == ("pelvis", 9.0, (0.0, 0.1, 0.0))
    assert pelvis.inertia_kgm2.tolist() == [[1, 0.1, 0.2], [0.1, 2, 0.3], [0.2, 0.3, 3]]
