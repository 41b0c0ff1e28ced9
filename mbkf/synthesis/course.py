"""A motion put together from parts: footwork, posture and balance are appended part by part, then made a plan."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.model.body import Body
from mbkf.synthesis.balance import HorizontalPath
from mbkf.synthesis.curves import Curve, added, path, sinusoid, spline
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.footwork import Footwork, Spot
from mbkf.synthesis.inverse_kinematics import InverseKinematics
from mbkf.synthesis.plan import MotionPlan, resting, with_oscillation
from mbkf.synthesis.standing import Angles, posture

KNEE_RAD = np.deg2rad(12.0)
"""Flexion of the straighter knee at which the body stands."""

COARSE_S, ROUNDS = 0.04, 6
"""Grid and iterations of the search for the body's height."""

CALM_S = 0.18
"""Standard deviation of the smoothing of the height."""

TRUNK_S, HEAD_S = 0.12, 0.22
"""By how much trunk and head turn before the pelvis."""

PELVIS_S = 0.10
"""By how much the pelvis turns before the feet."""


class Course:
    """A motion under construction.

    Attributes:
        model: The body.
        rng: Source of the differences between persons and trials.
        size: Its mean scale factor.
        feet: The footwork.
        now_s: End of the parts so far.
    """

    def __init__(self, model: Body, rng: np.random.Generator) -> None:
        """Begins with both feet side by side.

        Args:
            model: The body.
            rng: Source of the differences.
        """
        self.model, self.rng, self.size = model, rng, float(model.scale.mean())
        half, out = rng.uniform(0.105, 0.12) * self.size, np.deg2rad(rng.uniform(4, 8))
        spots = (Spot(np.array([0.0, -half]), -out), Spot(np.array([0.0, half]), out))
        self.feet, self.now_s = Footwork(model, spots, rng), 0.0
        self._gains: list[tuple[Curve, Angles]] = []

    def bend(self, curve: Curve, change_deg: Angles) -> None:
        """Adds a curve (0…1) times a change of joint angles in degrees."""
        self._gains.append((curve, change_deg))

    def heading(self) -> float:
        """Where the body faces, rad: the mean of the feet."""
        return 0.5 * (self.feet.spot(0).yaw + self.feet.spot(1).yaw)

    def plan(self, seconds: float) -> MotionPlan:
        """The plan of the parts so far.

        Args:
            seconds: Duration, s.
        """
        angles = with_oscillation(posture(resting(), self._gains, self.rng), self.rng, 0.8)
        for joint, curve in (
            ("pelvis", self._facing(PELVIS_S)),
            ("torso", self._leading(TRUNK_S)),
            ("head", self._leading(HEAD_S)),
        ):
            x, y, z = angles[joint]
            angles[joint] = (x, y, added(z, curve))
        height = standing_height(self.model, angles, self.feet, seconds)
        return MotionPlan(0.0, seconds, angles, self.feet.poses, height, self.feet.load, KNEE_RAD)

    def _facing(self, ahead_s: float) -> Curve:
        """Yaw of the pelvis: half of each foot's turn, a little before the foot."""
        first = 0.5 * (self.feet.first[0].yaw + self.feet.first[1].yaw)
        return added(
            sinusoid(0.0, 1.0, 0.0, first),
            *(
                path([(lift - 2.0 * ahead_s, 0.0), (land - 0.5 * ahead_s, 0.5 * turn)])
                for lift, land, turn in self.feet.turned()
            ),
        )

    def _leading(self, ahead_s: float) -> Curve:
        """Lead of a segment that turns before the one below it."""
        later = self._facing(PELVIS_S)
        return lambda times: later(times + ahead_s) - later(times)


def spare(seconds: float, needed_s: float, what: str) -> float:
    """Time that is left over for standing still, s.

    Args:
        seconds: Duration of the trial, s.
        needed_s: Duration of the parts, s.
        what: Their name, for the message.

    Raises:
        InvalidInput: The trial is too short.
    """
    if seconds < needed_s:
        raise InvalidInput(f"{what} takes {needed_s:.2f} s, got {seconds:g} s")
    return seconds - needed_s


def standing_height(
    model: Body, angles: dict[str, tuple[Curve, Curve, Curve]], feet: Footwork, seconds: float
) -> Curve:
    """Height of the centre of mass, m: smooth, and about as high as the legs reach.

    Args:
        model: The body.
        angles: Joint angles, rad.
        feet: The footwork.
        seconds: Duration, s.
    """
    count = max(12, round(seconds / COARSE_S)) + 1
    times = np.linspace(0.0, seconds, count)
    load, poses = feet.load(times), feet.poses(times)
    joints = {joint: tuple(curve(times) for curve in axes) for joint, axes in angles.items()}
    kinematics = InverseKinematics(model)
    posture = kinematics.posture(joints, poses)
    usual = 0.95 * float(model.scale.mean())
    flat = Dual.constant(np.full(count, usual))
    plane = HorizontalPath([(0.0, seconds)], 2 * COARSE_S)
    plane.solve(times, load.total_pressure, flat, np.zeros((count, 2)))
    across, height, start = plane(times).value, usual + load.mean_surface, None
    for _ in range(ROUNDS):
        pose = kinematics.pose(Dual(np.column_stack([across, height])), posture, start)
        start = pose.origins["pelvis"].value
        height = height + 0.9 * (np.cos(KNEE_RAD / 2) - pose.reach) * kinematics.leg_length("r")
    step = times[1]
    low = _lowest(height, round(1.5 * CALM_S / step))
    calm = _calmed(low, CALM_S / step)
    every = max(1, round(0.12 / step))
    knots = np.unique(np.r_[0:count:every, count - 1])
    bends = (2 * (calm[1] - calm[0]) / step**2, 2 * (calm[-2] - calm[-1]) / step**2)
    return spline(times[knots].tolist(), calm[knots].tolist(), (0.0, bends[0]), (0.0, bends[1]))


def _lowest(values: Array, reach: int) -> Array:
    """(T,) least value within ``reach`` samples."""
    padded = np.pad(values, reach, mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1).min(axis=1)


def _calmed(values: Array, deviation: float) -> Array:
    """(T,) values smoothed by a Gaussian of so many samples."""
    reach = int(np.ceil(3 * deviation))
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / deviation) ** 2)
    return np.convolve(np.pad(values, reach, mode="reflect"), weights / weights.sum(), mode="valid")
