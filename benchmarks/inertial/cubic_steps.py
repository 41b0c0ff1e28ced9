"""The simulated walk of the stride-length study (key ``stride``): two cubic steps of 1 m, read at 50 Hz, no rotation.

Along x the sensor stands for 1 s, moves 1 m in 1 s, stands for 1 s, moves 1 m in 1 s and stands; its height goes up by
1 m with the first step and down again with the second. Readings are the second differences of the sampled position,
as the study has them; at a jump of the acceleration they are the mean over the samples around it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.errors import InvalidInput, UnknownName

RATE_HZ, SAMPLES = 50.0, 250
STEP_STARTS_S = (1.0, 3.0)


@dataclass(frozen=True)
class SensorErrors:
    """Standard deviation of white noise on each accelerometer axis, and a constant on each gyroscope axis."""

    noise_m_s2: float = 0.0
    bias_rad_s: float = 0.0


CASES: dict[str, SensorErrors] = {
    "clean": SensorErrors(),
    "noise": SensorErrors(noise_m_s2=0.06),
    "drift": SensorErrors(bias_rad_s=0.1),
    "noise and drift": SensorErrors(0.06, 0.1),
}
"""The study's four cases."""


@dataclass(frozen=True)
class CubicSteps:
    """The walk.

    Attributes:
        time_s: (T,) times.
        position_m: (T, 3) true position.
        specific_force_mps2, angular_velocity_rad_s: (T, 3) readings, sensor axes parallel to the world's.
    """

    time_s: Array
    position_m: Array
    specific_force_mps2: Array
    angular_velocity_rad_s: Array


def cubic_steps(case: str = "clean", seed: int = 0, *, delay_s: float = 0.0) -> CubicSteps:
    """The walk with one of the four cases' errors.

    Args:
        case: One of :data:`CASES`.
        seed: Of the noise.
        delay_s: Delay of the motion against the study's; the times of the samples do not change.

    Raises:
        UnknownName: The case does not exist.
        InvalidInput: With that delay the walk does not fit into the samples.
    """
    if case not in CASES:
        raise UnknownName("case", case, CASES)
    if not 0.0 <= delay_s <= 0.9:
        raise InvalidInput(f"the delay must lie between 0 and 0.9 s, got {delay_s}")
    errors, rng = CASES[case], np.random.default_rng(seed)
    step = 1.0 / RATE_HZ
    times: Array = step * np.arange(SAMPLES, dtype=float)
    before, here, after = (_position(times - delay_s + shift) for shift in (-step, 0.0, step))
    force = (after - 2.0 * here + before) / step**2 + np.array([0.0, 0.0, GRAVITY_M_S2])
    force += errors.noise_m_s2 * rng.normal(size=force.shape)
    return CubicSteps(times, here, force, np.full_like(force, errors.bias_rad_s))


def _position(t: Array) -> Array:
    """(T, 3) true position at times (T,)."""
    one, two = (_smooth(t - start) for start in STEP_STARTS_S)
    return np.stack([one + two, 0.0 * t, one - two], axis=1)


def _smooth(u: Array) -> Array:
    """0 before 0, 1 after 1 and 3u² − 2u³ between."""
    u = np.clip(u, 0.0, 1.0)
    return u * u * (3.0 - 2.0 * u)
