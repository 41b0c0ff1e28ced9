"""The chosen filter for a trial: body, markers, plates and settings put together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mbkf.conventions import Array, BoolArray
from mbkf.errors import UnknownName
from mbkf.filters.dynamic import DynamicFilter
from mbkf.filters.dynamic_follower import DynamicFollower
from mbkf.filters.dynamic_settings import DynamicSettings
from mbkf.filters.estimate import Follower
from mbkf.filters.inertial_part import InertialPart
from mbkf.filters.kinematic import KinematicFilter
from mbkf.filters.kinematic_follower import KinematicFollower
from mbkf.filters.settings import KinematicSettings
from mbkf.filters.torque import TorqueFilter
from mbkf.filters.torque_follower import TorqueFollower
from mbkf.filters.torque_settings import TorqueSettings
from mbkf.io.records import PlateReadings
from mbkf.sensors.footing import FootingSensor
from mbkf.sensors.inertial import InertialSensor
from mbkf.sensors.markers import MarkerSensor


@dataclass(frozen=True)
class FilterInputs:
    """Inputs that every filter is built from.

    Attributes:
        sensor: The markers on the scaled body.
        noise_m: (M,) marker noise.
        plates: The plates.
        dt_s: Time between frames.
        held: (nv,) dofs that no marker of the trial moves with.
        kinematic, dynamic, torque: Settings of each filter.
        inertial: Inertial sensors on the body, None where there are none.
    """

    sensor: MarkerSensor
    noise_m: Array
    plates: tuple[PlateReadings, ...]
    dt_s: float
    held: BoolArray
    kinematic: KinematicSettings
    dynamic: DynamicSettings
    torque: TorqueSettings
    inertial: InertialSensor | None = None


def _kinematic(inputs: FilterInputs) -> Follower:
    return KinematicFollower(_starter(inputs))


def _dynamic(inputs: FilterInputs) -> Follower:
    model, dynamic, felt = inputs.sensor.model, inputs.dynamic, None
    if inputs.inertial is not None:
        felt = InertialPart(inputs.inertial, inputs.dt_s, dynamic)
    kalman = DynamicFilter(
        inputs.sensor,
        inputs.noise_m,
        FootingSensor(model, inputs.plates, inputs.dt_s),
        inputs.dt_s,
        inputs.held,
        dynamic,
        inertial=felt,
    )
    return DynamicFollower(kalman, _starter(inputs))


def _torque(inputs: FilterInputs) -> Follower:
    kalman = TorqueFilter(inputs.sensor, inputs.noise_m, inputs.dt_s, inputs.held, inputs.torque)
    feet = FootingSensor(inputs.sensor.model, inputs.plates, inputs.dt_s)
    return TorqueFollower(kalman, feet, _starter(inputs))


def _starter(inputs: FilterInputs) -> KinematicFilter:
    return KinematicFilter(inputs.sensor, inputs.noise_m, inputs.dt_s, inputs.held, inputs.kinematic)


_MAKERS: dict[str, Callable[[FilterInputs], Follower]] = {
    "kinematic": _kinematic,
    "torque": _torque,
    "dynamic": _dynamic,
}

FILTERS = tuple(_MAKERS)
"""Names of the filters."""


def follower(name: str, inputs: FilterInputs) -> Follower:
    """The filter of that name.

    Raises:
        UnknownName: There is none.
    """
    if name not in _MAKERS:
        raise UnknownName("filter", name, FILTERS)
    return _MAKERS[name](inputs)
