"""The torque-state filter on synthetic motions: it follows, obeys Newton, and bears losses."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.dynamic.nis import nis
from mbkf.errors import InvalidInput
from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.torque.filter import TorqueFilter
from mbkf.filters.torque.report import TorqueState
from mbkf.filters.torque.settings import TorqueSettings, preset
from mbkf.sensors.block import Frame
from mbkf.sensors.contact.records import Contact, ContactDecision, ContactMemory
from mbkf.synthesis.person import body_of, synthesise_subject
from tests.motions import assert_near, marker_positions, protocol_sensor
from tests.recordings import performer

pytestmark = pytest.mark.slow

RATE_HZ, NOISE_M, FRAMES = 100.0, 0.005, 90
BOTH = np.ones(2, dtype=bool)


@pytest.fixture(scope="module")
def model():
    return body_of(synthesise_subject(5))


@pytest.fixture(scope="module")
def motions():
    return {name: performer(name, 1.5, 5)[2] for name in ("squat", "walk")}


class Told:
    """A detector that is told each foot's wrench: a measured foot that carries nothing is in the air."""

    def __init__(self, measured):
        self.measured, self.decided = measured, 0

    def begin(self):
        return ContactMemory((), (), float("nan"), (0.0, 0.0))

    def decide(self, memory, q, v, a, wrench):
        self.decided += 1
        loaded = (wrench != 0.0).any(axis=1)
        kinds = [
            Contact.UNMEASURED if not known else Contact.MEASURED if on else Contact.AIR
            for known, on in zip(self.measured, loaded, strict=True)
        ]
        return ContactDecision(tuple(kinds), wrench, np.zeros((2, 3)), False, memory)


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
        everywhere = np.zeros(model.nv, dtype=bool)
        self.told = Told(measured)
        self.filter = TorqueFilter.standard(sensor, noise, self.told, 1 / RATE_HZ, everywhere, settings)
        loaded = (motion.foot_wrench[:frames] != 0).any(axis=2, keepdims=True)
        spread = np.array([1.0, 1.0, 1.0, 0.2, 0.2, 0.2])
        self.wrench = motion.foot_wrench[:frames] + loaded * spread * rng.normal(size=(frames, 2, 6))
        P = np.diag(np.repeat([0.01, 0.5], model.nv) ** 2)
        start = KinematicState(motion.q[0], motion.v[0], P)
        first = self.filter.first(start, motion.a[0], self.frame(0))
        state, memory, self.steps, self.memories = first.state, first.memory, [], [first.memory]
        self.states = [self.read(state)]
        for t in range(1, frames):
            self.steps.append(self.filter.step(state, memory, self.frame(t)))
            state, memory = self.steps[-1].state, self.steps[-1].memory
            self.states.append(self.read(state))
            self.memories.append(memory)

    def read(self, state):
        return TorqueState.of(self.filter.body, self.filter.plates.sensor, state)

    def frame(self, t):
        return Frame(self.markers[t], self.wrench[t])

    def error(self, name, skip=15):
        true = getattr(self.truth, name)[: len(self.states)]
        return np.array([getattr(state, name) for state in self.states])[skip:] - true[skip:]

    def angle_rms(self, skip=15):
        pairs = zip(self.truth.q[skip : len(self.states)], self.states[skip:], strict=True)
        return rms([self.model.difference(q, state.q)[6:] for q, state in pairs])


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.mark.parametrize(("name", "scheme"), [("walk", "FD"), ("squat", "FDMC")])
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
    assert_near(u, run.steps[-1].state.u, 1e-6)
    assert_near(body.joint_forces(state.q, state.v, u).torque, state.tau[body.torque_dofs], 1e-6)


def test_start_agrees_with_plates_and_motion(model, motions):
    """A poor acceleration estimate is corrected until nearly no residual is left, its uncertainty is stated."""
    motion, settings = motions["squat"], TorqueSettings()
    run = Run(model, motion, settings, frames=1)
    P = np.diag(np.repeat([0.003, 0.1], model.nv) ** 2)
    guess = motion.a[0] + np.random.default_rng(0).normal(size=model.nv)
    frame = Frame(run.markers[0], motion.foot_wrench[0])
    first = run.filter.first(KinematicState(motion.q[0], motion.v[0], P), guess, frame)
    state = run.read(first.state)
    assert np.abs(state.tau[:3]).max() < 5.0
    n = len(first.state.P)
    assert n == 166
    assert np.linalg.eigvalsh(first.state.P).min() > -1e-9 * first.state.P.max()
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
    assert nis(run.steps[44])[1] < nis(run.steps[20])[1]
    last = model.difference(run.truth.q[FRAMES - 1], run.states[-1].q)
    assert rms(last[6:]) < np.deg2rad(2.0)


