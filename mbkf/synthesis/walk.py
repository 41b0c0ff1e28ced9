"""Level walking: heel strike, roll-over, push-off over the toes and swing, arms against legs.

The recorded time is a window of an endless walk; the walk is planned a few steps beyond both ends.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.model.body import Body
from mbkf.synthesis import dual_numbers
from mbkf.synthesis.contact import Load, LoadPlan, sole_outline
from mbkf.synthesis.curves import Curve, path, sinusoid, spline
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.inverse_kinematics import SIDE_NAMES, FootPose, InverseKinematics
from mbkf.synthesis.plan import MotionPlan, resting, with_oscillation
from mbkf.synthesis.standing import posture

# Timing as parts of a stride, after Perry & Burnfield, Gait Analysis, 2nd ed. 2010 (stance 62 %, double support 12 %).
DOUBLE_SUPPORT = 0.12
FOOT_FLAT = 0.1014
HEEL_OFF = 0.3327
STRIKE_PITCH_DEG = (-13.45, 517.2, -14909.0)
TOE_OFF_PITCH_DEG = (58.46, 738.9, 5394.0)
"""Pitch of the foot (heel up) at heel strike and toe-off, deg, deg/s, deg/s²."""

# The swing, as values at parts of its time: fraction of the way forward, height of the ankle over its height on the
# flat foot (m, body of the reference size), pitch of the foot (deg). Found by least squares against typical knee and
# ankle angles of natural walking, small changes of angular momentum, and toes clear of the floor.
SWING_PARTS = (0.22, 0.45, 0.68, 0.88)
SWING_FORWARD = (0.1534, 0.4297, 0.7583, 0.9452)
SWING_HEIGHT_M = (0.1739, 0.1276, 0.0364, 0.0180)
SWING_PITCH_DEG = (66.84, 38.50, 2.27, -10.80)
BOB_M, BOB_LATE = 0.0214, 0.487
"""Half the rise of the centre of mass, and when in double support it is lowest (0 heel strike … 1 toe-off)."""

MARGIN_STEPS = 4


@dataclass(frozen=True)
class Step:
    """One placement of a foot: side 0 right, 1 left; heel strike and toe-off times in s; ankle over the flat foot."""

    side: int
    strike_s: float
    off_s: float
    ankle_m: Array
    yaw: float


def walk_plan(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    """Walking along +x at about 1.2 m/s, in the middle of its course at half time.

    Args:
        model: The body that walks.
        seconds: Duration of the recorded window, s.
        rng: Source of the differences between persons.
    """
    return walk_and_speed(model, seconds, rng)[0]


def walk_and_speed(
    model: Body, seconds: float, rng: np.random.Generator, apart_m: float = 0.0
) -> tuple[MotionPlan, float]:
    """A walk along +x, in the middle of its course at half time, and its mean speed in m/s.

    Args:
        model: The body that walks.
        seconds: Duration of the recorded window, s.
        rng: Source of the differences between persons.
        apart_m: How much wider than usual the steps are, m.
    """
    size = float(model.scale.mean())
    stride_s = rng.uniform(1.02, 1.08) * np.sqrt(size)
    length = rng.uniform(0.60, 0.64) * size
    steps = _steps(model, seconds, stride_s / 2, length, rng, apart_m)
    feet = {SIDES[k]: _Foot(model, k, [s for s in steps if s.side == k], stride_s) for k in (0, 1)}
    phase_s = next(step.strike_s for step in steps if step.side == 0)
    start, end = _middle(steps, 1, stride_s), _middle(steps, len(steps) - 2, stride_s)

    def poses(times: Array) -> dict[str, FootPose]:
        return {side: foot.pose(times) for side, foot in feet.items()}

    bob = BOB_M * size * rng.uniform(0.95, 1.05)
    step_hz = 2.0 / stride_s
    height = sinusoid(
        bob,
        step_hz,
        -2 * np.pi * step_hz * (phase_s + BOB_LATE * DOUBLE_SUPPORT * stride_s) - np.pi / 2,
        0.97 * size,
    )
    plan = MotionPlan(
        start,
        end,
        with_oscillation(_angles(stride_s, phase_s, rng), rng, 0.6),
        poses,
        height,
        _load(model, steps, feet, stride_s),
        np.deg2rad(8.5),
        recorded_s=(0.0, seconds),
    )
    return plan, 2.0 * length / stride_s


def _steps(
    model: Body, seconds: float, step_s: float, length: float, rng: np.random.Generator, apart_m: float
) -> list[Step]:
    half_width = 0.055 * float(model.scale.mean()) * rng.uniform(0.85, 1.15) + 0.5 * apart_m
    yaw = np.deg2rad(rng.uniform(4, 9))
    count = int(np.ceil(seconds / step_s)) + 2 * MARGIN_STEPS
    begin = rng.uniform(-0.5, 0.5) * step_s - MARGIN_STEPS * step_s
    first = int(rng.integers(2))
    off = step_s * (1 + 2 * DOUBLE_SUPPORT)
    steps = []
    for k in range(count):
        side = (first + k) % 2
        sign = -1.0 if side == 0 else 1.0
        ankle = np.array(
            [(k - 0.5 * count) * length, sign * half_width, -sole_outline(model, SIDES[side]).height]
        )
        steps.append(Step(side, begin + k * step_s, begin + k * step_s + off, ankle, sign * yaw))
    return steps


def _middle(steps: list[Step], k: int, stride_s: float) -> float:
    return steps[k].strike_s + 0.5 * DOUBLE_SUPPORT * stride_s


class _Foot:
    """One foot over all its steps: on the heel, flat, on the toes, in the air."""

    def __init__(self, model: Body, side: int, steps: list[Step], stride_s: float) -> None:
        name = SIDE_NAMES[SIDES[side]]
        outline = sole_outline(model, SIDES[side])
        toes = InverseKinematics(model).offset[f"{name}_toes"]
        self.steps, self.stride_s, self.size = steps, stride_s, float(model.scale.mean())
        self.heel = np.array([outline.heel_x + 0.015, 0.0, outline.height])
        self.ball = np.array([toes[0], 0.0, toes[2]])
        self.heading = constant_rotation(steps[0].yaw)
        stance = path(
            [
                (0.0, *np.deg2rad(STRIKE_PITCH_DEG)),
                (FOOT_FLAT * stride_s, 0.0),
                (HEEL_OFF * stride_s, 0.0),
                (self.off * stride_s, *np.deg2rad(TOE_OFF_PITCH_DEG)),
            ]
        )
        times = [
            self.off * stride_s,
            *(stride_s * (self.off + part * (1 - self.off)) for part in SWING_PARTS),
            stride_s,
        ]
        angles = np.deg2rad([TOE_OFF_PITCH_DEG[0], *SWING_PITCH_DEG, STRIKE_PITCH_DEG[0]])
        bends = [tuple(np.deg2rad(pitch[1:])) for pitch in (TOE_OFF_PITCH_DEG, STRIKE_PITCH_DEG)]
        swing = spline(times, angles.tolist(), bends[0], bends[1])
        relaxed = path(
            [
                (0.0, np.deg2rad(-6.0)),
                (FOOT_FLAT * stride_s, 0.0),
                (HEEL_OFF * stride_s, 0.0),
                (self.off * stride_s, *-np.deg2rad(TOE_OFF_PITCH_DEG)),
                ((self.off + 0.035) * stride_s, np.deg2rad(-67.0)),
                ((self.off + 0.20) * stride_s, np.deg2rad(-14.0)),
                (stride_s, np.deg2rad(-6.0)),
            ]
        )
        self.pitch = self._repeated(
            lambda t: dual_numbers.where(t < self.off * stride_s, stance(t), swing(t))
        )
        self.toes = self._repeated(relaxed)
        self.swings = [self._swing(a, b) for a, b in pairwise(steps)]

    def _repeated(self, curve: Curve) -> Curve:
        """A curve of the time since heel strike, over all strides."""
        return lambda times: curve(np.mod(times - self.steps[0].strike_s, self.stride_s))

    @property
    def off(self) -> float:
        """Toe-off as part of the stride."""
        return 0.5 + DOUBLE_SUPPORT

    def _about(self, pivot: Array, pitch: Dual) -> Dual:
        """(T, 3) ankle over its place on the flat foot, of a foot that turns about a point that rests on the floor."""
        turned = dual_numbers.rotation(1, pitch).apply(-pivot) + pivot
        return Dual(*(x @ self.heading.T for x in turned.orders))

    def _swing(self, last: Step, following: Step) -> Curve:
        at_off, at_strike = np.array([last.off_s]), np.array([following.strike_s])
        off = self._about(self.ball, self.pitch(at_off)) + last.ankle_m
        strike = self._about(self.heel, self.pitch(at_strike)) + following.ankle_m
        duration = following.strike_s - last.off_s
        a, b = ([x[0] for x in end.orders] for end in (off, strike))
        times = [last.off_s, *(last.off_s + part * duration for part in SWING_PARTS), following.strike_s]
        way = b[0] - a[0]
        planar = [
            spline(
                times,
                [a[0][k], *(a[0][k] + part * way[k] for part in SWING_FORWARD), b[0][k]],
                (a[1][k], a[2][k]),
                (b[1][k], b[2][k]),
            )
            for k in (0, 1)
        ]
        raised = [last.ankle_m[2] + self.size * height for height in SWING_HEIGHT_M]
        upward = spline(times, [a[0][2], *raised, b[0][2]], (a[1][2], a[2][2]), (b[1][2], b[2][2]))
        return lambda at: dual_numbers.stack([planar[0](at), planar[1](at), upward(at)])

    def pose(self, times: Array) -> FootPose:
        """The foot at times in s."""
        pitch = self.pitch(times)
        step = np.searchsorted([step.strike_s for step in self.steps], times, side="right") - 1
        on = (step >= 0) & (times <= np.array([step.off_s for step in self.steps])[step])
        rolled = (
            dual_numbers.where(pitch.value < 0, self._about(self.heel, pitch), self._about(self.ball, pitch))
            + np.array([step.ankle_m for step in self.steps])[step]
        )
        ankle = dual_numbers.where(on, rolled, Dual.constant(np.zeros((len(times), 3))))
        for k, swing in enumerate(self.swings):
            swinging = np.flatnonzero((step == k) & ~on)
            for whole, part in zip(ankle.orders, swing(times[swinging]).orders, strict=True):
                whole[swinging] = part
        yaw = Dual.constant(np.full(len(times), self.steps[0].yaw))
        return FootPose(ankle, yaw, pitch, self.toes(times))


def constant_rotation(yaw: float) -> Array:
    """(3, 3) rotation about the vertical."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _load(model: Body, steps: list[Step], feet: dict[str, _Foot], stride_s: float) -> LoadPlan:
    """Pressure from heel to toes under each foot, handed from foot to foot in double support."""
    size = float(model.scale.mean())
    share_knots: list[tuple] = []
    pressure_knots: dict[int, list[tuple]] = {0: [], 1: []}
    for step in steps:
        share_knots += [
            (step.strike_s, float(step.side)),
            (step.strike_s + DOUBLE_SUPPORT * stride_s, 1.0 - step.side),
        ]
        heel, ball = feet[SIDES[step.side]].heel[0], feet[SIDES[step.side]].ball[0]
        outward = -1.0 if step.side == 0 else 1.0
        heading = constant_rotation(step.yaw)[:2, :2]
        for at, x, y in (
            (0.0, heel + 0.01, 0.0),
            (FOOT_FLAT, heel + 0.035, 0.004),
            (HEEL_OFF, ball + 0.008 * size, 0.006),
            (0.5, ball + 0.020 * size, -0.003),
            (0.5 + DOUBLE_SUPPORT, ball + 0.030 * size, -0.012),
        ):
            local = heading @ np.array([x, outward * y * size])
            pressure_knots[step.side].append((step.strike_s + at * stride_s, step.ankle_m[:2] + local))
    share = path(share_knots)
    pressure = [path(pressure_knots[side]) for side in (0, 1)]

    def load(times: Array) -> Load:
        return Load(
            share(times).value,
            np.stack([p(times).value for p in pressure], axis=1),
            np.ones(len(times), dtype=bool),
        )

    return load


