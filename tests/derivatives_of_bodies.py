"""Cases of tests/test_jacobians.py: the body, Newton–Euler, and the body moved by forces."""

from functools import partial

import numpy as np
import pinocchio as pin

from mbkf.model.clinical import ClinicalAngles
from mbkf.model.human_dynamics import FORCE_STATES, WRENCH_FRAMES, HumanDynamics
from mbkf.model.newton_euler import NewtonEuler
from tests.derivatives import along, checks, named, slope
from tests.dynamics import LOAD, random_state
from tests.motions import central_difference, moderate_pose, random_model

# The body.


@checks(
    "model.human.HumanModel.integration_derivatives",
    "model.human.HumanModel.difference_derivative",
)
def manifold(rng):
    model = random_model(rng)
    q, d = moderate_pose(model, rng), 0.3 * rng.normal(size=model.nv)
    A, B = model.integration_derivatives(q, d)
    end = model.integrate(q, d)
    by_q = along(model, lambda at: model.integrate(at, d), q)
    by_d = slope(lambda at: model.difference(end, model.integrate(q, at)), d)
    back = central_difference(model, lambda at: model.difference(q, at), end)
    return named(
        "model.human.HumanModel",
        ("integration_derivatives", [A, B], [by_q, by_d]),
        ("difference_derivative", model.difference_derivative(q, end), back),
    )


@checks("model.clinical.ClinicalAngles.jacobian")
def clinical_angles(rng):
    model = random_model(rng)
    clinical, q = ClinicalAngles(model), moderate_pose(model, rng)
    stated = [clinical.jacobian(name, q) for name in clinical.names]
    numeric = central_difference(
        model, lambda at: np.array([clinical.value(n, at) for n in clinical.names]), q
    )
    return named("model.clinical.ClinicalAngles", ("jacobian", stated, numeric))


@checks(
    "model.human.HumanModel.segment_jacobian",
    "model.human.HumanModel.spatial_jacobian",
    "model.human.HumanModel.frames_and_jacobian",
    "model.human.HumanModel.placements_and_jacobian",
)
def segments(rng):
    """A point's velocity is v + ω × m with the spatial velocity of the dofs below it; the whole of J by the hand."""
    model = random_model(rng)
    q, name = moderate_pose(model, rng), "left_hand"
    joint = model.joint(name).joint_id
    local, moves = rng.normal(size=3), model.supports[joint]

    def place(at):
        rotations, origins = model.placements(at)
        return origins[joint] + rotations[joint] @ local

    def turned(at):
        return pin.log3(model.placements(at)[0][joint] @ model.placements(q)[0][joint].T)

    point = place(q)
    numeric = np.vstack([central_difference(model, place, q), central_difference(model, turned, q)])
    spatial = numeric.copy()
    spatial[:3] -= np.cross(numeric[3:].T, point).T
    whole = [
        model.spatial_jacobian(q).copy(),
        model.frames_and_jacobian(q)[1].copy(),
        model.placements_and_jacobian(q)[2].copy(),
    ]
    names = ("spatial_jacobian", "frames_and_jacobian", "placements_and_jacobian")
    return named(
        "model.human.HumanModel",
        ("segment_jacobian", model.segment_jacobian(q, name, point), numeric),
        *((block, np.where(moves, J, 0.0), spatial) for block, J in zip(names, whole, strict=True)),
    )


# Newton–Euler.


@checks("model.newton_euler.RootBalance.by_state", tolerance=1e-6)
def newton_euler_root(rng):
    model = random_model(rng)
    balance, s = NewtonEuler(model), random_state(model, rng)
    by_state = [
        central_difference(model, lambda q: balance.root(q, s.v, s.a, s.w).residual, s.q),
        slope(lambda v: balance.root(s.q, v, s.a, s.w).residual, s.v),
        slope(lambda a: balance.root(s.q, s.v, a, s.w).residual, s.a, 1e-3),
        slope(lambda w: balance.root(s.q, s.v, s.a, w).residual, s.w, 1e-2),
    ]
    stated = balance.root(s.q, s.v, s.a, s.w).by_state
    return {"model.newton_euler.RootBalance.by_state": (stated, np.hstack(by_state))}


