"""The whole body as a forced one: forward against inverse dynamics, derivatives along the manifold, wrenches."""

from itertools import product

import numpy as np
import pinocchio as pin
import pytest

from mbkf.errors import UnknownName
from mbkf.model.human_dynamics import FORCE_STATES, GIVEN_FRAME, WRENCH_FRAMES, HumanDynamics
from tests.motions import assert_near, central_difference, moderate_pose, random_model, worst

FRAMES = (*WRENCH_FRAMES, GIVEN_FRAME)
each_state = pytest.mark.parametrize(("force_state", "frame"), list(product(FORCE_STATES, FRAMES)))
LOAD = np.array([80.0, 40.0, 500.0, 60.0, 60.0, 20.0])


class Moment:
    """A body at a random instant of a random motion under random loads."""

    def __init__(self, force_state="inertial", frame="ankle", seed=1, fixed=()):
        rng = np.random.default_rng(seed)
        self.model = random_model(rng)
        mask = np.zeros(self.model.nv, dtype=bool)
        mask[list(fixed)] = True
        given = frame == GIVEN_FRAME
        self.body = HumanDynamics(
            self.model, mask, "ankle" if given else frame, force_state, loads_given=given
        )
        self.q, self.v = moderate_pose(self.model, rng), 2.0 * rng.normal(size=self.model.nv)
        self.a = np.where(self.body.kinematic, 0.0, 10.0 * rng.normal(size=self.model.nv))
        self.wrench = rng.normal(size=(2, 6)) * LOAD
        self.u = self.forces(self.a, self.wrench)

    def forces(self, a, wrench):
        """Forces of the motion, followed by the loads where they are given."""
        own = self.body.forces(self.q, self.v, a, wrench)
        return np.concatenate([own, wrench.ravel()]) if self.body.loads_given else own


def change(function, x, step):
    columns = [(function(x + step * e) - function(x - step * e)) / (2 * step) for e in np.eye(len(x))]
    return np.stack(columns, axis=-1)


def test_the_reference_body_has_166_states():
    m = Moment()
    assert 2 * m.body.nv + m.body.nu == 166
    assert len(m.body.torque_dofs) == 50


def test_given_loads_leave_the_state():
    body = Moment(frame=GIVEN_FRAME).body
    assert 2 * body.nv + body.nu == 154


@each_state
def test_forward_undoes_inverse_dynamics(force_state, frame):
    m = Moment(force_state, frame)
    assert_near(m.body.acceleration(m.q, m.v, m.u), m.a, 1e-8)
    assert_near(m.body.linearise(m.q, m.v, m.u).a, m.a, 1e-8)


@each_state
def test_generalised_forces_drive_pinocchios_forward_dynamics(force_state, frame):
    """Independent path: world Jacobians for the loads and the articulated-body algorithm for the rest."""
    m = Moment(force_state, frame)
    tau = m.body.generalised(m.q, m.v, m.a, m.u)
    _, _, jacobian = m.model.placements_and_jacobian(m.q)
    for name, wrench in zip(m.model.roles.feet, m.wrench, strict=True):
        tau = tau + np.where(m.model.supports[m.model.joint(name).joint_id], wrench @ jacobian, 0.0)
    data = pin.Data(m.model.pin_model)
    assert_near(pin.aba(m.model.pin_model, data, m.q, m.v, tau), m.a, 1e-7)


@each_state
def test_derivatives_of_the_acceleration(force_state, frame):
    m = Moment(force_state, frame)
    slope = m.body.linearise(m.q, m.v, m.u)
    by_q = central_difference(m.model, lambda q: m.body.acceleration(q, m.v, m.u), m.q)
    by_v = change(lambda v: m.body.acceleration(m.q, v, m.u), m.v, 1e-5)
    by_u = change(lambda u: m.body.acceleration(m.q, m.v, u), m.u, 1.0)[:, : m.body.nu]
    for found, numeric in ((slope.by_q, by_q), (slope.by_v, by_v), (slope.by_u, by_u)):
        assert worst(found - numeric) < 1e-6 * max(1.0, worst(numeric))


