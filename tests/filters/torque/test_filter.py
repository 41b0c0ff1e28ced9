"""The torque-state filter on synthetic motions: it follows, obeys Newton, and bears losses."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.torque.filter import FootReading, TorqueFilter
from mbkf.filters.torque.settings import TorqueSettings, preset
from mbkf.synthesis.motion import synthesise_motion
from mbkf.synthesis.person import body_of, synthesise_subject
from tests.motions import assert_near, marker_positions, protocol_sensor

pytestmark = pytest.mark.slow

RATE_HZ, NOISE_M, FRAMES = 100.0, 0.005, 90
BOTH = np.ones(2, dtype=bool)


@pytest.fixture(scope="module")
def model():
    return body_of(synthesise_subject(5))


@pytest.fixture(scope="module")
def motions(model):
    return {name: synthesise_motion(model, name, 1.5, RATE_HZ, seed=5) for name in ("squat", "walk")}


class Run:
    """A filter run over the beginning of a true motion, with noisy markers and plates."""

    def __init__(self, model, motion, settings, frames=FRAMES, hide=None, measured=BOTH, seed=1):
        rng = np.random.default_rng(seed)
        sensor, _ = protocol_sensor(model)
        self.truth, self.sensor, self.model = motion, sensor, model
        self.markers = marker_positions(sensor, motion.q[:frames])
        self.markers += 0.002 * rng.normal(size=self.markers.shape)
        if hide is not None:
            segments, start, stop = hide
            rows = [k for k, name in enumerate(sensor.segments) if name in segments]
            self.markers[start:stop, rows] = np.nan
        noise = np.full(len(sensor.segments), NOISE_M)
        self.filter = TorqueFilter(sensor, noise, 1 / RATE_HZ, np.zeros(model.nv, dtype=bool), settings)
        loaded = (motion.foot_wrench[:frames] != 0).any(axis=2, keepdims=True)
        spread = np.array([1.0, 1.0, 1.0, 0.2, 0.2, 0.2])
        self.wrench = motion.foot_wrench[:frames] + loaded * spread * rng.normal(size=(frames, 2, 6))
        P = np.diag(np.repeat([0.01, 0.5], model.nv) ** 2)
        start = KinematicState(motion.q[0], motion.v[0], P)
        states = [self.filter.start(start, motion.a[0], self.wrench[0], measured)]
        self.steps = []
        for t in range(1, frames):
            self.steps.append(self.filter.step(states[-1], self.markers[t], self.wrench[t], measured))
            states.append(self.steps[-1].state)
        self.states = states

    def error(self, name, skip=15):
        true = getattr(self.truth, name)[: len(self.states)]
        return np.array([getattr(state, name) for state in self.states])[skip:] - true[skip:]

    def angle_rms(self, skip=15):
        pairs = zip(self.truth.q[skip : len(self.states)], self.states[skip:], strict=True)
        return rms([self.model.difference(q, state.q)[6:] for q, state in pairs])


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.mark.parametrize("scheme", ["FD", "FDMC"])
@pytest.mark.parametrize("name", ["squat", "walk"])
def test_follows_a_motion_and_its_forces(model, motions, name, scheme):
    run = Run(model, motions[name], preset(scheme))
    assert all(step.tracked for step in run.steps)
    assert run.angle_rms() < np.deg2rad(1.5)
    dynamic = ~run.filter.body.kinematic
    assert rms(run.error("tau")[:, dynamic][:, 6:]) < 8.0
    assert rms(run.error("tau")[:, :3]) < 5.0
    assert rms(run.error("foot_wrench")[:, :, :3]) < 5.0


def test_state_obeys_newton(model, motions):
    """Inverse dynamics of the state's motion under its own wrenches gives its torques back."""
    run = Run(model, motions["walk"], TorqueSettings(), frames=10)
    state, body = run.states[-1], run.filter.body
    u = body.forces(state.q, state.v, state.a, state.foot_wrench)
    assert_near(u, state.filtered.u, 1e-6)
    assert_near(body.joint_forces(state.q, state.v, u).torque, state.tau[body.torque_dofs], 1e-6)


def test_start_agrees_with_plates_and_motion(model, motions):
    """A poor acceleration estimate is corrected until nearly no residual is left, its uncertainty is stated."""
    motion, settings = motions["squat"], TorqueSettings()
    run = Run(model, motion, settings, frames=1)
    P = np.diag(np.repeat([0.003, 0.1], model.nv) ** 2)
    guess = motion.a[0] + np.random.default_rng(0).normal(size=model.nv)
    state = run.filter.start(KinematicState(motion.q[0], motion.v[0], P), guess, motion.foot_wrench[0], BOTH)
    assert np.abs(state.tau[:3]).max() < 5.0
    n = len(state.filtered.P)
    assert n == 166
    assert np.linalg.eigvalsh(state.filtered.P).min() > -1e-9 * state.filtered.P.max()
    assert (state.tau_sd[:3] <= settings.residual_spread_force_n * model.mass_kg / 100 * 1.001).all()


