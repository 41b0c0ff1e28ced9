"""Movements of made persons: measured ones put on another body, and others made by hand, such as a jump."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import butter, sosfiltfilt

from benchmarks.foreign.making.jump import jump
from benchmarks.foreign.making.legs import Stance, legs_into
from benchmarks.foreign.making.loads import pressure, shares
from benchmarks.foreign.making.osim_body import OsimBody
from benchmarks.foreign.making.paths import minimum_jerk
from benchmarks.foreign.making.persons import STANDING_DEG, Person, tilted
from benchmarks.foreign.making.record import RATE_HZ, Motion, needed, standing_points
from benchmarks.foreign.truth import Truth
from mbkf.conventions import SIDES, Array, BoolArray

MEASURED = ("walk", "squat", "run")
MADE = ("sit_to_stand", "stairs", "reach")
ADDED = ("jump",)
"""Made by hand, too, with draws of their own, so that the others stay as they were."""

CUT_OFF_HZ = 6.0
"""Of the correction of the pelvis's path that keeps feet where they stand."""

LEANS, LEAN_HZ = 6, 0.35
"""Number of turns that balance a standing body about its ankles, and the cut-off of the turn."""

PLACES = ("pelvis_tx", "pelvis_ty", "pelvis_tz")


@dataclass(frozen=True)
class Measured:
    """A measured movement of the body that it was measured on.

    Attributes:
        body: That body.
        truth: Its coordinates.
        contacts: (T, 2) right and left foot on the ground.
        floor_m: Height of the floor.
    """

    body: OsimBody
    truth: Truth
    contacts: BoolArray
    floor_m: float


def standing(person: Person, body: OsimBody) -> Array:
    """(C,) coordinates of the standing person, with the feet on a floor at height 0.

    Args:
        person: The person.
        body: The person's body.
    """
    values = {name: np.zeros(1) for name in body.names}
    values |= {name: np.array([np.deg2rad(angle)]) for name, angle in STANDING_DEG.items()}
    for side in SIDES:
        values[f"knee_angle_{side}_beta"] = values[f"knee_angle_{side}"]
    values = tilted(person, values)
    q = np.array([values[name][0] for name in body.names])
    q[body.column("pelvis_ty")] = -min(foot[1] for foot in feet(body, q))
    return q


def feet(body: OsimBody, q: Array) -> Array:
    """(2, 3) middle of heel and toes' joint of both feet.

    Args:
        body: The body.
        q: (C,) its pose.
    """
    body.move(q)
    return np.array([0.5 * (body.frame(f"calcn_{s}")[1] + body.frame(f"toes_{s}")[1]) for s in SIDES])


def leg_length(body: OsimBody, q: Array) -> float:
    """Height of the hips above the feet's middle in a standing pose, m.

    Args:
        body: The body.
        q: (C,) the pose.
    """
    down = feet(body, q)[:, 1].mean()
    return float(np.mean([body.frame(f"femur_{s}")[1][1] for s in SIDES]) - down)


def transferred(person: Person, body: OsimBody, measured: Measured) -> Motion:
    """A measured movement on another body: its joint angles, and feet that step as before, in proportion to the legs.

    Args:
        person: The person.
        body: The person's body.
        measured: The movement.
    """
    truth = measured.truth
    stand = standing(person, body)
    values = {
        name: truth.coordinate(name) if truth.has(name) else np.zeros(len(truth.q)) for name in body.names
    }
    for name, kept in person.stiff.items():
        mean = STANDING_DEG.get(name, 0.0)
        values[name] = np.deg2rad(mean) + kept * (values[name] - np.deg2rad(mean))
    values |= {f"mtp_angle_{side}": np.zeros(len(truth.q)) for side in SIDES}
    for side in SIDES:
        values[f"knee_angle_{side}_beta"] = values[f"knee_angle_{side}"]
    values = tilted(person, values)
    q = np.column_stack([values[name] for name in body.names])
    columns = [body.column(name) for name in PLACES]
    ratio = leg_length(body, stand) / leg_length(measured.body, _standing_of(measured.body))
    share = shares(measured.contacts)
    stepped = np.where(share.sum(axis=1, keepdims=True) > 0.0, share, 0.5)
    weight = sosfiltfilt(butter(2, CUT_OFF_HZ, fs=RATE_HZ, output="sos"), stepped, axis=0)
    theirs = np.array([feet(measured.body, one) for one in _coordinates(measured)])
    theirs[:, :, 1] -= measured.floor_m
    away = np.zeros((len(q), 3))
    for t in range(len(q)):
        away[t] = weight[t] @ (ratio * theirs[t] - feet(body, q[t]))
    q[:, columns] += sosfiltfilt(butter(2, CUT_OFF_HZ, fs=RATE_HZ, output="sos"), away, axis=0)
    still = bool(measured.contacts.all())
    return upright(body, Motion(q, measured.contacts, np.zeros((len(q), 2)), balanced=still))


