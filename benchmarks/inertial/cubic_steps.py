"""The simulated walk of the stride-length study (key ``stride``): two cubic steps of 1 m, read at 50 Hz, no rotation.

Along x the sensor stands for 1 s, moves 1 m in 1 s, stands for 1 s, moves 1 m in 1 s and stands; its height goes up by
1 m with the first step and down again with the second. Readings are the second differences of the sampled position,
as the study has them; at a jump of the acceleration they are the mean over the samples around it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.errors import InvalidInput, UnknownName

RATE_HZ, LENGTH_S = 50.0, 5.0
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


SHAPES: dict[str, Callable[[Array], Array]] = {
    "smooth": lambda u: u * u * (3.0 - 2.0 * u),
    "cube": lambda u: u**3,
    "cube backwards": lambda u: 1.0 - (1.0 - u) ** 3,
}
"""Cubic courses from 0 to 1 in unit time. The study names no coefficients; only the first begins and ends at rest."""


def cubic_steps(
    case: str = "clean",
    seed: int = 0,
    *,
    delay_s: float = 0.0,
    shape: str = "smooth",
    direction: tuple[float, float, float] = (1.0, 1.0, 1.0),
    rate_hz: float = RATE_HZ,
) -> CubicSteps:
    """The walk with one of the four cases' errors.

    Args:
        case: One of :data:`CASES`.
        seed: Of the noise.
        delay_s: Delay of the motion against the study's; the times of the samples do not change.
        shape: Course of a step, one of :data:`SHAPES`.
        direction: The gyroscope's constant is that of the case times these, one per axis.
        rate_hz: Of the samples.

    Raises:
        UnknownName: The case or the shape does not exist.
        InvalidInput: With that delay the walk does not fit into the samples.
    """
    if case not in CASES:
        raise UnknownName("case", case, CASES)
    if shape not in SHAPES:
        raise UnknownName("shape", shape, SHAPES)
    if not 0.0 <= delay_s <= 0.9:
        raise InvalidInput(f"the delay must lie between 0 and 0.9 s, got {delay_s}")
    errors, rng = CASES[case], np.random.default_rng(seed)
    step = 1.0 / rate_hz
    times: Array = step * np.arange(round(LENGTH_S * rate_hz), dtype=float)
    before, here, after = (_position(times - delay_s + shift, shape) for shift in (-step, 0.0, step))
    force = (after - 2.0 * here + before) / step**2 + np.array([0.0, 0.0, GRAVITY_M_S2])
    force += errors.noise_m_s2 * rng.normal(size=force.shape)
    bias = errors.bias_rad_s * np.array(direction)
    return CubicSteps(times, here, force, np.tile(bias, (len(times), 1)))


def _position(t: Array, shape: str) -> Array:
    """(T, 3) true position at times (T,)."""
    one, two = (SHAPES[shape](np.clip(t - start, 0.0, 1.0)) for start in STEP_STARTS_S)
    return np.stack([one + two, 0.0 * t, one - two], axis=1)