@each_state
def test_joint_torques_and_their_derivatives(force_state, frame):
    m = Moment(force_state, frame)
    found, rows = m.body.joint_forces(m.q, m.v, m.u), m.body.torque_dofs
    assert_near(found.torque, m.body.generalised(m.q, m.v, m.a, m.u)[rows], 1e-8)
    by_q = central_difference(m.model, lambda q: m.body.joint_forces(q, m.v, m.u).torque, m.q)
    by_v = change(lambda v: m.body.joint_forces(m.q, v, m.u).torque, m.v, 1e-5)
    by_u = change(lambda u: m.body.joint_forces(m.q, m.v, u).torque, m.u, 1.0)[:, : m.body.nu]
    for stated, numeric in ((found.by_q, by_q), (found.by_v, by_v), (found.by_u, by_u)):
        assert worst(stated - numeric) < 1e-7 * max(1.0, worst(numeric))


@each_state
def test_forces_follow_accelerations_and_loads(force_state, frame):
    m = Moment(force_state, frame)
    rows, nu = m.body.force_rows(m.q), m.body.nu
    more = m.forces(m.a + np.where(m.body.kinematic, 0.0, 1.0), m.wrench) - m.u
    assert_near(rows @ np.concatenate([~m.body.kinematic * 1.0, np.zeros(12)]), more[:nu], 1e-8)
    heavier = m.forces(m.a, 2.0 * m.wrench) - m.u
    assert_near(rows @ np.concatenate([np.zeros(m.model.nv), heavier[-12:]]), heavier[:nu], 1e-8)


def test_both_force_states_mean_the_same_torques():
    first, second = (Moment(force_state) for force_state in FORCE_STATES)
    torque = [m.body.joint_forces(m.q, m.v, m.u).torque for m in (first, second)]
    assert_near(torque[0], torque[1], 1e-9)
    np.testing.assert_array_equal(first.u[-12:], second.u[-12:])


@pytest.mark.parametrize("frame", FRAMES)
def test_local_wrench_has_the_same_power_on_the_foot(frame):
    """Work on any motion of the foot is the same from the world's wrench and from the local one."""
    m = Moment(frame=frame)
    local, by_state, by_q = m.body.local_wrench(m.q, m.u[-12:])
    for side, name in enumerate(m.model.roles.feet):
        joint = m.model.joint(name).joint_id
        world = m.model.placements_and_jacobian(m.q)[2]
        moves = np.where(m.model.supports[joint], world, 0.0) @ m.v
        rotations, origins = m.model.placements(m.q)
        A, ankle = rotations[joint], moves[:3] + np.cross(moves[3:], origins[joint])
        own = np.concatenate([A.T @ ankle, A.T @ moves[3:]])
        assert local[6 * side : 6 * side + 6] @ own == pytest.approx(m.wrench[side] @ moves, rel=1e-9)
    assert_near(by_state, change(lambda w: m.body.local_wrench(m.q, w)[0], m.u[-12:], 1.0), 1e-8)
    numeric = central_difference(m.model, lambda q: m.body.local_wrench(q, m.u[-12:])[0], m.q)
    assert_near(by_q, numeric, 1e-5)


def test_prescribed_dofs_do_not_accelerate():
    fixed = (9, 10, 20)
    m = Moment(fixed=fixed)
    a = m.body.acceleration(m.q, m.v, m.u + 1.0)
    assert not a[list(fixed)].any()
    toes = [m.model.joint(f"{side}_toes").v.start for side in ("right", "left")]
    assert not a[toes].any()
    np.testing.assert_array_equal(np.flatnonzero(m.body.kinematic), sorted([*fixed, *toes]))
    assert not m.body.linearise(m.q, m.v, m.u).by_u[list(fixed)].any()


def test_tangent_space_turns_with_the_motion():
    """Errors carried along by a constant velocity: Ad(exp(−v t)) to first order is I − ad(v) t."""
    m, h = Moment(), 1e-6
    forth, back = (m.body.retraction(m.q, s * h * m.v)[0] for s in (1.0, -1.0))
    assert_near((forth - back) / (2.0 * h), m.body.transport(m.v), 1e-8)
    assert_near(m.body.retraction(m.q, np.zeros(m.body.nv))[1], np.eye(m.body.nv), 1e-12)
    assert_near(m.body.difference(m.q, m.body.integrate(m.q, 0.1 * m.v)), 0.1 * m.v, 1e-12)


def test_unknown_names_are_refused():
    model = Moment().model
    with pytest.raises(UnknownName, match="wrench frame"):
        HumanDynamics(model, wrench_frame="toe")
    with pytest.raises(UnknownName, match="force state"):
        HumanDynamics(model, force_state="power")
