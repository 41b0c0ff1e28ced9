"""The frame of progression of a motion: the horizontal axes of pelvis angles.

Walking and running go along the path of the pelvis, also round a bend. Standing, squats, jumps and a treadmill go
nowhere: there the frame has the mean heading of pelvis and feet. So it has for backward and sideward steps, whose path
is not where the person faces. A capture turned about the vertical has its frame turned with it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.model.body import Body
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.numerics.windows import local_lines
from mbkf.sensors.contact.soles import sole_points

SMOOTHING_S, SMOOTHING_HEIGHTS = 0.5, 0.5
"""Least width of the window over which path and heading are smoothed (standard deviation), and the way that a person
goes in it at least, in heights of the standing pelvis: about half a stride, at slow gait too, so that the sway of the
pelvis from step to step does not count as a turn."""

TURNING_WINDOW = 0.5
"""Share of that window with which the heading of a turn is smoothed: over the whole one, a sharp bend would be cut."""

MOVING_M_S, MOVING_SHARE = 0.1, 0.25
"""The pelvis travels in frames in which its smoothed speed is above the first, and above this share of its largest one
in the trial; slow gait of patients has 0.25 m/s. Below half of that it stays."""

TRAVEL_HEIGHTS = 1.0
"""A person travels who gets further away than so many heights of the standing pelvis: two steps are more; a lunge or
rising from a chair is half of it."""

ASTRAY_RAD = float(np.deg2rad(45.0))
"""With a larger mean angle between path and body, the path is not where the person faces."""

BEND_RAD = float(np.deg2rad(30.0))
"""A path whose direction varies by more is a turn; the remaining sway is a few degrees."""

SPIN_RAD = float(np.deg2rad(60.0))
"""Pelvis and feet that turn by more on the spot have no mean heading worth the name; a swing of the pelvis over
standing feet counts half."""

PATH, HEADING, LABORATORY = "progression", "heading", "laboratory"
"""Reference of a frame: the path of the pelvis, the heading of pelvis and feet, or the laboratory's x axis."""

PELVIS_FRAMES = ("progression", "lab")
"""Frames that can be asked for."""


@dataclass(frozen=True)
class Progression:
    """The frame of progression of a trial.

    Attributes:
        direction: Its reference: "progression" (the path), "heading" or "laboratory".
        heading_rad: (T,) angle of its forward axis from the world's x axis about the vertical, rad, without jumps;
            constant unless the person turns.
        turning_rad_s: (T,) its rate.
    """

    direction: str
    heading_rad: Array
    turning_rad_s: Array


def kind_of(direction: str, heading_rad: Array) -> str:
    """A direction and its (T,) heading in words: a path or a heading, and whether it turns."""
    turns = len(heading_rad) > 0 and bool(np.ptp(heading_rad) > 0.0)
    if direction == PATH:
        return "turning path" if turns else "straight path"
    if direction == HEADING:
        return "turning heading" if turns else "mean heading"
    return LABORATORY


def laboratory(frames: int) -> Progression:
    """The laboratory's own axes, for so many frames."""
    return _constant(LABORATORY, 0.0, frames)


def pelvis_frame(asked: str, model: Body, q: Array, times_s: Array) -> Progression:
    """The frame that is asked for, of a motion.

    Args:
        asked: One of ``PELVIS_FRAMES``.
        model: The body.
        q: (T, nq) configurations; NaN where untracked.
        times_s: (T,) times, s.
    """
    return laboratory(len(q)) if asked == "lab" else progression_of(model, q, times_s)


def progression_of(model: Body, q: Array, times_s: Array) -> Progression:
    """The frame of progression of a motion.

    Args:
        model: The body.
        q: (T, nq) configurations; NaN where untracked.
        times_s: (T,) times, s.
    """
    return frame_of(*path_and_facing(model, q), times_s, standing_height(model))


def path_and_facing(model: Body, q: Array) -> tuple[Array, Array]:
    """(T, 2) horizontal positions of the pelvis, m, and (T, 2) horizontal vectors along pelvis and feet.

    Args:
        model: The body.
        q: (T, nq) configurations; NaN where untracked.
    """
    place = slice(model.root.q.start, model.root.q.start + 3)
    soles = sole_points(model, q)
    feet = soles[:, :, 2] - soles[:, :, 0]
    feet = feet / np.linalg.norm(feet, axis=2, keepdims=True)
    pelvis = quaternion_matrices(q[:, place.stop : place.stop + 4])[:, :, 0]
    return q[:, place][:, :2], (pelvis + feet.mean(axis=1))[:, :2]


def standing_height(model: Body) -> float:
    """Height of the pelvis above the soles in the neutral posture, m."""
    neutral = model.neutral()
    place = model.root.q.start + 2
    return float(neutral[place] - sole_points(model, neutral[None])[..., 2].min())


