"""The dynamic filter, step by step: the textbook's update, what it believes of markers, joints and feet."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

from benchmarks.dynamic.nis import nis
from mbkf.conventions import GRAVITY_M_S2
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.block import Frame
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.contact.soles import sole_points
from mbkf.sensors.holes import HOLE_POSTURE_SCALE
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.markers import Markers
from mbkf.sensors.posture import PosturePrior
from mbkf.sensors.posture_sensor import PostureSensor
from tests.dynamics import (
    DT,
    MARKER_SD_M,
    about,
    at_rest,
    dynamic_filter,
    follow,
    half_weight,
    memory_of,
    plates_under,
    random_state,
    standard_filter,
    standing,
    trial,
)
from tests.motions import assert_near, protocol_sensor, random_model, reference_model, worst

MODEL = reference_model()
NV = MODEL.nv
LOADS = 3 * NV + 12
N = LOADS + 6
"""Components of positions to wrenches, and of the whole state with the residual."""
STANDING = standing(MODEL)
PLATES = plates_under(MODEL, STANDING)
SOLES = sole_points(MODEL, STANDING[None])[0]
HALF = half_weight(MODEL, SOLES.mean(axis=1))
KNEE = MODEL.joint("right_shank").v.start + 1
RIGHT_LEG = ("right_thigh", "right_shank", "right_foot", "right_toes")
SETTINGS = DynamicSettings()


def balanced(q):
    """(2, 6) half of the weight on each foot, below the centre of mass of a body that rests."""
    under = SOLES.mean(axis=1)
    under[:, 0] = MODEL.centre_of_mass(q)[0]
    return half_weight(MODEL, under)


class Loaded:
    """A loaded body that moves a little, and what its instruments read, noise and all."""

    def __init__(self, seed=0, **settings):
        rng = np.random.default_rng(seed)
        self.kalman = dynamic_filter(MODEL, PLATES, **settings)
        self.state = random_state(MODEL, rng, STANDING, spread=0.1)
        self.markers = self.kalman.sensor.positions(self.kalman.plant.predict(self.state).q)
        self.markers = self.markers + 0.004 * rng.normal(size=self.markers.shape)
        self.plates = HALF + rng.normal(size=(2, 6))

    def step(self, kalman=None, markers=None):
        chosen = kalman or self.kalman
        markers = self.markers if markers is None else markers
        return chosen.step(self.state, chosen.begin(), Frame(markers, self.plates))


def noise_scale(kalman, step):
    """Square of the factor on the markers' noise after a step."""
    return memory_of(kalman, Markers, step.memory).noise_scale


def dense_readings(frame, prior):
    """y (m,), H (m, N), sd (m,) and the number of instruments' readings, put together by hand."""
    kalman, s = frame.kalman, frame.kalman.settings
    reading = kalman.sensor.reading(prior.q)
    H = [np.pad(reading.jacobian.reshape(-1, NV), ((0, 0), (0, N - NV)))]
    y, sd = [(frame.markers - reading.positions_m).ravel()], [np.full(H[0].shape[0], MARKER_SD_M)]
    balance = NewtonEuler(MODEL)
    root = balance.root(prior.q, prior.v, prior.a, prior.w)
    H.append(np.hstack([root.by_state, np.eye(6)]))
    y.append(-root.residual - prior.extra)
    sd.append(np.repeat([s.law.residual_force_n, s.law.residual_moment_nm], 3))
    centres = sole_points(MODEL, prior.q[None])[0][:, [0, 2]].mean(axis=1)
    X = scipy.linalg.block_diag(*map(about, centres))
    H.append(np.hstack([np.zeros((12, 3 * NV)), X, np.zeros((12, 6))]))
    y.append(X @ (frame.plates.ravel() - prior.w))
    sd.append(np.tile(np.repeat([s.contact.plate_force_n, s.contact.plate_moment_nm], 3), 2))
    instruments = sum(map(len, y))
    posture = PostureSensor(MODEL)
    leaning = posture.reading(prior.q)
    H.append(np.pad(leaning.jacobian, ((0, 0), (0, N - NV))))
    y.append(-leaning.deviation)
    sd.append(s.posture.posture_scale * posture.sd)
    size_n = (
        GRAVITY_M_S2 * MODEL.mass_kg * np.repeat([s.residual.residual_share, s.residual.residual_lever_m], 3)
    )
    H.append(np.eye(N)[LOADS:])
    y.append(-prior.extra)
    sd.append(size_n * np.sqrt(0.5 * s.residual.residual_memory_s / DT))
    return np.concatenate(y), np.vstack(H), np.concatenate(sd), instruments


