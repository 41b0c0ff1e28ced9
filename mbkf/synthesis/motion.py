"""True motions of a body: joint trajectories, torques and ground reactions that obey Newton's law together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, SIDES, Array, read_only
from mbkf.errors import InvalidInput, NotConverged
from mbkf.model.body import Body
from mbkf.synthesis.composition import Composition, compose
from mbkf.synthesis.contact import FRICTION, sole_outline, split
from mbkf.synthesis.coordinates import coordinates
from mbkf.synthesis.inverse_kinematics import SIDE_NAMES
from mbkf.synthesis.motions import registered_motion
from mbkf.synthesis.plan import held
from mbkf.synthesis.strength import overloaded
from mbkf.synthesis.support import SEGMENTS, Support, fault, wrenches

ATTEMPTS, BENT_RAD = 4, np.deg2rad(1.5)
"""Number of times that a failed motion is tried again, each time with the knees bent a little more."""

MIN_SECONDS, MAX_SECONDS = 1.0, 120.0


@dataclass(frozen=True)
class TrueMotion:
    """A motion known exactly.

    Attributes:
        name: Name of the registered motion.
        rate_hz: Sample rate.
        times_s: (T,) s.
        q: (T, nq) configuration.
        v: (T, nv) its exact rate in the tangent space.
        a: (T, nv) the exact rate of v.
        tau: (T, nv) generalised forces of the joints; the six of the pelvis are 0.
        foot_wrench: (T, 2, 6) force N and moment N m about the world origin, world axes, of the ground on the
            right, then the left foot (with its toes), applied to the foot segment.
        centre_of_pressure: (T, 2, 3) on the surface under the foot, m; NaN for a foot without load.
        plate_rate_hz: Sample rate of ``plate_wrench``, a multiple of ``rate_hz``.
        plate_wrench: (S, 2, 6) the same wrenches at that rate.
        plate_surface_m: (S, 2) height of the surface under right and left foot at that rate, m.
        flight_s: Take-off and touch-down times of a jump; None: no flight.
        support_names: S parts of the body that bear besides the feet, out of
            :data:`mbkf.synthesis.support.SEGMENTS`, which also names the segment that takes each wrench.
        support_wrench: (T, S, 6) force N and moment N m about the world origin, world axes, on these segments; 0
            without contact.
        belts: Belts of a treadmill, each with one plate: 1 under both feet, 2 for one each; 0 on the floor.
    """

    name: str
    rate_hz: float
    times_s: Array
    q: Array
    v: Array
    a: Array
    tau: Array
    foot_wrench: Array
    centre_of_pressure: Array
    plate_rate_hz: float
    plate_wrench: Array
    plate_surface_m: Array
    flight_s: tuple[float, float] | None = None
    support_names: tuple[str, ...] = ()
    support_wrench: Array = field(default_factory=lambda: np.zeros((0, 0, 6)))
    belts: int = 0

    def __post_init__(self) -> None:
        if not self.support_names:
            object.__setattr__(self, "support_wrench", np.zeros((len(self.times_s), 0, 6)))
        for each in fields(self):
            value = getattr(self, each.name)
            if isinstance(value, np.ndarray):
                object.__setattr__(self, each.name, read_only(value))


def synthesise_motion(
    model: Body,
    motion: str,
    seconds: float,
    rate_hz: float = 100.0,
    seed: int = 0,
    habit_deg: Mapping[str, float] | None = None,
) -> TrueMotion:
    """Makes a motion of a body, a different one for every seed.

    Args:
        model: The body that moves.
        motion: Name of a registered motion, see :mod:`mbkf.synthesis.motions`.
        seconds: Duration, s.
        rate_hz: Sample rate of the result.
        seed: Chooses the motion's details.
        habit_deg: How the person holds joints besides what the motion asks (:attr:`mbkf.io.subject.Subject.habit_deg`).

    Raises:
        UnknownName: The motion does not exist.
        InvalidInput: Duration or rate make no sense.
        NotConverged: Balance was not found for this body.
    """
    kind = registered_motion(motion)
    if not MIN_SECONDS <= seconds <= MAX_SECONDS:
        raise InvalidInput(f"a motion lasts {MIN_SECONDS:g} to {MAX_SECONDS:g} s, got {seconds:g} s")
    if not 20.0 <= rate_hz <= 2000.0:
        raise InvalidInput(f"a camera rate lies between 20 and 2000 Hz, got {rate_hz:g} Hz")
    plan = held(
        kind.planner(model, float(seconds), np.random.default_rng([seed, kind.stream])), habit_deg or {}
    )
    every = max(1, int(np.ceil(1000.0 / rate_hz - 1e-9)))
    frames = int(np.floor(seconds * rate_hz + 1e-9)) + 1
    fine = np.arange((frames - 1) * every + 1) / (rate_hz * every)
    for attempt in range(ATTEMPTS):
        bent = replace(plan, straightest_rad=plan.straightest_rad + attempt * BENT_RAD)
        moved = _dynamics(model, compose(model, bent), fine, every)
        problem = _fault(model, moved, plan.supports) or _strain(model, moved.tau)
        if not problem:
            break
    else:
        raise NotConverged(f"{motion} of this person: {problem}; try another seed")
    flight = plan.flight
    return TrueMotion(
        motion,
        rate_hz,
        fine[::every],
        moved.q,
        moved.v,
        moved.a,
        moved.tau,
        moved.feet[::every],
        moved.centres,
        rate_hz * every,
        moved.feet,
        moved.surfaces,
        None if flight is None else (flight.take_off_s, flight.touch_down_s),
        tuple(support.name for support in plan.supports),
        moved.supports[::every],
        plan.belts,
    )


@dataclass(frozen=True)
class _Moved:
    """q, v, a, tau and centres of pressure at the cameras' times; wrenches and surfaces of contact at the plates'."""

    q: Array
    v: Array
    a: Array
    tau: Array
    centres: Array
    feet: Array
    supports: Array
    surfaces: Array


def _dynamics(model: Body, composition: Composition, times: Array, every: int) -> _Moved:
    """The motion at every n-th time, wrenches at all."""
    plan, kinematics, pose = composition.plan, composition.kinematics, composition.pose(times)
    q, v, a = coordinates(model, pose, every)
    load = plan.load(times)
    for k in np.flatnonzero(~load.grounded[::every]).tolist():
        needed = model.inverse_dynamics(q[k], v[k], a[k])[:6]
        a[k, :6] -= np.linalg.solve(model.mass_matrix(q[k])[:6, :6], needed)
    com, (_, change) = kinematics.momentum(pose)
    force = kinematics.total_mass * (com.second + np.array([0.0, 0.0, GRAVITY_M_S2]))
    moment = change + np.cross(com.value, force)
    carried = wrenches(plan.supports, times, force)
    rest = np.hstack([force, moment]) - carried.sum(axis=1)
    feet, centres = split(rest, load, com.value[:, 2])
    names = [f"{SIDE_NAMES[side]}_foot" for side in SIDES] + [SEGMENTS[s.name] for s in plan.supports]
    joints = [model.joint(name).joint_id for name in names]
    own = np.concatenate([feet, carried], axis=1)[::every]
    tau = np.empty_like(v)
    for k in range(len(tau)):
        tau[k] = model.inverse_dynamics(q[k], v[k], a[k])
        jacobian = model.spatial_jacobian(q[k])
        for contact, joint in enumerate(joints):
            tau[k] -= np.where(model.supports[joint], own[k, contact] @ jacobian, 0.0)
    return _Moved(q, v, a, tau, centres[::every], feet, carried, load.surfaces)


def _strain(model: Body, tau: Array) -> str:
    """A sentence on the joint that would need more strength than people have; "" where every torque is possible."""
    joint = overloaded(model, tau)
    return f"{joint} would have to be stronger than people are" if joint else ""


def _fault(model: Body, moved: _Moved, supports: tuple[Support, ...]) -> str:
    """A sentence on a broken law of contact, "" without: the ground pushes, under the soles, within friction."""
    every = (len(moved.feet) - 1) // max(1, len(moved.q) - 1)
    for foot, side in enumerate(SIDES):
        name, fine = SIDE_NAMES[side], moved.feet[:, foot]
        along = np.linalg.norm(fine[:, :2], axis=1)
        if fine[:, 2].min() < 0:
            return f"the {name} foot would pull at the floor"
        if (along > FRICTION * fine[:, 2] + 1e-9).any():
            return f"the {name} foot would slip"
        outline, joint = sole_outline(model, side), model.joint(f"{name}_foot").joint_id
        for k in np.flatnonzero(fine[::every, 2] > 0):
            rotations, origins = model.placements(moved.q[int(k)])
            if not outline.holds(rotations[joint].T @ (moved.centres[k, foot] - origins[joint])):
                return f"the pressure leaves the {name} sole"
    return fault(supports, moved.supports)
