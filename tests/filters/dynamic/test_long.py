"""Covariances stay symmetric and positive over many steps, and through frames that come and go.

These steps run through the same prediction and update on one dof: a step of the whole body takes 0.4 ms and
more, so that the suite follows that through some hundred frames only. (Followed once for 100 000, by hand: the smallest
eigenvalue of the correlations was 5e-7, early on, and fell no further.)
"""

import numpy as np
import pytest

from mbkf.filters.dynamic.plant import DynamicState, SingerSettings
from mbkf.kernel.covariance import informed_with_rows
from mbkf.kernel.loading import COMPILED
from mbkf.model.body import SegmentJoint
from mbkf.sensors.block import Frame
from tests.dynamics import follow, singer, trial

pytestmark = pytest.mark.slow

STEPS, REFERENCE_STEPS = 30_000, 6_000
"""Of the compiled kernel, with which everybody computes, and of the reference, which is slower."""
SIZE = 15


class Slider:
    """A mass on a rail: as much of a body as the plant asks for."""

    nv = 1
    joints = {"mass": SegmentJoint("mass", "slider", "x", 1, slice(0, 1), slice(0, 1))}  # noqa: RUF012
    movement_sd = np.array([300.0])
    tree = None

    def integrate(self, q, dv):
        return q + dv

    def integration_derivatives(self, q, dv):
        return np.eye(1), np.eye(1)


def worst_eigenvalue(P):
    """Smallest eigenvalue of the correlations: rounding is judged by each component's own size."""
    sd = np.sqrt(np.diag(P))
    return np.linalg.eigvalsh(P / sd[:, None] / sd).min()


def hostile_rows(rng):
    """A Newton–Euler row that ties acceleration to all wrenches, and wrenches read well, badly or not at all."""
    rows = np.zeros((13, SIZE))
    rows[0, 2], rows[0, 3:] = 80.0, -rng.uniform(0.1, 1.0, 12)
    rows[0] *= 10 ** rng.uniform(-1, 3)
    seen = np.flatnonzero(rng.random(12) < 0.5)
    rows[1 + seen, 3 + seen] = 10 ** rng.uniform(-3, 2, len(seen))
    return rows


def followed_slider(steps):
    """Covariances after each step; the kinds of frames are drawn beforehand from 256 of each."""
    rng = np.random.default_rng(7)
    rows = [hostile_rows(rng) for _ in range(256)]
    markers = [np.array([[10.0 ** rng.uniform(-2, 10)]]) for _ in range(256)]
    wander = np.repeat([3000.0, 300.0, 3000.0, 300.0], 3) ** 2 * 0.01
    plant = singer(Slider(), [], settings=SingerSettings(decay_s=0.05))
    kinds, blind = rng.integers(0, 256, steps), 0
    state = DynamicState(
        np.zeros(1), np.zeros(1), np.zeros(1), np.zeros(12), np.diag([1e4, 1e-8, 1e6] + [1e6] * 12)
    )
    every = np.arange(3, SIZE)
    for k in kinds:
        P = plant.predict(state).P
        P[every, every] += wander
        blind = blind - 1 if blind else 500 * (k == 17 and rng.random() < 0.2)
        if not blind:
            P = informed_with_rows(P, markers[k], rows[k])
        state = DynamicState(state.q, state.v, state.a, state.w, P)
        yield P


def test_covariances_survive_many_steps(either_kernel):
    """Readings over twelve decades, wrenches tied together, and long stretches without any reading."""
    lowest, steps = 1.0, STEPS if either_kernel == COMPILED else REFERENCE_STEPS
    for t, P in enumerate(followed_slider(steps)):
        if t % 50 == 0:
            np.testing.assert_array_equal(P, P.T)
            lowest = min(lowest, worst_eigenvalue(P))
    assert t == steps - 1
    assert lowest > -1e-12


@pytest.mark.parametrize("plates", [1, 2])
def test_the_whole_filter_survives_markers_that_flicker(plates):
    """Each marker comes and goes, all of them go now and then, a squat there and back again."""
    made, rng = trial("squat"), np.random.default_rng(8)
    run = follow(made, range(1, 3), made.plates[:plates])
    kalman, m = run.kalman, made.motion
    state, memory = run.steps[-1].state, run.steps[-1].memory
    hidden = np.zeros(len(run.markers_m[0]), dtype=bool)
    there_and_back = np.concatenate([np.arange(3, len(m.q)), np.arange(len(m.q) - 2, 3, -1)])
    for n, t in enumerate(there_and_back):
        markers = kalman.sensor.positions(m.q[t]) + 0.002 * rng.normal(size=(len(hidden), 3))
        hidden ^= rng.random(len(hidden)) < 0.1
        markers[hidden | (n % 100 > 95)] = np.nan
        step = kalman.step(state, memory, Frame(markers, m.foot_wrench[t, :plates]))
        state, memory = step.state, step.memory
        if n % 10 == 0:
            np.testing.assert_array_equal(state.P, state.P.T)
            assert worst_eigenvalue(state.P) > 0
    assert n > 350
