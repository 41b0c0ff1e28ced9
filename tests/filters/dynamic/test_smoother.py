"""Smoothing the dynamic filter: the exact smoother around a trajectory, and what it makes of true motions."""

from functools import cache

import numpy as np
import pinocchio as pin
import pytest

from mbkf.filters.dynamic.smoother import WindowMemory, smooth
from mbkf.numerics.smoothing import BackwardPass
from tests.dynamics import DT, follow, trial
from tests.motions import angle_errors, assert_near, worst

pytestmark = pytest.mark.slow

ROUNDS = 4
MOTIONS = {"squat": range(40, 100), "walk": range(60, 120)}
each_motion = pytest.mark.parametrize("name", MOTIONS)


@cache
def run_of(name):
    return follow(trial(name), MOTIONS[name])


@cache
def smoothed(name, rounds=ROUNDS):
    run = run_of(name)
    return list(smooth(run.kalman, run.steps, rounds))


def residual_n(run, states):
    """RMS force by which states break Newton's law with the residual that they state."""
    root = run.kalman.balance.root
    found = [(root(s.q, s.v, s.a, s.w).residual + s.extra)[:3] for s in states]
    return float(np.sqrt(np.mean(np.square(found))))


def errors(run, states):
    """RMS errors of angles, velocities and torques of the joints, without the ends of the stretch."""
    m, inside = run.trial.motion, slice(10, -5)
    frames = slice(run.frames.start, run.frames.stop)
    angle = angle_errors(run.trial.model, [s.q for s in states], m.q[frames])
    tau = np.array([run.kalman.balance.tau(s.q, s.v, s.a, s.w) for s in states]) - m.tau[frames]
    v = np.array([s.v for s in states]) - m.v[frames]
    return np.array([np.sqrt(np.mean(part[inside, 6:] ** 2)) for part in (angle, v, tau)])


@each_motion
def test_rounds_restore_newtons_law(name):
    """One linear smoother breaks it where the trajectory moved; each further round halves that at least."""
    run = run_of(name)
    residuals = [residual_n(run, smoothed(name, rounds)) for rounds in range(1, ROUNDS + 1)]
    assert residuals[-1] < 0.3 * residuals[0]
    assert residuals[-1] < 2.5
    assert residuals[-1] < residual_n(run, run.states)


@each_motion
def test_velocities_are_the_trapezoids_of_accelerations(name):
    """Positions, velocities and accelerations are one trajectory, to the rounding of the smoother."""
    states = smoothed(name)
    v, a = np.array([s.v for s in states]), np.array([s.a for s in states])
    apart = np.diff(v, axis=0) - 0.5 * DT * (a[1:] + a[:-1])
    assert worst(apart) < 1e-6 * worst(DT * a)


@each_motion
def test_stated_powers_are_the_change_of_stated_energy(name):
    """Of generalised forces, gravity's apart, by the stated a, and of kinetic and potential energy at q and v."""
    run, model = run_of(name), trial(name).model
    data, nothing = model.pin_model.createData(), np.zeros(12)
    states = smoothed(name)
    energy = np.array([pin.computeMechanicalEnergy(model.pin_model, data, s.q, s.v) for s in states])
    power = np.array([run.kalman.balance.tau(s.q, s.v, s.a, nothing) @ s.v for s in states])
    misfit_w_kg = (np.diff(energy) / DT - 0.5 * (power[1:] + power[:-1])) / model.mass_kg
    assert np.sqrt(np.mean(misfit_w_kg**2)) < 0.1


@each_motion
def test_rounds_converge(name):
    """Gauss–Newton: the last round changes little."""
    run = run_of(name)
    before, after = smoothed(name, ROUNDS - 1), smoothed(name, ROUNDS)
    sd = [np.sqrt(np.diag(s.P)) for s in after]
    change = [run.kalman.plant.difference(a, b) for a, b in zip(before, after, strict=True)]
    assert worst(np.array(change) / np.array(sd)) < 0.3


