"""Does the dynamic filter err as much as it says? On motions made by its own plant, filter and smoother.

Matched exactly: start, Singer accelerations, white markers, plates and residual, all with the noise the filter
believes. Truth obeys Newton's law: the residual is drawn, and the two wrenches follow from the motion, shared
between the feet along a sine. A random walk cannot do that, so theirs is made wide enough (10 kN a frame) to be no
information; the 12 innovations of their readings are then 0 by comparison, and NIS counts the others. Posture,
limits and gate are made harmless, and feet are measured always. What remains is the filter's own linearisation.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from scipy.stats import chi2

from mbkf.filters.dynamic import DynamicFilter
from mbkf.filters.dynamic_settings import DynamicSettings
from mbkf.filters.dynamic_smoothing import Frame, smooth
from mbkf.filters.singer import DynamicState
from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.contacts import sole_points
from mbkf.sensors.footing import Footing, FootingMemory, FootLoad
from tests.dynamics import DT, standing
from tests.motions import protocol_sensor, reference_model

MODEL = reference_model()
NV = MODEL.nv
BALANCE = NewtonEuler(MODEL)
MARKER_SD_M, RUNS, FRAMES = 0.001, 20, 60
START_SD = np.repeat([0.01, 0.1], NV)
CENTRES = sole_points(MODEL, standing(MODEL)[None])[0].mean(axis=1)
SETTINGS = DynamicSettings(
    acceleration_scale=0.1,
    activity_gain=0.0,
    innovation_share=0.0,
    posture_scale=1e6,
    limit_sd_rad=1e6,
    gate=1e12,
    gate_radius_m=10.0,
    wrench_force=1e5,
    wrench_moment=1e5,
)
LAW_SD = np.repeat([SETTINGS.residual_force_n, SETTINGS.residual_moment_nm], 3)
PLATE_SD = np.repeat([SETTINGS.plate_force_n, SETTINGS.plate_moment_nm], 3)
QUANTITIES = ("positions", "velocities", "torques")


class AlwaysMeasured:
    """Two feet that stay on their plates whatever the body does."""

    def begin(self):
        return FootingMemory((), (), float("nan"), (0.0, 0.0))

    def decide(self, memory, q, v, a, plate_wrench):
        return FootLoad((Footing.MEASURED,) * 2, plate_wrench, CENTRES, False, memory)


@cache
def kalman():
    sensor = protocol_sensor(MODEL)[0]
    noise, held = np.full(len(sensor.segments), MARKER_SD_M), np.zeros(NV, dtype=bool)
    return DynamicFilter(sensor, noise, AlwaysMeasured(), DT, held, SETTINGS)


def begin():
    """What the filter starts from, before the first frame."""
    sd = np.concatenate([START_SD, kalman().plant.acceleration_sd, np.full(12, 1e4)])
    return DynamicState(standing(MODEL), np.zeros(NV), np.zeros(NV), np.zeros(12), np.diag(sd**2))


def moved(state, rng):
    """The plant's next q, v and a, with its noise."""
    plant = kalman().plant
    noise = np.linalg.cholesky(plant.noise) @ rng.normal(size=(3, NV)) * plant.acceleration_sd
    q = MODEL.integrate(MODEL.integrate(state.q, plant.dt_s * state.v + plant.c2 * state.a), noise[0])
    return q, state.v + plant.c1 * state.a + noise[1], plant.rho * state.a + noise[2]


def loads(q, v, a, share, rng):
    """(12,) wrenches that leave a residual of LAW_SD, the right foot taking a share."""
    root = BALANCE.root(q, v, a, np.zeros(12))
    total = np.linalg.solve(-root.by_wrench, root.residual + LAW_SD * rng.normal(size=6))
    return np.concatenate([share * total, (1.0 - share) * total])


def plate_noise(rng):
    """(2, 6) noise of PLATE_SD about the soles, as wrenches about the world's origin."""
    noise = PLATE_SD * rng.normal(size=(2, 6))
    noise[:, 3:] += np.cross(CENTRES, noise[:, :3])
    return noise


def errors(true, found):
    """Per quantity its error over its standard deviation (n,), and its NEES per dof with the whole covariance."""
    e, P = kalman().difference(found, true), found.P
    joint = BALANCE.torques(found.q, found.v, found.a, found.w)
    T = np.hstack([joint.by_q, joint.by_v, joint.by_a, joint.by_wrench])[6:]
    tau = BALANCE.tau(true.q, true.v, true.a, true.w)[6:] - joint.tau[6:]
    parts = [(e[:NV], P[:NV, :NV]), (e[NV : 2 * NV], P[NV : 2 * NV, NV : 2 * NV]), (tau, T @ P @ T.T)]
    return [(x / np.sqrt(np.diag(C)), x @ np.linalg.solve(C, x) / len(x)) for x, C in parts]


