"""An exported body is read back: the same masses, inertias, places, angles and shapes, at factors of 1."""

import numpy as np
import pytest

from mbkf.io.subject import SubjectMarker
from mbkf.model.body_file import load_body
from mbkf.model.body_shapes import segment_shapes
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.model.urdf import MARKER_PREFIX, to_urdf
from mbkf.model.urdf_body import side_path
from mbkf.model.urdf_side import urdf_side_text
from mbkf.synthesis.person import body_of, synthesise_subject

MARKER = SubjectMarker("RKNE", "right_thigh", np.array([0.01, -0.05, -0.43]), 0.005, 0.0)


@pytest.fixture(scope="module")
def model():
    """A person whose sides differ, with joint centres and inertias of the person's own."""
    return body_of(synthesise_subject(5))


@pytest.fixture(scope="module")
def again(model, tmp_path_factory):
    path = tmp_path_factory.mktemp("urdf") / "person.urdf"
    path.write_text(to_urdf(model, [MARKER]), "utf-8")
    side_path(path).write_text(urdf_side_text(model, 1.7), "utf-8")
    return HumanModel.scaled(body=load_body(path))


def test_masses_inertias_and_joints(model, again):
    assert again.mass_kg == pytest.approx(model.mass_kg, abs=1e-9)
    assert list(again.joints) == list(model.joints)
    for name, joint in model.joints.items():
        other = again.joints[name]
        assert (other.kind, other.axes, other.joint_id, other.q) == (
            joint.kind,
            joint.axes,
            joint.joint_id,
            joint.q,
        )
        own, found = model.pin_model.inertias[joint.joint_id], again.pin_model.inertias[joint.joint_id]
        np.testing.assert_allclose(found.toDynamicParameters(), own.toDynamicParameters(), atol=1e-9)


def test_kinematics_and_dynamics(model, again):
    rng, clinical = np.random.default_rng(1), (ClinicalAngles(model), ClinicalAngles(again))
    assert clinical[0].names == clinical[1].names
    for _ in range(3):
        q = model.integrate(model.neutral(), rng.uniform(-0.6, 0.6, model.nv))
        for found, wanted in zip(again.placements(q), model.placements(q), strict=True):
            np.testing.assert_allclose(found, wanted, atol=1e-9)
        np.testing.assert_allclose(again.mass_matrix(q), model.mass_matrix(q), atol=1e-9)
        angles = [one.angles(q[None])[0] for one in clinical]
        np.testing.assert_allclose(*angles, atol=1e-12)


def test_the_rest_of_the_body_is_the_persons(model, again):
    body, found = model.description, again.description
    assert (found.name, found.reference_height_m) == ("human18 (scaled)", 1.7)
    for name, landmark in body.landmarks.items():
        place = model.axis_scale(body.segment(landmark.segment)) * landmark.position_m
        assert found.landmarks[name].segment == landmark.segment
        np.testing.assert_allclose(found.landmarks[name].position_m, place, atol=1e-12)
    np.testing.assert_allclose(found.landmarks[MARKER_PREFIX + "RKNE"].position_m, MARKER.position_m)
    for own, sole in zip(body.roles.soles, found.roles.soles, strict=True):
        x, y, z = model.axis_scale(body.segment(own.segment))
        assert (sole.segment, sole.heel_x_m) == (own.segment, pytest.approx(x * own.heel_x_m))
        assert (sole.outer_y_m, sole.height_m) == (
            pytest.approx(y * own.outer_y_m),
            pytest.approx(z * own.height_m),
        )
    for own, one in zip(body.segments, found.segments, strict=True):
        np.testing.assert_array_equal(one.scale_matrix, own.scale_matrix)
        for key in ("limits_rad", "posture_sd_rad", "acceleration_sd", "movement_sd"):
            np.testing.assert_allclose(getattr(one, key), getattr(own, key))
    for key in ("legs", "toes", "leading", "steady", "knees"):
        assert getattr(found.roles, key) == getattr(body.roles, key)
    assert set(found.skin) == set(body.skin) and len(found.girdle) == len(body.girdle)
    assert [one.name for one in found.levels] == [one.name for one in body.levels]
    for own, joint in zip(body.clinical_joints, found.clinical_joints, strict=True):
        assert (joint.angles, joint.translations, joint.main) == (own.angles, own.translations, own.main)
    drawn, own = segment_shapes(again), segment_shapes(model)
    for name in ("pelvis", "left_thigh", "head", "left_hand"):
        np.testing.assert_allclose(drawn[name][0].numbers, own[name][0].numbers, atol=1e-12)
