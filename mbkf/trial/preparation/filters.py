"""The chosen filter for a trial: body, markers, plates and settings put together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput, UnknownName
from mbkf.filters.body_errors import BodyErrors
from mbkf.filters.dynamic.filter import DynamicFilter, dynamic_blocks
from mbkf.filters.dynamic.report import DynamicReport
from mbkf.filters.dynamic.settings import DynamicSettings
from mbkf.filters.dynamic.widening import WiderFilter
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.report import KinematicReport
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.kinematic.warm_start import WarmStart
from mbkf.filters.plant import PlantMaker
from mbkf.filters.report import AnyReport
from mbkf.filters.torque.settings import TorqueSettings
from mbkf.filters.tracking_filter import TrackingFilter
from mbkf.io.records import PlateReadings
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.sensors.block import AnyBlock
from mbkf.sensors.contact.causal import ContactDetector
from mbkf.sensors.inertial_sensor import InertialSensor
from mbkf.sensors.limb_fit import LimbFits
from mbkf.sensors.marker_sensor import MarkerSensor

Blocks = Sequence[AnyBlock] | None
"""Blocks of the dynamic filter; None: the standard ones."""


class OwnParts(NamedTuple):
    """Parts of a user's own in place of the dynamic filter's; None: the standard ones."""

    blocks: Blocks = None
    plant: PlantMaker | None = None


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
        inertial: Inertial sensors on the body; None: no sensors.
        spread_m: (M,) spread of one reading where noise stays for a while; None: white noise.
        remarks: Remarks on plate readings that were refused.
        other_contacts: Parts besides the feet bear load somewhere in the trial.
        contradictions: Unexplained forces by the motion of markers alone, with their causes.
        names: (M,) names of the markers; empty where they have none.
        body: Errors of the estimates because the person's body is not known exactly; None where they are not reported.
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
    contradictions: tuple[UnexplainedLoad, ...] = ()
    names: tuple[str, ...] = ()
    body: BodyErrors | None = None


def _kinematic(inputs: FilterInputs, own: OwnParts) -> TrackingFilter:
    _refuse(own, "the kinematic filter reads markers only")
    return _started(KinematicReport(_starter(inputs)), inputs)


def motion_filter(inputs: FilterInputs) -> TrackingFilter:
    """The kinematic filter where its motion alone is wanted: without smoothed covariances, spreads of innovations."""
    kalman = _starter(inputs)
    kalman.follows_spreads = False
    return _started(KinematicReport(kalman, smoothed_covariances=False), inputs)


def _dynamic(inputs: FilterInputs, own: OwnParts) -> TrackingFilter:
    narrow = _dynamic_report(inputs, own)
    if own.blocks is not None or inputs.other_contacts or not inputs.sensor.model.description.bearings:
        return _started(narrow, inputs)
    wide = partial(_dynamic_report, replace(inputs, other_contacts=True), own)
    return _started(narrow, inputs, WiderFilter(narrow.kalman, wide))


def _dynamic_report(inputs: FilterInputs, own: OwnParts) -> DynamicReport:
    known = inputs.sensor, inputs.noise_m, inputs.dt_s, inputs.unobservable, inputs.dynamic
    blocks = standard(inputs) if own.blocks is None else own.blocks
    return DynamicReport(DynamicFilter(*known, blocks, inputs.spread_m, own.plant))


def standard(inputs: FilterInputs) -> list[AnyBlock]:
    """The dynamic filter's standard blocks."""
    return dynamic_blocks(
        inputs.sensor,
        inputs.noise_m,
        ContactDetector(inputs.sensor.model, inputs.plates, inputs.dt_s),
        inputs.dt_s,
        inputs.unobservable,
        inputs.dynamic,
        inputs.inertial,
        inputs.spread_m,
        inputs.other_contacts,
    )


def _torque(inputs: FilterInputs, own: OwnParts) -> TrackingFilter:
    from mbkf.filters.torque.filter import TorqueFilter  # loads slowly, and most trials do without
    from mbkf.filters.torque.report import TorqueReport

    _refuse(own, "the torque filter is the thesis's")
    if inputs.torque.plates == "inputs" and not inputs.plates:
        raise InvalidInput(
            'plates = "inputs" takes the feet\'s wrenches from force plates, and 0 plates are read; '
            'give the ground reactions, or plates = "sensors"'
        )
    detector = ContactDetector(inputs.sensor.model, inputs.plates, inputs.dt_s)
    known = inputs.sensor, inputs.noise_m, detector, inputs.dt_s, inputs.unobservable, inputs.torque
    return _started(TorqueReport(TorqueFilter.standard(*known)), inputs)


def _started(report: AnyReport, inputs: FilterInputs, wider: WiderFilter | None = None) -> TrackingFilter:
    limbs = LimbFits(inputs.sensor, inputs.noise_m, inputs.unobservable, inputs.names)
    return TrackingFilter(report, WarmStart(_starter(inputs), limbs), wider)


def _starter(inputs: FilterInputs) -> KinematicFilter:
    return KinematicFilter(inputs.sensor, inputs.noise_m, inputs.dt_s, inputs.unobservable, inputs.kinematic)


def _refuse(own: OwnParts, reason: str) -> None:
    if own != OwnParts():
        raise InvalidInput(f"your own blocks and plants are for the dynamic filter; {reason}")


_MAKERS: dict[str, Callable[[FilterInputs, OwnParts], TrackingFilter]] = {
    "kinematic": _kinematic,
    "torque": _torque,
    "dynamic": _dynamic,
}

FILTERS = tuple(_MAKERS)
"""Names of the filters."""


def tracking_filter(
    name: str, inputs: FilterInputs, blocks: Blocks = None, plant: PlantMaker | None = None
) -> TrackingFilter:
    """The filter of that name.

    Args:
        name: One of :data:`FILTERS`.
        inputs: Body, markers, plates and settings.
        blocks: Blocks of the dynamic filter; None: the standard ones.
        plant: Makes the plant of the dynamic filter; None: the Singer plant.

    Raises:
        UnknownName: The filter does not exist.
        InvalidInput: Blocks or a plant are given for another filter.
    """
    if name not in _MAKERS:
        raise UnknownName("filter", name, FILTERS)
    return _MAKERS[name](inputs, OwnParts(blocks, plant))
