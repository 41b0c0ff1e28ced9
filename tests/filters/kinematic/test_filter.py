"""The kinematic filter: equal to the exact Kalman filter where the problem is linear, consistent where it is not."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from benchmarks.dynamic.nis import nis as nis_of
from mbkf.filters.kinematic.filter import KinematicFilter, VelocityStep, kinematic_blocks
from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.numerics.kalman import correct, information
from mbkf.sensors.holes import HOLE_POSTURE_SCALE
from mbkf.sensors.marker_sensor import MarkerSensor
from tests.motions import (
    assert_near,
    markers_only,
    moderate_pose,
    protocol_sensor,
    random_model,
    reference_model,
    smooth_motion,
    worst,
)

MODEL = reference_model()
NV = MODEL.nv
DT = 0.01
PELVIS_MARKERS = np.array([[0.1, 0.1, -0.2], [0.1, -0.1, -0.2], [-0.1, 0.0, -0.18], [0.0, 0.15, -0.1]])
NO_PRIORS = {"posture_scale": 1e6, "velocity_sd": 1e6, "gate": 1e12, "min_markers": 1}


def stepped(kalman, state, measured_m):
    """One step; the kinematic filter keeps nothing besides its state."""
    return kalman.step(state, kalman.begin(), markers_only(measured_m))


def change_covariance(kalman, before, step):
    """(nv, nv) of v_k − v_{k−1}."""
    return VelocityStep(before, step, kalman.plant).covariance


def unobservable_except(*dofs):
    return ~np.isin(np.arange(NV), np.r_[dofs])


def textbook_filter(x, P, measured, noise, sd, velocity_sd):
    """Six states (position, velocity) read by markers p + offset; a frame without any reads the velocity as zero."""
    phi = np.block([[np.eye(3), DT * np.eye(3)], [np.zeros((3, 3)), np.eye(3)]])
    gamma = np.vstack([DT**2 / 2 * np.eye(3), DT * np.eye(3)])
    H = np.vstack([np.hstack([np.eye(3), np.zeros((3, 3))])] * (len(measured[0]) // 3))
    rest = np.hstack([np.zeros((3, 3)), np.eye(3)])
    out = []
    for y in measured:
        x, P = phi @ x, phi @ P @ phi.T + gamma @ np.diag(sd**2) @ gamma.T
        if np.isnan(y).any():
            read, H_now, R = np.zeros(3), rest, velocity_sd**2 * np.eye(3)
        else:
            read, H_now, R = y, H, noise**2 * np.eye(len(H))
        S = H_now @ P @ H_now.T + R
        innovation = read - H_now @ x
        nis = 0.0 if H_now is rest else innovation @ np.linalg.solve(S, innovation)
        K = P @ H_now.T @ np.linalg.inv(S)
        x = x + K @ innovation
        before, P = P, (np.eye(6) - K @ H_now) @ P
        out.append((x, P, nis, before))
    return out


@pytest.mark.parametrize("velocity_sd", [0.5, 20.0, 1e6])
@pytest.mark.parametrize("yaw", [0.0, 0.8])
def test_a_translating_pelvis_is_the_exact_kalman_filter(yaw, velocity_sd):
    """All other dofs stay, the problem is linear. The body's tangent axes are the pelvis's, turned by the yaw."""
    rng, noise = np.random.default_rng(1), 0.004
    R = Rotation.from_euler("z", yaw).as_matrix()
    turn = np.kron(np.eye(2), R)
    sensor = MarkerSensor(MODEL, ["pelvis"] * 4, PELVIS_MARKERS)
    settings = KinematicSettings(velocity_sd=velocity_sd, gate=1e12, min_markers=1)
    kalman = KinematicFilter(sensor, np.full(4, noise), DT, unobservable_except(0, 1, 2), settings)
    A = rng.normal(size=(6, 6))
    x0, P0 = 0.1 * rng.normal(size=6), 0.01 * A @ A.T
    q = MODEL.neutral()
    q[:3], q[3:7] = x0[:3], Rotation.from_euler("z", yaw).as_quat()
    v, P = np.zeros(NV), np.zeros((2 * NV, 2 * NV))
    v[:3] = R.T @ x0[3:]
    free = np.r_[0:3, NV : NV + 3]
    P[np.ix_(free, free)] = turn.T @ P0 @ turn
    state = KinematicState(q, v, P)
    points = np.cumsum(0.01 * rng.normal(size=(50, 1, 3)), axis=0) + noise * rng.normal(size=(50, 4, 3))
    points[20:24] = np.nan
    reference = textbook_filter(x0, P0, points.reshape(50, -1), noise, MODEL.acceleration_sd[:3], velocity_sd)
    for point, (x, P_textbook, nis, _) in zip(points, reference, strict=True):
        result = stepped(kalman, state, point + PELVIS_MARKERS @ R.T)
        state = result.state
        assert_near(state.q[:3], x[:3], 1e-11)
        assert_near(R @ state.v[:3], x[3:], 1e-9)
        assert_near(turn @ state.P[np.ix_(free, free)] @ turn.T, P_textbook, 1e-10)
        assert nis_of(result)[0] == pytest.approx(nis, rel=1e-9, abs=1e-12)
    assert_near(state.q[3:], q[3:], 1e-12)


def test_the_covariance_of_a_velocity_step_is_that_of_the_error_of_eq_3_7():
    """Errors obey e' = (I − K H)(Φ e + Γ a) − K n; Cov(e' − e) written out for each axis of the linear problem."""
    noise, sd = 0.004, MODEL.acceleration_sd[0]
    sensor = MarkerSensor(MODEL, ["pelvis"] * 4, PELVIS_MARKERS)
    kalman = KinematicFilter(
        sensor, np.full(4, noise), DT, unobservable_except(0, 1, 2), KinematicSettings(**NO_PRIORS)
    )
    P = np.zeros((2 * NV, 2 * NV))
    one = np.array([[1e-4, 2e-4], [2e-4, 0.3]])
    for axis in range(3):
        P[np.ix_([axis, NV + axis], [axis, NV + axis])] = one
    q = MODEL.neutral()
    before = KinematicState(q, np.zeros(NV), P)
    found = change_covariance(kalman, before, stepped(kalman, before, sensor.positions(q)))
    phi, gamma = np.array([[1, DT], [0, 1]]), np.array([[DT**2 / 2], [DT]])
    Q, H = sd**2 * gamma @ gamma.T, np.array([[1.0, 0.0]] * 4)
    prior = phi @ one @ phi.T + Q
    K = prior @ H.T @ np.linalg.inv(H @ prior @ H.T + noise**2 * np.eye(4))
    rest = np.eye(2) - K @ H
    from_start = rest @ phi - np.eye(2)
    step = from_start @ one @ from_start.T + rest @ Q @ rest.T + noise**2 * K @ K.T
    np.testing.assert_allclose(found[:3, :3], step[1, 1] * np.eye(3), rtol=1e-9, atol=1e-14)


class Simulation:
    """The filter's own assumptions played out: white accelerations of some dofs, markers with white noise."""

    free = np.r_[0:9, MODEL.joint("right_thigh").v.start : MODEL.joint("right_thigh").v.stop]
    noise = 0.005

    def __init__(self, seed):
        self.rng = np.random.default_rng(seed)
        self.sensor, _ = protocol_sensor(MODEL)
        settings = KinematicSettings(**NO_PRIORS)
        noise = np.full(len(self.sensor.segments), self.noise)
        self.filter = KinematicFilter(self.sensor, noise, DT, unobservable_except(*self.free), settings)
        self.states = np.r_[self.free, NV + self.free]
        P = np.zeros((2 * NV, 2 * NV))
        P[self.states, self.states] = np.r_[np.full(len(self.free), 0.02**2), np.full(len(self.free), 1.0**2)]
        self.q, self.v = moderate_pose(MODEL, self.rng), np.zeros(NV)
        error = np.sqrt(np.diag(P)) * self.rng.normal(size=2 * NV)
        self.state = KinematicState(MODEL.integrate(self.q, error[:NV]), error[NV:], P)

    def step(self):
        """One step of truth and filter; NEES, NIS and the number of readings."""
        a = np.zeros(NV)
        a[self.free] = MODEL.acceleration_sd[self.free] * self.rng.normal(size=len(self.free))
        self.q = MODEL.integrate(self.q, self.v * DT + a * DT**2 / 2)
        self.v = self.v + a * DT
        exact = self.sensor.positions(self.q)
        result = stepped(self.filter, self.state, exact + self.noise * self.rng.normal(size=exact.shape))
        self.state = result.state
        error = np.r_[MODEL.difference(self.state.q, self.q), self.v - self.state.v][self.states]
        nees = error @ np.linalg.solve(self.state.P[np.ix_(self.states, self.states)], error)
        return nees, *nis_of(result)


