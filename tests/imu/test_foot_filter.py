"""The foot's filter: its plant's derivative, and how it follows made walks."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.inertial.cubic_steps import RATE_HZ, cubic_steps
from benchmarks.inertial.foot_walks import foot_walk
from mbkf.errors import InvalidInput
from mbkf.imu.foot_filter import LEVER, SIZE, FootFilterSettings, FootState, V, _stance, follow_foot, predict
from mbkf.imu.zero_velocity import StillnessSettings, still_samples

SETTINGS = FootFilterSettings()


def run_of(readings, settings=SETTINGS, still=None):
    f, w, rate = readings.specific_force_mps2, readings.angular_velocity_rad_s, readings.rate_hz
    seen = still_samples(f, w, rate, StillnessSettings()) if still is None else still
    return follow_foot(f, w, rate, seen, settings)


def random_state(rng):
    turned = Rotation.from_rotvec(rng.normal(size=3)).as_matrix()
    return FootState(
        rng.normal(size=3),
        rng.normal(size=3),
        0.1 * rng.normal(size=3),
        turned,
        0.1 * rng.normal(size=3),
        0.3 * rng.normal(size=3),
    )


@pytest.mark.parametrize("seed", range(3))
def test_the_transition_is_the_numeric_derivative_of_the_step(seed):
    rng = np.random.default_rng(seed)
    state, f, w, dt, h = random_state(rng), 10 * rng.normal(size=3), 5 * rng.normal(size=3), 0.02, 1e-6
    after, stated = predict(state, f, w, dt)
    numeric = np.empty((SIZE, SIZE))
    for k, e in enumerate(h * np.eye(SIZE)):
        plus, minus = (predict(state.moved(s * e), f, w, dt)[0] for s in (1.0, -1.0))
        numeric[:, k] = (after.error_of(plus) - after.error_of(minus)) / (2.0 * h)
    assert np.abs(stated - numeric).max() < 1e-7
    assert np.abs(stated - np.eye(SIZE)).max() > 0.1


def test_errors_and_moves_undo_each_other():
    rng = np.random.default_rng(4)
    one, error = random_state(rng), 0.5 * rng.normal(size=SIZE)
    assert np.allclose(one.error_of(one.moved(error)), error)


@pytest.mark.parametrize("mounting", [(0.0, 0.0, 0.0), (0.4, -0.3, 2.0), (3.0, 0.2, 0.1)])
def test_a_clean_walk_is_followed_wherever_the_sensor_points(mounting):
    walk = foot_walk(mounting_rad=mounting, gyro_bias_rad_s=(0.05, -0.04, 0.03))
    run = run_of(walk.readings)
    way = run.steps[-1].state.position
    assert np.hypot(way[0], way[1]) == pytest.approx(walk.lengths_m.sum(), abs=0.01)
    assert abs(way[2]) < 0.01
    assert np.allclose(run.steps[-1].state.gyro_bias, (0.05, -0.04, 0.03), atol=2e-3)


def test_the_state_covers_the_capture_from_the_first_rest_on():
    walk = foot_walk()
    still = walk.still.copy()
    still[:200] = False
    run = run_of(walk.readings, still=still)
    assert run.first == int(still.argmax()) > 200
    assert run.first + len(run.steps) == len(still) == len(run.still)
    assert not run.still[: run.first].any()


def test_steady_motion_is_not_taken_for_rest():
    """In the middle of a cubic step the acceleration passes zero: without rotation that looks like rest."""
    walk = cubic_steps()
    f, w = walk.specific_force_mps2, walk.angular_velocity_rad_s
    still = still_samples(f, w, RATE_HZ, StillnessSettings())
    inside = np.abs(walk.time_s - 1.5) < 0.03
    assert still[inside].all()
    run = follow_foot(f, w, RATE_HZ, still, SETTINGS)
    assert run.refused > 0
    assert not run.still[inside].any()
    trusting = follow_foot(f, w, RATE_HZ, still, replace(SETTINGS, gate=1e9))
    lost = (abs(one.steps[-1].state.position[0] - 2.0) for one in (trusting, run))
    assert next(lost) > 0.5
    assert next(lost) < 0.01


def test_a_rest_that_goes_on_is_believed_after_all():
    """A gyroscope off by 60°/s for one stride makes the velocity wrong beyond the gate; the next long rest heals it."""
    walk = foot_walk((1.2,))
    wrong = walk.readings.angular_velocity_rad_s.copy()
    wrong[~walk.still] += 3.0
    readings = replace(walk.readings, angular_velocity_rad_s=wrong)
    settings = replace(SETTINGS, insist_s=0.3)
    run = run_of(readings, settings, still=walk.still)
    assert 0 < run.refused <= round(0.3 * walk.readings.rate_hz)
    assert run.still[-1]
    assert np.linalg.norm(run.steps[-1].state.velocity) < 0.05


def test_the_second_of_two_doubted_rests_is_believed():
    """A gyroscope that errs in the first stride only, and rests too short to insist on."""
    walk = foot_walk((1.2,) * 4)
    t = walk.readings.time_s
    wrong = walk.readings.angular_velocity_rad_s.copy()
    wrong[(t > 1.5) & (t < 2.2)] += 1.0
    run = run_of(replace(walk.readings, angular_velocity_rad_s=wrong), still=walk.still)
    first, second, third = ((t > start + 0.05) & (t < start + 0.35) for start in (2.2, 3.3, 4.4))
    assert not run.still[first].any()
    assert run.still[second].all()
    assert run.still[third].all()


def test_on_level_ground_heights_do_not_drift():
    walk = foot_walk((1.2,) * 8, force_noise_m_s2=0.3, rate_noise_rad_s=0.1, seed=3)
    free, level = (
        run_of(walk.readings, settings) for settings in (SETTINGS, replace(SETTINGS, level_m=0.02))
    )
    assert abs(level.steps[-1].state.position[2]) < 0.5 * abs(free.steps[-1].state.position[2])


@pytest.mark.parametrize("seed", range(3))
def test_a_stance_is_read_with_its_derivative_by_the_lever(seed):
    rng = np.random.default_rng(seed)
    state, w, h = random_state(rng), rng.normal(size=3), 1e-6
    stated = _stance(state, w, SETTINGS)
    for part, place in ((np.eye(3), V), (stated.by_lever, LEVER)):
        for k, e in enumerate(h * np.eye(SIZE)[place]):
            plus, minus = (_stance(state.moved(s * e), w, SETTINGS).beyond for s in (1.0, -1.0))
            assert np.allclose((plus - minus) / (2.0 * h), part[:, k], atol=1e-8)


def test_a_foot_that_rolls_has_the_velocity_of_its_lever():
    rng = np.random.default_rng(5)
    state, w = random_state(rng), rng.normal(size=3)
    rolling = state._replace(velocity=state.rotation @ np.cross(w - state.gyro_bias, state.lever))
    assert np.abs(_stance(rolling, w, SETTINGS).beyond).max() < 1e-12


def test_a_turning_foot_in_swing_is_no_stance_whatever_was_doubted_before():
    walk = foot_walk((1.2,) * 3)
    everywhere = np.ones_like(walk.still)
    one = walk.readings
    run = follow_foot(
        one.specific_force_mps2, one.angular_velocity_rad_s, one.rate_hz, walk.still, SETTINGS, everywhere
    )
    speed = np.linalg.norm(np.gradient(walk.position_m, 1.0 / one.rate_hz, axis=0), axis=1)
    assert not run.still[speed > 1.5].any()


def test_covariances_stay_symmetric_and_positive():
    for step in run_of(foot_walk().readings).steps[::50]:
        assert np.allclose(step.P, step.P.T, atol=1e-12)
        assert np.linalg.eigvalsh(step.P).min() > -1e-12


def test_the_bias_is_not_fooled_by_a_movement_at_the_end_of_the_first_rest():
    walk = foot_walk()
    shifted = walk.readings.angular_velocity_rad_s.copy()
    shifted[100:140] += 0.3
    readings = replace(walk.readings, angular_velocity_rad_s=shifted)
    run = run_of(readings, still=walk.still)
    assert np.abs(run.steps[0].state.gyro_bias).max() < 1e-6


def test_a_foot_that_never_rests_is_refused():
    walk = foot_walk()
    with pytest.raises(InvalidInput, match="never stands still"):
        run_of(walk.readings, still=np.zeros_like(walk.still))


def test_bad_settings_are_refused():
    with pytest.raises(InvalidInput, match="gate"):
        FootFilterSettings(gate=0.0)
    with pytest.raises(InvalidInput, match="level_m"):
        FootFilterSettings(level_m=-0.1)
