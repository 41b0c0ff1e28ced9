"""Inverse kinematics of legs: feet flat on given paths, with the centre of mass above them.

Newton's method finds flexion and adduction of the hip, knee and ankle of each leg so that the middle of the foot lies
on its path and the foot is level. The pelvis moves forward and sideways until the centre of mass is above the feet, at
the share of the load that each foot is to bear.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, sosfiltfilt

from benchmarks.foreign.making.osim_body import OsimBody
from mbkf.conventions import SIDES, Array, BoolArray
from mbkf.errors import NotConverged

RATE_HZ, CUT_OFF_HZ = 100.0, 4.0
ROUNDS, STEPS, STEP_RAD, CLOSE, APPROACH = 4, 25, 1e-5, 1e-6, 15
LEAST_KNEE_RAD = np.deg2rad(-2.0)
"""A knee that would have to bend backwards has a path beyond the leg's reach."""


@dataclass(frozen=True)
class Stance:
    """Task of the legs in a movement.

    Attributes:
        height_m: (T,) height of the pelvis.
        paths_m: (T, 2, 3) middle of both feet.
        contacts: (T, 2) feet on the ground.
        heights_m: (T, 2) height of the ground below each foot.
        right: (T,) share of the load on the right foot, where the centre of mass is to be.
        heels_m: (T,) how high heels are above toes, beyond standing; None for level feet.
    """

    height_m: Array
    paths_m: Array
    contacts: BoolArray
    heights_m: Array
    right: Array
    heels_m: Array | None = None


def legs_into(body: OsimBody, q: Array, stance: Stance, stand: Array) -> Array:
    """(T, C) coordinates with legs that reach their feet's paths and a pelvis in balance.

    Args:
        body: The body.
        q: (T, C) coordinates; those of legs are found.
        stance: What the legs have to do.
        stand: (C,) the standing pose, from which the search begins, and whose feet are level.

    Raises:
        NotConverged: A foot's path cannot be reached.
    """
    q = q.copy()
    q[:, body.column("pelvis_ty")] = stance.height_m
    forward, side = body.column("pelvis_tx"), body.column("pelvis_tz")
    share = np.column_stack([stance.right, 1.0 - stance.right])[:, :, None]
    aim = (share * stance.paths_m).sum(axis=1)
    low_pass = butter(2, CUT_OFF_HZ, fs=RATE_HZ, output="sos")
    levels = [_foot(body, stand, name)[3] for name in SIDES]
    heels = np.zeros(len(q)) if stance.heels_m is None else stance.heels_m
    for _ in range(ROUNDS):
        away = np.zeros((len(q), 2))
        for t in range(len(q)):
            body.move(q[t])
            away[t] = (aim[t] - body.centre_of_mass())[[0, 2]]
        q[:, [forward, side]] += sosfiltfilt(low_pass, away, axis=0)
        for leg, name in enumerate(SIDES):
            aimed = np.column_stack([stance.paths_m[:, leg], levels[leg] - heels])
            start = _approached(body, stand, q[0], name, aimed[0])
            for t in range(len(q)):
                q[t] = start = _leg(body, q[t], start, name, aimed[t])
    return q


def _foot(body: OsimBody, q: Array, side: str) -> Array:
    """(4,) middle of a foot, and how much higher its toes' joint is than its heel, m."""
    body.move(q)
    heel, toe = body.frame(f"calcn_{side}")[1], body.frame(f"toes_{side}")[1]
    return np.append(0.5 * (heel + toe), (toe - heel)[1])


def _approached(body: OsimBody, stand: Array, q: Array, side: str, aimed: Array) -> Array:
    """(C,) the first pose, found in small steps from the standing one."""
    held = stand
    begin = _foot(body, stand, side)
    for share in np.linspace(0.0, 1.0, APPROACH):
        pose = stand + share * (q - stand)
        held = _leg(body, pose, held, side, begin + share * (aimed - begin))
    return held


def _leg(body: OsimBody, q: Array, start: Array, side: str, aimed: Array) -> Array:
    """(C,) the pose with one leg whose foot is as aimed, found from another pose of the leg."""
    names = [f"{joint}_{side}" for joint in ("hip_flexion", "hip_adduction", "knee_angle", "ankle_angle")]
    columns, beta = [body.column(name) for name in names], body.column(f"knee_angle_{side}_beta")
    q = q.copy()

    def missed(values: Array) -> Array:
        q[columns], q[beta] = values, values[2]
        return _foot(body, q, side) - aimed

    values = start[columns]
    for _ in range(STEPS):
        error = missed(values)
        if np.abs(error).max() < CLOSE:
            break
        slopes = np.column_stack(
            [(missed(values + STEP_RAD * unit) - error) / STEP_RAD for unit in np.eye(4)]
        )
        step = np.linalg.lstsq(slopes, -error, rcond=1e-6)[0]
        values = values + np.clip(step, -0.3, 0.3)
    error = np.abs(missed(values)).max()
    if error > 1e-3 or values[2] < LEAST_KNEE_RAD:
        bent = np.rad2deg(values[2])
        raise NotConverged(
            f"a leg misses its foot's path by {1e3 * error:.0f} mm with the knee bent by {bent:.0f}°"
        )
    return q