@pytest.mark.parametrize("seed", range(3))
def test_a_step_is_the_textbook_update(seed):
    """K = P Hᵀ (H P Hᵀ + R)⁻¹ with all readings in one dense matrix, covariance by Joseph's form."""
    frame = Loaded(seed, limit_sd_rad=1e6)
    found = frame.step()
    prior = found.prior.state
    assert found.decisions.notes.contact.contacts == (Contact.MEASURED, Contact.MEASURED)
    assert found.decisions.notes.trusted.all()
    y, H, sd, instruments = dense_readings(frame, prior)
    R, P = np.diag(sd**2), prior.P
    K = np.linalg.solve(H @ P @ H.T + R, H @ P).T
    closed = np.eye(N) - K @ H
    posterior, step = closed @ P @ closed.T + K @ R @ K.T, K @ y
    scale = np.sqrt(np.diag(P))
    assert worst((found.state.P - posterior) / scale[:, None] / scale) < 1e-8
    assert worst((frame.kalman.plant.difference(prior, found.state) - step) / scale) < 1e-7
    y, H, R = y[:instruments], H[:instruments], R[:instruments, :instruments]
    assert nis(found) == pytest.approx((y @ np.linalg.solve(H @ P @ H.T + R, y), instruments), rel=1e-7)


def test_the_prior_is_the_plants_and_the_wrenches_wander_about_the_soles():
    frame = Loaded()
    prior, plain = frame.step().prior.state, frame.kalman.plant.predict(frame.state)
    s = frame.kalman.settings.contact
    for foot, centre in enumerate(sole_points(MODEL, plain.q[None])[0][:, [0, 2]].mean(axis=1)):
        mine = slice(3 * NV + 6 * foot, 3 * NV + 6 * foot + 6)
        X = about(centre)
        own = X @ (prior.P - plain.P)[mine, mine] @ X.T
        expected = np.diag(np.repeat([s.wrench_force, s.wrench_moment], 3) ** 2 * DT)
        assert worst(own - expected) < 1e-8 * worst(expected)
    assert_near(prior.P[: 3 * NV], plain.P[: 3 * NV], 1e-12 * worst(plain.P))
    for name in ("q", "v", "a", "w", "extra"):
        np.testing.assert_array_equal(getattr(prior, name), getattr(plain, name))


def test_readings_are_linearised_anew_as_they_were():
    """For a smoother: the same decision at the same state gives the same rows."""
    frame = Loaded()
    found = frame.step()
    again = frame.kalman.linearise(found.prior.state, found.decisions)
    assert_near(again.rows, found.readings.rows, 1e-12 * worst(found.readings.rows))
    assert_near(again.values, found.readings.values, 1e-9)
    assert_near(again.whole_matrix, found.readings.whole_matrix, 1e-12 * worst(found.readings.whole_matrix))
    assert_near(again.whole_vector, found.readings.whole_vector, 1e-9 * worst(found.readings.whole_vector))


def test_tangent_steps_go_back_and_forth():
    rng = np.random.default_rng(1)
    kalman, s = dynamic_filter(MODEL), random_state(MODEL, rng)
    x = 0.3 * rng.normal(size=N)
    assert_near(kalman.plant.difference(s, kalman.plant.retract(s, x, s.P)), x, 1e-10)


def assert_same_state(found, expected, tolerance=1e-8):
    scale = np.sqrt(np.diag(expected.P))
    assert worst(MODEL.difference(expected.q, found.q) / scale[:NV]) < tolerance
    means = [np.concatenate([s.v, s.a, s.w, s.extra]) for s in (found, expected)]
    assert worst((means[0] - means[1]) / scale[NV:]) < tolerance
    assert worst((found.P - expected.P) / scale[:, None] / scale) < tolerance


def with_markers(kalman, chosen):
    """The same filter with some of its markers, in this order."""
    sensor = kalman.sensor
    less = MarkerSensor(MODEL, [sensor.segments[k] for k in chosen], sensor.local_m[chosen])
    detector = ContactDetector(MODEL, PLATES, DT)
    noise = kalman.noise_m[chosen]
    return standard_filter(less, noise, detector, DT, kalman.unobservable, kalman.settings)


def test_the_order_of_markers_changes_nothing():
    frame = Loaded()
    order = np.random.default_rng(2).permutation(len(frame.markers))
    found = frame.step(with_markers(frame.kalman, order), frame.markers[order])
    assert_same_state(found.state, frame.step().state)
    assert nis(found)[0] == pytest.approx(nis(frame.step())[0], rel=1e-9)
    assert noise_scale(frame.kalman, found) == pytest.approx(
        noise_scale(frame.kalman, frame.step()), rel=1e-12
    )