def frame_of(path_m: Array, facing: Array, times_s: Array, height_m: float) -> Progression:
    """The frame of progression of a path.

    Args:
        path_m: (T, 2) horizontal positions of the pelvis, m; NaN where not known.
        facing: (T, 2) horizontal vectors along pelvis and feet; short ones count less.
        times_s: (T,) times, s.
        height_m: Height of the pelvis in standing, m.
    """
    known = np.asarray(np.isfinite(path_m).all(axis=1) & np.isfinite(facing).all(axis=1))
    if not known.any():
        return _constant(HEADING, 0.0, len(known))
    dt_s = float(np.median(np.diff(times_s))) if len(times_s) > 1 else SMOOTHING_S
    way = _Way(path_m - path_m[known][0], facing, known, dt_s)
    width_s = way.width_s(SMOOTHING_HEIGHTS * height_m)
    place, velocity = way.path(width_s)
    moving = _moving(velocity)
    travels = bool(moving.any()) and float(np.linalg.norm(place, axis=1).max()) > TRAVEL_HEIGHTS * height_m
    on_path = travels and _between(velocity[moving], way.faced(width_s)[moving]).mean() < ASTRAY_RAD
    if on_path:
        direction, most, counted = PATH, BEND_RAD, moving
        mean = _velocity(way.path_m[known][moving], times_s[known][moving])
    else:
        direction, most, counted = HEADING, SPIN_RAD, np.ones(len(place), dtype=bool)
        mean = facing[known].mean(axis=0)
    width_s = width_s if on_path else SMOOTHING_S
    if np.ptp(_angle(way.ahead(width_s, on_path))[counted]) > most:
        angle = _angle(way.ahead(TURNING_WINDOW * width_s, on_path))
        heading = np.interp(times_s, times_s[known], angle)
        return Progression(direction, heading, np.gradient(heading, times_s))
    return _constant(direction, float(np.arctan2(mean[1], mean[0])), len(known))


@dataclass(frozen=True)
class _Way:
    """Path and heading of a person, in the n frames in which both are known.

    Attributes:
        path_m: (T, 2) horizontal positions of the pelvis.
        facing: (T, 2) horizontal vectors along pelvis and feet.
        known: (T,) where both are known.
        dt_s: Time between frames.
    """

    path_m: Array
    facing: Array
    known: BoolArray
    dt_s: float

    def path(self, width_s: float) -> tuple[Array, Array]:
        """(n, 2) positions and velocities, smoothed over a window."""
        place, velocity = local_lines(self.path_m, self.known, self.dt_s, width_s)
        return place[self.known], velocity[self.known]

    def faced(self, width_s: float) -> Array:
        """(n, 2) unit vectors along pelvis and feet, smoothed over a window."""
        return _unit(local_lines(self.facing, self.known, self.dt_s, width_s)[0][self.known])

    def ahead(self, width_s: float, on_path: bool) -> Array:
        """(n, 2) along the path where the pelvis travels, if it is to count, else along pelvis and feet."""
        faced = self.faced(width_s)
        if not on_path:
            return faced
        velocity = self.path(width_s)[1]
        speed = np.linalg.norm(velocity, axis=1, keepdims=True)
        share = np.clip(2.0 * speed / _least_speed(speed) - 1.0, 0.0, 1.0)
        return share * _unit(velocity) + (1.0 - share) * faced

    def width_s(self, way_m: float) -> float:
        """Width of the window: the usual one, or as long as it takes to go a way at the person's usual speed."""
        velocity = self.path(SMOOTHING_S)[1]
        moving = velocity[_moving(velocity)]
        usual = np.median(np.linalg.norm(moving, axis=1)) if len(moving) else np.inf
        return max(SMOOTHING_S, way_m / float(usual))


def _constant(direction: str, heading_rad: float, frames: int) -> Progression:
    return Progression(direction, np.full(frames, heading_rad), np.zeros(frames))


def _least_speed(speed: Array) -> float:
    """Speed from which the pelvis travels, m/s, where it has these smoothed speeds."""
    return max(MOVING_M_S, MOVING_SHARE * float(speed.max()))


def _moving(velocity: Array) -> BoolArray:
    """(T,) frames in which the pelvis travels, at these smoothed velocities (T, 2)."""
    speed = np.linalg.norm(velocity, axis=1)
    return np.asarray(speed > _least_speed(speed))


def _between(first: Array, second: Array) -> Array:
    """(T,) angles between horizontal vectors (T, 2), without sign, rad."""
    across = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return np.abs(np.arctan2(across, (first * second).sum(axis=1)))


def _velocity(positions_m: Array, times_s: Array) -> Array:
    """(2,) direction of the straight line in time that fits positions (T, 2) best; its length has no meaning."""
    return np.asarray((times_s - times_s.mean()) @ (positions_m - positions_m.mean(axis=0)))


def _angle(vectors: Array) -> Array:
    """(T,) angles of horizontal vectors (T, 2) from the x axis, without jumps, rad."""
    return np.asarray(np.unwrap(np.arctan2(vectors[:, 1], vectors[:, 0])))


def _unit(vectors: Array) -> Array:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0.0, length, 1.0)
