"""Standing on two flat feet: where they are, how they share the load, and postures between two extremes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.model.body import Body
from mbkf.synthesis.contact import Load, LoadPlan, sole_outline
from mbkf.synthesis.curves import Curve, added, scaled, sinusoid
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.inverse_kinematics import FootPose
from mbkf.synthesis.plan import JOINTS, FeetPlan

Angles = Mapping[str, tuple[float, float, float]]
"""Angles about x, y and z in degrees, by joint."""


def constant(times: Array, value: float) -> Dual:
    """(T,) dual number that stays at a value."""
    return Dual.constant(np.full(len(times), value))


def planted(model: Body, half_width_m: float, toe_out_deg: float, rng: np.random.Generator) -> FeetPlan:
    """Both feet flat and still, ankles at x = 0 and y = ∓ half the width; the toes lift a little.

    Args:
        model: The body that stands.
        half_width_m: Half the distance of the ankles, m.
        toe_out_deg: Outward turn of each foot, deg.
        rng: Source of the toes' motion.
    """
    lifting = {
        side: sinusoid(
            np.deg2rad(rng.uniform(0.5, 1.5)), rng.uniform(0.3, 0.6), rng.uniform(0, 6.28), np.deg2rad(-2.0)
        )
        for side in SIDES
    }

    def feet(times: Array) -> dict[str, FootPose]:
        poses = {}
        for side, sign in zip(SIDES, (-1.0, 1.0), strict=True):
            at = np.array([0.0, sign * half_width_m, -sole_outline(model, side).height])
            poses[side] = FootPose(
                Dual.constant(np.tile(at, (len(times), 1))),
                constant(times, sign * np.deg2rad(toe_out_deg)),
                constant(times, 0.0),
                lifting[side](times),
            )
        return poses

    return feet


def standing_load(feet: FeetPlan, forward_m: float, rng: np.random.Generator) -> LoadPlan:
    """About half the load on each foot, pressure under the middle of the feet, both swaying a little.

    Args:
        feet: Poses of the feet.
        forward_m: Distance of the pressure ahead of the ankles, m.
        rng: Source of the sway.
    """
    sway = sinusoid(
        0.03 * rng.uniform(0.5, 1),
        rng.uniform(0.2, 0.5),
        rng.uniform(0, 6.28),
        0.5 + 0.03 * rng.uniform(-1, 1),
    )
    forth = sinusoid(0.006, rng.uniform(0.2, 0.5), rng.uniform(0, 6.28), forward_m)

    def load(times: Array) -> Load:
        poses = feet(times)
        pressure = np.stack([pressed(poses[side], forth(times).value) for side in SIDES], axis=1)
        return Load(sway(times).value, pressure, np.ones(len(times), dtype=bool))

    return load


def shifted(load: LoadPlan, forward: Curve) -> LoadPlan:
    """A load with the pressure under both feet moved along x, m."""

    def moved(times: Array) -> Load:
        planned = load(times)
        ahead = np.column_stack([forward(times).value, np.zeros(len(times))])
        return replace(planned, pressure=planned.pressure + ahead[:, None])

    return moved


def pressed(foot: FootPose, forward_m: Array, left_m: Array | float = 0.0) -> Array:
    """(T, 2) point on the floor beside an ankle, along the foot's heading.

    Args:
        foot: The foot.
        forward_m: (T,) distance ahead of the ankle, m.
        left_m: (T,) distance to the left of it, m.
    """
    c, s = np.cos(foot.yaw.value), np.sin(foot.yaw.value)
    return foot.ankle.value[:, :2] + np.stack(
        [c * forward_m - s * left_m, s * forward_m + c * left_m], axis=-1
    )


def posture(
    base_deg: Angles, gains: Sequence[tuple[Curve, Angles]], rng: np.random.Generator, spread: float = 0.08
) -> dict[str, tuple[Curve, Curve, Curve]]:
    """Joint angles: a base posture plus curves (0…1) times the change of each, each person a little different.

    Args:
        base_deg: Angles (x, y, z) in degrees by joint.
        gains: Pairs of a curve and the angles in degrees that it adds at 1.
        rng: Source of the differences.
        spread: Relative size (1 sd) of the differences.
    """
    curves = {}
    for joint in ("pelvis", *JOINTS):
        axes = []
        for axis in range(3):
            own = base_deg.get(joint, (0.0, 0.0, 0.0))[axis] + rng.normal(0.0, 1.0) * (joint != "pelvis")
            parts = [sinusoid(0.0, 1.0, 0.0, np.deg2rad(own))]
            for curve, gain in gains:
                amount = np.deg2rad(gain.get(joint, (0.0, 0.0, 0.0))[axis]) * (1 + spread * rng.normal())
                if amount:
                    parts.append(scaled(amount, curve))
            axes.append(added(*parts))
        curves[joint] = (axes[0], axes[1], axes[2])
    return curves
