"""Optimal control: a squat with a motor at each knee, by direct collocation (CasADi) and IPOPT.

Found are the posture θ over time (ankle, knee, hip and lumbar joint, turned about y), the ground reaction and the
motors' torque u, so that ∫ Σ τ² dt of the muscles' joint torques is least; the muscles' knee torque is the joint's
less u. Both sides do the same, feet stay flat where they are, arms are held forward, other joints as in standing.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np
import pinocchio as pin
from matplotlib.figure import Figure

import mbkf
from mbkf.errors import NotConverged

JOINTS = {"ankle": "right_foot", "knee": "right_shank", "hip": "right_thigh", "lumbar": "torso"}
KNEE = np.array([0.0, 1.0, 0.0, 0.0])
EXTENDS = np.array([1.0, -1.0, 1.0, -1.0])  # sign of the turn about y that extends each
SIDES = np.array([2.0, 2.0, 2.0, 1.0])
SECONDS, STANDING_DEG, ARMS_DEG, FRICTION = 2.4, 5.0, -80.0, 0.5
TORQUE_NM = 100.0  # unit of torques in the objective
SMOOTH = 2e-3  # weight there of squared accelerations, s⁴/rad²
DEGREE = 3
PLACES = ca.collocation_points(DEGREE, "radau")
SLOPES, ENDS, WEIGHTS = ca.collocation_coeff(PLACES)


def mirrored_body(person):
    """The person's body with the mean of right and left sizes: only a symmetric one moves in a plane."""
    sizes, swap = person.scale_factors, {"right": "left", "left": "right"}
    other = {name: "_".join(swap.get(word, word) for word in name.split("_")) for name in sizes}
    mean = {name: 0.5 * (sizes[name] + sizes[other[name]]) for name in sizes}
    return mbkf.HumanModel.scaled(mean, person.mass_kg)


class PlanarBody:
    """The body on two flat feet: motion and forces from θ, θ̇, θ̈ and the reaction (F_x, F_z, −M_y) under each foot.

    ``motion`` gives q, v, a and both feet's wrenches; ``forces`` the load left over at the pelvis (F_x, F_z, M_y), and
    the extending torques at the four joints, of one leg and the trunk.
    """

    def __init__(self, body):
        self.body, self.dynamics = body, mbkf.casadi_dynamics(body)
        self.rows = [body.joint(segment).v.start + 1 for segment in JOINTS.values()]
        ankle = self._ankle(body.neutral()).full().ravel()
        soles = self.dynamics.soles(body.neutral(), np.zeros(body.nv))[0].full()
        self.ankle_height, self.soles_y = ankle[2] - soles[0, 2], soles[[0, 3], 1]
        # Toes have no torque of their own and bear no load: pressure lies between heel and ball.
        self.heel, self.ball = soles[0, 0] - ankle[0], soles[1, 0] - ankle[0]
        theta, rate, acceleration = (ca.SX.sym(name, 4) for name in ("theta", "rate", "acceleration"))
        reaction = ca.SX.sym("reaction", 3)
        q = self._posture(theta)
        v = self._velocity(q, theta, rate)
        a = ca.jtimes(v, theta, rate) + ca.jtimes(v, rate, acceleration)
        x, z, turning = ca.vertsplit(reaction)
        wrenches = ca.vertcat(*(ca.horzcat(x, 0, z, y * z, -turning, -y * x) for y in self.soles_y))
        tau = self.dynamics.inverse_dynamics(q, v, a, wrenches)
        inputs = [theta, rate, acceleration, reaction]
        self.motion = ca.Function("motion", inputs, [q, v, a, wrenches])
        self.forces = ca.Function("forces", inputs, [tau[[0, 2, 4]], EXTENDS * tau[self.rows]])

    def _ankle(self, q):
        row = self.dynamics.segment_names.index(JOINTS["ankle"])
        return self.dynamics.segments(q, np.zeros(self.body.nv))[0][row, :].T

    def _posture(self, theta):
        """Configuration (nq,) with the ankles over the world's y axis."""
        q, (ankle, knee, hip, lumbar) = ca.SX(self.body.neutral()), ca.vertsplit(theta)
        legs = {"foot": ankle, "shank": knee, "thigh": hip, "upper_arm": np.deg2rad(ARMS_DEG)}
        turns = {f"{side}_{part}": turn for side in ("right", "left") for part, turn in legs.items()}
        turns |= {"torso": lumbar, "pelvis": -(ankle + knee + hip)}
        for segment, turn in turns.items():
            end = self.body.joint(segment).q.stop
            q[end - 4 : end] = ca.vertcat(0, ca.sin(turn / 2), 0, ca.cos(turn / 2))
        at = self._ankle(q)
        q[0], q[2] = -at[0], self.ankle_height - at[2]
        return q

    def _velocity(self, q, theta, rate):
        """Velocity (nv,): turns about y, and the pelvis's path in its own axes."""
        v, legs = ca.SX.zeros(self.body.nv), ca.sum1(theta[:3])
        for side in ("right", "left"):
            for part, own in zip(("foot", "shank", "thigh"), ca.vertsplit(rate[:3]), strict=True):
                v[self.body.joint(f"{side}_{part}").v.start + 1] = own
        v[self.rows[-1]] = rate[3]
        x, _, z = ca.vertsplit(ca.jtimes(q[:3], theta, rate))
        v[0], v[2] = ca.cos(legs) * x + ca.sin(legs) * z, -ca.sin(legs) * x + ca.cos(legs) * z
        v[4] = -ca.sum1(rate[:3])
        return v