def test_errors_and_innovations_are_as_large_as_the_filter_says():
    """NEES of independent runs and NIS of all steps inside their 99.8 % chi-square bands."""
    nees, nis, readings, runs = [], [], 0, 25
    for seed in range(runs):
        simulation = Simulation(seed)
        steps = [simulation.step() for _ in range(20)]
        nees.append(steps[-1][0])
        nis += [one[1] for one in steps]
        readings += sum(one[2] for one in steps)
    size = 2 * len(Simulation.free)
    assert chi2.ppf(0.001, runs * size) < sum(nees) < chi2.ppf(0.999, runs * size)
    assert chi2.ppf(0.001, readings) < sum(nis) < chi2.ppf(0.999, readings)


@pytest.mark.slow
def test_covariance_stays_symmetric_and_positive_over_2000_steps():
    """The whole body, every marker lost for half of the time and at times all of them for 0.15 s."""
    rng, sensor = np.random.default_rng(2), protocol_sensor(MODEL)[0]
    kalman = KinematicFilter(sensor, np.full(36, 0.005), DT, np.zeros(NV, bool), KinematicSettings())
    motion = smooth_motion(MODEL, rng)
    state = kalman.start(sensor.positions(motion.q(0.0)))
    for k in range(1, 2000):
        measured = sensor.positions(motion.q(k * DT)) + 0.005 * rng.normal(size=(36, 3))
        lost = rng.random(36) < 0.5 if k % 500 > 15 else np.ones(36, bool)
        state = stepped(kalman, state, np.where(lost[:, None], np.nan, measured)).state
        assert (state.P == state.P.T).all()
    assert np.linalg.eigvalsh(state.P).min() > 0
    assert np.isfinite(state.q).all()
    assert worst(MODEL.difference(motion.q(1999 * DT), state.q)) < 0.5  # rad, of the worst seen toe or hand


