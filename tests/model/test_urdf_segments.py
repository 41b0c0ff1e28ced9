"""Segments from links: fixed ones are lumped, hinges at a point are one joint, and the motion is Pinocchio's."""

import numpy as np
import pinocchio as pin
import pytest

from mbkf.errors import FileFormatError
from mbkf.model.body_file import load_body
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.model.urdf_segments import urdf_segments
from mbkf.model.urdf_tree import read_urdf_tree
from tests.urdf_files import SIDE, biped, joint, link, written

HALF_TURN = "3.141592653589793"
QUARTER = "1.5707963267948966"


def arm():
    """Frames that are turned at zero, a shoulder of three hinges, a wrist of two, a tool with products of inertia."""
    products = (0.004, -0.003, 0.002)
    return [
        link("s1", 1e-4, (1e-7,) * 3, com="0 0 0"), link("s2", None), link("arm", 2.0, com="0 0.15 0"),
        link("w1", None), link("hand", 0.4, (0.01, 0.02, 0.02), products, "0.02 0 0.05", "0.3 0.2 0.1"),
        link("tool", 0.3, products=products, com="0.1 0 0", turn="0.5 0 0.2"),
        link("thumb", 0.1, com="0 0.02 0.03"),
        joint("shoulder_y", "pelvis", "s1", at="0 -0.2 0.4", axis="0 0 -1", turn=f"{QUARTER} 0 0"),
        joint("shoulder_x", "s1", "s2", axis="1 0 0", turn=f"0 0 {HALF_TURN}"),
        joint("shoulder_z", "s2", "arm", axis="0 -1 0"),
        joint("wrist_z", "arm", "w1", at="0 0.3 0", axis="0 1 0"),
        joint("wrist_x", "w1", "hand", axis="1 0 0"),
        joint("thumb", "hand", "thumb", at="0.02 0.01 0", axis="-0.5 0.3 0.6", turn="0.4 -0.2 0.7"),
        joint("grip", "hand", "tool", "fixed", at="0.01 0.02 0.03", turn="0.4 0.5 0.6"),
    ]  # fmt: skip


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return written(tmp_path_factory.mktemp("urdf"), biped(*arm()))


@pytest.fixture(scope="module")
def model(path):
    return HumanModel.scaled(body=load_body(path))


def test_joints_of_one_point_become_one(model):
    kinds = {one.name: (one.parent, one.joint, one.axes) for one in model.description.segments}
    assert kinds["arm"] == ("pelvis", "spherical", "")
    assert kinds["hand"] == ("arm", "universal", "zx")
    assert kinds["right_shank"] == ("right_thigh", "hinge", "y")
    assert kinds["thumb"] == ("hand", "hinge", "y")
    assert "tool" not in kinds and "right_sensor" not in kinds
    order = {one.distal: one.order for one in model.description.clinical_joints}
    assert (order["arm"], order["hand"]) == ("yxz", "zx")


def test_the_dynamics_are_those_of_the_file(model, path):
    """Mass matrix, gravity and places in random postures, hinge by hinge, against Pinocchio's own reader."""
    other = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
    other.gravity = model.pin_model.gravity
    data, clinical, rng = other.createData(), ClinicalAngles(model), np.random.default_rng(4)
    for _ in range(5):
        q = model.integrate(model.neutral(), rng.uniform(-0.7, 0.7, model.nv))
        angles, E = clinical.angles(q[None])[0], clinical.rate_matrix(q)
        q_other, S = pin.neutral(other), np.zeros((other.nv, model.nv))
        q_other[:7], S[:6, :6] = q[:7], np.eye(6)
        for column, name in enumerate(clinical.names):
            if other.existJointName(name):
                hinge = other.joints[other.getJointId(name)]
                S[hinge.idx_v] = E[column]
                q_other[hinge.idx_q : hinge.idx_q + hinge.nq] = turned(angles[column], hinge.nq)
        M = pin.crba(other, data, q_other)
        M = np.triu(M) + np.triu(M, 1).T
        np.testing.assert_allclose(S.T @ M @ S, model.mass_matrix(q), atol=2e-5)
        g = pin.computeGeneralizedGravity(other, data, q_other)
        np.testing.assert_allclose(S.T @ g, model.gravity_torques(q), atol=1e-9)
        pin.framesForwardKinematics(other, data, q_other)
        R, p = model.placements(q)
        for name, landmark in model.description.landmarks.items():
            k = model.joint(landmark.segment).joint_id
            place = data.oMf[other.getFrameId(name)].translation
            np.testing.assert_allclose(p[k] + R[k] @ landmark.position_m, place, atol=1e-12)


