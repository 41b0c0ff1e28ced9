"""URDF and MJCF against the native body: same points, mass matrix, gravity and energy elsewhere."""

from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest

from mbkf.errors import UnknownName
from mbkf.io.subject import SubjectMarker
from mbkf.model.body_shapes import COLOURS, segment_shapes, side_of
from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human import HumanModel
from mbkf.model.mjcf import to_mjcf
from mbkf.model.primitive_shapes import primitives
from mbkf.model.urdf import MARKER_PREFIX, to_urdf
from tests.oblique_hinges import oblique_body

POSES = 8
MARKERS = (
    SubjectMarker("RKNE", "right_thigh", np.array([0.01, -0.05, -0.43]), 0.005, 0.0),
    SubjectMarker("LTOE", "left_toes", np.array([0.05, 0.01, 0.02]), 0.005, 0.0),
)


@pytest.fixture(scope="module")
def model():
    factors = {"trunk_height": 1.07, "right_thigh": 0.94, "left_foot_width": 1.1, "left_foot_length": 0.9}
    return HumanModel.scaled(factors, 68.3, oblique_body())


@pytest.fixture(scope="module")
def clinical(model):
    return ClinicalAngles(model)


@pytest.fixture(scope="module")
def poses(model):
    """Configurations and velocities away from the hinges' singularity."""
    rng = np.random.default_rng(11)
    q = [model.integrate(model.neutral(), rng.uniform(-0.7, 0.7, model.nv)) for _ in range(POSES)]
    return list(zip(q, rng.normal(size=(POSES, model.nv)), strict=True))


def placed(model, q):
    """World transform (4, 4) of every segment."""
    R, p = model.placements(q)
    transforms = {}
    for name, joint in model.joints.items():
        transforms[name] = np.eye(4)
        transforms[name][:3, :3], transforms[name][:3, 3] = R[joint.joint_id], p[joint.joint_id]
    return transforms


def relative_error(got, wanted):
    return np.abs(got - wanted).max() / np.abs(wanted).max()


class TestUrdf:
    @pytest.fixture(scope="class")
    @staticmethod
    def path(model, tmp_path_factory):
        path = tmp_path_factory.mktemp("urdf") / "body.urdf"
        path.write_text(to_urdf(model, MARKERS), encoding="utf-8")
        return path

    def test_yourdfpy_reads_it_and_places_every_segment_and_marker(self, path, model, clinical, poses):
        import yourdfpy

        urdf = yourdfpy.URDF.load(str(path), load_meshes=False, build_collision_scene_graph=False)
        assert urdf.validate()
        assert urdf.base_link == "pelvis"
        assert urdf.num_actuated_joints == model.nv - 6
        for q, _ in poses:
            angles = dict(zip(clinical.names, clinical.angles(q[None])[0], strict=True))
            urdf.update_cfg({name: angles[name] for name in urdf.actuated_joint_names})
            world = placed(model, q)
            for name, transform in world.items():
                np.testing.assert_allclose(world["pelvis"] @ urdf.get_transform(name), transform, atol=1e-12)
            for marker in MARKERS:
                point = (world["pelvis"] @ urdf.get_transform(MARKER_PREFIX + marker.name))[:3, 3]
                native = world[marker.segment] @ np.append(marker.position_m, 1.0)
                np.testing.assert_allclose(point, native[:3], atol=1e-12)

    def test_pinocchio_parses_it_to_the_same_dynamics(self, path, model, clinical, poses):
        other = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
        other.gravity = model.pin_model.gravity
        data = other.createData()
        assert other.nv == model.nv
        for q, v in poses:
            q_other, S = self.mapped(other, model, clinical, q)
            M = np.triu(pin.crba(other, data, q_other))
            M = M + np.triu(M, 1).T
            g = pin.computeGeneralizedGravity(other, data, q_other)
            assert relative_error(S.T @ M @ S, model.mass_matrix(q)) < 1e-12
            assert relative_error(S.T @ g, model.gravity_torques(q)) < 1e-12
            energy = pin.computeKineticEnergy(other, data, q_other, S @ v)
            assert energy == pytest.approx(0.5 * v @ model.mass_matrix(q) @ v, rel=1e-12)

    def test_pinocchio_draws_it_with_the_sides_in_colour(self, path, model):
        body, _, visuals = pin.buildModelsFromUrdf(str(path), str(path.parent), pin.JointModelFreeFlyer())
        drawn = {}
        for one in visuals.geometryObjects:
            drawn.setdefault(body.frames[one.parentFrame].name, []).append(one)
        assert set(drawn) == {*model.joints, *(MARKER_PREFIX + marker.name for marker in MARKERS)}
        for name, shapes in segment_shapes(model).items():
            assert len(drawn[name]) == sum(len(primitives(shape)) for shape in shapes)
            np.testing.assert_allclose(drawn[name][0].meshColor, [*COLOURS[side_of(name)], 1.0])

    def test_every_link_has_a_mass_and_their_sum_is_the_persons(self, path, model):
        """PyBullet counts 1 kg for a link without a mass."""
        root = ET.parse(path).getroot()
        masses = [float(link.find("inertial/mass").get("value")) for link in root.findall("link")]
        assert sum(masses) == pytest.approx(model.mass_kg, abs=1e-9)

    def test_mujoco_draws_it_and_sets_its_root_free(self, path, model):
        import mujoco

        spec = mujoco.MjSpec.from_file(str(path))
        spec.body("pelvis").add_freejoint()
        other = spec.compile()
        assert other.nv == model.nv
        assert other.body_mass.sum() == pytest.approx(model.mass_kg, abs=1e-9)
        assert other.ngeom == sum(len(link.findall("visual")) for link in ET.parse(path).getroot())
        assert not other.geom_contype.any()

    @staticmethod
    def mapped(other, model, clinical, q):
        """Configuration of the hinge body, and S of v_other = S v: the free joint as it is, hinges by E."""
        angles, E = clinical.angles(q[None])[0], clinical.rate_matrix(q)
        q_other, S = pin.neutral(other), np.zeros((other.nv, model.nv))
        q_other[:7], S[:6, :6] = q[:7], np.eye(6)
        for column, name in enumerate(clinical.names):
            if other.existJointName(name):
                joint = other.joints[other.getJointId(name)]
                q_other[joint.idx_q], S[joint.idx_v] = angles[column], E[column]
        assert np.linalg.matrix_rank(S) == model.nv
        return q_other, S


