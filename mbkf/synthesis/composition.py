"""From a plan to a motion: finds the height, the path of the centre of mass and the turning in flight that fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import NotConverged
from mbkf.model.body import Body
from mbkf.numerics.threads import single_threaded
from mbkf.synthesis.balance import HorizontalPath
from mbkf.synthesis.curves import Curve
from mbkf.synthesis.dual_numbers import Dual
from mbkf.synthesis.flight import SMALL, Tumbling
from mbkf.synthesis.holding import Correction
from mbkf.synthesis.inverse_kinematics import FootPose, HandPose, InverseKinematics, Pose, Posture
from mbkf.synthesis.plan import MotionPlan
from mbkf.synthesis.support import weight_n, zero_moment

STEP_S = 0.005
"""Grid on which balance is solved."""

LIFTS, ROUNDS = 3, 8
"""Iterations that find the height alone, and all together."""

FLIGHT_ROUNDS = 40

HOLD_ROUNDS, NEAR_M, FAR_M = 24, 0.001, 0.02
"""Most iterations that bring a supported part to its place, the distance that suffices, and the one that fails."""


@dataclass(frozen=True)
class Given:
    """A plan at (T,) times in s: joint angles by joint, rad, and the poses of feet and hands by side."""

    times: Array
    angles: dict[str, tuple[Dual, ...]]
    feet: dict[str, FootPose]
    hands: dict[str, HandPose] | None


@dataclass
class Composition:
    """A plan completed by vertical shift in m, horizontal path of the centre of mass and pelvis angles.

    ``found`` holds (T,) times and the (T, 3) way from the centre of mass to the pelvis then, m, once it was found.
    """

    plan: MotionPlan
    kinematics: InverseKinematics
    horizontal: HorizontalPath
    pelvis: tuple[Curve, Curve, Curve]
    lift_m: float = 0.0
    correction: Correction | None = None
    found: tuple[Array, Array] | None = None

    def height(self, times: Array) -> Dual:
        """(T,) height of the centre of mass."""
        planned = self.plan.height(times) + self.lift_m
        return planned if self.correction is None else planned + self.correction(times)[:, 1]

    def com(self, times: Array) -> Dual:
        """(T, 3) centre of mass."""
        plane, height = self.horizontal(times), self.height(times)
        return Dual(*(np.column_stack([p, h]) for p, h in zip(plane.orders, height.orders, strict=True)))

    def given(self, times: Array) -> Given:
        """Values of the plan at times in s."""
        angles = {joint: tuple(curve(times) for curve in axes) for joint, axes in self.plan.angles.items()}
        hands = None if self.plan.hands is None else self.plan.hands(times)
        return Given(times, angles, self.plan.feet(times), hands)

    def posture(self, given: Given, pelvis: tuple[Dual, ...] | None = None) -> Posture:
        """The body without its centre of mass.

        Args:
            given: Values of the plan.
            pelvis: (T,) pelvis angles about x, y and z, rad; by default the composition's own.
        """
        angles = {**given.angles, "pelvis": pelvis or self._pelvis(given.times)}
        if self.correction is not None:
            lean = self.correction(given.times)[:, 0]
            for joint, gains in self.correction.hold.lean.items():
                if joint != "pelvis":
                    angles[joint] = _leaned(angles[joint], gains, lean)
        return self.kinematics.posture(angles, given.feet, given.hands)

    def pose(self, times: Array) -> Pose:
        """The body over time."""
        com, start = self.com(times), None
        if self.found is not None:
            at, way = self.found
            start = com.value + np.column_stack([np.interp(times, at, axis) for axis in way.T])
        return self.kinematics.pose(com, self.posture(self.given(times)), start)

    def _pelvis(self, times: Array) -> tuple[Dual, ...]:
        """(T,) pelvis angles about x, y and z, rad."""
        angles = tuple(curve(times) for curve in self.pelvis)
        if self.correction is None:
            return angles
        gains = self.correction.hold.lean.get("pelvis", (0.0, 0.0, 0.0))
        return _leaned(angles, gains, self.correction(times)[:, 0])


def _leaned(angles: tuple[Dual, ...], gains: tuple[float, float, float], lean: Dual) -> tuple[Dual, ...]:
    return tuple(angle + lean * gain for angle, gain in zip(angles, gains, strict=True))


@single_threaded()
def compose(model: Body, plan: MotionPlan) -> Composition:
    """Solves balance and flight for a plan.

    Raises:
        NotConverged: The flight was not found, or a supported part does not stay in place.
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
    if plan.hold is not None:
        result.correction = Correction(plan.hold, times)
    given, still = result.given(times), tumbling is None and not (plan.hold and plan.hold.lean)
    posture = result.posture(given)
    airborne = given if tumbling is None else result.given(tumbling.times)
    turning = np.zeros((len(times), 2))
    start: Array | None = None
    missed_m = 0.0
    for k in range(LIFTS + (ROUNDS if plan.hold is None else HOLD_ROUNDS)):
        height = result.height(times)
        vertical = weight_n(model.mass_kg, height.second)
        target, level = zero_moment(plan.supports, times, load, height.value, vertical)
        over = Dual(height.value - level, height.first, height.second)
        result.horizontal.solve(times, target, over, turning)
        posture = posture if still else result.posture(given)
        com = result.com(times)
        values = k < LIFTS or tumbling is not None
        pose = result.kinematics.pose(com.upto(0) if values else com, posture, start)
        start = pose.origins["pelvis"].value
        result.found = times, start - com.value
        result.lift_m += _lift(result, pose, times)
        if k < LIFTS:
            continue
        if result.correction is not None:
            missed_m = result.correction.improve(pose)
            if missed_m < NEAR_M and k > ROUNDS:
                break
        if tumbling is not None:
            _fly(result, tumbling, airborne, 3)
            pose = result.kinematics.pose(result.com(times), result.posture(given), start)
        _, (_, change) = result.kinematics.momentum(pose)
        turning = np.column_stack([change[:, 1], -change[:, 0]]) / result.kinematics.total_mass
    if missed_m > FAR_M:
        raise NotConverged("a supported part of the body does not stay in its place; try another seed")
    if tumbling is not None and _fly(result, tumbling, airborne, FLIGHT_ROUNDS) > 1e3 * SMALL:
        raise NotConverged("the flight was not found; try another seed")
    return result


def _fly(composition: Composition, tumbling: Tumbling, given: Given, rounds: int) -> float:
    """Turns the pelvis in the air; returns the last change of its rates in rad/s."""
    kinematics, com = composition.kinematics, composition.com(tumbling.times).upto(1)
    start = kinematics.pose(com.upto(0), composition.posture(given)).origins["pelvis"].value

    def momentum(angles: tuple[Dual, Dual, Dual]) -> Array:
        return kinematics.momentum(kinematics.pose(com, composition.posture(given, angles), start))[1][0]

    change = tumbling.refine(momentum, rounds)
    composition.pelvis = tumbling.curves()
    return change


def _lift(composition: Composition, pose: Pose, times: Array) -> float:
    """Height by which the body may rise until its straightest knee has the planned flexion, m.

    With something that stays on a support, only where nothing changes for that.
    """
    kinematics, plan = composition.kinematics, composition.plan
    start, end = plan.recorded_s or (plan.start_s, plan.end_s)
    use = (times >= start - STEP_S) & (times <= end + STEP_S)
    if plan.hold is not None:
        use &= plan.hold.free(times) > 0
    reach = pose.reach[use].max()
    return 0.9 * (np.cos(plan.straightest_rad / 2) - reach) * kinematics.leg_length("r")