@checks(
    "model.newton_euler.NewtonEuler.torques",
    *(f"model.newton_euler.JointTorques.by_{x}" for x in ("q", "v", "a", "wrench", "state")),
    tolerance=1e-6,
)
def newton_euler_torques(rng):
    model = random_model(rng)
    balance, s = NewtonEuler(model), random_state(model, rng)
    found = balance.torques(s.q, s.v, s.a, s.w)
    by_q = central_difference(model, lambda q: balance.tau(q, s.v, s.a, s.w), s.q)
    pairs = (
        ("JointTorques.by_q", found.by_q, by_q),
        ("JointTorques.by_v", found.by_v, slope(lambda v: balance.tau(s.q, v, s.a, s.w), s.v)),
        ("JointTorques.by_a", found.by_a, slope(lambda a: balance.tau(s.q, s.v, a, s.w), s.a, 1e-3)),
        (
            "JointTorques.by_wrench",
            found.by_wrench,
            slope(lambda w: balance.tau(s.q, s.v, s.a, w), s.w, 1e-2),
        ),
    )
    whole = ("JointTorques.by_state", found.by_state, np.hstack([numeric for _, _, numeric in pairs]))
    return named("model.newton_euler", ("NewtonEuler.torques", found.by_q, by_q), *pairs, whole)


@checks("model.newton_euler.NewtonEuler.loaded", "model.newton_euler.NewtonEuler.jacobian", tolerance=1e-6)
def further_loads(rng):
    """Wrenches on some other segments; the feet's chains are among those of one of them."""
    model = random_model(rng)
    balance, s = NewtonEuler(model), random_state(model, rng)
    ids = [model.joint(name).joint_id for name in ("pelvis", "right_hand", "left_shank")]
    loads = dict(zip(ids, rng.normal(size=(3, 6)) * LOAD, strict=True))

    def tau(q, each):
        found = balance.torques(q, s.v, s.a, s.w)
        balance.loaded(found, dict(zip(ids, each.reshape(3, 6), strict=True)))
        return found

    found, whole = tau(s.q, np.concatenate([*loads.values()])), np.concatenate([*loads.values()])
    by_q = central_difference(model, lambda q: tau(q, whole).tau, s.q)
    J = np.vstack([balance.jacobian(joint) for joint in ids])
    by_loads = slope(lambda each: tau(s.q, each).tau, whole, 1e-2)
    return named("model.newton_euler.NewtonEuler", ("loaded", found.by_q, by_q), ("jacobian", J, -by_loads.T))


# The body of the torque filter.


def forced_body(rng, force_state=None):
    """A body, q, v, a and u under random loads, in a random choice of coordinates."""
    model = random_model(rng)
    chosen = force_state or str(rng.choice(FORCE_STATES))
    body = HumanDynamics(model, None, str(rng.choice(WRENCH_FRAMES)), chosen)
    q, v = moderate_pose(model, rng), rng.normal(size=model.nv)
    a = np.where(body.kinematic, 0.0, 5.0 * rng.normal(size=model.nv))
    return body, q, v, a, body.forces(q, v, a, rng.normal(size=(2, 6)) * LOAD)


@checks(
    "model.human_dynamics.HumanDynamics.linearise",
    *(f"model.forced_body.LinearAcceleration.by_{x}" for x in "qvu"),
    tolerance=2e-6,
)
def forward_dynamics(rng):
    """Both kinds of force states side by side."""
    stated, numeric = {x: [] for x in "qvu"}, {x: [] for x in "qvu"}
    for force_state in FORCE_STATES:
        body, q, v, _, u = forced_body(rng, force_state)
        found = body.linearise(q, v, u)
        for x in "qvu":
            stated[x].append(getattr(found, f"by_{x}"))
        numeric["q"].append(central_difference(body.model, partial(body.acceleration, v=v, u=u), q))
        numeric["v"].append(slope(partial(body.acceleration, q, u=u), v))
        numeric["u"].append(slope(partial(body.acceleration, q, v), u, 1.0))
    pairs = ((f"by_{x}", stated[x], numeric[x]) for x in "qvu")
    linearise = named("model.human_dynamics.HumanDynamics", ("linearise", stated["q"], numeric["q"]))
    return linearise | named("model.forced_body.LinearAcceleration", *pairs)


