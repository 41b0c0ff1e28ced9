"""Kneeling down on one knee out of a long stride stance, a hand on the floor, and up again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.model.body import Body
from mbkf.synthesis import dual_numbers
from mbkf.synthesis.contact import Load, LoadPlan, sole_outline
from mbkf.synthesis.course import spare
from mbkf.synthesis.curves import Curve, added, path, scaled, sinusoid
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.hands import held_hand, palm
from mbkf.synthesis.holding import Hold
from mbkf.synthesis.inverse_kinematics import SIDE_NAMES, FootPose, InverseKinematics, Pose
from mbkf.synthesis.plan import FeetPlan, MotionPlan, resting, with_oscillation
from mbkf.synthesis.standing import Angles, constant, posture, pressed
from mbkf.synthesis.support import Support

DOWN_S, HAND_S, BEAR_S = 1.4, 1.2, 0.5
"""Times in which the knee goes down, then the hand, and in which each takes its load; backwards on the way up."""

BOW_FIRST_S, REACH_S = 0.3, 1.0
"""By how much the trunk is bowed before the hand is down, and the time in which the arm reaches for the floor."""

QUIET_S, LEAST_HOLD_S = 0.2, 2.2 * BEAR_S
"""Standing at both ends, and the shortest time with the hand on the floor."""

KNEE_M, KNEE_X_M = 0.055, -0.29
"""Centre of the knee over the floor, and from the front ankle, of a body of the reference size."""

STANCE_DEG, KNEELING_DEG = 38.0, 76.0
"""Pitch of the rear foot."""

APEX_M = 1.8
"""Height at which the feet's forces point: so far apart, they would slip if they pointed at the low centre of mass."""

HAND_M, FINGERS_M = (0.36, 0.08), 0.16
"""Hand from the knee (ahead, outward), and fingertips from the wrist, of a body of the reference size."""

BOWED_DEG = {
    "pelvis": (0.0, 34.0, 0.0),
    "torso": (0.0, 38.0, 0.0),
    "neck": (0.0, -14.0, 0.0),
    "head": (0.0, -16.0, 0.0),
}
"""Change of the joint angles (x, y, z) as the hand goes down."""

SUNK_DEG = {"pelvis": (0.0, 14.0, 0.0), "torso": (0.0, 10.0, 0.0), "head": (0.0, -10.0, 0.0)}
"""Change as the knee goes down."""


@dataclass(frozen=True)
class _Times:
    """When the knee meets the floor, the hand does, the hand leaves it, the knee does, s."""

    knee: float
    hand: float
    lifted: float
    risen: float

    def there(self, start: float, end: float, takes_s: float, smooth: int = 2) -> Curve:
        """0 until ``takes_s`` before the start, 1 between start and end."""
        return path([(start - takes_s, 0.0), (start, 1.0), (end, 1.0), (end + takes_s, 0.0)], smooth)


def kneel_plan(model: Body, seconds: float, rng: np.random.Generator) -> MotionPlan:
    """One knee to the floor, then the fingertips of the same side, and back to the stance.

    Args:
        model: The body.
        seconds: Duration, s.
        rng: Source of the differences.

    Raises:
        InvalidInput: The time is too short.
    """
    needed = 2.0 * (QUIET_S + DOWN_S + HAND_S) + LEAST_HOLD_S
    rest = spare(seconds, needed, "kneeling down and standing up")
    knee_s = QUIET_S + DOWN_S + rng.uniform(0.0, 0.4) * rest
    times = _Times(knee_s, knee_s + HAND_S, seconds - knee_s - HAND_S, seconds - knee_s)
    size, side = float(model.scale.mean()), int(rng.integers(2))
    outward = -1.0 if side == 0 else 1.0
    name = SIDE_NAMES[SIDES[side]]
    feet, knee = _feet(model, side, times, rng)
    floor = np.array([knee[0], knee[1], 0.0])
    wrist = knee + size * np.array([HAND_M[0], outward * HAND_M[1], FINGERS_M - KNEE_M])
    held = times.there(times.hand, times.lifted, REACH_S, smooth=3)
    sunk = times.there(times.knee, times.risen, DOWN_S)
    bowed = times.there(times.hand - BOW_FIRST_S, times.lifted + BOW_FIRST_S, HAND_S)
    down = added(scaled(0.6, sunk), scaled(0.4, bowed))
    thigh = float(np.linalg.norm(InverseKinematics(model).offset[f"{name}_shank"]))
    on_knee, on_hand = rng.uniform(0.46, 0.54), rng.uniform(0.10, 0.16)

    def missed(at: Array, pose: Pose) -> Array:
        over = pose.origins[f"{name}_thigh"].value - knee
        length = np.linalg.norm(over, axis=1)
        return np.column_stack([np.zeros(len(at)), (length - thigh) * length / over[:, 2]])

    angles = with_oscillation(posture(resting(), [(sunk, SUNK_DEG), (bowed, _bowed(side))], rng), rng, 0.6)
    still = sinusoid(np.deg2rad(0.02), 0.5, rng.uniform(0, 6.28))
    angles[f"{name}_shank"] = (still, still, angles[f"{name}_shank"][2])
    return MotionPlan(
        start_s=0.0,
        end_s=seconds,
        angles=angles,
        feet=feet,
        height=added(sinusoid(0.0, 1.0, 0.0, 0.85 * size), scaled(-0.42 * size, down)),
        load=_load(model, feet, side, times, rng),
        straightest_rad=np.deg2rad(14.0),
        supports=(
            _on_floor(f"{name}_knee", times.knee, times.risen, on_knee, floor),
            _on_floor(f"{name}_hand", times.hand, times.lifted, on_hand, palm(size, wrist, 0.0, FINGERS_M)),
        ),
        hold=Hold(
            missed,
            lambda at: ((at > times.knee) & (at < times.risen)).astype(float),
            lambda at: ((at < times.knee - 0.8) | (at > times.risen + 0.8)).astype(float),
            {},
        ),
        hands=held_hand(model, side, held, wrist, 0.0),
    )