def test_a_foot_in_the_air_carries_nothing(model, motions):
    run = Run(model, motions["walk"], TorqueSettings())
    air = (run.truth.foot_wrench[:FRAMES] == 0).all(axis=2)
    assert air.any()
    found = np.array([state.foot_wrench for state in run.states])
    late = np.arange(FRAMES) > 15
    assert np.abs(found[air & late[:, None]][:, :3]).max() < 2.0


def test_a_hidden_leg_is_carried_by_dynamics(model, motions):
    """A lost marker's rows vanish; the state stays near and recovers."""
    legs = ("right_shank", "right_foot", "right_toes")
    run = Run(model, motions["squat"], TorqueSettings(), hide=(legs, 40, 55))
    assert run.angle_rms() < np.deg2rad(4.0)
    assert run.steps[44].readings < run.steps[20].readings
    last = model.difference(run.truth.q[FRAMES - 1], run.states[-1].q)
    assert rms(last[6:]) < np.deg2rad(2.0)


def test_an_unmeasured_foot_is_inferred(model, motions):
    """Newton's law and the other plate tell what stands on the missing one."""
    run = Run(model, motions["squat"], TorqueSettings(), measured=np.array([True, False]))
    vertical = run.error("foot_wrench")[:, 1, 2]
    assert rms(vertical) < 60.0
    sd = np.array([state.foot_wrench_sd[1, 2] for state in run.states[15:]])
    known = np.array([state.foot_wrench_sd[0, 2] for state in run.states[15:]])
    assert (sd > 3.0 * known).all()
    assert rms(vertical) < 3.0 * rms(sd)


def test_a_frame_without_readings_is_the_prediction(model, motions):
    """Only the weak pulls and the residual's law remain."""
    settings = TorqueSettings()
    loose = replace(settings.tracking, posture_scale=1e9, velocity_sd=1e9)
    settings = replace(settings, tracking=loose, residual_spread_force_n=1e9, residual_spread_moment_nm=1e9)
    run = Run(model, motions["squat"], settings, frames=5)
    nothing = np.full_like(run.markers[0], np.nan)
    step = run.filter.step(run.states[-1], nothing, run.wrench[4], ~BOTH)
    assert not step.tracked
    assert step.readings == 0
    assert_near(step.state.q, step.prediction.state.q, 1e-6)
    assert_near(step.state.filtered.u, step.prediction.state.u, 1e-3)


def test_a_step_gives_a_smoother_what_it_needs(model, motions):
    """Prior covariance = Φ P Φᵀ + Q with the posterior before, and a step is a pure function."""
    run = Run(model, motions["squat"], TorqueSettings(), frames=5)
    before, again = run.states[-2], run.filter.step(run.states[-2], run.markers[4], run.wrench[4], BOTH)
    np.testing.assert_array_equal(again.state.filtered.P, run.states[-1].filtered.P)
    np.testing.assert_array_equal(again.state.q, run.states[-1].q)
    phi, prior = again.prediction.phi, again.prediction.state
    Q = prior.P - phi @ before.filtered.P @ phi.T
    assert np.linalg.eigvalsh(0.5 * (Q + Q.T)).min() > -1e-7 * np.abs(Q).max()
    np.testing.assert_array_equal(prior.u, before.filtered.u)


def test_what_cannot_be_computed_is_untracked(model, motions):
    run = Run(model, motions["squat"], TorqueSettings(), frames=3)
    broken = replace(run.states[-1].filtered, P=-1e3 * np.eye(166))
    step = run.filter.step(replace(run.states[-1], filtered=broken), run.markers[2], run.wrench[2], BOTH)
    assert not step.tracked
    assert step.state.q is run.states[-1].q


def test_a_zero_wrench_means_the_air_unless_told():
    wrench = np.array([[0.0] * 6, [1.0] * 6])
    told = FootReading.of(wrench, BOTH)
    assert told.airborne.tolist() == [True, False]
    assert FootReading.of(wrench, ~BOTH).airborne.tolist() == [False, False]
    landed = FootReading.of(wrench, BOTH, np.array([False, True]))
    assert landed.airborne.tolist() == [False, True]
    assert not landed.wrench.any()
