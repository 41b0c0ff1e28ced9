"""Loads on the body and joint torques of a tracked trial, compared with the plates."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.inverse_dynamics import inverse_dynamics
from mbkf.filters.record import Track
from mbkf.io.contacts import Source, bearing, foot_sources
from mbkf.io.records import PlateReadings
from mbkf.io.result_groups import Reactions, SupportLoads, Torques
from mbkf.model.body import Body
from mbkf.sensors.contact.offline import FootLoads, assign_feet, falling
from mbkf.sensors.contact.plates import pressure_and_free_moment, surface_height
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.contact.rules import BOTH, least_load
from mbkf.trial.results.supports import supports_of

PRESSURE_FROM_N = 20.0
"""Vertical force from which an estimated wrench has a centre of pressure."""

FLOATING_SHARE = 0.02
"""Share of frames without any contact, and without a fall, that take-off and landing explain."""


@dataclass(frozen=True)
class GroundReactions:
    """Loads of a trial, and the torques and the residual that follow from them.

    Attributes:
        loads: On the feet: estimated, or measured where the filter does not estimate them.
        supports: On other parts.
        torques: With all these loads; NaN where neither plates nor the filter know the loads.
        measured: (T,) every loaded foot on a measured plate, of its own or shared, and no other part bears.
        accounted: (T,) measured, or a load that no plate reads is estimated: a foot beside plates or another part, or
            nothing bears and the body falls; no plate is loaded by something other than a foot.
        judged: (T,) every loaded foot is read by a plate, so that motion and loads can contradict each other; loads
            that are estimated follow the motion.
        warnings: Remarks for the reader.
    """

    loads: Reactions
    supports: SupportLoads
    torques: Torques
    measured: BoolArray
    accounted: BoolArray
    judged: BoolArray
    warnings: tuple[str, ...]


def ground_reactions(
    model: Body,
    track: Track,
    times_s: Array,
    rate_hz: float,
    plates: tuple[PlateReadings, ...],
    inputs: bool = False,
    wrench: Array | None = None,
) -> GroundReactions:
    """Loads and torques of a tracked trial.

    Args:
        model: The body.
        track: The tracked trial.
        times_s: (T,) times of the frames.
        rate_hz: Frame rate.
        plates: The plates it could read.
        inputs: The plates are known inputs, so that the load of a foot without a plate is not estimated.
        wrench: (T, P, 6) wrenches of the plates (:func:`mbkf.sensors.contact.plates.plate_wrenches`), where known.
    """
    read = assign_feet(model, track.q, times_s, rate_hz, plates, wrench)
    supports = supports_of(model, track)
    by_plates = inverse_dynamics(model, track, read.wrench)
    known = np.where(bool(plates), 1.0, np.nan)
    if track.foot_contact is None:
        tau = by_plates.tau * known
        loads = _measured_loads(read)
        measured = accounted = read.valid
        judged = read.recorded & ~read.unread.any(axis=1)
        shared = _shared_warning((read.foot_of_plate == BOTH).any(axis=1))
        unread = ("no force plates: torques and residuals are not computed",)
        warnings = (*read.warnings, *shared) if plates else unread
    else:
        tau = inverse_dynamics(model, track, track.wrench, track.support).tau
        loads = _estimated_loads(track, track.foot_contact, read, plates)
        bears = bearing(supports.support_wrench).any(axis=1)
        estimated = (loads.foot_source == Source.ESTIMATED).any(axis=1) | bears
        measured = read.valid & ~estimated
        judged = read.recorded & (loads.foot_source != Source.ESTIMATED).all(axis=1)
        held = ~falling(track.q[:, 2], rate_hz) & ~bears
        flies = (track.foot_contact == Contact.AIR).all(axis=1) & ~held & ~bears
        accounted = measured | ((estimated | flies) & ~_stray(read, plates))
        contact = _contact_warnings(track.foot_contact, plates, inputs)
        floating = _floating_warning(track.foot_contact, held & track.tracked)
        warnings = (*read.warnings, *contact, *floating)
    torque_sd, torque_offset = (
        np.where(np.isnan(tau), np.nan, sd) for sd in (track.torque_sd, track.torque_offset)
    )
    torques = Torques(
        tau=tau,
        sd_tau=torque_sd,
        sd_tau_offset=torque_offset,
        residual_force_n=by_plates.residual_force_n * known,
        residual_moment_nm=by_plates.residual_moment_nm * known,
    )
    loads = replace(loads, read_plate_names=tuple(plate.name for plate in plates))
    judged &= bool(plates) & track.tracked
    return GroundReactions(loads, supports, torques, measured, accounted, judged, warnings)


def _measured_loads(read: FootLoads) -> Reactions:
    """Loads where the filter does not estimate them."""
    return Reactions(
        foot_wrench=read.wrench,
        foot_cop_m=read.centre_of_pressure_m,
        foot_free_moment_nm=read.free_moment_nm,
        foot_source=_plate_sources(read),
    )


def _estimated_loads(
    track: Track, contact: Array, read: FootLoads, plates: tuple[PlateReadings, ...]
) -> Reactions:
    """Loads as the filter estimates them.

    Args:
        track: The tracked trial.
        contact: (T, 2) support of the feet.
        read: Loads that the plates measured.
        plates: The plates.
    """
    surface = np.mean([surface_height(plate) for plate in plates]) if plates else 0.0
    pressure, free = pressure_and_free_moment(track.wrench, float(surface), PRESSURE_FROM_N)
    return Reactions(
        foot_wrench=track.wrench,
        foot_wrench_sd=track.wrench_sd,
        foot_wrench_sd_offset=track.wrench_offset,
        foot_wrench_sd_change=track.wrench_change,
        foot_cop_m=pressure,
        foot_free_moment_nm=free,
        foot_source=foot_sources(contact, track.wrench),
        plate_change=_plate_change(track.wrench, read, plates) if plates else None,
    )


def _plate_sources(loads: FootLoads) -> Array:
    """(T, 2) sources of the feet's wrenches known from plates alone."""
    foot = loads.foot_of_plate
    own = np.stack([(foot == side).any(axis=1) for side in range(2)], axis=1)
    shared = (foot == BOTH).any(axis=1)[:, None]
    return np.where(shared, Source.SHARED, np.where(own, Source.MEASURED, Source.NONE))


