"""The body as an OpenSim model: places, masses, inertias and conjugate forces are those of the native body."""

import numpy as np
import pytest

from mbkf.errors import UnknownName
from mbkf.io.subject import SubjectMarker
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.model.osim import osim_coordinates, osim_files, osim_forces, to_osim, to_osim_axes
from tests.oblique_hinges import oblique_body
from tests.osim_reading import OsimModel, vector

MARKERS = (
    SubjectMarker("RKNE", "right_thigh", np.array([0.01, -0.05, -0.43]), 0.005, 0.0),
    SubjectMarker("LTOE", "left_toes", np.array([0.05, 0.01, 0.02]), 0.005, 0.0),
    SubjectMarker("LASI", "pelvis", np.array([0.08, 0.12, -0.2]), 0.005, 0.0),
)


@pytest.fixture(scope="module")
def model():
    factors = {"trunk_height": 1.07, "right_thigh": 0.94, "left_foot_width": 1.1, "left_foot_length": 0.9}
    return HumanModel.scaled(factors, 68.3, oblique_body())


@pytest.fixture(scope="module")
def read(model):
    return OsimModel(to_osim(model, MARKERS))


@pytest.fixture(scope="module")
def postures(model):
    rng = np.random.default_rng(5)
    return np.array([model.integrate(model.neutral(), rng.uniform(-0.7, 0.7, model.nv)) for _ in range(6)])


def values(model, q):
    return dict(zip(ClinicalAngles(model).names, osim_coordinates(model, q[None])[0], strict=True))


def test_bodies_and_markers_are_where_the_native_body_has_them(model, read, postures):
    for q in postures:
        R, origins = model.placements(q)
        places, markers = read.places(values(model, q)), read.markers(values(model, q))
        for segment, joint in model.joints.items():
            np.testing.assert_allclose(
                places[segment][:3, 3], to_osim_axes(origins[joint.joint_id]), atol=1e-12
            )
            turned = to_osim_axes(to_osim_axes(R[joint.joint_id]).T).T  # Rᵀ of the axes on both sides
            np.testing.assert_allclose(places[segment][:3, :3], turned, atol=1e-12)
        for one in MARKERS:
            k = model.joint(one.segment).joint_id
            wanted = to_osim_axes(origins[k] + R[k] @ one.position_m)
            np.testing.assert_allclose(markers[one.name], wanted, atol=1e-12)


def test_up_is_y_and_the_pelvis_is_placed_by_its_origin_between_the_asis(model, read):
    np.testing.assert_array_equal(to_osim_axes([1.0, 2.0, 3.0]), [1.0, 3.0, -2.0])
    assert read.root.findtext("gravity") == "0.0 -9.80665 0.0"
    at = values(model, model.neutral())
    place = model.axis_scale(model.description.segments[0]) * [0.059, 0.0, -0.213]  # models/human18.toml
    np.testing.assert_allclose([at[f"pelvis_t{axis}"] for axis in "xyz"], to_osim_axes(place), atol=1e-12)
    assert at["pro_sup_r"] == pytest.approx(np.pi / 2)


def test_inertias_give_the_native_kinetic_energy(model, read):
    """½ ωᵀ I ω + ½ m v_com² of a rigid turn about the ground's origin, ω in the axes of each program."""
    q, turn = model.neutral(), np.array([0.3, -0.8, 0.5])
    spin = np.zeros(model.nv)
    spin[model.root.v] = [*np.cross(turn, [0, 0, 0]), *turn]  # the neutral root stands at the world's origin
    wanted = 0.5 * spin @ model.mass_matrix(q) @ spin
    energy, total = 0.0, 0.0
    for segment, pose in read.places(values(model, q)).items():
        if segment == "ground":
            continue
        body = read.bodies[segment]
        xx, yy, zz, xy, xz, yz = vector(body.findtext("inertia"))
        inertia, mass = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), float(body.findtext("mass"))
        omega = to_osim_axes(turn)
        com = pose[:3] @ [*vector(body.findtext("mass_center")), 1.0]
        inner = pose[:3, :3].T @ omega
        energy += 0.5 * inner @ inertia @ inner + 0.5 * mass * np.sum(np.cross(omega, com) ** 2)
        total += mass
    assert energy == pytest.approx(wanted, rel=1e-12)
    assert total == pytest.approx(model.mass_kg, rel=1e-12)


