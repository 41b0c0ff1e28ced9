"""Positions and velocities in the world of points that are fixed to segments, in CasADi."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from mbkf.conventions import Array
from mbkf.model.symbolic.spatial import constant
from mbkf.model.symbolic.tree import Pose, SymbolicTree


def point_kinematics(
    tree: SymbolicTree, q: ca.SX, v: ca.SX, joints: Sequence[int], places_m: Array
) -> tuple[ca.SX, ca.SX]:
    """Positions (P, 3), m, and velocities (P, 3), m/s, in world axes.

    Args:
        tree: The body.
        q: (nq,) configuration.
        v: (nv,) velocity in the tangent space.
        joints: Pinocchio's index of the joint of each point's segment.
        places_m: (P, 3) places in the segments' frames, m.
    """
    poses = tree.world(q)
    rates = segment_rates(tree, poses, v)
    positions, velocities = ca.SX.zeros(len(joints), 3), ca.SX.zeros(len(joints), 3)
    for row, (index, place) in enumerate(zip(joints, places_m, strict=True)):
        pose, (travel, turn) = poses[index - 1], rates[index - 1]
        lever = pose.rotation @ constant(place)
        positions[row, :] = (pose.origin + lever).T
        velocities[row, :] = (travel + ca.cross(turn, lever)).T
    return positions, velocities


def segment_rates(tree: SymbolicTree, poses: Sequence[Pose], v: ca.SX) -> list[tuple[ca.SX, ca.SX]]:
    """Velocity of each joint's origin (3,), m/s, and angular velocity (3,), rad/s, in world axes.

    Args:
        tree: The body.
        poses: Every joint's frame in the world.
        v: (nv,) velocity in the tangent space.
    """
    found: list[tuple[ca.SX, ca.SX]] = []
    for pose, joint in zip(poses, tree.joints, strict=True):
        own = joint.subspace @ v[joint.v]
        travel, turn = pose.rotation @ own[:3], pose.rotation @ own[3:]
        if joint.parent:
            before, (travel_before, turn_before) = poses[joint.parent - 1], found[joint.parent - 1]
            travel += travel_before + ca.cross(turn_before, pose.origin - before.origin)
            turn += turn_before
        found.append((travel, turn))
    return found