def turned(angle, nq):
    return angle if nq == 1 else [np.cos(angle), np.sin(angle)]


def test_the_mass_is_that_of_all_links(model):
    assert model.mass_kg == pytest.approx(20.0 + 2 * 6.5 + 2.0001 + 0.4 + 0.3 + 0.1, abs=1e-12)


def test_limits_follow_the_sense_of_the_axis(tmp_path):
    limit = '<limit lower="-0.5" upper="2" effort="1" velocity="1"/>'
    parts = biped(link("tail"), joint("wag", "pelvis", "tail", axis="0 0 -1", extra=limit))
    body = load_body(written(tmp_path, parts))
    np.testing.assert_allclose(body.segment("tail").limits_rad, [[-2.0, 0.5]])
    np.testing.assert_allclose(body.segment("left_shank").limits_rad, [[0.0, 2.5]])
    assert np.isinf(body.segment("left_foot").limits_rad).all()


def test_a_link_named_world_gives_the_axes(tmp_path):
    """Of a file whose y points up."""
    for kind in ("fixed", "floating"):
        parts = [link("world", None), joint("base", "world", "pelvis", kind, turn=f"{QUARTER} 0 0"),
                 link("pelvis", 20.0, com="0 0.1 0"), link("tail"),
                 joint("wag", "pelvis", "tail", at="0 -0.2 0", axis="0 0 1")]  # fmt: skip
        found = urdf_segments(read_urdf_tree(written(tmp_path, parts)), {"tail": "right_foot"})
        pelvis, tail = found.segments
        assert (pelvis["name"], tail["name"], tail["axes"]) == ("pelvis", "right_foot", "y")
        np.testing.assert_allclose(pelvis["com_m"], [0, 0, 0.1], atol=1e-15)
        np.testing.assert_allclose(tail["origin_m"], [0, 0, -0.2], atol=1e-15)
        assert found.clinical_joints[1]["angle"] == [{"name": "wag", "axis": "y", "sign": -1}]


def test_a_joint_of_the_type_spherical_turns_freely(tmp_path):
    parts = biped(link("head"), joint("neck", "pelvis", "head", "spherical", at="0 0 0.5"))
    body = load_body(written(tmp_path, parts))
    assert body.segment("head").joint == "spherical"
    names = next(one for one in body.clinical_joints if one.distal == "head").angles
    assert [one.name for one in names] == ["neck_y", "neck_x", "neck_z"]


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        ([link("p", None), joint("m", "pelvis", "p")], "link p has no mass"),
        ([link("a", None), link("p"), joint("m", "pelvis", "a"), joint("n", "a", "p", axis="1 0 1")],
         r"joint n turns about \[0.7071, 0.0, 0.7071\]"),
        ([link("p"), joint("m", "pelvis", "p", "floating")], "joint m is floating"),
        ([link("a", None), link("p"), joint("m", "pelvis", "a"), joint("n", "a", "p")], "the joints m, n meet"),
        ([link("p", 1.0, (0.1, 0.1, 0.5)), joint("m", "pelvis", "p")], "segment p: a rigid body cannot have"),
    ],
)  # fmt: skip
def test_joints_and_inertias_that_no_body_has_are_refused(tmp_path, parts, said):
    with pytest.raises(FileFormatError, match=said) as caught:
        load_body(written(tmp_path, biped(*parts), SIDE))
    assert "\n" not in str(caught.value)


def test_a_long_chain_ends_in_no_error_of_python(tmp_path):
    n = 1500
    parts = [link(f"l{k}") for k in range(n)]
    parts += [joint(f"j{k}", f"l{k}", f"l{k + 1}", at="0 0 0.1") for k in range(n - 1)]
    found = urdf_segments(read_urdf_tree(written(tmp_path, parts)), {})
    assert len(found.segments) == n