def test_products_of_inertia_turn_with_the_axes(model):
    import pinocchio as pin

    k = model.joint("head").joint_id
    own = model.pin_model.inertias[k]
    products = own.inertia + 1e-3 * np.array([[0.0, 1.0, 2.0], [1.0, 0.0, 3.0], [2.0, 3.0, 0.0]])
    inertias = list(model.pin_model.inertias)
    inertias[k] = pin.Inertia(own.mass, own.lever, products)
    text = OsimModel(to_osim(model.with_inertias(inertias))).bodies["head"].findtext("inertia")
    assert vector(text)[3:] == pytest.approx([2e-3, -1e-3, -3e-3], abs=1e-12)  # xy is our xz, xz −xy, yz −yz


def test_forces_do_the_same_work_as_the_tangent_ones(model, postures):
    """m · δθ = τ · δv for a small displacement δv of the posture."""
    rng = np.random.default_rng(9)
    for q in postures:
        step, tau = rng.normal(size=model.nv), rng.normal(size=model.nv)
        h = 1e-6
        both = np.array([model.integrate(q, sign * h * step) for sign in (1.0, -1.0)])
        moved = np.subtract(*osim_coordinates(model, both)) / (2 * h)
        assert osim_forces(model, q[None], tau[None])[0] @ moved == pytest.approx(tau @ step, rel=1e-6)


def test_ranges_are_the_bodys_in_the_sense_of_each_coordinate(model, read):
    knee = read.coordinates["knee_angle_r"]
    limits = model.limits[model.joint("right_shank").v][1]
    np.testing.assert_allclose(vector(knee.findtext("range")), limits)
    hip = model.limits[model.joint("right_thigh").v][1]
    np.testing.assert_allclose(vector(read.coordinates["hip_flexion_r"].findtext("range")), -hip[::-1])
    arm = model.limits[model.joint("right_forearm").v][2] + np.pi / 2
    np.testing.assert_allclose(vector(read.coordinates["pro_sup_r"].findtext("range")), arm)
    assert {one.findtext("locked") for one in read.coordinates.values()} == {"false"}
    assert len(read.coordinates) == model.nv


def test_it_stands_on_the_ground_by_default(model, read):
    default = {name: float(one.findtext("default_value")) for name, one in read.coordinates.items()}
    places = read.places(default)
    soles = [
        (places[sole.segment][:3] @ [*to_osim_axes(np.array([0, 0, sole.height_m]) * model.axis_scale(
            model.description.segment(sole.segment))), 1.0])[1]
        for sole in model.roles.soles
    ]  # fmt: skip
    assert min(soles) == pytest.approx(0.0, abs=1e-12)


def test_every_segment_has_a_surface_in_opensims_axes(model):
    files = osim_files(model, MARKERS, "p1.osim")
    meshes = {one.text for one in OsimModel(files["p1.osim"]).root.iter("mesh_file")}
    assert {*meshes, "p1.osim"} == set(files) and len(meshes) == len(model.joints)
    from xml.etree import ElementTree as ET

    points = ET.fromstring(files["p1_right_thigh.vtp"]).find(".//Points/DataArray").text
    lowest = vector(points).reshape(-1, 3)[:, 1].min()
    assert lowest < -0.3, "the thigh hangs along −y"


def test_names_hold_no_character_that_opensim_refuses_and_stay_different(model):
    names = ("L Knee/1", "L_Knee_1", "*110", "A+B", "R:LASI", "R.Knee")
    markers = [SubjectMarker(name, "torso", np.full(3, 0.1 * k), 0.005, 0.0) for k, name in enumerate(names)]
    found = OsimModel(to_osim(model, markers)).markers(values(model, model.neutral()))
    assert list(found) == ["L_Knee_1", "L_Knee_1_2", "_110", "A_B", "R:LASI", "R.Knee"]


def test_a_marker_of_an_unknown_segment_is_refused(model):
    with pytest.raises(UnknownName, match="tail"):
        to_osim(model, (SubjectMarker("X", "tail", np.zeros(3), 0.005, 0.0),))
