"""Simulated feet that hardly rest: mounted softly, never flat, running, on stairs, in sand.

A foot is a rigid body with a heel and a ball. In stance it rolls over the heel and then over the ball, or stands flat
between; in swing it follows smooth curves. A sensor on its instep reads that motion at its own rate, with the noise,
biases and range of usual ones. How long a stride is, is known at every sample.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.io.imu.readings import ImuReadings

FINE_HZ, SMOOTH_S, STAND_S = 2000.0, 0.006, 1.5
HEEL_M, BALL_M, SENSOR_M = (-0.07, 0.0), (0.13, 0.0), (0.05, 0.07)
"""Places in the foot: forward of the ankle's projection, and above the sole."""

RANGE_MPS2, RANGE_RAD_S = 16.0 * GRAVITY_M_S2, np.radians(2000.0)


@dataclass(frozen=True)
class Gait:
    """How a foot goes.

    Attributes:
        stride_m, cycle_s, stance: Length and time of a stride, and the share of it that is stance.
        flat: Share of the stance in which the foot stands flat.
        landing_rad, leaving_rad: Pitch at landing (toes up) and at leaving (heel up).
        rise_m: Of each stride.
        lift_m: Of the ankle in swing.
        slip_m: How far the foot slides back and sinks in stance.
        wobble_rad: Largest rotation of the sensor against the foot after landing.
    """

    stride_m: float
    cycle_s: float
    stance: float
    flat: float
    landing_rad: float
    leaving_rad: float
    rise_m: float = 0.0
    lift_m: float = 0.12
    slip_m: float = 0.0
    wobble_rad: float = 0.0


@dataclass(frozen=True)
class SimulatedFoot:
    """Readings of a foot's sensor, and its true place (T, 3), m, at each sample."""

    kind: str
    readings: ImuReadings
    position_m: Array


def _soft(rng: np.random.Generator) -> Gait:
    return Gait(rng.uniform(1.0, 1.6), rng.uniform(0.95, 1.2), 0.62, rng.uniform(0.3, 0.5), 0.35, 1.0,
                wobble_rad=rng.uniform(0.05, 0.12))  # fmt: skip


def _never_flat(rng: np.random.Generator) -> Gait:
    return Gait(
        rng.uniform(1.0, 1.6),
        rng.uniform(0.95, 1.2),
        0.62,
        0.0,
        rng.uniform(0.15, 0.35),
        rng.uniform(0.7, 1.0),
    )


def _run(rng: np.random.Generator) -> Gait:
    return Gait(
        rng.uniform(1.6, 2.8), rng.uniform(0.66, 0.78), rng.uniform(0.33, 0.42), rng.uniform(0.0, 0.15),
        rng.uniform(0.0, 0.25), rng.uniform(0.8, 1.1), lift_m=0.25, wobble_rad=rng.uniform(0.0, 0.05),
    )  # fmt: skip


def _stairs(rng: np.random.Generator) -> Gait:
    up = rng.choice([-1.0, 1.0])
    return Gait(rng.uniform(0.5, 0.65), rng.uniform(1.1, 1.4), 0.62, rng.uniform(0.2, 0.5), rng.uniform(-0.3, 0.1), 0.8,
                rise_m=up * rng.uniform(0.3, 0.36), lift_m=0.12)  # fmt: skip


def _sand(rng: np.random.Generator) -> Gait:
    return Gait(rng.uniform(0.9, 1.4), rng.uniform(1.0, 1.3), 0.64, rng.uniform(0.2, 0.45), 0.25, 0.9,
                slip_m=rng.uniform(0.01, 0.03))  # fmt: skip


KINDS: dict[str, Callable[[np.random.Generator], Gait]] = {
    "mounted softly": _soft, "never flat": _never_flat, "running": _run, "stairs": _stairs, "sand": _sand,
}  # fmt: skip


