"""A motion with all that is true of it: loads, generalised forces, moments of the knees, places of markers."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.spatial.transform import Rotation

from benchmarks.foreign.making.loads import (
    beyond_feet,
    distal,
    feet_wrenches,
    motion_correction,
    projected_shares,
    shares,
)
from benchmarks.foreign.making.osim_body import OsimBody
from mbkf.conventions import SIDES, Array, BoolArray

RATE_HZ = 100.0
ROUNDS, GAIN = 14, 0.7
"""Number of corrections of the motion in flight, and the share that each applies."""

IN_STANCE = 0.3
"""Weight of the turn of the body in stance, beside that in flight."""

LOOK_S = 1e-4
"""Half of the step over which momentum is differentiated."""

TOE_M = 0.04
"""Distance of the ball of the foot in front of the toes' joint, before scaling, m."""


@dataclass(frozen=True)
class Motion:
    """How a body moves, and on what it stands.

    Attributes:
        q: (T, C) coordinates at :data:`RATE_HZ`.
        contacts: (T, 2) right and left foot on the ground.
        heights_m: (T, 2) height of the ground below each foot.
        balanced: Slow, so that double support is shared by where the centre of pressure lies; else by time.
    """

    q: Array
    contacts: BoolArray
    heights_m: Array
    balanced: bool = False

    @property
    def times_s(self) -> Array:
        """(T,) times."""
        return np.arange(len(self.q)) / RATE_HZ

    def rates(self) -> tuple[Array, Array]:
        """(T, C) rates and accelerations, of a quintic spline through the coordinates."""
        spline = make_interp_spline(self.times_s, self.q, k=5)
        return np.asarray(spline(self.times_s, 1)), np.asarray(spline(self.times_s, 2))


@dataclass(frozen=True)
class Recorded:
    """A motion and its loads.

    Attributes:
        motion: The motion.
        u: (T, C) rates.
        wrenches: (T, 2, 6) on right and left foot about the ground's origin.
        tau: (T, C) generalised forces.
        knee_flexion, knee_adduction: (T, 2) moments of right and left knee about anatomical axes.
        com_m: (T, 3) centre of mass.
    """

    motion: Motion
    u: Array
    wrenches: Array
    tau: Array
    knee_flexion: Array
    knee_adduction: Array
    com_m: Array


def standing_points(body: OsimBody, motion: Motion) -> Array:
    """(T, 2, 3) where each foot stands: from the heel to the ball of the toes as the heel rises.

    Args:
        body: The body.
        motion: The motion.
    """
    found = np.zeros((len(motion.q), 2, 3))
    for t, q in enumerate(motion.q):
        body.move(q)
        for k, side in enumerate(SIDES):
            _, heel = body.frame(f"calcn_{side}")
            turned, joint = body.frame(f"toes_{side}")
            ball = joint + turned[:, 0] * TOE_M
            rise = (heel[1] - joint[1]) / max(float(np.linalg.norm(ball - heel)), 1e-6)
            forward = 0.5 + 0.5 * np.tanh(6.0 * rise)
            found[t, k] = heel + (0.15 + 0.75 * forward) * (ball - heel)
    found[:, :, 1] = motion.heights_m
    return found


def needed(body: OsimBody, motion: Motion) -> Array:
    """(T, 6) wrench about the ground's origin that the motion needs.

    Args:
        body: The body.
        motion: The motion.
    """
    u, a = motion.rates()
    found = np.zeros((len(motion.q), 6))
    for t in range(len(motion.q)):
        body.move(motion.q[t], u[t])
        found[t] = body.residual_wrench(body.torques(a[t]))
    return found


