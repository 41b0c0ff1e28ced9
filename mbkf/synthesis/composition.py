"""From a plan to a motion: finds the height, the path of the centre of mass and the turning in flight that fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import NotConverged
from mbkf.model.human import HumanModel
from mbkf.synthesis import jets
from mbkf.synthesis.balance import HorizontalPath, zero_moment_point
from mbkf.synthesis.curves import Curve
from mbkf.synthesis.figure import Figure, Pose
from mbkf.synthesis.jets import Jet
from mbkf.synthesis.plan import MotionPlan

STEP_S = 0.01
"""Grid on which balance is solved."""

LIFTS, ROUNDS = 3, 8
CLOSE_M = 5e-4
"""Balance is found when the pressure lies this close to where the plan wants it, or cannot be improved."""


@dataclass
class Composition:
    """A plan and what it lacked: vertical shift in m, horizontal path of the centre of mass, pelvis angles."""

    plan: MotionPlan
    figure: Figure
    horizontal: HorizontalPath
    pelvis: tuple[Curve, Curve, Curve]
    lift_m: float = 0.0

    def com(self, times: Array) -> Jet:
        """(T, 3) centre of mass."""
        plane, height = self.horizontal(times), self.plan.height(times) + self.lift_m
        return Jet(*(np.column_stack([p, h]) for p, h in zip(plane.orders, height.orders, strict=True)))

    def pose(self, times: Array, start: Jet | None = None) -> Pose:
        """The body at times in s."""
        curves = {**self.plan.angles, "pelvis": self.pelvis}
        angles = {joint: tuple(curve(times) for curve in axes) for joint, axes in curves.items()}
        return self.figure.pose(self.com(times), angles, self.plan.feet(times), start)

    def coordinates(self, times: Array) -> tuple[Array, Array, Array]:
        """q, v and a at times in s."""
        return self.figure.coordinates(self.pose(times))

    def pelvis_rotations(self, times: Array) -> Array:
        """(T, 3, 3) world rotations of the pelvis."""
        return jets.euler(*(curve(times) for curve in self.pelvis), order="zyx").value


def compose(model: HumanModel, plan: MotionPlan) -> Composition:
    """Solves balance for a plan.

    Raises:
        NotConverged: The legs do not reach, or the pressure stays away from where it must be.
    """
    times = np.linspace(plan.start_s, plan.end_s, round((plan.end_s - plan.start_s) / STEP_S) + 1)
    load = plan.load(times)
    result = Composition(plan, Figure(model), HorizontalPath([(plan.start_s, plan.end_s)]), plan.angles["pelvis"])
    turning = np.zeros((len(times), 2))
    start: Jet | None = None
    for k in range(LIFTS + ROUNDS):
        result.horizontal.solve(times, load.total_pressure, plan.height(times) + result.lift_m, turning)
        pose = result.pose(times, start)
        start = pose.origins["pelvis"]
        raised = _lift(result, pose, times)
        result.lift_m += raised
        if k < LIFTS:
            continue
        _, _, change = result.figure.momentum(pose)
        turning = np.column_stack([change[:, 1], -change[:, 0]]) / result.figure.total_mass
    return result


def _lift(composition: Composition, pose: Pose, times: Array) -> float:
    """How much higher the body may stand until its straightest knee has the planned flexion, m."""
    figure, plan = composition.figure, composition.plan
    start, end = plan.recorded_s or (plan.start_s, plan.end_s)
    reach = pose.reach[(times >= start - STEP_S) & (times <= end + STEP_S)].max()
    return 0.9 * (np.cos(plan.straightest_rad / 2) - reach) * figure.leg_length("r")