def test_a_missing_marker_is_one_left_out():
    frame = Loaded()
    gone = [k for k, name in enumerate(frame.kalman.sensor.segments) if name in ("torso", "pelvis")][::2]
    kept = np.delete(np.arange(len(frame.markers)), gone)
    markers = frame.markers.copy()
    markers[gone] = np.nan
    found = frame.step(markers=markers)
    assert_same_state(found.state, frame.step(with_markers(frame.kalman, kept), frame.markers[kept]).state)
    assert not found.decisions.notes.seen[gone].any() and not found.refused.any()


def test_a_wrong_marker_is_refused_and_changes_nothing():
    frame = Loaded()
    wrong, missing = frame.markers.copy(), frame.markers.copy()
    wrong[4] += 0.8
    missing[4] = np.nan
    found, without = frame.step(markers=wrong), frame.step(markers=missing)
    np.testing.assert_array_equal(np.flatnonzero(found.refused), [4])
    assert_same_state(found.state, without.state, 1e-12)
    assert nis(found)[1] == nis(without)[1]
    assert noise_scale(frame.kalman, found) == noise_scale(frame.kalman, without)


def test_a_step_repeats_and_leaves_its_inputs_alone():
    frame = Loaded()
    kept = [x.copy() for x in (*vars(frame.state).values(), frame.markers, frame.plates)]
    first = frame.step()
    found = {name: getattr(first.state, name).copy() for name in "qvawP"}
    frame.step(markers=frame.markers + 0.01)
    again = frame.step().state
    for name, value in found.items():
        np.testing.assert_array_equal(getattr(first.state, name), value)
        np.testing.assert_array_equal(getattr(again, name), value)
    for now, before in zip((*vars(frame.state).values(), frame.markers, frame.plates), kept, strict=True):
        np.testing.assert_array_equal(now, before)


def test_a_few_markers_do_not_track_a_body():
    frame = Loaded()
    least = frame.kalman.settings.markers.min_markers
    markers = np.full_like(frame.markers, np.nan)
    lost = frame.step(markers=markers)
    assert not lost.tracked and np.isfinite(lost.state.P).all() and np.isfinite(lost.state.q).all()
    markers[:least] = frame.markers[:least]
    assert frame.step(markers=markers).tracked


def scales(noise_share, frames=150, **settings):
    """Factor on the markers' variance, and mean square innovation, where markers are off by a share of their noise."""
    rng = np.random.default_rng(3)
    kalman = dynamic_filter(MODEL, PLATES, noise_memory_s=0.2, **settings)
    loads = balanced(STANDING)
    state, memory, found = at_rest(MODEL, STANDING, loads), kalman.begin(), []
    exact = kalman.sensor.positions(STANDING)
    for _ in range(frames):
        markers = exact + noise_share * MARKER_SD_M * rng.normal(size=exact.shape)
        step = kalman.step(state, memory, Frame(markers, loads))
        innovation = (markers - kalman.sensor.positions(step.prior.state.q)) / MARKER_SD_M
        state, memory = step.state, step.memory
        found.append((noise_scale(kalman, step), (innovation**2).mean()))
    return np.array(found).T


@pytest.mark.parametrize(("noise_share", "limit"), [(0.05, 0.5), (20.0, 3.0)])
def test_the_noise_follows_the_innovations_within_its_range(noise_share, limit):
    """Without gates; such markers would drive the plant's activity, and that would drive their innovations."""
    found, _ = scales(noise_share, noise_range=(0.5, 3.0), gate=1e12, gate_radius_m=10.0, activity_gain=0.0)
    assert (found >= 0.5**2).all() and (found <= 3.0**2).all()
    assert found[-1] == pytest.approx(limit**2, rel=0.01)


def test_the_noise_is_the_mean_square_innovation_over_its_share():
    """Exponential mean over the memory's time."""
    share, forget, expected = 0.5, 1.0 - np.exp(-DT / 0.2), [1.0]
    found, squared = scales(1.5, innovation_share=share)
    for now in squared:
        expected.append(expected[-1] + forget * (np.clip(now / share, 0.5**2, 4.0**2) - expected[-1]))
    assert_near(found, expected[1:], 1e-9)
    assert 2.0 < found[-1] < 15.0


def test_the_noise_stays_where_nothing_is_to_be_learnt():
    assert (scales(20.0, frames=5, innovation_share=0.0)[0] == 1.0).all()