def test_start_is_at_rest_at_the_fitted_pose():
    model = random_model(np.random.default_rng(3))
    sensor, _ = protocol_sensor(model)
    unobservable = ~np.isin(np.arange(NV), np.arange(30))
    kalman = KinematicFilter(sensor, np.full(36, 0.005), DT, unobservable, KinematicSettings())
    q = moderate_pose(model, np.random.default_rng(4), spread=0.2)
    state = kalman.start(sensor.positions(q))
    assert worst(model.difference(q, state.q)) < 0.02
    np.testing.assert_array_equal(state.v, 0.0)
    assert (np.sqrt(np.diag(state.P))[NV:][unobservable] <= 1e-6).all()
    assert (np.sqrt(np.diag(state.P))[NV:][~unobservable] >= 1.0).all()


def test_no_start_from_too_few_or_impossible_markers():
    sensor, _ = protocol_sensor(MODEL)
    kalman = KinematicFilter(sensor, np.full(36, 0.005), DT, np.zeros(NV, bool), KinematicSettings())
    standing = sensor.positions(MODEL.neutral())
    few = np.where(np.arange(36)[:, None] < 5, standing, np.nan)
    assert kalman.start(few) is None
    assert kalman.start(np.random.default_rng(5).uniform(-2, 2, (36, 3))) is None
    assert kalman.start(standing) is not None


def test_refused_and_missing_markers_are_told_apart():
    sensor, names = protocol_sensor(MODEL)
    kalman = KinematicFilter(sensor, np.full(36, 0.005), DT, np.zeros(NV, bool), KinematicSettings())
    standing = sensor.positions(MODEL.neutral())
    state = kalman.start(standing)
    for _ in range(20):
        state = stepped(kalman, state, standing).state
    measured = standing.copy()
    measured[names.index("RKNE")] += [0.3, 0.0, 0.0]
    measured[names.index("LKNE")] = np.nan
    result = stepped(kalman, state, measured)
    assert np.flatnonzero(result.refused).tolist() == [names.index("RKNE")]
    assert nis_of(result)[1] == 3 * 34
    assert result.tracked
    assert worst(MODEL.difference(state.q, result.state.q)) < 0.01


def test_unobservable_dofs_stay_where_they_are():
    sensor, _ = protocol_sensor(MODEL)
    unobservable = unobservable_except(*range(0, 30))
    kalman = KinematicFilter(sensor, np.full(36, 0.005), DT, unobservable, KinematicSettings())
    rng = np.random.default_rng(6)
    P = np.zeros((2 * NV, 2 * NV))
    free = np.r_[~unobservable, ~unobservable]
    P[free, free] = 0.1
    state = KinematicState(MODEL.neutral(), np.zeros(NV), P)
    for _ in range(5):
        posed = moderate_pose(MODEL, rng, spread=0.1, heading=0.0)
        state = stepped(kalman, state, sensor.positions(posed)).state
    assert worst(MODEL.difference(MODEL.neutral(), state.q)[unobservable]) < 1e-9
    assert worst(state.v[unobservable]) < 1e-9