def _angles(
    stride_s: float, phase_s: float, rng: np.random.Generator
) -> dict[str, tuple[Curve, Curve, Curve]]:
    """Trunk and arms as sines of the stride, counted from right heel strike."""

    def wave(amplitude: float, part: float, per_stride: int = 1) -> Curve:
        """Largest at the part of the stride."""
        hz = per_stride / stride_s
        return sinusoid(
            amplitude * rng.uniform(0.9, 1.1), hz, np.pi / 2 - 2 * np.pi * hz * (phase_s + part * stride_s)
        )

    base = {
        **resting(),
        "pelvis": (0.0, 2.0, 0.0),
        "torso": (0.0, 2.0, 0.0),
        "right_forearm": (0.0, -26.0, 10.0),
        "left_forearm": (0.0, -26.0, -10.0),
        "right_upper_arm": (-8.0, 4.0, 6.0),
        "left_upper_arm": (8.0, 4.0, -6.0),
    }
    right, left = wave(1.0, 0.5), wave(1.0, 0.0)
    twist, twice = wave(1.0, 0.0), wave(1.0, 0.06, 2)
    lean = wave(1.0, 0.30)
    gains = [
        (
            right,
            {
                "right_upper_arm": (0.0, -19.0, 0.0),
                "right_forearm": (0.0, -11.0, 4.0),
                "right_hand": (2.0, -4.0, 1.0),
            },
        ),
        (
            left,
            {
                "left_upper_arm": (0.0, -19.0, 0.0),
                "left_forearm": (0.0, -11.0, -4.0),
                "left_hand": (-2.0, -4.0, -1.0),
            },
        ),
        (twist, {"pelvis": (0.0, 0.0, 4.5), "torso": (0.0, 0.0, -8.5), "head": (0.0, 0.0, 3.5)}),
        (
            twice,
            {
                "pelvis": (0.0, 1.2, 0.0),
                "torso": (0.0, 1.0, 0.0),
                "neck": (0.0, -1.0, 0.0),
                "head": (0.0, -1.0, 0.0),
            },
        ),
        (wave(1.0, 0.12), {"pelvis": (-3.5, 0.0, 0.0), "torso": (4.5, 0.0, 0.0), "neck": (-0.7, 0.0, 0.0)}),
        (lean, {"head": (1.0, 0.0, 0.0), "right_shank": (1.0, 0.0, 2.0), "left_shank": (1.0, 0.0, 2.0)}),
    ]
    return posture(base, gains, rng)