def bent_knee(limit_sd_rad):
    """Knee angle after 20 frames that show no marker of a leg whose knee is 0.4 rad beyond its limit."""
    kalman = dynamic_filter(MODEL, PLATES, posture_scale=1e6, limit_sd_rad=limit_sd_rad)
    limit = MODEL.limits[KNEE]
    near = limit[np.argmin(np.abs(limit))]
    q = MODEL.integrate(STANDING, (near + 0.4 * np.sign(near)) * np.eye(NV)[KNEE])
    markers = kalman.sensor.positions(q)
    markers[np.isin(kalman.sensor.segments, RIGHT_LEG)] = np.nan
    loads = balanced(q)
    state, memory = at_rest(MODEL, q, loads), kalman.begin()
    for _ in range(20):
        step = kalman.step(state, memory, Frame(markers, loads))
        state, memory = step.state, step.memory
    return (MODEL.difference(MODEL.neutral(), state.q)[KNEE] - near) * np.sign(near)


def test_a_joint_beyond_its_limit_comes_back():
    """Back behind its limit; a quarter of the knee's range is as far as the speed it gets may carry it unseen."""
    quarter = 0.25 * np.ptp(MODEL.limits[KNEE])
    assert bent_knee(1e6) > 0.3
    assert -quarter < bent_knee(0.03) < 0.05


def test_unobservable_dofs_stay():
    unobservable = np.zeros(NV, dtype=bool)
    unobservable[[NV - 1, 30]] = True
    frame = Loaded()
    kalman = dynamic_filter(MODEL, PLATES, unobservable=unobservable)
    P = frame.state.P.copy()
    for k in np.flatnonzero(unobservable):
        own = [k, NV + k, 2 * NV + k]
        P[own], P[:, own] = 0.0, 0.0
        P[own, own] = 1e-12
    v, a = np.where(unobservable, 0.0, frame.state.v), np.where(unobservable, 0.0, frame.state.a)
    frame.state = replace(frame.state, v=v, a=a, P=P)
    found = frame.step(kalman)
    assert worst(MODEL.difference(frame.state.q, found.state.q)[unobservable]) < 1e-4


def test_the_first_estimate_takes_up_the_frame():
    kalman = dynamic_filter(MODEL, PLATES)
    P = np.diag(np.concatenate([np.full(NV, 0.02), np.full(NV, 1.0)]) ** 2)
    found = kalman.first(
        STANDING, np.zeros(NV), np.zeros(NV), P, Frame(kalman.sensor.positions(STANDING), HALF)
    )
    assert found.tracked and found.decisions.notes.contact.contacts == (Contact.MEASURED, Contact.MEASURED)
    assert worst(found.state.w[:3] - HALF[0, :3]) < 1.0
    root = kalman.balance.root(found.state.q, found.state.v, found.state.a, found.state.w)
    assert worst(root.residual) < 5.0


@pytest.mark.slow
def test_covariances_are_symmetric_and_positive():
    made = trial("walk")
    for plates in (1, 2):
        for state in follow(made, range(20, 60), made.plates[:plates]).states:
            np.testing.assert_array_equal(state.P, state.P.T)
            sd = np.sqrt(np.diag(state.P))
            assert np.linalg.eigvalsh(state.P / sd[:, None] / sd).min() > 0


def test_other_bodies_are_served_too():
    model = random_model(np.random.default_rng(4))
    kalman = dynamic_filter(model, 2)
    q = standing(model)
    under = sole_points(model, q[None])[0].mean(axis=1)
    under[:, 0] = model.centre_of_mass(q)[0]
    half = half_weight(model, under)
    P = np.diag(np.concatenate([np.full(NV, 0.02), np.full(NV, 1.0)]) ** 2)
    step = kalman.first(q, np.zeros(NV), np.zeros(NV), P, Frame(kalman.sensor.positions(q), half))
    for _ in range(20):
        step = kalman.step(step.state, step.memory, Frame(kalman.sensor.positions(q), half))
    s = step.state
    torques = kalman.balance.tau(s.q, s.v, s.a, s.w)
    assert worst(torques[6:] - kalman.balance.tau(q, 0 * s.v, 0 * s.a, half.ravel())[6:]) < 3.0


@pytest.mark.parametrize("scale", [1.0, 3.0])
def test_joints_beside_an_unmarked_segment_are_nearer_to_the_usual_posture(scale):
    """The prior's spreads are those of the body's table times one scale or the other."""
    sensor, names = protocol_sensor(MODEL)
    rest = [name for name, segment in zip(names, sensor.segments, strict=True) if segment != "right_thigh"]
    bare = dynamic_filter(MODEL, keep=rest, posture_scale=scale)
    (prior,) = [block for block in bare.blocks if isinstance(block, PosturePrior)]
    known = prior.prepare(at_rest(MODEL, STANDING, HALF), None).information.matrix
    usual = prior.sensor.weights(1.0, np.zeros(NV, dtype=bool)) ** 2
    for side, factor in (("right", HOLE_POSTURE_SCALE), ("left", scale)):
        knee = MODEL.joint(f"{side}_shank").v.start + 1
        assert known[knee, knee] == pytest.approx(usual[knee] / factor**2)
