"""A person's body as CasADi functions, for optimal control: kinematics of points, dynamics, steps on the manifold.

The functions are built from the joints of the scaled body; they give the numbers of Pinocchio.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from mbkf.conventions import Array
from mbkf.io.subject import Subject
from mbkf.model.body import Body
from mbkf.model.clinical import dof_names
from mbkf.model.human import HumanModel
from mbkf.model.layout import FOOT
from mbkf.model.soles import sole_locals, sole_names
from mbkf.model.symbolic import recursions
from mbkf.model.symbolic.points import point_kinematics
from mbkf.model.symbolic.tree import SymbolicTree


@dataclass(frozen=True)
class CasadiDynamics:
    """A person's body as functions of CasADi, which accept numbers and the symbols SX and MX.

    Inputs and outputs have names. A configuration ``q`` (nq,) lies on the body's manifold; ``v``, ``a`` and ``tau``
    (nv,) are velocity, acceleration and generalised forces in its tangent space: of the free root linear then angular
    in the root's axes, of other joints rotations about their own axes (m, rad, s, N, N m). The world's z points up.
    ``foot_wrench`` (2, 6) is the ground's force, N, and moment about the world's origin, N m, on right and left foot.

    Attributes:
        body: The scaled body: ``body.joint("right_shank").v`` is where a joint lies in v, ``body.neutral()`` a posture.
        dofs: (nv) names of the components of v, such as ``"right_shank_y"``.
        marker_names: (M) names of the rows of ``markers``.
        segment_names: (S) names of the rows of ``segments``.
        sole_names: (6) names of the rows of ``soles``, such as ``"right_foot_heel"``.
        markers: (q, v) → position_m (M, 3), velocity_m_s (M, 3) of the subject's markers in the world.
        segments: (q, v) → position_m (S, 3), velocity_m_s (S, 3) of the segments' origins, their proximal joints.
        soles: (q, v) → position_m (6, 3), velocity_m_s (6, 3) of heel, ball and toe end of right and left sole.
        inverse_dynamics: (q, v, a, foot_wrench) → tau (nv,), joint torques behind the six of the root.
        forward_dynamics: (q, v, tau, foot_wrench) → a (nv,).
        mass_matrix: (q) → mass_matrix (nv, nv).
        foot_jacobians: (q) → right (6, nv), left (6, nv): J v is the foot's velocity, linear then angular, at the
            world's origin; Jᵀ w is the effect of the wrench w on the generalised forces.
        integrate: (q, dv) → q_after (nq,), the configuration reached by the tangent vector dv.
        difference: (q0, q1) → dv (nv,), the tangent vector from q0 to q1.
    """

    body: Body
    dofs: tuple[str, ...]
    marker_names: tuple[str, ...]
    segment_names: tuple[str, ...]
    sole_names: tuple[str, ...]
    markers: ca.Function
    segments: ca.Function
    soles: ca.Function
    inverse_dynamics: ca.Function
    forward_dynamics: ca.Function
    mass_matrix: ca.Function
    foot_jacobians: ca.Function
    integrate: ca.Function
    difference: ca.Function


def casadi_dynamics(subject: Subject | Body) -> CasadiDynamics:
    """Kinematics and dynamics of a person as functions of CasADi.

    Args:
        subject: The person, or a scaled body, which has no markers.

    Returns:
        The functions, all with derivatives of any order.

    Raises:
        UnknownName: The subject's reference body is unknown.
        InvalidInput: A joint of the body is of another kind than free, spherical or revolute.
    """
    body = HumanModel.of(subject) if isinstance(subject, Subject) else subject
    markers = subject.markers if isinstance(subject, Subject) else ()
    tree = SymbolicTree.of(body.pin_model)
    soles, sole_places = sole_locals(body)
    return CasadiDynamics(
        body=body,
        dofs=dof_names(body),
        marker_names=tuple(marker.name for marker in markers),
        segment_names=tuple(body.joints),
        sole_names=sole_names(body),
        markers=_points(
            "markers", tree, body, [one.segment for one in markers], [one.position_m for one in markers]
        ),
        segments=_points("segments", tree, body, list(body.joints), np.zeros((len(body.joints), 3))),
        soles=_points("soles", tree, body, soles, sole_places),
        **_dynamics(tree, body),
        **_manifold(tree),
    )


def _points(
    name: str, tree: SymbolicTree, body: Body, segments: Sequence[str], places_m: Sequence[Array] | Array
) -> ca.Function:
    q, v = ca.SX.sym("q", tree.nq), ca.SX.sym("v", tree.nv)
    joints = [body.joint(segment).joint_id for segment in segments]
    found = point_kinematics(tree, q, v, joints, np.reshape(places_m, (-1, 3)))
    return _function(name, {"q": q, "v": v}, dict(zip(("position_m", "velocity_m_s"), found, strict=True)))


def _dynamics(tree: SymbolicTree, body: Body) -> dict[str, ca.Function]:
    q, v, a, tau = (ca.SX.sym(name, n) for name, n in zip("qvat", (tree.nq, *[tree.nv] * 3), strict=True))
    wrench = ca.SX.sym("foot_wrench", 2, FOOT)
    feet = [body.joint(segment).joint_id for segment in body.roles.feet]
    loads = {foot: wrench[side, :].T for side, foot in enumerate(feet)}
    poses = tree.world(q)
    right, left = (recursions.world_jacobian(tree, poses, foot) for foot in feet)
    torques = recursions.inverse_dynamics(tree, q, v, a, loads)
    accelerations = recursions.forward_dynamics(tree, q, v, tau, loads)
    motion = {"q": q, "v": v}
    found = (
        _function("inverse_dynamics", motion | {"a": a, "foot_wrench": wrench}, {"tau": torques}),
        _function("forward_dynamics", motion | {"tau": tau, "foot_wrench": wrench}, {"a": accelerations}),
        _function("mass_matrix", {"q": q}, {"mass_matrix": recursions.mass_matrix(tree, q)}),
        _function("foot_jacobians", {"q": q}, {"right": right, "left": left}),
    )
    return {one.name(): one for one in found}


def _manifold(tree: SymbolicTree) -> dict[str, ca.Function]:
    q0, q1, dv = ca.SX.sym("q0", tree.nq), ca.SX.sym("q1", tree.nq), ca.SX.sym("dv", tree.nv)
    found = (
        _function("integrate", {"q": q0, "dv": dv}, {"q_after": tree.integrate(q0, dv)}),
        _function("difference", {"q0": q0, "q1": q1}, {"dv": tree.difference(q0, q1)}),
    )
    return {one.name(): one for one in found}


def _function(name: str, inputs: Mapping[str, ca.SX], outputs: Mapping[str, ca.SX]) -> ca.Function:
    """A function with named inputs and outputs; outputs are dense, as numbers of other programs are."""
    values = [ca.densify(value) for value in outputs.values()]
    return ca.Function(name, list(inputs.values()), values, list(inputs), list(outputs))
