"""The dynamic filter: positions, velocities, accelerations and foot wrenches that obey Newton's law together.

For given q and v, (a, w) and (τ, w) are equivalent, τ = ID(q, v, a) − Jᵀw. A state of accelerations instead of torques
has a linear plant that is never stiff; Newton's law at the pelvis is one of its readings, and torques follow.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.filters.dynamic.plant import DynamicState, SingerPlant
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.filter import Filter, Step
from mbkf.filters.plant import PlantMaker
from mbkf.model.layout import FEET, Layout
from mbkf.model.newton_euler import NewtonEuler
from mbkf.sensors.block import AnyBlock, Frame
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.coordination.prior import CoordinationPrior
from mbkf.sensors.foot_contact import FootContact
from mbkf.sensors.holes import posture_scales
from mbkf.sensors.inertial import InertialSensors
from mbkf.sensors.inertial_sensor import InertialSensor
from mbkf.sensors.joint_limits import JointLimits
from mbkf.sensors.lasting_noise import prior_dilution
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.sensors.markers import Markers
from mbkf.sensors.mean_posture import MeanPosture
from mbkf.sensors.newton_euler import NewtonEulerLaw
from mbkf.sensors.planted import PlantedFeet
from mbkf.sensors.posture import PosturePrior
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.sensors.root_residual import RootResidual
from mbkf.sensors.supports.block import Supports
from mbkf.sensors.unobserved import UnobservedJoints

START_WRENCH_SD = 1000.0
"""Standard deviation of a wrench before the first reading, N and N m."""


def dynamic_blocks(
    sensor: MarkerSensor,
    noise_m: Array,
    detector: ContactDetector,
    dt_s: float,
    unobservable: BoolArray,
    settings: DynamicSettings,
    inertial: InertialSensor | None = None,
    spread_m: Array | None = None,
    other_contacts: bool = False,
) -> list[AnyBlock]:
    """The standard blocks, in the order in which they decide.

    Args:
        sensor: The markers on the body.
        noise_m: (M,) their noise, m.
        detector: Finds the support of the feet.
        dt_s: Time between frames.
        unobservable: (nv,) dofs that no marker of the capture moves with.
        settings: Settings of every block.
        inertial: Inertial sensors on the body.
        spread_m: (M,) spread of one reading where noise stays for a while (:mod:`mbkf.sensors.lasting_noise`), m. A
            frame then counts for less than an independent reading, and so does the posture prior, or the body would
            be drawn to standing.
        other_contacts: Parts besides the feet bear load in some frames.
    """
    model, s, posture = sensor.model, settings, PostureSensor(sensor.model)
    weight_n = GRAVITY_M_S2 * model.mass_kg
    usual = s.posture.posture_scale
    dilution = posture_scales(sensor, unobservable, usual) / usual
    if spread_m is not None:
        dilution = dilution * prior_dilution(sensor, noise_m, spread_m)
    movement = np.where(unobservable, 0.0, s.motion.acceleration_scale * model.movement_sd)
    blocks: list[AnyBlock] = [
        Markers(sensor, noise_m, dt_s, unobservable, s.markers, spread_m=spread_m),
        NewtonEulerLaw(NewtonEuler(model), s.law, unobservable),
        *([RootResidual(weight_n, dt_s, s.residual)] if s.residual.residual_share > 0.0 else []),
        *([Supports(model, dt_s, s.supports)] if other_contacts else []),
        FootContact(detector, weight_n, dt_s, s.contact),
        UnobservedJoints.of(movement, s.unobserved),
        PlantedFeet(model, detector, s.planted, spread_m is not None),
    ]
    if inertial is not None:
        blocks += [InertialSensors(inertial, s.inertial), MeanPosture(model, dt_s, s.mean_posture)]
    if s.coordination.coordination_memory_s > 0.0:
        blocks.append(CoordinationPrior(model, dt_s, unobservable, s.coordination))
    return [
        *blocks,
        PosturePrior(posture, unobservable, s.posture, dilution),
        JointLimits(posture, unobservable, s.limits),
    ]


DynamicStep = Step[DynamicState]
"""A step of the dynamic filter."""


class DynamicFilter(Filter[DynamicState]):
    """A :class:`mbkf.filters.filter.Filter` with decaying accelerations and blocks on (q, v, a, wrenches).

    Attributes:
        sensor: The markers on the body.
        noise_m: (M,) their noise, m.
        unobservable: (nv,) dofs that no marker of the capture moves with.
        settings: Settings of plant and blocks.
        model: The body.
        balance: Newton–Euler equations, for torques.
        spread_m: (M,) spread of one reading where noise stays for a while, else None.
    """

    def __init__(
        self,
        sensor: MarkerSensor,
        noise_m: Array,
        dt_s: float,
        unobservable: BoolArray,
        settings: DynamicSettings,
        blocks: Sequence[AnyBlock],
        spread_m: Array | None = None,
        plant: PlantMaker | None = None,
    ) -> None:
        """Makes the filter.

        Args:
            sensor: The markers on the body.
            noise_m: (M,) their noise, m.
            dt_s: Time between frames.
            unobservable: (nv,) dofs that no marker of the capture moves with.
            settings: Settings of plant and error covariance.
            blocks: Instruments, laws and priors; :func:`dynamic_blocks` for the standard ones.
            spread_m: (M,) spread of one reading of markers whose noise stays; None where the noise is white.
            plant: Makes another plant than the Singer plant, for a state of the same parts.
        """
        model, extras = sensor.model, [extra for block in blocks for extra in block.states()]
        make = partial(SingerPlant, settings=settings.motion) if plant is None else plant
        super().__init__(make(model, Layout.dynamic(model.nv, extras), dt_s, unobservable), blocks)
        self.sensor, self.unobservable, self.settings = sensor, unobservable, settings
        self.noise_m, self.spread_m = noise_m * settings.markers.marker_noise_scale, spread_m
        self.model, self.balance = model, NewtonEuler(model)

    def first(self, q: Array, v: Array, a: Array, P: Array, frame: Frame) -> Step[DynamicState]:
        """A first estimate from a pose and velocity, corrected by a frame.

        Args:
            q: (nq,) configuration.
            v: (nv,) velocity.
            a: (nv,) acceleration.
            P: (2 nv, 2 nv) covariance of (q, v).
            frame: Readings of the frame; inertial ones are left out.
        """
        layout, size, motion = self.layout, self.layout.size, self.layout.motion
        whole, sd, free = np.zeros((size, size)), np.zeros(size), np.tile(~self.unobservable, 2)
        whole[motion, motion] = P * np.outer(free, free)
        sd[layout.a] = np.where(self.unobservable, 0.0, self.model.acceleration_sd)
        sd[layout.wrench] = START_WRENCH_SD
        extra, sd[layout.extra] = layout.start()
        whole.reshape(-1)[:: size + 1][motion.stop :] = sd[motion.stop :] ** 2
        state, memory = DynamicState(q, v, a, np.zeros(FEET), whole.T, extra), self.begin()
        prior = self.prepared(state, self.plant.noise(memory.plant), memory)
        return self.correct(prior, memory, frame._replace(imus=None))
