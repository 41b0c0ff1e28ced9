"""Filtered and smoothed paths, and how certain the ways between rests are."""

import numpy as np
import pytest

from benchmarks.inertial.foot_walks import foot_walk
from mbkf.imu.foot_filter import (
    READ,
    SIZE,
    FootFilterSettings,
    P,
    _add_noise,
    _plant_noises,
    _start,
    follow_foot,
)
from mbkf.imu.foot_track import filtered_track, rest_middles, smoothed_track
from mbkf.imu.strides import find_strides
from mbkf.numerics.runs import runs

pytestmark = pytest.mark.slow

SETTINGS = FootFilterSettings()


def run_of(walk, settings=SETTINGS):
    one = walk.readings
    return follow_foot(one.specific_force_mps2, one.angular_velocity_rad_s, one.rate_hz, walk.still, settings)


def test_both_paths_find_the_strides_of_a_clean_walk():
    walk = foot_walk()
    for track in (filtered_track(run_of(walk)), smoothed_track(run_of(walk))):
        strides = find_strides(walk.readings.time_s, track.position_m, track.still)
        assert [s.length_m for s in strides] == pytest.approx(walk.lengths_m, abs=0.005)
        assert [s.lift_m for s in strides] == pytest.approx([0.12] * 3, abs=0.005)


def test_orientation_is_that_of_the_sensor_but_for_the_heading():
    walk = foot_walk(heading_rad=0.0, mounting_rad=(0.3, -0.2, 0.0))
    found = smoothed_track(run_of(walk)).orientation
    up = np.array([0.0, 0.0, 1.0])
    true = walk.orientation.inv().apply(up)
    rotation = type(walk.orientation).from_quat(found)
    assert np.abs(rotation.inv().apply(up) - true).max() < 5e-3


def test_the_smoother_ends_where_the_filter_ends():
    run = run_of(foot_walk(force_noise_m_s2=0.1, rate_noise_rad_s=0.02))
    one, other = filtered_track(run), smoothed_track(run)
    assert np.allclose(one.position_m[-1], other.position_m[-1])
    assert np.allclose(one.velocity_m_s[-1], other.velocity_m_s[-1])


def test_the_smoother_knows_in_the_swing_what_the_next_rest_will_say():
    walk = foot_walk((1.2,) * 6, force_noise_m_s2=0.5, rate_noise_rad_s=0.1, seed=5)
    run = run_of(walk)
    truth = np.gradient(walk.position_m, 1.0 / walk.readings.rate_hz, axis=0)
    late = [start - 3 for start, _ in runs(walk.still)[1:]]
    speed = {
        name: np.linalg.norm(track.velocity_m_s[late], axis=1) - np.linalg.norm(truth[late], axis=1)
        for name, track in (("filter", filtered_track(run)), ("smoother", smoothed_track(run)))
    }
    assert np.abs(speed["smoother"]).mean() < 0.5 * np.abs(speed["filter"]).mean()


def test_nothing_is_known_before_the_first_rest():
    walk = foot_walk()
    still = walk.still.copy()
    still[: int((~walk.still).argmax())] = False
    one = walk.readings
    run = follow_foot(one.specific_force_mps2, one.angular_velocity_rad_s, one.rate_hz, still, SETTINGS)
    track = smoothed_track(run)
    assert np.isnan(track.position_m[: run.first]).all()
    assert np.isfinite(track.position_m[run.first :]).all()


def test_certainty_of_the_ways_is_that_of_the_joint_gaussian():
    """All states of a short run at once, conditioned on its readings by dense algebra."""
    walk = foot_walk((1.2, 1.1), rate_hz=16.0)
    run = run_of(walk)
    steps, dt = run.steps, 1.0 / walk.readings.rate_hz
    densities = _plant_noises(walk.readings.specific_force_mps2, SETTINGS, dt)
    N = len(steps)
    reach = np.zeros((N, SIZE, N, SIZE))  # state k = Σ_j reach[k, :, j] (what enters at step j)
    reach[0, :, 0] = np.eye(SIZE)
    for k in range(1, N):
        reach[k] = np.tensordot(steps[k].Phi, reach[k - 1], axes=(1, 0))
        reach[k, :, k] = np.eye(SIZE)
    entering = np.zeros((N, SIZE, N, SIZE))
    start = slice(*runs(walk.still)[0])
    f, w = walk.readings.specific_force_mps2, walk.readings.angular_velocity_rad_s
    _, entering[0, :, 0] = _start(f[start], w[start], walk.readings.rate_hz, SETTINGS, True)
    for k in range(1, N):
        noise = np.zeros((SIZE, SIZE))
        _add_noise(noise, densities[run.first + k], SETTINGS, dt)
        entering[k, :, k] = noise
    G, Q = (x.reshape(N * SIZE, N * SIZE) for x in (reach, entering))
    joint = G @ Q @ G.T
    rests = [k for k in range(N) if steps[k].reading is not None]
    middles = rest_middles(run.still)
    for track, last in ((smoothed_track(run), N), (filtered_track(run), middles[1] + 1)):
        C = np.zeros((3 * N, N * SIZE))  # readings with errors of one
        for k in (k for k in rests if k < last):
            values, vectors = np.linalg.eigh(steps[k].reading.matrix)
            C[3 * k : 3 * k + 3, k * SIZE : k * SIZE + READ] = (
                np.sqrt(values[-3:])[:, None] * vectors[:, -3:].T
            )
        S = C @ joint @ C.T + np.eye(3 * N)
        posterior = joint - joint @ C.T @ np.linalg.solve(S, C @ joint)
        difference = np.zeros((3, N * SIZE))
        difference[:, middles[1] * SIZE :][:, P] = np.eye(3)
        difference[:, middles[0] * SIZE :][:, P] -= np.eye(3)
        expected = difference @ posterior @ difference.T
        if last < N:  # the filter's place at the first rest knows the readings up to there only
            here = slice(middles[0] * SIZE, (middles[0] + 1) * SIZE)
            expected += (steps[middles[0]].P - posterior[here, here])[P, P]
        assert track.displacement_covariances_m2[0] == pytest.approx(expected, rel=1e-7, abs=1e-12)


def test_stated_deviations_are_the_errors_of_sensors_that_err_as_assumed():
    rate = 100.0
    normalised = []
    for seed in range(12):
        walk = foot_walk(
            (1.2,) * 4,
            rate_hz=rate,
            force_noise_m_s2=SETTINGS.acceleration_noise * np.sqrt(rate),
            rate_noise_rad_s=SETTINGS.angular_noise * np.sqrt(rate),
            seed=seed,
        )
        track = smoothed_track(run_of(walk))
        strides = find_strides(
            walk.readings.time_s,
            track.position_m,
            track.still,
            displacement_covariances_m2=track.displacement_covariances_m2,
        )
        normalised += [((s.length_m - 1.2) / s.length_sd_m) ** 2 for s in strides]
    # 48 squared standard normal numbers have a mean of 1 ± 0.2.
    assert 0.5 < np.mean(normalised) < 1.7