@dataclass(frozen=True)
class Squat:
    """An optimal squat at K collocation points, and θ, θ̇ (8, N + 1) at the nodes of its mesh; rad, s, N, N m."""

    times: np.ndarray  # (K,)
    states: np.ndarray  # (8, K) θ, θ̇
    accelerations: np.ndarray  # (4, K)
    reactions: np.ndarray  # (3, K) under one foot
    torques: np.ndarray  # (4, K) of the joints, extending
    motor: np.ndarray  # (K,)
    nodes: np.ndarray
    status: str

    @property
    def muscles(self):
        """(4, K) torques of the muscles."""
        return self.torques - np.outer(KNEE, self.motor)


def optimal_squat(planar, motor_nm, depth_deg=90.0, intervals=16, iterations=300):
    """The squat of least muscle torques with motors of 0 to ``motor_nm`` at the knees.

    Raises:
        NotConverged: IPOPT ended without a solution.
    """
    count, step, half_weight = intervals * DEGREE, SECONDS / intervals, planar.body.mass_kg * 9.81 / 2
    problem = ca.Opti()
    nodes, states = problem.variable(8, intervals + 1), problem.variable(8, count)
    accelerations, loads, motor = (problem.variable(rows, count) for rows in (4, 3, 1))
    unknowns = states[:4, :], states[4:, :], accelerations, half_weight * loads
    root, torques = planar.forces.map(count)(*unknowns)
    problem.subject_to(ca.vec(root) / half_weight == 0)  # the ground alone pushes the body
    for k in range(intervals):
        own = slice(k * DEGREE, (k + 1) * DEGREE)
        curve = ca.horzcat(nodes[:, k], states[:, own])
        rates = ca.vertcat(states[4:, own], accelerations[:, own])
        problem.subject_to(ca.vec(curve @ SLOPES - step * rates) == 0)
        problem.subject_to(nodes[:, k + 1] == curve @ ENDS)
    _contact(problem, planar, loads)
    _movement(problem, planar, nodes, depth_deg)
    problem.subject_to(problem.bounded(0, motor, motor_nm / TORQUE_NM))
    muscles = torques / TORQUE_NM - KNEE[:, None] @ motor
    effort = SIDES[None, :] @ muscles**2 + SMOOTH * ca.sum1(accelerations**2)
    problem.minimize(step * effort @ ca.repmat(WEIGHTS, intervals, 1))
    times = np.add.outer(step * np.arange(intervals), step * np.array(PLACES)).ravel()
    problem.set_initial(nodes, guess(step * np.arange(intervals + 1), depth_deg))
    problem.set_initial(states, guess(times, depth_deg))
    problem.set_initial(loads[1, :], 1.0)
    limits = {"print_level": 0, "sb": "yes", "tol": 1e-10, "max_iter": iterations}
    problem.solver("ipopt", {"print_time": False}, limits)
    try:
        found = problem.solve()
    except RuntimeError as failure:
        raise NotConverged(
            f"IPOPT ended a squat of {depth_deg:g} degrees with '{problem.return_status()}' after "
            f"{problem.stats()['iter_count']} iterations; choose a shallower squat, more time or more iterations"
        ) from failure
    values = states, accelerations, half_weight * loads, torques, TORQUE_NM * motor, nodes
    return Squat(times, *(found.value(one) for one in values), found.stats()["return_status"])


def _contact(problem, planar, loads):
    """Reactions lie in the friction cone, their centre of pressure on the sole."""
    x, z, turning = ca.vertsplit(loads)
    for cone in (FRICTION * z - x, FRICTION * z + x, turning - planar.heel * z, planar.ball * z - turning):
        problem.subject_to(ca.vec(cone) >= 0)


