"""Greatest difference of each CasADi function of a person from Pinocchio, at random states."""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca
import numpy as np
import pinocchio as pin

import mbkf
from mbkf.conventions import Array
from mbkf.io.subject import Subject
from mbkf.model.casadi_dynamics import CasadiDynamics
from mbkf.model.soles import sole_locals

TURNS, RATES, ACCELERATIONS, TORQUES = 2.0, 5.0, 30.0, 100.0
FORCES_N, MOMENTS_NM = 500.0, 100.0
STEPS = (0.0, 1e-4, 0.1, 1.0)
"""Sizes of random states: rad, rad/s, rad/s², N m; and of steps on the manifold."""


def agreement(subject: Subject, states: int, rng: np.random.Generator) -> dict[str, float]:
    """By output, the greatest difference at random states, over the greatest number there or 1.

    Args:
        subject: The person.
        states: Number of states.
        rng: Their source.
    """
    dynamics = mbkf.casadi_dynamics(subject)
    worst: dict[str, float] = {}
    for _ in range(states):
        for name, found, expected in _compared(dynamics, subject, rng):
            apart = float(np.abs(_numbers(found, expected) - expected).max())
            apart /= max(1.0, float(np.abs(expected).max()))
            # A NaN stays the worst.
            worst[name] = apart if not apart <= worst.get(name, 0.0) else worst.get(name, 0.0)
    return worst


def _numbers(found: ca.DM, expected: Array) -> Array:
    values = found.full()
    if expected.ndim == 1:
        values = values[:, 0]
    if values.shape != expected.shape:
        raise ValueError(f"shape {values.shape} of CasADi, {expected.shape} of Pinocchio")
    return values


def _compared(
    dynamics: CasadiDynamics, subject: Subject, rng: np.random.Generator
) -> Iterator[tuple[str, ca.DM, Array]]:
    """Each output of CasADi and of Pinocchio at one random state."""
    model = dynamics.body.pin_model
    data = model.createData()
    q = pin.integrate(model, pin.neutral(model), TURNS * rng.normal(size=model.nv))
    v, a, tau = rng.normal(size=(3, model.nv)) * [[RATES], [ACCELERATIONS], [TORQUES]]
    wrench = rng.normal(size=(2, 6)) * np.repeat([FORCES_N, MOMENTS_NM], 3)
    yield from _points(dynamics, subject, q, v)
    pin.forwardKinematics(model, data, q)
    loads = pin.StdVec_Force([pin.Force.Zero()] * model.njoints)
    feet = [dynamics.body.joint(name).joint_id for name in dynamics.body.roles.feet]
    for foot, own in zip(feet, wrench, strict=True):
        loads[foot] = data.oMi[foot].actInv(pin.Force(own))
    yield (
        "inverse dynamics",
        dynamics.inverse_dynamics(q, v, a, wrench),
        pin.rnea(model, data, q, v, a, loads).copy(),
    )
    yield (
        "forward dynamics",
        dynamics.forward_dynamics(q, v, tau, wrench),
        pin.aba(model, data, q, v, tau, loads).copy(),
    )
    yield "mass matrix", dynamics.mass_matrix(q), dynamics.body.mass_matrix(q).copy()
    pin.computeJointJacobians(model, data, q)
    for foot, found in zip(feet, dynamics.foot_jacobians(q), strict=True):
        yield "Jacobians of the feet", found, pin.getJointJacobian(model, data, foot, pin.WORLD)
    step = rng.choice(STEPS) * rng.normal(size=model.nv)
    after = pin.integrate(model, q, step)
    yield "step on the manifold", dynamics.integrate(q, step), after
    yield "difference on the manifold", dynamics.difference(q, after), pin.difference(model, q, after)


def _points(
    dynamics: CasadiDynamics, subject: Subject, q: Array, v: Array
) -> Iterator[tuple[str, ca.DM, Array]]:
    """Positions and velocities of markers, segments' origins and sole points."""
    body = dynamics.body
    model = body.pin_model.copy()
    soles, sole_places = sole_locals(body)
    groups = (
        (
            dynamics.markers,
            [one.segment for one in subject.markers],
            [one.position_m for one in subject.markers],
        ),
        (dynamics.segments, list(body.joints), np.zeros((len(body.joints), 3))),
        (dynamics.soles, soles, sole_places),
    )
    frames: list[list[int]] = []
    for function, segments, places in groups:
        own: list[int] = []
        for segment, place in zip(segments, places, strict=True):
            joint = body.joint(segment).joint_id
            frame = pin.Frame(
                f"{function.name()} {len(own)}", joint, 0, pin.SE3(np.eye(3), place), pin.OP_FRAME
            )
            own.append(model.addFrame(frame))
        frames.append(own)
    data = model.createData()
    pin.forwardKinematics(model, data, q, v)
    pin.updateFramePlacements(model, data)
    for (function, _, _), own in zip(groups, frames, strict=True):
        position, velocity = function(q, v)
        rates = [pin.getFrameVelocity(model, data, one, pin.LOCAL_WORLD_ALIGNED).linear for one in own]
        yield (
            f"positions of {function.name()}",
            position,
            np.array([data.oMf[one].translation for one in own]),
        )
        yield f"velocities of {function.name()}", velocity, np.array(rates)
