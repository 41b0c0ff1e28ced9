"""The thesis's dynamic filter: markers and plates through forward dynamics, with torques and wrenches as states.

State: positions, velocities, pelvis residual, joint torques and foot wrenches, 166 for the reference body; in which
coordinates of the forces, :data:`mbkf.model.human_dynamics.FORCE_STATES` says.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple, cast

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput
from mbkf.filters.filter import Filter, Memory, Prior, Step
from mbkf.filters.kinematic.plant import KinematicState
from mbkf.filters.torque.noise import ForceNoise
from mbkf.filters.torque.plant import ForcedState, TorquePlant
from mbkf.filters.torque.settings import MASS_OF_TABLE_KG, TorqueSettings
from mbkf.filters.torque.start import TorqueStart
from mbkf.kernel.covariance import positive_informed
from mbkf.model.human_dynamics import HumanDynamics
from mbkf.sensors.block import AnyBlock, Frame, Notes, OperatingPoint
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.contact.records import ContactDecision
from mbkf.sensors.foot_plates import Ahead, FootPlates, FootPlateSettings, FootReading, PlateMemory
from mbkf.sensors.given_plates import GivenPlates
from mbkf.sensors.marker_sensor import JacobianInformation, MarkerSensor
from mbkf.sensors.markers import Markers, MarkerSettings
from mbkf.sensors.pelvis_residual import PelvisResidual
from mbkf.sensors.posture_sensor import PostureSensor
from mbkf.sensors.rest import PostureAndRest

TorqueStep = Step[ForcedState]
"""A step of the torque-state filter."""


def torque_blocks(
    sensor: MarkerSensor,
    noise_m: Array,
    body: HumanDynamics,
    detector: ContactDetector,
    dt_s: float,
    settings: TorqueSettings,
) -> list[AnyBlock]:
    """The standard blocks: markers, plates, posture and rest, pelvis residual.

    Args:
        sensor: The markers on the body.
        noise_m: (M,) their noise, m.
        body: The forced body.
        detector: Finds what the feet stand on.
        dt_s: Time between frames.
        settings: Settings of every block.
    """
    s, weak, scale = settings, settings.tracking, _scale(body)
    markers = MarkerSettings(
        marker_noise_scale=weak.marker_noise_scale,
        innovation_share=0.0,
        gate=weak.gate,
        gate_radius_m=weak.gate_radius_m,
        min_markers=weak.min_markers,
    )
    plates = FootPlateSettings(
        s.plate_force_n * scale,
        s.plate_moment_nm * scale,
        s.unloaded_force_n * scale,
        s.unloaded_moment_nm * scale,
        None if s.plate_vertical_force_n is None else s.plate_vertical_force_n * scale,
    )
    return [
        # The literal presets amplify roundings: the Jacobian's own keep the figures that were measured with them.
        Markers(
            sensor,
            weak.noise(noise_m),
            dt_s,
            body.fixed,
            markers,
            inflate=False,
            track_loss=False,
            compress=JacobianInformation,
        ),
        (GivenPlates if body.loads_given else FootPlates)(body, detector, dt_s, plates),
        PostureAndRest(PostureSensor(body.model), body.fixed, weak.posture_scale, weak.velocity_sd),
        PelvisResidual(body, residual_sd(body, settings)),
    ]


def residual_sd(body: HumanDynamics, settings: TorqueSettings) -> Array:
    """(6,) spread of the pelvis residual about 0, N and N m."""
    spread = [settings.residual_spread_force_n, settings.residual_spread_moment_nm]
    return np.repeat(spread, 3) * _scale(body)


def _scale(body: HumanDynamics) -> float:
    return body.model.mass_kg / MASS_OF_TABLE_KG


class FirstState(NamedTuple):
    """A first state, the memory for the step after it, and the support of the feet."""

    state: ForcedState
    memory: Memory
    contact: ContactDecision


class TorqueFilter(Filter[ForcedState]):
    """A :class:`mbkf.filters.filter.Filter` with forward dynamics as its plant.

    Attributes:
        sensor: The markers on the body.
        noise_m: (M,) their noise, m.
        unobservable: (nv,) dofs that no marker of the capture moves with.
        settings: Settings of plant and blocks.
        body: The forced body.
        plates: The block of the force plates.
    """

    plant: TorquePlant

    def __init__(
        self,
        sensor: MarkerSensor,
        noise_m: Array,
        dt_s: float,
        body: HumanDynamics,
        settings: TorqueSettings,
        blocks: Sequence[AnyBlock],
    ) -> None:
        """Makes the filter.

        Args:
            sensor: The markers on the body.
            noise_m: (M,) their noise, m.
            dt_s: Time between frames.
            body: The forced body.
            settings: Settings of plant and start.
            blocks: Instruments, laws and priors, force plates among them; :func:`torque_blocks` for the standard ones.

        Raises:
            InvalidInput: The block of force plates is missing, or one adds states of its own.
        """
        plates = [block for block in blocks if isinstance(block, FootPlates)]
        if len(plates) != 1 or any(block.states() for block in blocks):
            raise InvalidInput(
                "a torque-state filter needs one block FootPlates and takes no block that adds states of its own; "
                "the dynamic filter does"
            )
        plant = TorquePlant(
            body, dt_s, ForceNoise(body, dt_s, settings), settings.scheme, wrenches=not body.loads_given
        )
        super().__init__(plant, blocks, positive_informed)
        self.sensor, self.settings, self.body, self.plates = sensor, settings, body, plates[0]
        self.noise_m = settings.tracking.noise(noise_m) * settings.tracking.marker_noise_scale
        self.unobservable = body.fixed
        self._start = TorqueStart(body, plant, settings, residual_sd(body, settings))

    @classmethod
    def standard(
        cls,
        sensor: MarkerSensor,
        noise_m: Array,
        detector: ContactDetector,
        dt_s: float,
        unobservable: BoolArray,
        settings: TorqueSettings,
    ) -> TorqueFilter:
        """The filter with :func:`torque_blocks`.

        Args:
            sensor: The markers on the body.
            noise_m: (M,) their noise, m.
            detector: Finds what the feet stand on.
            dt_s: Time between frames.
            unobservable: (nv,) dofs that no marker of the capture moves with.
            settings: Settings of plant and blocks.
        """
        given = settings.plates == "inputs"
        body = HumanDynamics(
            sensor.model, unobservable, settings.wrench_frame, settings.force_state, loads_given=given
        )
        blocks = torque_blocks(sensor, noise_m, body, detector, dt_s, settings)
        return cls(sensor, noise_m, dt_s, body, settings, blocks)

    def _decided(
        self, prior: Prior[ForcedState], memory: Memory, frame: Frame
    ) -> tuple[Prior[ForcedState], list[Any], Notes]:
        """Decisions; given loads of the frame then replace those of the frame before."""
        prior, decided, notes = super()._decided(prior, memory, frame)
        if self.body.loads_given:
            reading = decided[self.blocks.index(self.plates)].reading
            state = replace(prior.state, given=self._given(reading))
            prior = prior._replace(state=state, points=[at._replace(state=state) for at in prior.points])
        return prior, decided, notes

    def _given(self, feet: FootReading) -> Array:
        """(12,) wrenches of the feet where they are known inputs, else (0,)."""
        return self.plates.loads(feet) if isinstance(self.plates, GivenPlates) else np.zeros(0)

    def first(self, motion: KinematicState, acceleration: Array, frame: Frame) -> FirstState:
        """A first state from a motion, and the plates of its frame.

        Args:
            motion: Positions and velocities, as the kinematic filter estimates them.
            acceleration: (nv,) estimate.
            frame: Readings of the frame; the plates' are used.
        """
        # Where the motion leads is given, so that no forces are read of the state.
        begun = PlateMemory(self.plates.detector.begin(), Ahead(motion.q, motion.v, acceleration))
        decision = self.plates.decide(
            OperatingPoint(cast("ForcedState", motion), None), frame, begun, Notes()
        )
        feet = decision.reading
        state = self._start.state(motion, acceleration, feet, self.plates.sd(feet), self._given(feet))
        memory = self._with_plates(self.begin(), self.plates.next_memory(state, decision))
        return FirstState(state, memory, decision.contact)

    def stayed(self, state: ForcedState, memory: Memory, frame: Frame) -> FirstState:
        """The same state after a frame in which nothing could be computed but contact.

        Args:
            state: Posterior of the frame before.
            memory: Of the frame before.
            frame: The readings.
        """
        kept = memory.blocks[self.blocks.index(self.plates)]
        decision = self.plates.decide(OperatingPoint(state, None), frame, kept, Notes())
        if self.body.loads_given:
            state = replace(state, given=self._given(decision.reading))
        remembered = self._with_plates(memory, self.plates.next_memory(state, decision))
        return FirstState(state, remembered, decision.contact)

    def _with_plates(self, memory: Memory, plates: PlateMemory) -> Memory:
        blocks = zip(self.blocks, memory.blocks, strict=True)
        return memory._replace(blocks=tuple(plates if one is self.plates else kept for one, kept in blocks))