@dataclass(frozen=True)
class Simulated:
    """One run: true states, what a smoother starts from, and what the filter said; covariances are too many to keep."""

    truth: list
    first: DynamicState
    frames: list
    errors: list
    nis: list
    readings: list


@cache
def simulated(seed):
    rng, start = np.random.default_rng(seed), begin()
    sd = np.sqrt(np.diag(start.P))[: 3 * NV]
    true = kalman().retract(start, np.concatenate([sd * rng.normal(size=3 * NV), np.zeros(12)]), start.P)
    state, memory, run = start, kalman().begin(), Simulated([], start, [], [], [], [])
    for t in range(FRAMES):
        q, v, a = moved(true, rng)
        true = DynamicState(q, v, a, loads(q, v, a, 0.5 + 0.3 * np.sin(0.1 * t), rng), start.P)
        markers = kalman().sensor.positions(q)
        markers = markers + MARKER_SD_M * rng.normal(size=markers.shape)
        step = kalman().step(state, memory, markers, true.w.reshape(2, 6) + plate_noise(rng))
        state, memory = step.state, step.memory
        run = run if t else replace(run, first=state)
        run.truth.append(true)
        run.frames.append(Frame(replace(state, P=start.P), step.decision, markers))
        run.errors.append(errors(true, state))
        run.nis.append(step.nis)
        run.readings.append(step.readings)
    return run


@cache
def judged(smoothed):
    """By quantity: (runs, frames, n) normalised errors, and (runs, frames) NEES per dof."""
    runs = [simulated(seed).errors for seed in range(RUNS)] if not smoothed else []
    for run in (simulated(seed) for seed in range(8 if smoothed else 0)):
        found = smooth(kalman(), run.first, run.frames, rounds=2)
        runs.append([errors(*pair) for pair in zip(run.truth, found, strict=True)])
    normal = [np.array([[frame[k][0] for frame in run] for run in runs]) for k in range(3)]
    whole = [np.array([[frame[k][1] for frame in run] for run in runs]) for k in range(3)]
    return dict(zip(QUANTITIES, normal, strict=True)), dict(zip(QUANTITIES, whole, strict=True))


both = pytest.mark.parametrize("smoothed", [False, True], ids=["filter", "smoother"])
each = pytest.mark.parametrize("quantity", QUANTITIES)


@both
@each
def test_errors_are_as_large_as_stated(quantity, smoothed):
    """Mean squared error over variance, over all dofs, frames and runs."""
    assert np.mean(judged(smoothed)[0][quantity] ** 2) == pytest.approx(1.0, abs=0.08)


@both
@each
def test_intervals_of_95_percent_cover_as_much(quantity, smoothed):
    inside = np.abs(judged(smoothed)[0][quantity]) < 1.959964
    assert 0.93 < inside.mean() < 0.97


@both
@each
def test_every_dof_errs_as_much_as_stated(quantity, smoothed):
    """At the middle and the last frame: over independent runs, each sum of squares lies in its χ² band."""
    for t in (FRAMES // 2, FRAMES - 1):
        errors_there = judged(smoothed)[0][quantity][:, t]
        runs, dofs = errors_there.shape
        low, high = chi2(runs).ppf([0.001 / dofs, 1.0 - 0.001 / dofs])
        total = (errors_there**2).sum(axis=0)
        assert (total > low).all() and (total < high).all()


@both
@pytest.mark.parametrize(("quantity", "most"), [("positions", 1.08), ("velocities", 1.08), ("torques", 1.25)])
def test_whole_covariances_are_as_large_as_errors(quantity, most, smoothed):
    """NEES per dof. Torques have directions known to 0.01 N m, where the second order of T's other terms shows."""
    assert 0.93 < judged(smoothed)[1][quantity].mean() < most


def test_innovations_are_as_large_as_stated():
    """NIS over all readings but the 12 that a wide random walk takes up: a χ² of 110 000 degrees of freedom."""
    runs = [simulated(seed) for seed in range(RUNS)]
    freedom = sum(readings - 12 for run in runs for readings in run.readings)
    assert freedom > 100_000
    low, high = chi2(freedom).ppf([1e-5, 1.0 - 1e-5]) / freedom
    ratio = sum(sum(run.nis) for run in runs) / freedom
    assert low - 0.005 < ratio < high + 0.005