def simulated_foot(kind: str, seed: int, strides: int = 20) -> SimulatedFoot:
    """A foot that stands, makes strides of one kind, each a little different, and stands again.

    Args:
        kind: A key of :data:`KINDS`.
        seed: Of the person, the strides and the sensor.
        strides: How many.
    """
    rng = np.random.default_rng((list(KINDS).index(kind), seed))
    gait = KINDS[kind](rng)
    time, place, pitch = _path(gait, strides, rng)
    heading = np.cumsum(rng.normal(0.0, 0.1, 4))  # a way that turns slowly
    bend = gaussian_filter1d(np.interp(time, np.linspace(0.0, time[-1], 4), heading), 0.5 * FINE_HZ)
    step = np.diff(place[:, 0], prepend=place[0, 0])
    world = np.column_stack([np.cumsum(step * np.cos(bend)), np.cumsum(step * np.sin(bend)), place[:, 1]])
    roll = -0.1 * pitch
    angles = gaussian_filter1d(np.column_stack([bend, pitch, roll]), SMOOTH_S * FINE_HZ, axis=0)
    turn = Rotation.from_euler("ZYX", angles) * Rotation.from_euler("xyz", rng.uniform(-0.5, 0.5, 3))
    return _read(kind, time, gaussian_filter1d(world, SMOOTH_S * FINE_HZ, axis=0), turn, rng)