@each_motion
def test_smoothing_beats_the_filter(name):
    run = run_of(name)
    gain = errors(run, smoothed(name)) / errors(run, run.states)
    assert (gain < [0.95, 0.7, 0.9]).all(), gain


@each_motion
def test_the_first_round_is_a_linear_pass_about_the_filters_own_course(name):
    """By the textbook's matrices; the last frame, after which nothing comes, is the filter's."""
    run, plant = run_of(name), run_of(name).kalman.plant
    back = BackwardPass(run.kalman.layout.size)
    frames = zip([None, *run.steps[:-1]], run.steps, smoothed(name, 1), strict=True)
    for before, step, found in list(frames)[:-16:-1]:  # rounding grows backwards
        P = step.state.P
        sd = np.sqrt(np.diag(P))
        change, covariance = back.corrected(P)
        assert_near(plant.difference(step.state, found) / sd, change / sd, 1e-6)
        assert_near(found.P / sd[:, None] / sd, covariance / sd[:, None] / sd, 1e-6)
        if before is not None:
            back.through_readings(P, step.readings.whole_matrix, step.readings.whole_vector)
            back.through_plant(plant.transition(before.state))


@each_motion
def test_stretches_that_look_ahead_are_nearly_the_whole(name):
    """The first half, smoothed with 20 more frames in sight (half of what is usual), against smoothing all."""
    run, half = run_of(name), 30
    part = list(smooth(run.kalman, run.steps[: half + 20], ROUNDS, wanted=half))
    assert len(part) == half
    for t, (found, whole) in enumerate(zip(part, smoothed(name), strict=False)):
        sd, share = np.sqrt(np.diag(whole.P)), 0.25 if t < half // 2 else 1.0
        assert worst(run.kalman.plant.difference(whole, found) / sd) < 0.3 * share
        assert worst((found.P - whole.P) / sd[:, None] / sd) < 0.2 * share


@each_motion
def test_a_window_goes_on_from_the_one_before(name):
    """Its linearisation does not begin anew: it is the whole run's, but for readings beyond the first window."""
    run, half, memory = run_of(name), 30, WindowMemory()
    list(smooth(run.kalman, run.steps[: half + 20], 2, half, memory))
    second = smooth(run.kalman, run.steps[half - 1 :], 2, memory=memory)
    for found, whole in zip(second, smoothed(name, 2)[half - 1 :], strict=True):
        assert worst(run.kalman.plant.difference(whole, found) / np.sqrt(np.diag(whole.P))) < 0.01


def test_looking_ahead_is_what_makes_a_stretch_good():
    run, half = run_of("squat"), 30
    off = []
    for ahead in (0, 5, 20):
        part = smooth(run.kalman, run.steps[: half + ahead], 2, wanted=half)
        pairs = zip(part, smoothed("squat", 2), strict=False)
        sd_and_change = [(np.sqrt(np.diag(w.P)), run.kalman.plant.difference(w, found)) for found, w in pairs]
        off.append(max(worst(change / sd) for sd, change in sd_and_change))
    assert off[2] < 0.3 * off[1] < 0.3 * off[0]


@each_motion
def test_covariances_are_symmetric_positive_and_not_larger(name):
    run = run_of(name)
    for own, state in zip(run.states, smoothed(name), strict=True):
        sd = np.sqrt(np.diag(own.P))
        np.testing.assert_array_equal(state.P, state.P.T)
        assert np.linalg.eigvalsh(state.P / sd[:, None] / sd).min() > -1e-9
    gained = [
        np.diag(state.P) / np.diag(own.P) for own, state in zip(run.states, smoothed(name), strict=True)
    ]
    assert np.median(gained[5:-5]) < 0.7


def test_a_single_frame_is_what_it_was():
    run = run_of("squat")
    (found,) = smooth(run.kalman, run.steps[:1], 3)
    assert_near(run.kalman.plant.difference(run.states[0], found), 0.0, 1e-12)
    assert_near(found.P, run.states[0].P, 1e-9 * worst(run.states[0].P))