def in_free_flight(body: OsimBody, motion: Motion) -> Motion:
    """The motion with a pelvis that moves so that no load is needed in flight, and one below the feet in stance.

    Joint angles are kept. Movements without flight stay as they are.

    Args:
        body: The body.
        motion: A motion, with or without flight.
    """
    flight: BoolArray = np.asarray(~motion.contacts.any(axis=1))
    if not flight.any():
        return motion
    turns = [body.column(f"pelvis_{name}") for name in ("tilt", "list", "rotation")]
    places = [body.column(f"pelvis_t{axis}") for axis in "xyz"]
    share = shares(motion.contacts)
    for _ in range(ROUNDS):
        wrench, points = needed(body, motion), standing_points(body, motion)
        centres, inertias = np.zeros((len(motion.q), 3)), np.zeros((len(motion.q), 3, 3))
        for t, q in enumerate(motion.q):
            body.move(q)
            centres[t], inertias[t] = body.centre_of_mass(), body.inertia()
        about_centre: Array = wrench[:, 3:] - np.cross(centres, wrench[:, :3])
        wrong = np.where(flight[:, None], about_centre, beyond_feet(wrench, share, points))
        spin = np.asarray(np.linalg.solve(inertias, wrong[:, :, None])[:, :, 0])
        moved = motion_correction(wrench[:, :3] / body.mass_kg, flight.astype(float), 1.0 / RATE_HZ)
        turn = motion_correction(spin, np.where(flight, 1.0, IN_STANCE), 1.0 / RATE_HZ)
        turned = Rotation.from_rotvec(GAIN * turn)
        q = motion.q.copy()
        q[:, turns] = np.unwrap((turned * Rotation.from_euler("ZXY", q[:, turns])).as_euler("ZXY"), axis=0)
        q[:, places] = centres + turned.apply(q[:, places] - centres) + GAIN * moved
        motion = replace(motion, q=q)
    return motion


def recorded(body: OsimBody, motion: Motion) -> Recorded:
    """All loads and forces of a motion.

    Args:
        body: The body.
        motion: The motion.
    """
    points, total = standing_points(body, motion), needed(body, motion)
    share = shares(motion.contacts)
    if motion.balanced:
        both = motion.contacts.all(axis=1, keepdims=True)
        share = np.where(both, projected_shares(total, points), share)
    return with_loads(body, motion, feet_wrenches(total, share, points))


def with_loads(body: OsimBody, motion: Motion, wrenches: Array) -> Recorded:
    """Generalised forces and knee moments of a motion with known loads.

    Args:
        body: The body.
        motion: The motion.
        wrenches: (T, 2, 6) wrenches of right and left foot.
    """
    u, a = motion.rates()
    tau, com = np.zeros(motion.q.shape), np.zeros((len(motion.q), 3))
    knees = np.zeros((2, len(motion.q), 2))
    for t, q in enumerate(motion.q):
        for k, side in enumerate(SIDES):
            knees[:, t, k] = _knee(body, side, q, u[t], a[t], wrenches[t, k])
        body.move(q, u[t])
        com[t] = body.centre_of_mass()
        tau[t] = body.torques(a[t])
        for k, side in enumerate(SIDES):
            tau[t] -= body.by_load(f"calcn_{side}", wrenches[t, k])
    return Recorded(motion, u, wrenches, tau, knees[0], knees[1], com)


def _knee(body: OsimBody, side: str, q: Array, u: Array, a: Array, wrench: Array) -> tuple[float, float]:
    """Moments of flexion and of adduction, from the momentum of everything below the knee."""
    below = distal(side)
    looks = []
    for sign in (1.0, -1.0):
        h = sign * LOOK_S
        body.move(q + h * u + 0.5 * h**2 * a, u + h * a)
        looks.append(np.concatenate(body.momentum(below)))
    body.move(q, u)
    net = (looks[0] - looks[1]) / (2.0 * LOOK_S) - body.weight(below) - wrench
    thigh, _ = body.frame(f"femur_{side}")
    shank, centre = body.frame(f"tibia_{side}")
    moment = net[3:] - np.cross(centre, net[:3])
    floating = np.cross(shank[:, 1], thigh[:, 2])
    floating /= np.linalg.norm(floating)
    outward = 1.0 if side == "r" else -1.0
    return float(-thigh[:, 2] @ moment), float(outward * floating @ moment)