class TestMjcf:
    @pytest.fixture(scope="class")
    @staticmethod
    def other(model):
        import mujoco

        return mujoco.MjModel.from_xml_string(to_mjcf(model, MARKERS))

    @staticmethod
    def posed(other, model, q):
        """MuJoCo's data at a native configuration, and S of qvel = S v: the root's velocity in the world."""
        import mujoco

        data = mujoco.MjData(other)
        data.qpos[:] = q
        for joint in model.joints.values():
            if joint.kind in ("free", "spherical"):
                quaternion = slice(joint.q.stop - 4, joint.q.stop)
                data.qpos[quaternion] = np.roll(q[quaternion], 1)
        mujoco.mj_forward(other, data)
        S = np.eye(model.nv)
        S[:3, :3] = model.placements(q)[0][model.joint("pelvis").joint_id]
        return data, S

    def test_mujoco_places_every_body_and_marker(self, other, model, poses):
        assert (other.nq, other.nv) == (model.nq, model.nv)
        for q, _ in poses:
            data, _ = self.posed(other, model, q)
            for name, transform in placed(model, q).items():
                np.testing.assert_allclose(data.body(name).xpos, transform[:3, 3], atol=1e-12)
                np.testing.assert_allclose(data.body(name).xmat.reshape(3, 3), transform[:3, :3], atol=1e-12)
            for marker in MARKERS:
                transform = placed(model, q)[marker.segment]
                point = (transform @ np.append(marker.position_m, 1.0))[:3]
                np.testing.assert_allclose(data.site(marker.name).xpos, point, atol=1e-12)

    def test_mujoco_has_the_same_mass_matrix_gravity_and_energy(self, other, model, poses):
        import mujoco

        assert other.body_mass.sum() == pytest.approx(model.mass_kg, rel=1e-12)
        for q, v in poses:
            data, S = self.posed(other, model, q)
            M = np.empty((other.nv, other.nv))
            mujoco.mj_fullM(other, data, M)
            assert relative_error(S.T @ M @ S, model.mass_matrix(q)) < 1e-8
            assert relative_error(S.T @ data.qfrc_bias, model.gravity_torques(q)) < 1e-8
            data.qvel[:] = S @ v
            other.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
            mujoco.mj_forward(other, data)
            assert data.energy[1] == pytest.approx(0.5 * v @ model.mass_matrix(q) @ v, rel=1e-8)

    def test_products_of_inertia_reach_mujoco(self, model):
        import mujoco

        thigh = model.joint("left_thigh").joint_id
        inertias = list(model.pin_model.inertias)
        skew = inertias[thigh].inertia + np.array([[0, 0.01, 0.02], [0.01, 0, -0.015], [0.02, -0.015, 0]])
        inertias[thigh] = pin.Inertia(inertias[thigh].mass, inertias[thigh].lever, skew)
        other = mujoco.MjModel.from_xml_string(to_mjcf(model.with_inertias(inertias)))
        axes, found = np.empty(9), other.body("left_thigh")
        mujoco.mju_quat2Mat(axes, found.iquat)
        axes = axes.reshape(3, 3)
        np.testing.assert_allclose(axes @ np.diag(found.inertia) @ axes.T, skew, atol=1e-12)

    def test_nothing_but_gravity_acts(self, other, model):
        data, _ = self.posed(other, model, model.neutral())
        assert data.ncon == 0
        np.testing.assert_allclose(data.qacc[:3], [0.0, 0.0, -9.80665], atol=1e-8)
        np.testing.assert_allclose(data.qacc[3:], 0.0, atol=1e-6)


@pytest.mark.parametrize("write", [to_urdf, to_mjcf])
def test_a_marker_on_an_unknown_segment_is_refused(model, write):
    with pytest.raises(UnknownName, match="tail"):
        write(model, (SubjectMarker("T", "tail", np.zeros(3), 0.005, 0.0),))
