"""The frame of progression of a motion: the horizontal axes that pelvis angles are told in.

Walking and running go along the path of the pelvis, also round a bend. Standing, squats, jumps and a treadmill go
nowhere: there the frame has the mean heading of pelvis and feet. So it has for backward and sideward steps, whose path
is not where the person faces. A capture turned about the vertical has its frame turned with it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.numerics.cardan import quaternion_matrices
from mbkf.numerics.windows import local_lines
from mbkf.sensors.contact.soles import sole_points

SMOOTHING_S = 0.5
"""Width of the window over which path and heading are smoothed (standard deviation): about half a stride, so that the
sway of the pelvis from step to step is no turn of the path."""

STILL_M_S, MOVING_M_S = 0.15, 0.3
"""Up to the first smoothed speed the pelvis stays, from the second one on it travels; very slow gait has 0.4 m/s."""

TRAVEL_HEIGHTS = 1.0
"""A person travels who gets further away than so many heights of the standing pelvis: two steps are more; a lunge or
rising from a chair is half of it."""

ASTRAY_RAD = float(np.deg2rad(45.0))
"""With a larger mean angle between path and body, the path is not where the person faces."""

BEND_RAD = float(np.deg2rad(30.0))
"""A path whose direction varies by more is a turn; what is left of the sway is a few degrees."""

SPIN_RAD = float(np.deg2rad(90.0))
"""Pelvis and feet that turn by more on the spot have no mean heading worth the name."""

PATH, HEADING, LABORATORY = "progression", "heading", "laboratory"
"""What a frame follows: the path of the pelvis, the heading of pelvis and feet, or the laboratory's x axis."""


PELVIS_FRAMES = ("progression", "lab")
"""Frames that can be asked for."""


@dataclass(frozen=True)
class Progression:
    """The frame of progression of a trial.

    Attributes:
        direction: What it follows: "progression" (the path), "heading" or "laboratory".
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
    place = slice(model.root.q.start, model.root.q.start + 3)
    soles = sole_points(model, q)
    feet = soles[:, :, 2] - soles[:, :, 0]
    feet = feet / np.linalg.norm(feet, axis=2, keepdims=True)
    pelvis = quaternion_matrices(q[:, place.stop : place.stop + 4])[:, :, 0]
    neutral = model.neutral()
    height_m = float(neutral[place][2] - sole_points(model, neutral[None])[..., 2].min())
    return frame_of(
        q[:, place][:, :2], (pelvis + feet.mean(axis=1))[:, :2], times_s, TRAVEL_HEIGHTS * height_m
    )


def frame_of(path_m: Array, facing: Array, times_s: Array, travel_m: float) -> Progression:
    """The frame of progression of a path.

    Args:
        path_m: (T, 2) horizontal positions of the pelvis, m; NaN where not known.
        facing: (T, 2) horizontal vectors along pelvis and feet; short ones count less.
        times_s: (T,) times, s.
        travel_m: Distance from where it began beyond which a person travels, m.
    """
    known = np.asarray(np.isfinite(np.hstack([path_m, facing])).all(axis=1))
    if not known.any():
        return _constant(HEADING, 0.0, len(known))
    dt_s = float(np.median(np.diff(times_s))) if len(times_s) > 1 else SMOOTHING_S
    origin_m = path_m[known][0]
    place, velocity = (each[known] for each in local_lines(path_m - origin_m, known, dt_s, SMOOTHING_S))
    faced = _unit(local_lines(facing, known, dt_s, SMOOTHING_S)[0][known])
    speed, along = np.linalg.norm(velocity, axis=1), _unit(velocity)
    moving = speed > MOVING_M_S
    travels = bool(moving.any()) and float(np.linalg.norm(place, axis=1).max()) > travel_m
    if travels and _between(along[moving], faced[moving]).mean() < ASTRAY_RAD:
        share = np.clip((speed - STILL_M_S) / (MOVING_M_S - STILL_M_S), 0.0, 1.0)[:, None]
        ahead, direction, most, counted = share * along + (1.0 - share) * faced, PATH, BEND_RAD, moving
        mean = _velocity(path_m[known][moving] - origin_m, times_s[known][moving])
    else:
        ahead, direction, most, counted = faced, HEADING, SPIN_RAD, np.ones(len(faced), dtype=bool)
        mean = facing[known].mean(axis=0)
    angle = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
    if np.ptp(angle[counted]) > most:
        heading = np.interp(times_s, times_s[known], angle)
        return Progression(direction, heading, np.gradient(heading, times_s))
    return _constant(direction, float(np.arctan2(mean[1], mean[0])), len(known))


def _constant(direction: str, heading_rad: float, frames: int) -> Progression:
    return Progression(direction, np.full(frames, heading_rad), np.zeros(frames))


def _between(first: Array, second: Array) -> Array:
    """(T,) angles between horizontal vectors (T, 2), without sign, rad."""
    across = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return np.abs(np.arctan2(across, (first * second).sum(axis=1)))


def _velocity(positions_m: Array, times_s: Array) -> Array:
    """(2,) direction of the straight line in time that fits positions (T, 2) best; its length has no meaning."""
    return np.asarray((times_s - times_s.mean()) @ (positions_m - positions_m.mean(axis=0)))


def _unit(vectors: Array) -> Array:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0.0, length, 1.0)