def upright(body: OsimBody, motion: Motion) -> Motion:
    """A movement of standing feet with the whole body turned about the ankles, so that pressure lies below the feet.

    Args:
        body: The body.
        motion: The movement; others than of standing feet stay as they are.
    """
    if not motion.contacts.all():
        return motion
    turned = [body.column(name) for name in ("pelvis_tilt", "ankle_angle_r", "ankle_angle_l")]
    places = [body.column(name) for name in PLACES]
    for _ in range(LEANS):
        points = np.asarray(standing_points(body, motion).mean(axis=1))
        total = needed(body, motion)
        ahead: Array = pressure(total, points[:, 1])[0] - points[:, 0]
        lean = sosfiltfilt(butter(2, LEAN_HZ, fs=RATE_HZ, output="sos"), ahead / motion.q[:, places[1]])
        ankles = np.array([feet(body, one).mean(axis=0) for one in motion.q])
        q = motion.q.copy()
        q[:, turned] += lean[:, None] * np.array([1.0, -1.0, -1.0])
        q[:, places] += ankles - np.array([feet(body, one).mean(axis=0) for one in q])
        motion = replace(motion, q=q)
    return motion


def _coordinates(measured: Measured) -> Array:
    truth = measured.truth
    zero = np.zeros(len(truth.q))
    return np.column_stack(
        [truth.coordinate(name) if truth.has(name) else zero for name in measured.body.names]
    )


def _standing_of(body: OsimBody) -> Array:
    q = np.zeros(len(body.names))
    for name, angle in STANDING_DEG.items():
        q[body.column(name)] = np.deg2rad(angle)
    return q


def made(name: str, person: Person, body: OsimBody) -> Motion:
    """A movement made by hand, of feet that stand where they are put and a body in balance above them.

    Args:
        name: One of :data:`MADE` or :data:`ADDED`.
        person: The person.
        body: The person's body.
    """
    makers: Mapping[str, Callable[[OsimBody, Array], tuple[Stance, dict[str, Array]]]] = {
        "sit_to_stand": _sit_to_stand,
        "stairs": _stairs,
        "reach": _reach,
        "jump": _jump,
    }
    stand = standing(person, body)
    stance, moved = makers[name](body, stand)
    q = np.repeat(stand[None], len(stance.height_m), axis=0)
    for coordinate, degrees in moved.items():
        q[:, body.column(coordinate)] += np.deg2rad(degrees)
    return Motion(legs_into(body, q, stance, stand), stance.contacts, stance.heights_m, balanced=True)


def _jump(body: OsimBody, stand: Array) -> tuple[Stance, dict[str, Array]]:
    """A jump on the spot."""
    return jump(leg_length(body, stand), float(stand[body.column("pelvis_ty")]), feet(body, stand))


def _times(duration_s: float) -> Array:
    return np.arange(round(duration_s * RATE_HZ) + 1) / RATE_HZ


def _planted(body: OsimBody, stand: Array, count: int) -> Array:
    """(T, 2, 3) feet that stay where they stand."""
    return np.repeat(feet(body, stand)[None], count, axis=0)