def _movement(problem, planar, nodes, depth_deg):
    """From rest down to a knee flexion, and up to the same rest, within the ranges of the joints."""
    least, most = planar.body.limits[planar.rows].T
    least = np.where(np.arange(4) == 3, 0.0, least)  # the trunk does not bend backwards
    problem.subject_to(ca.vec(nodes[:4, :] - least) >= 0)
    problem.subject_to(ca.vec(most - nodes[:4, :]) >= 0)
    for node, knee_deg in ((0, STANDING_DEG), (nodes.shape[1] // 2, depth_deg)):
        problem.subject_to(KNEE[None, :] @ nodes[:4, node] == np.deg2rad(knee_deg))
        problem.subject_to(nodes[4:, node] == 0)
    problem.subject_to(nodes[:, -1] == nodes[:, 0])


def guess(times, depth_deg):
    """(8, T) a smooth way down and up, where the search starts."""
    lowest, phase = np.deg2rad([-35.0, depth_deg, -65.0, 5.0]), 2 * np.pi * times / SECONDS
    shape, rate = 0.5 * (1 - np.cos(phase)), np.pi / SECONDS * np.sin(phase)
    return np.vstack([np.outer(lowest, shape), np.outer(lowest, rate)])


def physics(planar, squat):
    """Errors by Pinocchio: equations of motion (N, N m), feet (m), energy of the way down (share of its work)."""
    body, model = planar.body, planar.body.pin_model
    data, feet = model.createData(), [body.joint(name).joint_id for name in body.roles.feet]
    residuals, places, power = [], [], []
    for k in range(len(squat.times)):
        own = squat.states[:4, k], squat.states[4:, k], squat.accelerations[:, k], squat.reactions[:, k]
        q, v, a, wrenches = (one.full().squeeze() for one in planar.motion(*own))
        pin.forwardKinematics(model, data, q)
        loads = pin.StdVec_Force([pin.Force.Zero()] * model.njoints)
        for foot, wrench in zip(feet, wrenches, strict=True):
            loads[foot] = data.oMi[foot].actInv(pin.Force(wrench))
        places.append([data.oMi[foot].homogeneous for foot in feet])
        tau = pin.rnea(model, data, q, v, a, loads)
        residuals += [*tau[:6], *(EXTENDS * tau[planar.rows] - squat.torques[:, k])]
        power.append(tau @ v)
    half = len(power) // 2
    step = SECONDS * DEGREE / len(power)
    work = step * np.tile(WEIGHTS.full().ravel(), half // DEGREE) @ power[:half]
    gained = energy(planar, squat.nodes[:, squat.nodes.shape[1] // 2]) - energy(planar, squat.nodes[:, 0])
    return np.abs(residuals).max(), np.ptp(places, axis=0).max(), abs(work - gained) / abs(gained)


def energy(planar, state):
    """Kinetic and potential energy, J, of θ and θ̇ (8,)."""
    q, v = (one.full().ravel() for one in planar.motion(state[:4], state[4:], np.zeros(4), np.zeros(3))[:2])
    return pin.computeMechanicalEnergy(planar.body.pin_model, planar.body.pin_model.createData(), q, v)


def drawn(alone, assisted):
    """Flexion of the joints, and knee torques of one leg, with and without motors."""
    figure = Figure(figsize=(9, 3.6), layout="constrained")
    angles, torques = figure.subplots(1, 2)
    for k, name in enumerate(JOINTS):
        flexion = [-EXTENDS[k] * np.rad2deg(squat.states[k]) for squat in (alone, assisted)]
        angles.plot(alone.times, flexion[0], "--", color=f"C{k}")
        angles.plot(assisted.times, flexion[1], color=f"C{k}", label=name)
    torques.plot(alone.times, alone.muscles[1], "k--", label="muscles, no motor")
    torques.plot(assisted.times, assisted.muscles[1], "k", label="muscles, with motor")
    torques.plot(assisted.times, assisted.motor, "C3", label="motor")
    angles.set(xlabel="time (s)", ylabel="flexion (°), dashed: no motor")
    torques.set(xlabel="time (s)", ylabel="knee torque, one leg (N m)")
    for axes, columns in ((angles, 4), (torques, 3)):
        axes.legend(
            frameon=False, ncols=columns, loc="lower center", bbox_to_anchor=(0.5, 1.0), columnspacing=1.0
        )
    return figure


if __name__ == "__main__":
    person, _ = mbkf.synthesise("squat", seconds=1.0, seed=5)
    planar = PlanarBody(mirrored_body(person))
    alone, assisted = (optimal_squat(planar, motor_nm) for motor_nm in (0.0, 40.0))
    for name, squat in {"no motor": alone, "40 N m": assisted}.items():
        knee, (residual, moved_m, unbalanced) = np.abs(squat.muscles[1]), physics(planar, squat)
        print(f"{name}: {squat.status}; knee muscles bear {knee.max():.0f} N m, on average {knee.mean():.0f}")
        print(f"  residual {residual:.1e} N, feet move {moved_m:.1e} m, energy within {unbalanced:.1e}")
        assert squat.status == "Solve_Succeeded" and residual < 1e-6 and moved_m < 1e-9 and unbalanced < 1e-3
    drawn(alone, assisted).savefig("assisted_squat.png", dpi=110)
    assert np.abs(assisted.muscles[1]).max() < np.abs(alone.muscles[1]).max() - 30.0