@pytest.mark.parametrize("holds", [False, True])
def test_a_step_is_the_dense_textbook_step(holds):
    """All readings stacked with their Jacobians, Φ P Φᵀ + Q and the covariance of v_k − v_{k−1} as dense products.

    A forearm and hand go out of sight, so that their velocities are read as zero.
    """
    rng, sensor = np.random.default_rng(8), protocol_sensor(MODEL)[0]
    unobservable = (np.arange(NV) >= 50) & holds
    noise, gone = rng.uniform(0.003, 0.008, 36), ["left_forearm", "left_hand"]
    hidden = np.isin(sensor.segments, gone)
    assert hidden.any()
    kalman = KinematicFilter(sensor, noise, DT, unobservable, KinematicSettings())
    motion = smooth_motion(MODEL, rng)
    points = np.array([sensor.positions(motion.q(k * DT)) for k in range(12)])
    points += 0.003 * rng.normal(size=points.shape)
    points[5:, 20:23] = np.nan
    points[7:, hidden] = np.nan
    points[9, 3] += 0.4
    state = kalman.start(points[0])
    for k, measured in enumerate(points[1:], 1):
        out_of_sight = [np.arange(NV)[MODEL.joint(s).v] for s in gone if s in sensor.segments and k >= 7]
        free = np.array([i for dofs in out_of_sight for i in dofs if not unobservable[i]], dtype=int)
        result = stepped(kalman, state, measured)
        phi, plant = kalman.plant.transition(state), kalman.plant
        Q = np.block(
            [
                [np.diag(plant.position_noise), np.diag(plant.cross_noise)],
                [np.diag(plant.cross_noise), np.diag(plant.velocity_noise)],
            ]
        )
        q, P = MODEL.integrate(state.q, state.v * DT), phi @ state.P @ phi.T + Q
        reading, lean = sensor.reading(q), kalman.posture.reading(q)
        good = ~np.isnan(measured).any(axis=1) & ~result.refused
        y, H, sd = (
            measured[good] - reading.positions_m[good],
            reading.jacobian[good],
            np.repeat(noise[good], 3),
        )
        markers = information(y.ravel(), H.reshape(-1, NV), sd)
        own = ~unobservable[kalman.posture.dofs]
        H = np.vstack([H.reshape(-1, NV), lean.jacobian[own], np.zeros((len(free), NV))])
        H = np.hstack([H, np.zeros((len(H), NV))])
        H[len(H) - len(free) :, NV:] = np.eye(NV)[free]
        y = np.r_[y.ravel(), -lean.deviation[own], -state.v[free]]
        sd = np.r_[sd, 10.0 * kalman.posture.sd[own], np.full(len(free), 20.0)]
        K = np.linalg.solve(H @ P @ H.T + np.diag(sd**2), H @ P).T
        step, after = K @ y, P - K @ H @ P
        assert worst(MODEL.difference(MODEL.integrate(q, step[:NV]), result.state.q)) < 1e-9
        assert_near(result.state.v, state.v + step[NV:], 1e-7)
        assert worst(after - result.state.P) < 1e-9 * worst(P)
        assert nis_of(result)[0] == pytest.approx(correct(P[:NV, :NV], markers).nis, rel=1e-7)
        C = (np.eye(2 * NV) - K @ H) @ phi @ state.P
        both = after + state.P - C - C.T
        assert worst(both[NV:, NV:] - change_covariance(kalman, state, result)) < 1e-9 * worst(P)
        state = result.state


def test_joints_beside_an_unmarked_segment_are_known_by_posture_and_limits_too():
    """Both knees bend backwards by 0.3 rad; only the right one is beside an unmarked thigh."""
    sensor, _ = protocol_sensor(MODEL)
    marked = [m for m, segment in enumerate(sensor.segments) if segment != "right_thigh"]
    bare = MarkerSensor(MODEL, [sensor.segments[m] for m in marked], sensor.local_m[marked])
    nothing, settings = np.zeros(NV, dtype=bool), KinematicSettings()
    right, left = (MODEL.joint(f"{side}_shank").v.start + 1 for side in ("right", "left"))
    bent = np.zeros(NV)
    bent[[right, left]] = -0.3
    state = KinematicState(MODEL.integrate(MODEL.neutral(), bent), np.zeros(NV), np.eye(2 * NV))
    whole = kinematic_blocks(sensor, np.full(len(sensor.segments), 0.01), DT, nothing, settings)
    *_, prior, limits = kinematic_blocks(bare, np.full(len(marked), 0.01), DT, nothing, settings)
    usual = whole[-1].prepare(state, None).information.matrix
    known = prior.prepare(state, None).information.matrix
    assert known[right, right] == pytest.approx(
        usual[right, right] * (settings.posture_scale / HOLE_POSTURE_SCALE) ** 2
    )
    assert known[left, left] == pytest.approx(usual[left, left])
    held = limits.prepare(state, None).matrix
    assert held[right, right] > 100.0 and held[left, left] == 0.0
    assert len(whole) == 3
