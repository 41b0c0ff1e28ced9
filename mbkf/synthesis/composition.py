"""From a plan to a motion: finds the height, the path of the centre of mass and the turning in flight that fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import NotConverged
from mbkf.model.body import Body
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis import dual_numbers
from mbkf.synthesis.balance import HorizontalPath
from mbkf.synthesis.curves import Curve
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.flight import SMALL, Tumbling
from mbkf.synthesis.inverse_kinematics import InverseKinematics, Pose
from mbkf.synthesis.plan import MotionPlan

STEP_S = 0.005
"""Grid on which balance is solved."""

LIFTS, ROUNDS = 3, 8
"""Iterations that find the height alone, and all together."""

FLIGHT_ROUNDS = 40


@dataclass
class Composition:
    """A plan completed by vertical shift in m, horizontal path of the centre of mass and pelvis angles."""

    plan: MotionPlan
    kinematics: InverseKinematics
    horizontal: HorizontalPath
    pelvis: tuple[Curve, Curve, Curve]
    lift_m: float = 0.0

    def com(self, times: Array) -> Dual:
        """(T, 3) centre of mass."""
        plane, height = self.horizontal(times), self.plan.height(times) + self.lift_m
        return Dual(*(np.column_stack([p, h]) for p, h in zip(plane.orders, height.orders, strict=True)))

    def pose(self, times: Array, start: Dual | None = None, pelvis: tuple[Dual, ...] | None = None) -> Pose:
        """The body over time.

        Args:
            times: (T,) s.
            start: (T, 3) pelvis position from which the inverse kinematics start; by default the centre of mass.
            pelvis: (T,) pelvis angles about x, y and z, rad; by default the composition's own.
        """
        angles = {joint: tuple(curve(times) for curve in axes) for joint, axes in self.plan.angles.items()}
        angles["pelvis"] = pelvis or tuple(curve(times) for curve in self.pelvis)
        return self.kinematics.pose(self.com(times), angles, self.plan.feet(times), start)

    def coordinates(self, times: Array) -> tuple[Array, Array, Array]:
        """q, v and a at times in s."""
        return self.kinematics.coordinates(self.pose(times))

    def pelvis_rotations(self, times: Array) -> Array:
        """(T, 3, 3) world rotations of the pelvis."""
        return dual_numbers.euler((curve(times) for curve in self.pelvis), order="zyx").value


@single_threaded()
def compose(model: Body, plan: MotionPlan) -> Composition:
    """Solves balance and flight for a plan.

    Raises:
        NotConverged: The flight was not found.
    """
    times = np.linspace(plan.start_s, plan.end_s, round((plan.end_s - plan.start_s) / STEP_S) + 1)
    load = plan.load(times)
    tumbling = None if plan.flight is None else Tumbling(plan.flight)
    spells = [(plan.start_s, plan.end_s)]
    if plan.flight is not None:
        spells = [(plan.start_s, plan.flight.take_off_s), (plan.flight.touch_down_s, plan.end_s)]
    result = Composition(
        plan,
        InverseKinematics(model),
        HorizontalPath(spells),
        plan.angles["pelvis"] if tumbling is None else tumbling.curves(),
    )
    turning = np.zeros((len(times), 2))
    start: Dual | None = None
    for k in range(LIFTS + ROUNDS):
        height = plan.height(times) + result.lift_m
        over = Dual(height.value - load.mean_surface, height.first, height.second)
        result.horizontal.solve(times, load.zero_moment(height.value), over, turning)
        pose = result.pose(times, start)
        start = pose.origins["pelvis"]
        result.lift_m += _lift(result, pose, times)
        if k < LIFTS:
            continue
        if tumbling is not None:
            _fly(result, tumbling, 3)
            pose = result.pose(times, start)
        _, _, change = result.kinematics.momentum(pose)
        turning = np.column_stack([change[:, 1], -change[:, 0]]) / result.kinematics.total_mass
    if tumbling is not None and _fly(result, tumbling, FLIGHT_ROUNDS) > 1e3 * SMALL:
        raise NotConverged("the flight was not found; try another seed")
    return result


def _fly(composition: Composition, tumbling: Tumbling, rounds: int) -> float:
    """Turns the pelvis in the air; returns the last change of its rates in rad/s."""
    start = composition.pose(tumbling.times).origins["pelvis"]

    def momentum(angles: tuple[Dual, Dual, Dual]) -> Array:
        return composition.kinematics.momentum(composition.pose(tumbling.times, start, angles))[1]

    change = tumbling.refine(momentum, rounds)
    composition.pelvis = tumbling.curves()
    return change


def _lift(composition: Composition, pose: Pose, times: Array) -> float:
    """How much higher the body may stand until its straightest knee has the planned flexion, m."""
    kinematics, plan = composition.kinematics, composition.plan
    start, end = plan.recorded_s or (plan.start_s, plan.end_s)
    reach = pose.reach[(times >= start - STEP_S) & (times <= end + STEP_S)].max()
    return 0.9 * (np.cos(plan.straightest_rad / 2) - reach) * kinematics.leg_length("r")