@checks(*(f"model.human_dynamics.JointForces.by_{x}" for x in "qvu"), tolerance=2e-6)
def joint_forces(rng):
    """Torques follow from "inertial" states only by subtracting loads; else they are states themselves."""
    model = random_model(rng)
    body = HumanDynamics(model, None, str(rng.choice(WRENCH_FRAMES)), "inertial")
    q, v, a = moderate_pose(model, rng), rng.normal(size=model.nv), rng.normal(size=model.nv)
    u = body.forces(q, v, a, rng.normal(size=(2, 6)) * LOAD)
    found = body.joint_forces(q, v, u)
    by_q = central_difference(model, lambda at: body.joint_forces(at, v, u).torque, q)
    return named(
        "model.human_dynamics.JointForces",
        ("by_q", found.by_q, by_q),
        ("by_v", found.by_v, slope(lambda at: body.joint_forces(q, at, u).torque, v)),
        ("by_u", found.by_u, slope(lambda at: body.joint_forces(q, v, at).torque, u, 1.0)),
    )


@checks("model.human_dynamics.HumanDynamics.force_rows", tolerance=1e-6)
def forces_of_accelerations(rng):
    body, q, v, a, u = forced_body(rng)
    wrench, dofs = u[len(body.torque_dofs) :], len(body.torque_dofs)

    def forces(x):
        acting = body.generalised(q, v, x[: body.nv], np.concatenate([np.zeros(dofs), x[body.nv :]]))
        own = body.model.mass_matrix(q) @ x[: body.nv]
        return np.concatenate(
            [(acting if body.force_state == "torque" else own)[body.torque_dofs], x[body.nv :]]
        )

    numeric = slope(forces, np.concatenate([a, wrench]), 1e-2)
    return named("model.human_dynamics.HumanDynamics", ("force_rows", body.force_rows(q), numeric))


@checks(
    "model.human_dynamics.HumanDynamics.retraction",
    "model.human_dynamics.HumanDynamics.transport",
    tolerance=1e-6,
)
def tangent_space(rng):
    body, q, v, _, _ = forced_body(rng)
    model, d, h = body.model, 0.3 * rng.normal(size=body.nv), 1e-5
    end = model.integrate(q, d)
    by_q = along(model, lambda at: model.integrate(at, d), q)
    by_d = slope(lambda at: model.difference(end, model.integrate(q, at)), d)
    forth, back = (model.integration_derivatives(q, s * h * v)[0] for s in (1.0, -1.0))
    return named(
        "model.human_dynamics.HumanDynamics",
        ("retraction", body.retraction(q, d), [by_q, by_d]),
        ("transport", body.transport(v), (forth - back) / (2 * h)),
    )


@checks("model.human_dynamics.HumanDynamics.local_wrench", tolerance=1e-6)
def wrenches_in_the_feet(rng):
    model, frame = random_model(rng), str(rng.choice(("ankle", "thesis")))
    body = HumanDynamics(model, wrench_frame=frame)
    q, state = moderate_pose(model, rng), rng.normal(size=12) * LOAD.repeat(2)
    _, by_state, by_q = body.local_wrench(q, state)
    numeric_q = central_difference(model, lambda at: body.local_wrench(at, state)[0], q)
    numeric = np.hstack([slope(lambda at: body.local_wrench(q, at)[0], state, 1e-2), numeric_q])
    return named("model.human_dynamics.HumanDynamics", ("local_wrench", np.hstack([by_state, by_q]), numeric))