def _sit_to_stand(body: OsimBody, stand: Array) -> tuple[Stance, dict[str, Array]]:
    """From the moment at which the seat is left, with the trunk forward, to standing."""
    t = _times(2.4)
    rise = minimum_jerk(t, [(0.2, 0.0), (2.0, 1.0)])
    legs = leg_length(body, stand)
    lean = minimum_jerk(t, [(0.0, 1.0), (0.4, 1.08), (2.0, 0.0)])
    height = stand[body.column("pelvis_ty")] - legs * (0.03 + 0.39 * (1.0 - rise))
    arms = {f"arm_flex_{side}": 45.0 * lean for side in SIDES}
    moved = {
        "pelvis_tilt": -32.0 * lean,
        "lumbar_extension": -14.0 * lean,
        "lumbar_bending": 2.0 * lean,
        **arms,
    }
    contacts = np.ones((len(t), 2), dtype=bool)
    return Stance(
        height, _planted(body, stand, len(t)), contacts, np.zeros((len(t), 2)), np.full(len(t), 0.5)
    ), moved


def _stairs(body: OsimBody, stand: Array) -> tuple[Stance, dict[str, Array]]:
    """One step up: the right foot stands on it, the left one follows."""
    t = _times(3.0)
    legs = leg_length(body, stand)
    step, ahead = 0.19 * legs, 0.28 * legs
    paths = _planted(body, stand, len(t))
    paths[:, 0] += (0.5 * ahead, step, 0.0)
    swing = minimum_jerk(t, [(0.95, 0.0), (2.1, 1.0)])
    paths[:, 1, 0] += ahead * (swing - 0.5)
    paths[:, 1, 1] += step * minimum_jerk(t, [(0.95, 0.0), (1.75, 1.0)])
    paths[:, 1, 1] += 0.25 * step * np.sin(np.pi * swing) ** 2
    rise = minimum_jerk(t, [(0.7, 0.0), (2.4, 1.0)])
    lowered = stand[body.column("pelvis_ty")] - legs * (0.13 - 0.09 * rise)
    height = lowered + step * rise
    right = minimum_jerk(t, [(0.0, 0.2), (0.9, 1.0), (2.15, 1.0), (2.9, 0.5)])
    lifted = (t > 0.95) & (t < 2.1)
    contacts = np.column_stack([np.ones(len(t), dtype=bool), ~lifted])
    heights = np.column_stack([np.full(len(t), step), np.where(t < 1.5, 0.0, step)])
    lean = minimum_jerk(t, [(0.0, 0.6), (0.9, 1.0), (2.4, 0.0)])
    moved = {
        "pelvis_tilt": -10.0 * lean,
        "lumbar_extension": -6.0 * lean,
        "pelvis_rotation": 5.0 * (rise - 0.5),
        "arm_flex_l": 20.0 * lean,
        "arm_flex_r": -12.0 * lean,
    }
    return Stance(height, paths, contacts, heights, right), moved


def _reach(body: OsimBody, stand: Array) -> tuple[Stance, dict[str, Array]]:
    """Both arms forward, then the right one up and across while the trunk turns, and back; knees bend a little."""
    t = _times(4.0)
    legs = leg_length(body, stand)
    first = minimum_jerk(t, [(0.2, 0.0), (1.2, 1.0), (2.4, 0.0)])
    second = minimum_jerk(t, [(1.4, 0.0), (2.6, 1.0), (3.8, 0.0)])
    height = stand[body.column("pelvis_ty")] - legs * (0.03 + 0.08 * first + 0.02 * second)
    moved = {
        "pelvis_tilt": -18.0 * first - 4.0 * second,
        "lumbar_extension": -22.0 * first + 6.0 * second,
        "lumbar_bending": -10.0 * second,
        "lumbar_rotation": 28.0 * second,
        "arm_flex_r": 80.0 * first + 115.0 * second,
        "arm_flex_l": 75.0 * first + 10.0 * second,
        "arm_add_r": 18.0 * first + 15.0 * second,
        "arm_add_l": 15.0 * first,
        "arm_rot_r": 20.0 * second - 10.0 * first,
        "elbow_flex_r": 25.0 * first + 35.0 * second,
        "elbow_flex_l": 20.0 * first + 15.0 * second,
    }
    contacts = np.ones((len(t), 2), dtype=bool)
    share = 0.5 + 0.2 * second
    return Stance(height, _planted(body, stand, len(t)), contacts, np.zeros((len(t), 2)), share), moved
