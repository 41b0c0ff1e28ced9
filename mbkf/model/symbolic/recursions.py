"""Recursions over the tree of joints in CasADi: inverse dynamics, mass matrix, forward dynamics.

Recursive Newton–Euler (RNEA), composite rigid bodies (CRBA) and articulated bodies (ABA) in each joint's own frame:
R. Featherstone, Rigid Body Dynamics Algorithms, Springer 2008, tables 5.1, 6.2 and 7.1.
"""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from mbkf.model.symbolic.spatial import motion_cross, motion_transform
from mbkf.model.symbolic.tree import Pose, SymbolicTree

Loads = Mapping[int, ca.SX]
"""Wrench (6,) about the world's origin in world axes, N and N m, by the index of Pinocchio's joint that bears it."""


def inverse_dynamics(tree: SymbolicTree, q: ca.SX, v: ca.SX, a: ca.SX, loads: Loads) -> ca.SX:
    """τ (nv,) of a motion under loads: M a − Q_g − Σ Jᵀ w.

    Args:
        tree: The body.
        q: (nq,) configuration.
        v: (nv,) velocity in the tangent space.
        a: (nv,) acceleration.
        loads: Wrenches from outside.
    """
    X = _transforms(tree, q)
    velocities: list[ca.SX] = []
    accelerations: list[ca.SX] = []
    forces: list[ca.SX] = []
    own = _local_loads(tree, q, loads)
    for i, joint in enumerate(tree.joints):
        v_joint = joint.subspace @ v[joint.v]
        a_joint = joint.subspace @ a[joint.v]
        before = X[i] @ _of_parent(velocities, joint.parent, ca.SX(6, 1))
        velocities.append(before + v_joint)
        # The world accelerates upward in place of gravity.
        carried = X[i] @ _of_parent(accelerations, joint.parent, -ca.SX(tree.gravity))
        accelerations.append(carried + a_joint + motion_cross(velocities[i]) @ v_joint)
        momentum = joint.inertia @ velocities[i]
        gyroscopic = -motion_cross(velocities[i]).T @ momentum
        forces.append(joint.inertia @ accelerations[i] + gyroscopic - own.get(i, ca.SX(6, 1)))
    tau = ca.SX.zeros(tree.nv)
    for i, joint in reversed(list(enumerate(tree.joints))):
        tau[joint.v] = joint.subspace.T @ forces[i]
        if joint.parent:
            forces[joint.parent - 1] += X[i].T @ forces[i]
    return tau


def mass_matrix(tree: SymbolicTree, q: ca.SX) -> ca.SX:
    """M (nv, nv), symmetric."""
    X = _transforms(tree, q)
    composite = [joint.inertia for joint in tree.joints]
    M = ca.SX.zeros(tree.nv, tree.nv)
    for i, joint in reversed(list(enumerate(tree.joints))):
        if joint.parent:
            composite[joint.parent - 1] += X[i].T @ composite[i] @ X[i]
        force = composite[i] @ joint.subspace
        M[joint.v, joint.v] = joint.subspace.T @ force
        at = i
        while tree.joints[at].parent:
            force = X[at].T @ force
            at = tree.joints[at].parent - 1
            other = tree.joints[at]
            M[other.v, joint.v] = other.subspace.T @ force
            M[joint.v, other.v] = M[other.v, joint.v].T
    return M