def _path(gait: Gait, strides: int, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Times, (T, 2) place of the sensor forward and up, and (T,) pitch (toes down positive) of a straight way."""
    knots = _Knots()
    knots.hold(STAND_S)
    for _ in range(strides):
        length = gait.stride_m * rng.normal(1.0, 0.03)
        knots.swing(gait, length, gait.rise_m, (1.0 - gait.stance) * gait.cycle_s * rng.normal(1.0, 0.02))
        knots.stance(gait, gait.stance * gait.cycle_s * rng.normal(1.0, 0.02), rng)
    knots.settle(gait)
    knots.hold(STAND_S)
    return knots.sampled()


class _Knots:
    """Pieces of a foot's motion, one after the other, each with the ankle's place and the pitch."""

    def __init__(self) -> None:
        self.time, self.ground, self.pitch_now = 0.0, np.zeros(2), 0.0
        self.pieces: list[tuple[Array, Array, Array, Array]] = []
        self.leaving = 0.0

    def hold(self, seconds: float) -> None:
        t = np.arange(0.0, seconds, 1.0 / FINE_HZ)
        self._add(t, np.zeros((len(t), 2)), np.zeros(len(t)), np.zeros(len(t)))

    def swing(self, gait: Gait, length: float, rise: float, seconds: float) -> None:
        """From heel up over the swing to the pitch of landing; the first one begins flat."""
        t = np.arange(0.0, seconds, 1.0 / FINE_HZ)
        u = t / seconds
        begin, end = self._place(self.pitch_now), np.add(self._place(-gait.landing_rad), [length, rise])
        rate = 6.0 if self.pitch_now > 0.1 else 0.0
        first, last = (
            self._rolling(self.pitch_now, rate),
            self._rolling(-gait.landing_rad, 4.0 * (gait.landing_rad > 0.05)),
        )
        place = CubicHermiteSpline([0.0, 1.0], [begin, end], [seconds * first, seconds * last])(u)
        forward = begin[0] + (end[0] - begin[0]) * (10 * u**3 - 15 * u**4 + 6 * u**5)
        ease = 16.0 * u**2 * (1.0 - u) ** 2
        place[:, 0] = (1.0 - ease) * place[:, 0] + ease * forward
        place[:, 1] += gait.lift_m * 64.0 * (u * (1.0 - u)) ** 3 + max(abs(rise) - 0.1, 0.0) * 0.3 * ease
        pitch = CubicHermiteSpline(
            [0.0, 1.0],
            [self.pitch_now, -gait.landing_rad],
            [seconds * rate, seconds * 4.0 * (gait.landing_rad > 0.05)],
        )(u)
        self._add(t, place, pitch, np.zeros(len(t)), direct=True)
        self.ground = np.add(self.ground, [length, rise])
        self.pitch_now = -gait.landing_rad

    def stance(self, gait: Gait, seconds: float, rng: np.random.Generator) -> None:
        """Over the heel, flat, over the ball; it ends with the heel up."""
        t = np.arange(0.0, seconds, 1.0 / FINE_HZ)
        rest = gait.flat * seconds
        land = 0.25 * (seconds - rest)
        times = [0.0, land, land + rest, seconds]
        slow = 0.0 if rest > 0.02 else 0.8 * (gait.landing_rad + 0.5 * gait.leaving_rad) / seconds
        pitch = CubicHermiteSpline(
            times if rest > 0.02 else [0.0, 0.35 * seconds, seconds],
            [-gait.landing_rad, 0.0, 0.0, gait.leaving_rad]
            if rest > 0.02
            else [-gait.landing_rad, 0.0, gait.leaving_rad],
            [4.0 * (gait.landing_rad > 0.05), 0.0, 0.0, 6.0]
            if rest > 0.02
            else [4.0 * (gait.landing_rad > 0.05), slow, 6.0],
        )(t)
        ease = 0.5 - 0.5 * np.cos(np.pi * t / seconds)
        slide = gait.slip_m * np.column_stack([-ease, -0.5 * ease])
        shake = gait.wobble_rad * np.exp(-t / 0.08) * np.sin(2.0 * np.pi * rng.uniform(8.0, 13.0) * t)
        place = np.array([self._place(one) for one in pitch]) + slide
        self._add(t, place, pitch, shake, direct=True)
        self.ground = self.ground + slide[-1]
        self.pitch_now = gait.leaving_rad

    def settle(self, gait: Gait) -> None:
        """Puts the foot down where it is."""
        gentle = Gait(0.3, 0.9, 0.5, 0.5, 0.0, 0.0, lift_m=0.05)
        self.swing(gentle, 0.3, 0.0, 0.5 * gait.cycle_s + 0.2)
        self.pitch_now = 0.0

    def _add(self, t: Array, place: Array, pitch: Array, shake: Array, direct: bool = False) -> None:
        own = place if direct else np.array([self._place(one) for one in pitch])
        self.pieces.append((self.time + t, own, pitch, shake))
        self.time += len(t) / FINE_HZ

    def _place(self, pitch: float) -> Array:
        """(2,) the sensor, where the foot touches with its heel (toes up) or ball (heel up)."""
        pivot = np.array(HEEL_M if pitch < 0.0 else BALL_M)
        c, s = np.cos(pitch), np.sin(pitch)
        arm = np.array(SENSOR_M) - pivot
        return np.asarray(self.ground + pivot + np.array([c * arm[0] + s * arm[1], -s * arm[0] + c * arm[1]]))

    def _rolling(self, pitch: float, rate: float) -> Array:
        """(2,) velocity of the sensor while the foot rolls."""
        return (
            (self._place(pitch + 1e-5 * np.sign(pitch)) - self._place(pitch))
            / (1e-5 * (np.sign(pitch) or 1.0))
            * rate
        )

    def sampled(self) -> tuple[Array, Array, Array]:
        time, place, pitch, shake = (np.concatenate(parts) for parts in zip(*self.pieces, strict=True))
        return time, place, pitch + shake


def _read(kind: str, time: Array, place: Array, turn: Rotation, rng: np.random.Generator) -> SimulatedFoot:
    """What a sensor reads at its own rate: mean over a sample, biases, noise, range."""
    rate_hz = float(rng.choice([100.0, 200.0]))
    every = round(FINE_HZ / rate_hz)
    acceleration = np.gradient(np.gradient(place, 1.0 / FINE_HZ, axis=0), 1.0 / FINE_HZ, axis=0)
    between = (turn[:-1].inv() * turn[1:]).as_rotvec() * FINE_HZ
    rates = np.vstack([between, between[-1:]])
    force = turn.inv().apply(np.add(acceleration, [0.0, 0.0, GRAVITY_M_S2]))
    smooth = 0.35 * every  # the sensor's own low-pass
    force, rates = (gaussian_filter1d(values, smooth, axis=0)[::every] for values in (force, rates))
    force = force + rng.normal(0.0, 0.1, 3) + rng.normal(0.0, 0.05, force.shape)
    rates = rates * (1.0 + rng.normal(0.0, 0.003)) + rng.normal(0.0, np.radians(0.5), 3)
    rates = rates + rng.normal(0.0, np.radians(0.1), rates.shape)
    times = time[::every]
    return SimulatedFoot(
        kind,
        ImuReadings(
            "foot",
            times,
            np.clip(force, -RANGE_MPS2, RANGE_MPS2),
            np.clip(rates, -RANGE_RAD_S, RANGE_RAD_S),
            None,
            rate_hz,
        ),
        place[::every],
    )