def _on_floor(name: str, start: float, end: float, share: float, point: Array) -> Support:
    """A part of the body that bears on a point of the floor for a while.

    Args:
        name: Name of the part.
        start: When it meets the floor, s.
        end: When it leaves it, s.
        share: Greatest part of the load.
        point: (3,) where, m.
    """
    bears = path([(start, 0.0), (start + BEAR_S, share), (end - BEAR_S, share), (end, 0.0)])
    return Support(name, lambda times: bears(times).value, lambda times: np.tile(point, (len(times), 1)))


def _bowed(side: int) -> Angles:
    """Bowing to a hand on the floor: a little to its side, the other hand on the front thigh."""
    outward, other = (-1.0, "left") if side == 0 else (1.0, "right")
    x, y, z = BOWED_DEG["torso"]
    return {
        **BOWED_DEG,
        "torso": (x - 6.0 * outward, y, z - 25.0 * outward),
        f"{other}_upper_arm": (0.0, -50.0, 0.0),
        f"{other}_forearm": (0.0, -55.0, 0.0),
    }


def _feet(model: Body, side: int, times: _Times, rng: np.random.Generator) -> tuple[FeetPlan, Array]:
    """The front foot flat, the rear one on its ball, and the (3,) place of the rear knee on the floor, m.

    Args:
        model: The body.
        side: Kneeling side, 0 right, 1 left.
        times: When knee and hand meet and leave the floor.
        rng: Source of small differences.
    """
    size, name = float(model.scale.mean()), SIDE_NAMES[SIDES[side]]
    offset, sign = InverseKinematics(model).offset, -1.0 if side == 0 else 1.0
    half, yaw = rng.uniform(0.085, 0.10) * size, np.deg2rad(rng.uniform(2.0, 6.0))
    front_z, rear_z = (-sole_outline(model, SIDES[k]).height for k in (1 - side, side))
    ball = offset[f"{name}_toes"] * [1.0, 0.0, 1.0]
    sunk = times.there(times.knee, times.risen, DOWN_S)
    pitch = added(
        sinusoid(0.0, 1.0, 0.0, np.deg2rad(STANCE_DEG)), scaled(np.deg2rad(KNEELING_DEG - STANCE_DEG), sunk)
    )
    lifting = sinusoid(np.deg2rad(1.0), rng.uniform(0.3, 0.6), rng.uniform(0, 6.28), np.deg2rad(-2.0))

    def over_ball(at: Dual) -> Dual:
        """(T, 3) ankle from where it is on the flat foot."""
        return dual_numbers.rotation(1, at).apply(-ball) + ball

    raised = over_ball(Dual.constant(np.array([np.deg2rad(KNEELING_DEG)]))).value[0]
    shank = float(np.linalg.norm(offset[f"{name}_foot"]))
    knee_z = KNEE_M * size
    along = float(np.sqrt(shank**2 - (rear_z + raised[2] - knee_z) ** 2))
    knee = np.array([KNEE_X_M * size, sign * half, knee_z])
    rear = np.array([knee[0] - along - raised[0], sign * half, rear_z])

    def feet(at: Array) -> dict[str, FootPose]:
        tilt = pitch(at)
        front = Dual.constant(np.tile([0.0, -sign * half, front_z], (len(at), 1)))
        return {
            SIDES[1 - side]: FootPose(front, constant(at, -sign * yaw), constant(at, 0.0), lifting(at)),
            SIDES[side]: FootPose(over_ball(tilt) + rear, constant(at, 0.0), tilt, lifting(at) - tilt, knee),
        }

    return feet, knee


def _load(model: Body, feet: FeetPlan, side: int, times: _Times, rng: np.random.Generator) -> LoadPlan:
    """The feet's part of the load: most on the front foot, the rear one on its ball.

    Args:
        model: The body.
        feet: Poses of the feet.
        side: Kneeling side, 0 right, 1 left.
        times: When knee and hand meet and leave the floor.
        rng: Source of the sway.
    """
    size = float(model.scale.mean())
    forth = sinusoid(0.005, rng.uniform(0.2, 0.5), rng.uniform(0, 6.28), 0.05 * size)
    sway = sinusoid(0.02, rng.uniform(0.2, 0.5), rng.uniform(0, 6.28), rng.uniform(0.38, 0.44))
    rear_share = added(
        sway,
        scaled(-0.06, times.there(times.knee, times.risen, DOWN_S)),
        scaled(-0.19, times.there(times.knee + BEAR_S, times.risen - BEAR_S, BEAR_S)),
    )
    ball = InverseKinematics(model).offset[f"{SIDE_NAMES[SIDES[side]]}_toes"]

    def load(at: Array) -> Load:
        poses = feet(at)
        front, rear = poses[SIDES[1 - side]], poses[SIDES[side]]
        turned = dual_numbers.rotation(1, rear.pitch).apply(np.array([ball[0], 0.0, ball[2]])).value
        toes = rear.ankle.value[:, :2] + turned[:, :2] + [0.02 * size, 0.0]
        pressure = [pressed(front, forth(at).value), toes]
        share = rear_share(at).value
        if side == 0:
            return Load(share, np.stack(pressure[::-1], axis=1), np.ones(len(at), dtype=bool), apex_m=APEX_M)
        return Load(1.0 - share, np.stack(pressure, axis=1), np.ones(len(at), dtype=bool), apex_m=APEX_M)

    return load