def forward_dynamics(tree: SymbolicTree, q: ca.SX, v: ca.SX, tau: ca.SX, loads: Loads) -> ca.SX:
    """(nv,) acceleration M⁻¹ (τ + Q_g + Σ Jᵀ w).

    Args:
        tree: The body.
        q: (nq,) configuration.
        v: (nv,) velocity in the tangent space.
        tau: (nv,) generalised forces.
        loads: Wrenches from outside.
    """
    X = _transforms(tree, q)
    own = _local_loads(tree, q, loads)
    velocities: list[ca.SX] = []
    biases: list[ca.SX] = []
    pulls: list[ca.SX] = []
    articulated = [joint.inertia for joint in tree.joints]
    for i, joint in enumerate(tree.joints):
        v_joint = joint.subspace @ v[joint.v]
        velocities.append(X[i] @ _of_parent(velocities, joint.parent, ca.SX(6, 1)) + v_joint)
        biases.append(motion_cross(velocities[i]) @ v_joint)
        gyroscopic = -motion_cross(velocities[i]).T @ (joint.inertia @ velocities[i])
        pulls.append(gyroscopic - own.get(i, ca.SX(6, 1)))
    gains: dict[int, ca.SX] = {}
    answers: dict[int, ca.SX] = {}
    for i, joint in reversed(list(enumerate(tree.joints))):
        U = articulated[i] @ joint.subspace
        D = joint.subspace.T @ U
        push = tau[joint.v] - joint.subspace.T @ pulls[i]
        solved = solved_positive(D, ca.horzcat(push, U.T))
        answers[i], gains[i] = solved[:, 0], solved[:, 1:]
        if joint.parent:
            reduced = articulated[i] - U @ gains[i]
            pull = pulls[i] + reduced @ biases[i] + U @ answers[i]
            articulated[joint.parent - 1] += X[i].T @ reduced @ X[i]
            pulls[joint.parent - 1] += X[i].T @ pull
    accelerations: list[ca.SX] = []
    a = ca.SX.zeros(tree.nv)
    for i, joint in enumerate(tree.joints):
        carried = X[i] @ _of_parent(accelerations, joint.parent, -ca.SX(tree.gravity)) + biases[i]
        a[joint.v] = answers[i] - gains[i] @ carried
        accelerations.append(carried + joint.subspace @ a[joint.v])
    return a


def world_jacobian(tree: SymbolicTree, poses: list[Pose], index: int) -> ca.SX:
    """J (6, nv): velocity (linear, angular) at the world's origin of a joint's segment, in world axes.

    Args:
        tree: The body.
        poses: Every joint's frame in the world.
        index: Pinocchio's index of the joint.
    """
    J = ca.SX.zeros(6, tree.nv)
    for i in tree.chain(index):
        joint = tree.joints[i]
        linear, angular = (poses[i].rotation @ part for part in ca.vertsplit(joint.subspace, 3))
        J[:3, joint.v] = linear + ca.skew(poses[i].origin) @ angular
        J[3:, joint.v] = angular
    return J


def solved_positive(A: ca.SX, B: ca.SX) -> ca.SX:
    """A⁻¹ B of a small symmetric positive definite A by elimination, which needs no pivots there."""
    A, B = ca.SX(A), ca.SX(B)
    n = A.size1()
    for k in range(n):
        for i in range(k + 1, n):
            factor = A[i, k] / A[k, k]
            A[i, k:] -= factor * A[k, k:]
            B[i, :] -= factor * B[k, :]
    for k in reversed(range(n)):
        B[k, :] = (B[k, :] - A[k, k + 1 :] @ B[k + 1 :, :]) / A[k, k]
    return B


def _transforms(tree: SymbolicTree, q: ca.SX) -> list[ca.SX]:
    return [motion_transform(pose.rotation, pose.origin) for pose in tree.relative(q)]


def _of_parent(values: list[ca.SX], parent: int, world: ca.SX) -> ca.SX:
    return values[parent - 1] if parent else world


def _local_loads(tree: SymbolicTree, q: ca.SX, loads: Loads) -> dict[int, ca.SX]:
    """Wrenches in the axes of the joints that bear them, about their origins, by place in ``joints``."""
    if not loads:
        return {}
    poses = tree.world(q)
    found = {}
    for index, wrench in loads.items():
        pose = poses[index - 1]
        force, moment = wrench[:3], wrench[3:] - ca.cross(pose.origin, wrench[:3])
        found[index - 1] = ca.vertcat(pose.rotation.T @ force, pose.rotation.T @ moment)
    return found
