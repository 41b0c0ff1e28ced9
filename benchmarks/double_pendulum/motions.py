"""Motions of the double pendulum with known truth, and virtual sensors on it (thesis section 3.3.3, table 3.1)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.double_pendulum.pendulum import DoublePendulum, PendulumShape
from mbkf.conventions import Array
from mbkf.errors import UnknownName
from mbkf.synthesis.cameras import skin_artefact

MARKER_SHARES = np.array([0.35, 0.65, 0.35, 0.65])
MARKER_BARS = np.array([1, 1, 2, 2])
"""Where the four markers sit: distance from the bar's upper end over L, and the bar."""

RATE_HZ, SECONDS = 100.0, 3.0
_CYCLES_HZ = 0.5


@dataclass(frozen=True)
class PendulumMotion:
    """A motion with the efforts that cause it.

    Attributes:
        name: "sin" or "squat".
        shape: The pendulum that moves.
        times_s: (T,).
        q, v, a: (T, 4) z, ż and z̈.
        efforts: (T, 4) T_e without residual.
    """

    name: str
    shape: PendulumShape
    times_s: Array
    q: Array
    v: Array
    a: Array
    efforts: Array


@dataclass(frozen=True)
class PendulumNoise:
    """Errors of the virtual sensors; each number is a standard deviation per sample.

    Attributes:
        camera_m: White noise of each marker coordinate.
        artefact_m: Skin artefact of each marker coordinate, low-passed white noise, stationary.
        cutoff_hz: The low pass's.
        force_n, moment_nm: White noise of force and moment sensors.
    """

    camera_m: float = 2e-5
    artefact_m: float = 1e-2
    cutoff_hz: float = 0.5
    force_n: float = 0.3
    moment_nm: float = 0.3


@dataclass(frozen=True)
class PendulumReadings:
    """Readings: ``markers_m`` (T, 8) x and y of each marker, ``efforts`` (T, 4); NaN where missing."""

    markers_m: Array
    efforts: Array


def _sine(t: Array) -> tuple[Array, Array, Array]:
    """Angle of bar 1 with its two derivatives, 0.9 sin(2π·0.5·t)."""
    w, A = 2.0 * np.pi * _CYCLES_HZ, 0.9
    return A * np.sin(w * t), A * w * np.cos(w * t), -A * w**2 * np.sin(w * t)


def _squat(t: Array) -> tuple[Array, Array, Array]:
    """The same of 0.45 (1 − cos(2π·0.5·t)): bent to one side only."""
    w, A = 2.0 * np.pi * _CYCLES_HZ, 0.45
    return A * (1.0 - np.cos(w * t)), A * w * np.sin(w * t), A * w**2 * np.cos(w * t)


MOTIONS: dict[str, Callable[[Array], tuple[Array, Array, Array]]] = {"sin": _sine, "squat": _squat}
"""θ_1 by name; θ_2 = −θ_1, so that point 0 goes up and down above point 2."""


def pendulum_motion(
    name: str, shape: PendulumShape, seconds: float = SECONDS, rate_hz: float = RATE_HZ
) -> PendulumMotion:
    """A motion with point 2 at the origin, and its efforts by inverse dynamics.

    Args:
        name: One of :data:`MOTIONS`.
        shape: Lengths and masses of the pendulum.
        seconds: Duration, s.
        rate_hz: Sample rate.

    Raises:
        UnknownName: There is no such motion.
    """
    if name not in MOTIONS:
        raise UnknownName("pendulum motion", name, MOTIONS)
    t = np.arange(round(seconds * rate_hz) + 1) / rate_hz
    one, rate, accelerated = MOTIONS[name](t)
    c, s, L = np.cos(one), np.sin(one), shape.length_m
    none = np.zeros_like(t)
    q = np.stack([none, 2.0 * L * c, one, -one], axis=1)
    v = np.stack([none, -2.0 * L * s * rate, rate, -rate], axis=1)
    rise = -2.0 * L * (s * accelerated + c * rate**2)
    a = np.stack([none, rise, accelerated, -accelerated], axis=1)
    body = DoublePendulum(shape, residual=False)
    efforts = np.stack([body.efforts(*frame) for frame in zip(q, v, a, strict=True)])
    return PendulumMotion(name, shape, t, q, v, a, efforts)


def readings(
    motion: PendulumMotion, noise: PendulumNoise, rng: np.random.Generator, rate_hz: float = RATE_HZ
) -> PendulumReadings:
    """Readings of all sensors of a motion, each with its own noise.

    Args:
        motion: The exact motion.
        noise: Standard deviations of the sensors.
        rng: Source of the noise.
        rate_hz: Sample rate of the motion.
    """
    body = DoublePendulum(motion.shape, residual=False)
    points = np.stack([body.on_bars(q, MARKER_SHARES, MARKER_BARS).positions_m for q in motion.q])
    white = noise.camera_m * rng.normal(size=points.shape)
    slid = skin_artefact(points.shape, rate_hz, noise.artefact_m, noise.cutoff_hz, rng)
    sd = np.array([noise.moment_nm, noise.force_n, noise.force_n, noise.moment_nm])
    efforts = motion.efforts + sd * rng.normal(size=motion.efforts.shape)
    return PendulumReadings(points + white + slid, efforts)
