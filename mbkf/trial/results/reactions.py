"""Loads on the body and joint torques of a tracked trial, compared with the plates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.filters.inverse_dynamics import inverse_dynamics
from mbkf.filters.tracking import Track
from mbkf.io.contacts import Source, bearing, foot_sources
from mbkf.io.records import PlateReadings
from mbkf.model.body import Body
from mbkf.sensors.contact.offline import FootLoads, assign_feet, falling
from mbkf.sensors.contact.plates import pressure_and_free_moment, surface_height
from mbkf.sensors.contact.records import Contact
from mbkf.sensors.contact.rules import BOTH, least_load
from mbkf.trial.results.supports import Supports, supports_of

PRESSURE_FROM_N = 20.0
"""Vertical force from which an estimated wrench has a centre of pressure."""


FLOATING_SHARE = 0.02
"""Share of frames without any contact, and without a fall, that take-off and landing explain."""


@dataclass(frozen=True)
class Reactions:
    """Reactions of a trial, the torques and the residual that follow from them; NaN where not known.

    Attributes:
        wrench: (T, 2, 6) on right and left foot about the world's origin: estimated, or measured where the filter
            estimates none.
        wrench_sd: (T, 2, 6) standard deviations, or None.
        centre_of_pressure_m: (T, 2, 3) under each foot.
        free_moment_nm: (T, 2) about the vertical through it.
        supports: Loads on other parts than the feet.
        tau: (T, nv) generalised forces with all these loads.
        residual_force_n, residual_moment_nm: (T, 3) residual at the pelvis with the measured plates.
        plate_change: (T, P, 6) estimated minus measured wrench about the plate's origin where a foot stands on that
            plate alone; None where the filter estimates none or there are no plates.
        foot_source: (T, 2) :class:`~mbkf.io.contacts.Source` of the feet's wrenches.
        measured: (T,) every loaded foot on a measured plate, of its own or shared, and no other part bears.
        accounted: (T,) measured, or what no plate reads is estimated: a foot beside plates or another part; no plate is
            loaded by something that is no foot.
        warnings: Remarks for the reader.
    """

    wrench: Array
    wrench_sd: Array | None
    centre_of_pressure_m: Array
    free_moment_nm: Array
    supports: Supports
    tau: Array
    residual_force_n: Array
    residual_moment_nm: Array
    plate_change: Array | None
    foot_source: Array
    measured: BoolArray
    accounted: BoolArray
    warnings: tuple[str, ...]


def reactions(
    model: Body, track: Track, times_s: Array, rate_hz: float, plates: tuple[PlateReadings, ...]
) -> Reactions:
    """Reactions of a tracked trial.

    Args:
        model: The body.
        track: The tracked trial.
        times_s: (T,) times of the frames.
        rate_hz: Frame rate.
        plates: The plates it could read.
    """
    loads = assign_feet(model, track.q, times_s, rate_hz, plates)
    supports = supports_of(model, track)
    measured = inverse_dynamics(model, track, loads.wrench)
    known = np.where(bool(plates), 1.0, np.nan)
    force, moment = measured.residual_force_n * known, measured.residual_moment_nm * known
    if track.contact is None:
        return Reactions(
            loads.wrench,
            None,
            loads.centre_of_pressure_m,
            loads.free_moment_nm,
            supports,
            measured.tau * known,
            force,
            moment,
            None,
            _plate_sources(loads),
            loads.valid,
            loads.valid,
            (*loads.warnings, *_shared_warning((loads.foot_of_plate == BOTH).any(axis=1)))
            if plates
            else ("no force plates: torques and residuals are not computed",),
        )
    surface = np.mean([surface_height(plate) for plate in plates]) if plates else 0.0
    pressure, free = pressure_and_free_moment(track.wrench, float(surface), PRESSURE_FROM_N)
    source = foot_sources(track.contact, track.wrench)
    estimated = (source == Source.ESTIMATED).any(axis=1) | bearing(supports.wrench).any(axis=1)
    on_plates = loads.valid & ~estimated
    held = ~falling(track.q[:, 2], rate_hz) & ~bearing(supports.wrench).any(axis=1)
    return Reactions(
        track.wrench,
        track.wrench_sd,
        pressure,
        free,
        supports,
        inverse_dynamics(model, track, track.wrench, track.support).tau,
        force,
        moment,
        _plate_change(track.wrench, loads, plates) if plates else None,
        source,
        on_plates,
        on_plates | (estimated & ~_stray(loads, plates)),
        (
            *loads.warnings,
            *_contact_warnings(track.contact, plates),
            *_floating_warning(track.contact, held & track.tracked),
        ),
    )


def _plate_sources(loads: FootLoads) -> Array:
    """(T, 2) sources of the feet's wrenches where plates alone tell them."""
    foot = loads.foot_of_plate
    own = np.stack([(foot == side).any(axis=1) for side in range(2)], axis=1)
    shared = (foot == BOTH).any(axis=1)[:, None]
    return np.where(shared, Source.SHARED, np.where(own, Source.MEASURED, Source.NONE))


def _stray(loads: FootLoads, plates: tuple[PlateReadings, ...]) -> BoolArray:
    """(T,) frames in which a plate is loaded by something that is no foot."""
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


def _contact_warnings(contact: Array, plates: tuple[PlateReadings, ...]) -> list[str]:
    unread = contact == Contact.UNMEASURED
    one, both = int(unread.any(axis=1).sum()), int(unread.all(axis=1).sum())
    warnings = []
    if not plates:
        warnings.append(
            "no force plates: reactions are estimated from the motion, residuals are not computed"
        )
    if one:
        warnings.append(
            f"in {one} of {len(contact)} frames a foot carries weight where no plate reads: its reaction is estimated "
            "from the motion"
        )
    if both:
        warnings.append(
            f"in {both} frames both feet do, and how they share the load is known by where they stand only "
            "(see the standard deviations)"
        )
    return [*warnings, *_shared_warning((contact == Contact.SHARED).any(axis=1))]


def _floating_warning(contact: Array, supported: BoolArray) -> list[str]:
    """What is told where both feet were held to be in the air and the body did not fall.

    Args:
        contact: (T, 2) what the feet stand on.
        supported: (T,) frames in which the body does not fall.
    """
    floating = int(((contact == Contact.AIR).all(axis=1) & supported).sum())
    if floating <= FLOATING_SHARE * len(contact):
        return []
    return [
        f"in {floating} of {len(contact)} frames no foot was seen to stand on anything, yet the body does not fall: "
        "reactions and torques there are not to be trusted"
    ]


def _shared_warning(shared: BoolArray) -> list[str]:
    """What is told of the frames (T,) in which both feet stand on one plate."""
    if not shared.any():
        return []
    return [
        f"in {int(shared.sum())} frames both feet stand on one plate: how they share its load is estimated from where "
        "they stand"
    ]
