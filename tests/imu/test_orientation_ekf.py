"""The error-state filter: it finds attitude and bias, knows its own error, and is not led astray."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.imu.orientation_ekf import OrientationFilter, OrientationSettings
from tests.imu.turning import RATE_HZ, apart_deg, turning

pytestmark = pytest.mark.slow

DT = 1.0 / RATE_HZ
BIAS = np.array([0.02, -0.01, 0.015])


def course(gyro, force, field, settings=None):
    """Quaternions of one sensor, its last state and all."""
    states = courses([(gyro, force, field)], settings)
    return np.array([s.quaternion[0] for s in states]), states[-1], states


def courses(readings, settings=None):
    """States of several sensors side by side."""
    kalman = OrientationFilter(DT, settings)
    gyro, force, field = (
        None if parts[0] is None else np.stack(parts, axis=1) for parts in zip(*readings, strict=True)
    )
    first = kalman.begin(force[0], None if field is None else field[0])
    return [first, *(p.state for p in kalman.run(gyro, force, field, first))]


def noisy(made, seed=0):
    rng = np.random.default_rng(seed)
    return (
        made.gyro + BIAS + rng.normal(0, 0.01, made.gyro.shape),
        made.force + rng.normal(0, 0.05, made.gyro.shape),
        made.field + rng.normal(0, 0.3, made.gyro.shape),
    )


def long_turning(shake_mps2=1.0):
    """A sensor that turns, and is shaken, for 24 s."""
    return turning(24.0, shake_mps2=shake_mps2)


DISTURBED = slice(1500, 1800)


def disturbed(field):
    """A magnet passes by."""
    found = field.copy()
    found[DISTURBED] += [30.0, 25.0, 0.0]
    return found


@pytest.fixture(scope="module")
def three():
    """Quaternions (T, 4) of a sensor that turns, of the same beside a magnet and of a shaken one; the last state."""
    gyro, force, field = noisy(long_turning())
    states = courses([(gyro, force, field), (gyro, force, disturbed(field)), noisy(long_turning(8.0))])
    return [np.array([s.quaternion[n] for s in states]) for n in range(3)], states[-1]


def test_attitude_and_bias_are_found(three):
    (found, _, _), last = three
    assert apart_deg(found, long_turning().truth)[1800:].max() < 2.0
    np.testing.assert_allclose(last.gyro_bias[0], BIAS, atol=0.003)


def test_without_a_field_only_the_heading_is_lost():
    made = long_turning()
    gyro, force, _ = noisy(made)
    found, _, _ = course(gyro, force, None)
    up = np.degrees(
        np.arccos(np.clip((Rotation.from_quat(found).inv().apply([0, 0, 1.0])
                           * Rotation.from_quat(made.truth).inv().apply([0, 0, 1.0])).sum(axis=1), -1, 1))
    )  # fmt: skip
    assert up[1000:].max() < 1.5


def test_covariances_stay_symmetric_and_positive():
    made = turning(10.0)
    for settings in (OrientationSettings(), OrientationSettings(rest_bias=True, integrating=False)):
        *_, states = course(*noisy(made), settings)
        for state in states[::50]:
            P = state.P[0]
            np.testing.assert_allclose(P, P.T, atol=1e-9)
            assert np.linalg.eigvalsh(P).min() > 0


def test_its_statement_of_error_is_honest_without_shaking():
    """Squared errors over stated variances: near 1 on the cautious side, for noise as the settings have it."""
    ratios = []
    every = [turning(10.0, seed, shake_mps2=0.5) for seed in range(4)]
    states = courses([noisy(made, seed) for seed, made in enumerate(every)])
    for n, made in enumerate(every):
        found = np.array([s.quaternion[n] for s in states])
        error = (Rotation.from_quat(made.truth) * Rotation.from_quat(found).inv()).as_rotvec()[500:]
        P = np.array([s.P[n, :2, :2] for s in states])[500:]
        ratios.append(
            np.einsum("ti,ti->t", error[:, :2], np.linalg.solve(P, error[:, :2, None])[..., 0]).mean() / 2
        )
    assert 0.02 < np.mean(ratios) < 2.0


def test_a_magnet_passing_by_does_not_turn_the_heading(three):
    (clean, found, _), _ = three
    gyro, force, field = noisy(long_turning())
    assert apart_deg(found, clean)[1500:].max() < 3.0
    blind = OrientationSettings(field_tolerance=1e6, dip_tolerance_rad=1e6)
    led, _, _ = course(*(part[:1800] for part in (gyro, force, disturbed(field))), blind)
    assert apart_deg(led, clean[:1800])[1500:].max() > 3 * apart_deg(found, clean)[1500:1800].max()


def test_strong_shaking_does_not_tilt_it(three):
    assert apart_deg(three[0][2], long_turning(8.0).truth)[1500:].max() < 5.0


def test_many_sensors_are_as_one():
    made = [turning(4.0, seed) for seed in range(3)]
    kalman = OrientationFilter(DT)
    gyro, force, field = (np.stack([getattr(m, n) for m in made], 1) for n in ("gyro", "force", "field"))
    together = [p.state for p in kalman.run(gyro, force, field)]
    for n in range(3):
        alone, last, _ = course(gyro[:, n], force[:, n], field[:, n])
        np.testing.assert_allclose(alone[-1], together[-1].quaternion[n], atol=1e-10)
        np.testing.assert_allclose(last.P[0], together[-1].P[n], atol=1e-10)


def test_a_sensor_at_rest_reads_its_bias():
    made = turning(12.0, still_s=100.0)
    gyro, force, _ = noisy(made)
    _, plain, _ = course(gyro, force, None, OrientationSettings(rest_bias=False))
    _, rested, _ = course(gyro, force, None)
    np.testing.assert_allclose(rested.gyro_bias[0], BIAS, atol=0.002)
    assert np.abs(plain.gyro_bias[0] - BIAS).max() > 0.003  # the turn about the vertical goes unseen


def test_missing_samples_widen_the_error_and_are_bridged():
    """Of the gyroscope, the accelerometer, the magnetometer."""
    made, readings = turning(10.0), []
    for instrument in range(3):
        parts = [part.copy() for part in noisy(made)]
        parts[instrument][600:640] = np.nan
        readings.append(parts)
    states = courses(readings)
    for state in states:
        assert np.isfinite(state.quaternion).all()
    assert np.isfinite(states[-1].P).all()
    assert states[639].P[0, 0, 0] > 10 * states[599].P[0, 0, 0]