def _stray(loads: FootLoads, plates: tuple[PlateReadings, ...]) -> BoolArray:
    """(T,) frames in which a plate is loaded by something other than a foot."""
    least = np.array([least_load(plate.threshold_n) for plate in plates])
    return np.asarray(((loads.plate_wrench[:, :, 2] >= least) & (loads.foot_of_plate < 0)).any(axis=1))


def _plate_change(wrench: Array, loads: FootLoads, plates: tuple[PlateReadings, ...]) -> Array:
    change = np.full(loads.plate_wrench.shape, np.nan)
    for p, plate in enumerate(plates):
        foot = loads.foot_of_plate[:, p]
        others = (loads.foot_of_plate == BOTH).any(axis=1)
        alone = (foot >= 0) & ~others & ((loads.foot_of_plate == foot[:, None]).sum(axis=1) == 1)
        frames = np.flatnonzero(alone)
        difference = wrench[frames, foot[frames]] - loads.plate_wrench[frames, p]
        difference[:, 3:] -= np.cross(plate.origin_m, difference[:, :3])
        change[frames, p] = difference
    return change


def _contact_warnings(contact: Array, plates: tuple[PlateReadings, ...], inputs: bool) -> list[str]:
    unread = contact == Contact.UNMEASURED
    one, both = int(unread.any(axis=1).sum()), int(unread.all(axis=1).sum())
    warnings = []
    if not plates:
        warnings.append(
            "no force plates: reactions are estimated from the motion, residuals are not computed"
        )
    if one and inputs:
        warnings.append(
            f"in {one} of {len(contact)} frames a foot carries weight where no plate reads: plates are known inputs, "
            "so its load counts as 0, stands in the pelvis residual, and torques have no standard deviation; "
            'set plates = "sensors" to have it estimated'
        )
    elif one:
        warnings.append(
            f"in {one} of {len(contact)} frames a foot carries weight where no plate reads: its reaction is estimated "
            "from the motion"
        )
    if both and not inputs:
        warnings.append(
            f"in {both} frames both feet do, and how they share the load is known by where they stand only "
            "(see the standard deviations)"
        )
    return [*warnings, *_shared_warning((contact == Contact.SHARED).any(axis=1))]


def _floating_warning(contact: Array, supported: BoolArray) -> list[str]:
    """Remark on frames in which both feet were taken to be in the air and the body did not fall.

    Args:
        contact: (T, 2) support of the feet.
        supported: (T,) frames in which the body does not fall.
    """
    floating = int(((contact == Contact.AIR).all(axis=1) & supported).sum())
    if floating <= FLOATING_SHARE * len(contact):
        return []
    return [
        f"in {floating} of {len(contact)} frames neither foot was found on a support, yet the body does not fall: "
        "do not use reactions and torques there"
    ]


def _shared_warning(shared: BoolArray) -> list[str]:
    """Remark on the frames (T,) in which both feet stand on one plate."""
    if not shared.any():
        return []
    return [
        f"in {int(shared.sum())} frames both feet stand on one plate: their shares of its load are estimated from "
        "their places"
    ]
