"""Plant noise of the whole body: the thesis's table, and noise that Newton–Euler allows."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.filters.torque.noise import ForceNoise, condition
from mbkf.filters.torque.plant import ForcedState
from mbkf.filters.torque.settings import TorqueSettings, preset
from mbkf.model.human_dynamics import FORCE_STATES, WRENCH_FRAMES, HumanDynamics
from tests.motions import assert_near, moderate_pose, random_model, worst

DT = 0.01


def made(settings, seed=1, fixed=()):
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    mask = np.zeros(model.nv, dtype=bool)
    mask[list(fixed)] = True
    body = HumanDynamics(model, mask, settings.wrench_frame, settings.force_state)
    q, v = moderate_pose(model, rng), rng.normal(size=model.nv)
    a = np.where(body.kinematic, 0.0, rng.normal(size=model.nv))
    u = body.forces(q, v, a, rng.normal(size=(2, 6)) * 100.0)
    n = 2 * model.nv + body.nu
    return body, ForcedState(q, v, u, np.zeros((n, n))), ForceNoise(body, DT, settings)


def test_conditioning_is_the_gaussians():
    """Equal to the blocks of the joint covariance of x and y = A x + r."""
    rng = np.random.default_rng(2)
    B, A, variance = rng.normal(size=(6, 6)), rng.normal(size=(2, 6)), np.array([0.1, 2.0])
    C = B @ B.T
    found = condition(C, A, variance, np.array([1.0, -3.0]))
    gain = C @ A.T @ np.linalg.inv(A @ C @ A.T + np.diag(variance))
    assert_near(found.shift, gain @ [1.0, -3.0], 1e-11)
    assert_near(found.covariance, C - gain @ A @ C, 1e-10)


@pytest.mark.parametrize("force_state", FORCE_STATES)
def test_consistent_noise_leaves_accelerations_and_loads_their_own(force_state):
    """Through M⁻¹ the forces' noise becomes that of the accelerations; the pelvis's is bound where the residual is."""
    settings = TorqueSettings(force_state=force_state)
    body, state, noise = made(settings)
    nv, density = body.nv, noise(state).matrix()
    by_u = body.linearise(state.q, state.v, state.u).by_u
    caused = np.sqrt(np.diag(by_u @ density[2 * nv :, 2 * nv :] @ by_u.T))
    jerk = np.where(body.kinematic, 0.0, settings.jerk_scale * body.model.acceleration_sd)
    assert (caused <= jerk * (1 + 1e-6) + 1e-9).all()
    if force_state == "inertial":
        assert_near(caused, jerk, 1e-6)
        load = np.repeat([settings.load_force_n, settings.load_moment_nm], 3) * body.model.mass_kg / 100
        assert_near(np.sqrt(np.diag(density)[-12:]), np.tile(load, 2), 1e-9)
    else:
        own = (
            np.repeat([settings.residual_force_n, settings.residual_moment_nm], 3) * body.model.mass_kg / 100
        )
        residual = np.sqrt(np.diag(density)[2 * nv : 2 * nv + 6])
        assert (residual <= own * (1 + 1e-6)).all()
    np.testing.assert_array_equal(density, density.T)
    assert np.linalg.eigvalsh(density).min() > -1e-9 * worst(density)


def test_a_covariance_of_readings_is_that_of_their_joint_gaussian():
    rng = np.random.default_rng(3)
    B, A, R = rng.normal(size=(4, 4)), rng.normal(size=(2, 4)), np.array([[0.5, 0.2], [0.2, 1.0]])
    C = B @ B.T
    gain = C @ A.T @ np.linalg.inv(A @ C @ A.T + R)
    assert_near(condition(C, A, R, np.zeros(2)).covariance, C - gain @ A @ C, 1e-10)


def test_vertical_forces_have_their_own_noise_in_the_world():
    """In whatever axes a force stands in the state: those of the pelvis, of the foot, of the world."""
    apart = {"residual_vertical_force_n": 30.0, "load_vertical_force_n": 60.0}
    for frame in WRENCH_FRAMES:
        settings = replace(preset("FD", literal=True), wrench_frame=frame, **apart)
        body, state, noise = made(settings)
        forces, rotations = (
            noise(state).matrix()[2 * body.nv :, 2 * body.nv :],
            body.model.placements(state.q)[0],
        )
        root, feet = body.model.joint("pelvis").joint_id, body.model.roles.feet
        scale = (body.model.mass_kg / 100.0) ** 2
        pelvis = rotations[root] @ forces[:3, :3] @ rotations[root].T
        assert_near(pelvis, scale * np.diag([10.0, 10.0, 30.0]) ** 2, 1e-9)
        for k, name in enumerate(feet):
            first = body.nu - 12 + 6 * k
            axes = rotations[body.model.joint(name).joint_id] if frame == "foot" else np.eye(3)
            load = axes @ forces[first : first + 3, first : first + 3] @ axes.T
            assert_near(load, scale * np.diag([20.0, 20.0, 60.0]) ** 2, 1e-9)


def test_given_loads_have_no_noise():
    settings = replace(TorqueSettings(), plates="inputs")
    body, state, _ = made(settings)
    given = HumanDynamics(body.model, loads_given=True)
    whole, known = (ForceNoise(one, DT, settings)(state).matrix() for one in (body, given))
    at = 2 * body.nv + given.nu
    assert known.shape == (at, at)
    assert_near(known, whole[:at, :at], 1e-12)


def test_independent_noise_is_the_table_scaled_by_mass():
    """Thesis Table 4.3 and thesis eq. 4.18."""
    body, state, noise = made(preset("FD", literal=True))
    nv, model, scale = body.nv, body.model, body.model.mass_kg / 100.0
    density = noise(state).matrix()
    sd = np.sqrt(np.diag(density)) / scale
    assert_near(density, np.diag(np.diag(density)), 0.0)
    torque = dict(zip(body.torque_dofs.tolist(), sd[2 * nv :], strict=False))
    assert [torque[k] for k in range(6)] == pytest.approx([10, 10, 10, 5, 5, 5])
    for segment, expected in (("torso", 5.0), ("left_hand", 5.0), ("right_thigh", 20.0), ("left_foot", 20.0)):
        dofs = model.joint(segment).v
        assert [torque[k] for k in range(dofs.start, dofs.stop)] == pytest.approx([expected] * 3)
    assert sd[-12:] == pytest.approx(np.full(12, 20.0))
    toes = [nv + model.joint(f"{side}_toes").v.start for side in ("right", "left")]
    assert np.sqrt(np.diag(density)[toes] / DT) == pytest.approx([10.0, 10.0])
    others = np.setdiff1d(np.arange(2 * nv), toes)
    assert not density[others].any()


def test_noise_per_frame_is_what_a_frame_adds():
    literal = preset("FD", literal=True)
    _, state, noise = made(literal)
    _, _, per_frame = made(replace(literal, per_frame=True))
    forces = np.diag(noise(state).forces)[-12:]
    assert_near(np.diag(per_frame(state).forces)[-12:] * DT, forces, 1e-9)


def test_fixed_dofs_receive_none():
    fixed = (9, 10)
    body, state, noise = made(TorqueSettings(), fixed=fixed)
    by_u = body.linearise(state.q, state.v, state.u).by_u
    caused = by_u @ noise(state).forces @ by_u.T
    assert not caused[list(fixed)].any()