@pytest.mark.parametrize(("name", "scheme"), [("walk", "FDMC"), ("squat", "FD")])
def test_plates_as_inputs_are_followed_without_wrench_states(model, motions, name, scheme):
    run = Run(model, motions[name], replace(preset(scheme), plates="inputs"))
    assert len(run.steps[-1].state.P) == 154
    assert run.angle_rms() < np.deg2rad(1.5)
    dynamic = ~run.filter.body.kinematic
    assert rms(run.error("tau")[:, dynamic][:, 6:]) < 8.0
    found = np.array([state.foot_wrench for state in run.states])
    assert_near(found, run.wrench, 1e-9)
    assert not any(state.foot_wrench_sd.any() for state in run.states)
    assert all(np.isfinite(state.tau_sd[run.filter.body.torque_dofs]).all() for state in run.states)


def test_contact_is_decided_once_a_frame_with_plates_as_inputs(model, motions):
    run = Run(model, motions["squat"], replace(preset("FDMC"), plates="inputs"), frames=4)
    assert run.told.decided == 4


@pytest.mark.parametrize("literal", [False, True])
def test_a_start_leaves_an_unknown_input_to_the_residual(model, motions, literal):
    settings = replace(preset("FDMC", literal=literal), plates="inputs")
    run = Run(model, motions["squat"], settings, frames=1, measured=np.array([True, False]))
    (state,), dynamic = run.states, ~run.filter.body.kinematic
    assert_near(state.a[dynamic], motions["squat"].a[0, dynamic], 1e-6)
    pelvis = model.placements(state.q)[0][model.joint("pelvis").joint_id]
    assert_near(pelvis @ state.tau[:3], run.wrench[0, 1, :3], 5.0)


def test_an_input_that_no_plate_reads_is_left_to_the_residual(model, motions):
    settings = replace(preset("FDMC"), plates="inputs")
    run = Run(model, motions["squat"], settings, frames=60, measured=np.array([True, False]))
    pelvis = model.joint("pelvis").joint_id
    residual = [model.placements(state.q)[0][pelvis] @ state.tau[:3] for state in run.states[15:]]
    assert_near(np.mean(residual, axis=0), run.wrench[15:, 1, :3].mean(axis=0), 25.0)
    assert run.angle_rms() < np.deg2rad(2.0)
    assert all(np.isnan(state.tau_sd).all() for state in run.states)
    assert all(np.isnan(state.foot_wrench_sd[1]).all() for state in run.states)
    assert not any(state.foot_wrench[1].any() for state in run.states)


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
    run.told.measured = ~BOTH
    step = run.filter.step(run.steps[-1].state, run.memories[-1], Frame(nothing, run.wrench[4]))
    assert not step.tracked
    assert nis(step)[1] == 0
    assert_near(step.state.q, step.prior.state.q, 1e-6)
    assert_near(step.state.u, step.prior.state.u, 1e-3)


def test_a_step_gives_a_smoother_what_it_needs(model, motions):
    """Prior covariance = Φ P Φᵀ + Q with the posterior before, and a step is a pure function."""
    run = Run(model, motions["squat"], TorqueSettings(), frames=5)
    before = run.steps[-2].state
    again = run.filter.step(before, run.memories[-2], run.frame(4))
    np.testing.assert_array_equal(again.state.P, run.steps[-1].state.P)
    np.testing.assert_array_equal(again.state.q, run.states[-1].q)
    prior = again.prior.state
    Q = prior.P - prior.phi @ before.P @ prior.phi.T
    assert np.linalg.eigvalsh(0.5 * (Q + Q.T)).min() > -1e-7 * np.abs(Q).max()
    np.testing.assert_array_equal(prior.u, before.u)


def test_contact_is_decided_where_the_state_before_leads(model, motions):
    """Not at the prediction by forces; it goes on where nothing else can be computed."""
    run = Run(model, motions["squat"], TorqueSettings(), frames=3)
    asked = []
    told = run.told.decide

    def decide(memory, q, v, a, wrench):
        asked.append((q, v, a))
        return told(memory, q, v, a, wrench)

    run.told.decide = decide
    last, state = run.states[-1], run.steps[-1].state
    run.filter.step(state, run.memories[-1], run.frame(2))
    stayed = run.filter.stayed(state, run.memories[-1], run.frame(2))
    for q, v, a in asked:
        np.testing.assert_allclose(q, model.integrate(last.q, last.v / RATE_HZ), rtol=1e-12, atol=1e-15)
        np.testing.assert_allclose(v, last.v + last.a / RATE_HZ, rtol=1e-12, atol=1e-15)
        np.testing.assert_array_equal(a, last.a)
    assert len(asked) == 2
    assert stayed.state is state
    assert stayed.contact.contacts == (Contact.MEASURED, Contact.MEASURED)


def test_a_state_that_is_no_covariance_is_refused(model, motions):
    run = Run(model, motions["squat"], TorqueSettings(), frames=3)
    broken = replace(run.steps[-1].state, P=-1e3 * np.eye(166))
    with pytest.raises(np.linalg.LinAlgError):
        run.filter.step(broken, run.memories[-1], run.frame(2))


def test_plates_are_a_block_that_the_filter_cannot_do_without(model, motions):
    made = Run(model, motions["squat"], TorqueSettings(), frames=1).filter
    for blocks in (made.blocks[:1], [*made.blocks, made.plates]):
        with pytest.raises(InvalidInput, match="one block FootPlates"):
            TorqueFilter(made.sensor, made.noise_m, 1 / RATE_HZ, made.body, made.settings, blocks)
