"""The chosen filter for a trial: body, markers, plates and settings put together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput, UnknownName
from mbkf.filters.body_errors import BodyErrors
from mbkf.filters.dynamic.filter import DynamicFilter, dynamic_blocks
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.dynamic.tracking import DynamicTracking
from mbkf.filters.estimate import TrackingFilter
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.kinematic.tracking import KinematicTracking
from mbkf.filters.torque.filter import TorqueFilter
from mbkf.filters.torque.settings import TorqueSettings
from mbkf.filters.torque.tracking import TorqueTracking
from mbkf.io.records import PlateReadings
from mbkf.sensors.block import AnyBlock
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.inertial_sensor import InertialSensor
from mbkf.sensors.marker_sensor import MarkerSensor

Blocks = Sequence[AnyBlock] | None
"""Blocks of the dynamic filter; None for the standard ones."""


@dataclass(frozen=True)
class FilterInputs:
    """Inputs that every filter is built from.

    Attributes:
        sensor: The markers on the scaled body.
        noise_m: (M,) marker noise.
        plates: The plates.
        dt_s: Time between frames.
        unobservable: (nv,) dofs that no marker of the trial moves with.
        kinematic, dynamic, torque: Settings of each filter.
        inertial: Inertial sensors on the body, None where there are none.
        spread_m: (M,) spread of one reading where noise stays for a while, None where no marker's does.
        remarks: What was refused of the plates' readings, in words.
        other_contacts: Whether parts besides the feet bear load somewhere in the trial.
        body: What estimates err by because the person's body is not known exactly; None where that is not told.
    """

    sensor: MarkerSensor
    noise_m: Array
    plates: tuple[PlateReadings, ...]
    dt_s: float
    unobservable: BoolArray
    kinematic: KinematicSettings
    dynamic: DynamicSettings
    torque: TorqueSettings
    inertial: InertialSensor | None = None
    spread_m: Array | None = None
    remarks: tuple[str, ...] = ()
    other_contacts: bool = False
    body: BodyErrors | None = None


def _kinematic(inputs: FilterInputs, blocks: Blocks) -> TrackingFilter:
    if blocks is not None:
        raise InvalidInput(
            "blocks of one's own are for the dynamic filter; the kinematic filter reads markers only"
        )
    return KinematicTracking(_starter(inputs))


def motion_filter(inputs: FilterInputs) -> TrackingFilter:
    """The kinematic filter where its motion alone is wanted: its covariances are not smoothed."""
    return KinematicTracking(_starter(inputs), smoothed_covariances=False)


def _dynamic(inputs: FilterInputs, blocks: Blocks) -> TrackingFilter:
    known = inputs.sensor, inputs.noise_m
    if blocks is None:
        blocks = standard(inputs)
    kalman = DynamicFilter(*known, inputs.dt_s, inputs.unobservable, inputs.dynamic, blocks, inputs.spread_m)
    return DynamicTracking(kalman, _starter(inputs))


def standard(inputs: FilterInputs) -> list[AnyBlock]:
    """The dynamic filter's standard blocks."""
    detector = ContactDetector(inputs.sensor.model, inputs.plates, inputs.dt_s)
    known = inputs.sensor, inputs.noise_m
    return dynamic_blocks(
        *known,
        detector,
        inputs.dt_s,
        inputs.unobservable,
        inputs.dynamic,
        inputs.inertial,
        inputs.spread_m,
        inputs.other_contacts,
    )


def _torque(inputs: FilterInputs, blocks: Blocks) -> TrackingFilter:
    if blocks is not None:
        raise InvalidInput(
            "blocks of one's own are for the dynamic filter; the torque filter is the thesis's"
        )
    detector = ContactDetector(inputs.sensor.model, inputs.plates, inputs.dt_s)
    known = inputs.sensor, inputs.noise_m
    kalman = TorqueFilter.standard(*known, detector, inputs.dt_s, inputs.unobservable, inputs.torque)
    return TorqueTracking(kalman, _starter(inputs))


def _starter(inputs: FilterInputs) -> KinematicFilter:
    return KinematicFilter(inputs.sensor, inputs.noise_m, inputs.dt_s, inputs.unobservable, inputs.kinematic)


_MAKERS: dict[str, Callable[[FilterInputs, Blocks], TrackingFilter]] = {
    "kinematic": _kinematic,
    "torque": _torque,
    "dynamic": _dynamic,
}

FILTERS = tuple(_MAKERS)
"""Names of the filters."""


def tracking_filter(name: str, inputs: FilterInputs, blocks: Blocks = None) -> TrackingFilter:
    """The filter of that name.

    Args:
        name: One of :data:`FILTERS`.
        inputs: What it is built from.
        blocks: Blocks of the dynamic filter; None for the standard ones.

    Raises:
        UnknownName: There is none.
        InvalidInput: Blocks are given for another filter.
    """
    if name not in _MAKERS:
        raise UnknownName("filter", name, FILTERS)
    return _MAKERS[name](inputs, blocks)
