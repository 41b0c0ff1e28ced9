"""An OpenSim model as a body of ours: our own exported one comes back, with its markers and its coordinates."""

import re
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.osim import read_osim
from mbkf.model.body_file import load_body
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.model.osim import osim_coordinates, osim_files, to_osim_axes
from mbkf.model.osim_kinematics import OsimKinematics
from mbkf.model.protocol import load_protocol
from mbkf.model.urdf_body import side_path
from tests.osim_mechanisms import mechanism
from tests.recordings import walker

SOLE = """[sole]
height_m = -0.07
heel_x_m = -0.06
ball_x_m = 0.13
toe_x_m = 0.2
inner_y_m = 0.04
outer_y_m = -0.05
"""
ROLES = '[roles]\nfeet = ["right_foot", "left_foot"]\n'
COMMON = {"right_foot": "calcn_r", "left_foot": "calcn_l", "right_shank": "tibia_r", "right_thigh": "femur_r"}


def written(folder, side, names=None):
    """Our body as an OpenSim model, with a side file."""
    person, model, _ = walker()
    text = osim_files(model, person.markers, "own.osim")["own.osim"]
    for ours, theirs in (names or {}).items():
        text = re.sub(rf"\b{ours}\b", theirs, text)
    path = folder / "own.osim"
    path.write_text(text, encoding="utf-8")
    if side is not None:
        side_path(path).write_text("reference_height_m = 1.75\n" + side, encoding="utf-8")
    return path


def test_masses_and_joints_come_back(tmp_path):
    model, body = walker()[1], load_body(written(tmp_path, ROLES + SOLE))
    assert body.reference_mass_kg == pytest.approx(model.mass_kg)
    assert [one.name for one in body.segments] == list(model.joints)
    for one in body.segments:
        inertia = model.pin_model.inertias[model.joint(one.name).joint_id]
        assert (one.joint, one.mass_kg) == (
            model.description.segment(one.name).joint,
            pytest.approx(inertia.mass),
        )
        assert one.com_m == pytest.approx(inertia.lever, abs=1e-12)
        assert one.inertia_matrix_kg_m2 == pytest.approx(inertia.inertia, abs=1e-12)
    assert body.roles.feet == ("right_foot", "left_foot")


def test_places_are_those_of_the_model_in_its_own_coordinates(tmp_path):
    """The body's angles are the model's coordinates: in both the markers are at one place, at any posture."""
    path = written(tmp_path, ROLES + SOLE)
    body, kinematics = HumanModel.scaled(body=path), OsimKinematics(read_osim(path))
    rng = np.random.default_rng(3)
    q = np.array([body.integrate(body.neutral(), rng.uniform(-0.8, 0.8, body.nv)) for _ in range(5)])
    names = ClinicalAngles(body).names
    assert set(names) == set(kinematics.names)
    coordinates = osim_coordinates(body, q)[:, [names.index(name) for name in kinematics.names]]
    markers = kinematics.model.markers
    numbers = np.array([kinematics.body(one.body) for one in markers])
    theirs = kinematics.poses(coordinates).points(numbers, np.array([one.position_m for one in markers]))[0]
    for row, expected in zip(q, theirs, strict=True):
        R, origins = body.placements(row)
        landmarks = [body.description.landmark(one.name) for one in markers]
        ids = [body.joint(one.segment).joint_id for one in landmarks]
        ours = [origins[k] + R[k] @ one.position_m for k, one in zip(ids, landmarks, strict=True)]
        assert to_osim_axes(np.array(ours)) == pytest.approx(expected, abs=1e-9)


def test_roles_are_found_by_opensims_names_or_demanded(tmp_path):
    body = load_body(written(tmp_path, SOLE, COMMON))
    assert body.roles.feet == ("calcn_r", "calcn_l")
    assert body.roles.knees == (("femur_r", "tibia_r"),)
    with pytest.raises(FileFormatError, match="lacks roles: no segments are named calcn_r and calcn_l"):
        load_body(written(tmp_path, SOLE))


def test_a_missing_side_file_or_entry_is_named(tmp_path):
    with pytest.raises(
        FileFormatError, match=r"needs a side file own.osim.toml .* with reference_height_m, sole"
    ):
        load_body(written(tmp_path, None))
    with pytest.raises(FileFormatError, match="lacks sole"):
        load_body(written(tmp_path, ROLES))


def test_a_joint_without_a_place_in_a_body_is_refused_with_the_file(tmp_path):
    path = tmp_path / "held.osim"
    path.write_text(mechanism(), encoding="utf-8")
    side_path(path).write_text("reference_height_m = 1.75\n" + SOLE, encoding="utf-8")
    with pytest.raises(FileFormatError, match=r"held\.osim: .*'patella' follows 'knee'"):
        load_body(path)


def test_a_joint_that_slides_is_a_hinge_with_its_residual_stated(tmp_path):
    """Toes that also shift by 0.008 m/rad² θ²; markers on them get the residual as noise."""
    path = written(tmp_path, ROLES + SOLE)
    before = {one.name: one.noise_m for one in load_protocol(path).markers}
    document = ET.fromstring(path.read_text(encoding="utf-8"))
    axis = document.find(".//CustomJoint[@name='mtp_r']//TransformAxis[@name='translation1']")
    axis.find("coordinates").text = "mtp_angle_r"
    axis.remove(axis.find("Constant"))
    ET.SubElement(ET.SubElement(axis, "PolynomialFunction"), "coefficients").text = "0.008 0 0"
    path.write_text(ET.tostring(document, encoding="unicode"), encoding="utf-8")
    protocol = load_protocol(path)
    (note,) = protocol.body.approximations
    assert note.segment == "right_toes" and 0.5e-3 < note.rms_m < 5e-3
    assert note.text.startswith("mtp_r turns about a fixed axis")
    moved = {one.name: one.segment for one in protocol.markers if one.noise_m != before[one.name]}
    assert set(moved.values()) == {"right_toes"}
    name = min(moved)
    after = next(one.noise_m for one in protocol.markers if one.name == name)
    assert after**2 == pytest.approx(before[name] ** 2 + note.rms_m**2)
    side_path(path).write_text(
        "reference_height_m = 1.75\nfitted_deg = {mtp_angle_r = [0.0, 20.0]}\n" + ROLES + SOLE,
        encoding="utf-8",
    )
    assert load_body(path).approximations[0].rms_m < 0.2 * note.rms_m


def test_its_markers_are_a_protocol(tmp_path):
    path, person = written(tmp_path, ROLES + SOLE), walker()[0]
    protocol = load_protocol(path)
    assert [one.name for one in protocol.markers] == [one.name for one in person.markers]
    for ours, theirs in zip(person.markers, protocol.markers, strict=True):
        assert (theirs.segment, theirs.kind) == (ours.segment, "anatomical")
        if ours.segment != "pelvis":
            assert theirs.position_m == pytest.approx(ours.position_m, abs=1e-9)
    with pytest.raises(FileFormatError, match="no landmarks of the body 'human18'"):
        load_protocol(path, load_body())
