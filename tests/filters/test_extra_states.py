"""States that a block brings: where they lie, how they start and drift, that they converge and are smoothed.

The block is that of tests/blocks: a tracker on the hand whose origin drifts.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from benchmarks.dynamic.nis import nis
from mbkf.errors import InvalidInput
from mbkf.filters.dynamic.filter import DynamicFilter, dynamic_blocks
from mbkf.filters.dynamic.report import DynamicReport
from mbkf.filters.dynamic.smoother import smooth
from mbkf.filters.estimate import Recording
from mbkf.filters.filter import Filter
from mbkf.filters.fixed_lag import SmoothingSettings
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.kinematic.warm_start import WarmStart
from mbkf.filters.tracking import track
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.model.layout import ExtraState
from mbkf.sensors.block import Block, Frame, Rows
from mbkf.sensors.marker_sensor import MarkerSensor
from tests.blocks.drifting_tracker import BIAS, READING, DriftingTracker, TrackerSettings
from tests.dynamics import DT, MARKER_SD_M, camera_markers, settings_with, trial
from tests.motions import assert_near, worst
from tests.straight import StraightPlant

OFFSET_M = np.array([0.12, -0.07, 0.2])
FRAMES = range(40, 100)
TRACKER = TrackerSettings(bias_walk_m=0.002)


@cache
def kalman():
    """The dynamic filter of the squat with a tracker on the hand."""
    made = trial("squat")
    plain = made.kalman()
    detector, everywhere = made.detector(), np.zeros(made.model.nv, dtype=bool)
    settings = settings_with()
    blocks = dynamic_blocks(plain.sensor, plain.noise_m, detector, DT, everywhere, settings)
    blocks.append(DriftingTracker(made.model, TRACKER))
    return DynamicFilter(plain.sensor, plain.noise_m, DT, everywhere, settings, blocks)


def hand_m(q):
    return MarkerSensor(trial("squat").model, ["right_hand"], np.zeros((1, 3))).positions(q)[0]


@cache
def read(gap=range(0)):
    """What cameras, plates and the tracker read; in the gap the tracker reads nothing."""
    m, rng = trial("squat").motion, np.random.default_rng(4)
    markers = camera_markers(kalman(), m.q[FRAMES.start : FRAMES.stop], rng)
    tracker = np.array([hand_m(m.q[t]) for t in FRAMES]) + OFFSET_M
    tracker += TRACKER.tracker_sd_m * rng.normal(size=tracker.shape)
    tracker[list(gap)] = np.nan
    plates = m.foot_wrench[FRAMES.start : FRAMES.stop] + rng.normal(size=(len(FRAMES), 2, 6))
    return Recording(markers, plates, DT, readings={READING: tracker})


@cache
def run(gap=range(0)):
    """Steps of the filter from a first estimate on."""
    m, nv = trial("squat").motion, trial("squat").model.nv
    P = np.diag(np.concatenate([np.full(nv, 0.02), np.full(nv, 1.0)]) ** 2)
    start = FRAMES.start
    steps = [kalman().first(m.q[start], m.v[start], m.a[start], P, read(gap).frame(0))]
    for t in range(1, len(FRAMES)):
        steps.append(kalman().step(steps[-1].state, steps[-1].memory, read(gap).frame(t)))
    return steps


def bias_of(state):
    return state.extra[kalman().layout.extra_index(BIAS)]


def bias_sd(state):
    return np.sqrt(np.diag(state.P)[kalman().layout[BIAS]])


def test_the_added_state_is_the_last_slice():
    layout, plain = kalman().layout, trial("squat").kalman().layout
    assert layout[BIAS] == slice(plain.size, plain.size + 3)
    assert layout.size == plain.size + 3 == len(run()[0].state.P)
    assert {name: layout[name] for name in plain.slices} == plain.slices


def test_it_starts_as_stated():
    """Before the first reading: at its mean, with its standard deviation, and independent of all else."""
    m, nv = trial("squat").motion, trial("squat").model.nv
    P = np.diag(np.concatenate([np.full(nv, 0.02), np.full(nv, 1.0)]) ** 2)
    frame = read().frame(0)._replace(readings={})
    first = kalman().first(m.q[FRAMES.start], m.v[FRAMES.start], m.a[FRAMES.start], P, frame).state
    np.testing.assert_array_equal(bias_of(first), 0.0)
    np.testing.assert_allclose(bias_sd(first), TRACKER.bias_sd_m, rtol=1e-12)
    own = kalman().layout[BIAS]
    assert not first.P[own, : own.start].any()


def test_it_wanders_as_stated_and_nothing_else_does():
    plant, state = kalman().plant, run()[10].state
    plain = trial("squat").kalman().plant
    own = kalman().layout[BIAS]
    found = plant.predict(state)
    np.testing.assert_array_equal(found.extra, state.extra)
    grown = found.P[own, own] - state.P[own, own]
    assert_near(grown, TRACKER.bias_walk_m**2 * DT * np.eye(3), 1e-15)
    alone = replace(state, P=np.asfortranarray(state.P[: own.start, : own.start]), extra=np.zeros(0))
    assert_near(found.P[: own.start, : own.start], plain.predict(alone).P, 1e-9 * worst(found.P))
    phi = plant.transition(state)
    carried = phi @ state.P @ phi.T
    sd = np.sqrt(np.diag(found.P))
    off = (found.P - carried)[own, : own.start] / sd[own, None] / sd[: own.start]
    assert worst(off) < 1e-12


def test_it_converges_to_the_truth_with_the_spread_it_states():
    last = run()[-1].state
    assert worst(bias_of(last) - OFFSET_M) < 0.01
    assert worst((bias_of(last) - OFFSET_M) / bias_sd(last)) < 4.0
    assert (bias_sd(last) < 0.05 * TRACKER.bias_sd_m).all()


def test_readings_of_ones_own_are_counted():
    with_tracker, without = run()[5], run(range(5, 6))[5]
    (squared, readings), (_, fewer) = nis(with_tracker), nis(without)
    assert readings == fewer + 3
    assert 0.0 < squared < 4.0 * readings


def test_while_the_instrument_is_silent_the_state_only_wanders():
    gap = range(20, 40)
    steps = run(gap)
    before, after = (bias_sd(steps[t].state) ** 2 for t in (19, 39))
    assert (after < before + 20 * TRACKER.bias_walk_m**2 * DT + 1e-12).all()
    assert (after > before).all()


def test_the_smoother_corrects_it_too():
    """Later readings say what the bias was at the beginning."""
    steps = run()
    states = list(smooth(kalman(), steps, rounds=2))
    early = 2
    assert worst(bias_of(states[early]) - OFFSET_M) < 0.01
    assert worst((bias_of(states[early]) - OFFSET_M) / bias_sd(states[early])) < 4.0
    assert (bias_sd(states[early]) < 0.7 * bias_sd(steps[early].state)).all()
    for state, step in zip(states, steps, strict=True):
        assert (bias_sd(state) <= 1.01 * bias_sd(step.state)).all()  # linearised anew
    last = kalman().plant.difference(steps[-1].state, states[-1])
    assert worst(last / np.sqrt(np.diag(steps[-1].state.P))) < 0.3


@pytest.mark.parametrize("smoothing", [False, True])
def test_a_trial_is_tracked_with_it(smoothing):
    plain, made = kalman(), trial("squat")
    noise = np.full(len(plain.noise_m), MARKER_SD_M)
    starter = KinematicFilter(plain.sensor, noise, DT, plain.unobservable, KinematicSettings())
    chosen = SmoothingSettings(window_s=10.0) if smoothing else None
    found = track(TrackingFilter(DynamicReport(plain), WarmStart(starter)), read(), smoothing=chosen)
    assert found.tracked.all() and np.isfinite(found.torque_sd).all()
    off = [made.model.difference(made.motion.q[t], q) for t, q in zip(FRAMES, found.q, strict=True)]
    assert np.sqrt(np.mean(np.square(off)[10:, 6:])) < 0.05


class Biased(Block):
    """z = q₀ + b + r in a linear world."""

    def states(self):
        return [ExtraState("b", np.array([0.3]), np.array([2.0]), np.array([0.7]))]

    def bind(self, layout, body):
        self._row = np.zeros((1, layout.size))
        self._row[0, 0], self._row[0, layout["b"]] = 1.0, 1.0

    def decide(self, at, frame, memory, notes):
        return frame.readings["z"]

    def linearise(self, at, decision):
        said = at.state.q[0] + at.state.extra[0]
        return Rows(self._row / 0.5, np.array([decision - said]) / 0.5, readings=1)


def test_in_a_linear_world_it_is_the_textbook_filter():
    """Two numbers and a bias, all read by hand as well."""
    block = Biased()
    plant = StraightPlant(2, sd=0.1, blocks=[block])
    linear, state, rng = Filter(plant, [block]), plant.start(), np.random.default_rng(5)
    x, P = np.array([0.0, 0.0, 0.3]), np.diag([1.0, 1.0, 4.0])
    Q, H, memory = np.diag([0.01, 0.01, 0.7**2 * 0.01]), np.array([[1.0, 0.0, 1.0]]), linear.begin()
    for z in rng.normal(size=20):
        step = linear.step(state, memory, Frame(np.zeros((0, 3)), np.zeros((0, 6)), readings={"z": z}))
        state, memory = step.state, step.memory
        P = P + Q
        S = H @ P @ H.T + 0.25
        K = P @ H.T / S
        y = z - H @ x
        x, P = x + K @ y, P - K @ H @ P
        assert_near(np.concatenate([state.q, state.extra]), x, 1e-12)
        assert_near(state.P, P, 1e-12)
        assert nis(step)[0] == pytest.approx(float((y @ y / S).item()), rel=1e-10)


def test_two_blocks_may_not_bring_the_same_state():
    with pytest.raises(InvalidInput, match="'b'"):
        StraightPlant(2, blocks=[Biased(), Biased()])
