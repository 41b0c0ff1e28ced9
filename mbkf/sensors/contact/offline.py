"""Ground reactions of a tracked trial assigned to the feet, and the frames in which every contact is measured.

The assignment looks at whole stretches of loading and at the trial's own floor. Its rules, and their differences from
those of a live filter, are in :mod:`mbkf.sensors.contact.rules`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.io.records import PlateReadings
from mbkf.model.body import Body
from mbkf.model.motion_frames import motion_frames
from mbkf.numerics.runs import stretches
from mbkf.numerics.windows import dilated, majority, second_derivative
from mbkf.sensors.contact.plates import (
    PlateAreas,
    centres_of_pressure,
    free_moment,
    plate_wrenches,
    surface_height,
)
from mbkf.sensors.contact.rules import (
    BOTH,
    FACES_DOWN,
    FALL_EDGE_S,
    FALL_WINDOW_S,
    FLOOR_PERCENTILE,
    MAJORITY_S,
    MIXED_SHARE,
    NEITHER,
    REACH_M,
    SOLE_ENDS,
    STANDING,
    STANDING_SHARE,
    TOUCHING,
    Touch,
    falls,
    nearer_foot,
    stand_together,
)
from mbkf.sensors.contact.sharing import share_load
from mbkf.sensors.contact.soles import distances_to_soles, sole_points


@dataclass(frozen=True)
class FootLoads:
    """Ground reactions per foot.

    Attributes:
        wrench: (T, 2, 6) force N and moment N m about the world's origin on right and left foot, world axes.
        centre_of_pressure_m: (T, 2, 3) of the stronger plate under each foot; NaN unloaded.
        free_moment_nm: (T, 2) about the vertical through the centre of pressure; NaN unloaded.
        plate_wrench: (T, P, 6) every plate about the world's origin; zero outside its recording.
        foot_of_plate: (T, P) 0 right, 1 left, 2 both, -1 none.
        valid: (T,) frames in which every loaded foot stands on a recorded plate.
        unread: (T, 2) feet that touch the floor where no plate reads.
        recorded: (T,) frames in which every plate was recorded.
        floor_m: Height of the floor as the soles show it; NaN where they were never tracked.
        warnings: Remarks for the reader of a report.
    """

    wrench: Array
    centre_of_pressure_m: Array
    free_moment_nm: Array
    plate_wrench: Array
    foot_of_plate: Array
    valid: BoolArray
    unread: BoolArray
    recorded: BoolArray
    floor_m: float
    warnings: tuple[str, ...]


def assign_feet(
    model: Body,
    q: Array,
    times_s: Array,
    rate_hz: float,
    plates: tuple[PlateReadings, ...],
    wrench: Array | None = None,
) -> FootLoads:
    """Assigns plate readings to feet by the distance of the centre of pressure from each sole.

    Args:
        model: The body.
        q: (T, nq) configurations of the trial, NaN where untracked.
        times_s: (T,) times of the frames.
        rate_hz: Frame rate.
        plates: The plates of the trial.
        wrench: (T, P, 6) their wrenches (:func:`mbkf.sensors.contact.plates.plate_wrenches`), where they are known.
    """
    soles, areas = sole_points(model, q), PlateAreas(plates)
    wrench = plate_wrenches(plates, times_s, rate_hz) if wrench is None else wrench.copy()
    recorded = np.asarray(~np.isnan(wrench).any(axis=2))
    wrench[~recorded] = 0.0
    pressure = np.full((len(q), len(plates), 3), np.nan)
    foot = np.full((len(q), len(plates)), NEITHER)
    for p, plate in enumerate(plates):
        pressure[:, p] = centres_of_pressure(wrench[:, p], surface_height(plate), plate.threshold_n)
        foot[:, p] = _foot_of_plate(pressure[:, p], soles, wrench[:, p, 2], rate_hz)
    foot[_together(soles, areas, rate_hz) & ~np.isnan(pressure[:, :, 0])] = BOTH
    total = np.zeros((len(q), 2, 6))
    for side in range(2):
        total[:, side] = (wrench * (foot == side)[:, :, None]).sum(axis=1)
    at_feet, free = _per_foot_pressure(pressure, wrench, foot)
    for t in np.flatnonzero((foot == BOTH).any(axis=1)):
        on = foot[t] >= 0
        surface = pressure[t, foot[t] == BOTH][0, 2]
        shared = share_load(wrench[t, on].sum(axis=0), soles[t].tolist(), q[t, :3], surface)
        total[t], at_feet[t] = shared.wrench, shared.centres_m
        free[t] = free_moment(shared.wrench, shared.centres_m)
    on_plate = _on_plate(foot)
    idle = _over_idle_plate(areas, soles, pressure, recorded)
    touching = _touching(soles, on_plate, rate_hz, TOUCHING) & ~idle & _facing_down(model, q)
    flight = ~touching.any(axis=1) & falling(q[:, 2], rate_hz)
    valid, warnings = _validity(model, touching, flight, foot, wrench, pressure, recorded)
    valid &= ~_on_silent_plate(areas, soles, on_plate, recorded, rate_hz)
    floor_m = _floor_height(soles, on_plate)
    unread, everywhere = touching & ~on_plate, np.asarray(recorded.all(axis=1))
    return FootLoads(total, at_feet, free, wrench, foot, valid, unread, everywhere, floor_m, warnings)


def _facing_down(model: Body, q: Array) -> BoolArray:
    """(T, 2) True for soles that face the floor at configurations q (T, nq); False where these are NaN."""
    feet = [model.joint(segment).joint_id for segment in model.roles.feet]
    return np.asarray(motion_frames(model, q)[0][:, feet, 2, 2] > FACES_DOWN)


def _floor_height(soles: Array, loaded: BoolArray) -> float:
    """Height of the floor: median of the soles (T, 2, 3, 3) that plates see loaded (T, 2), else of the lowest ones.

    NaN where no sole was tracked.
    """
    lowest = soles[:, :, :SOLE_ENDS, 2].min(axis=2)
    known = ~np.isnan(lowest)
    if (loaded & known).any():
        return float(np.median(lowest[loaded & known]))
    return float(np.percentile(lowest[known], FLOOR_PERCENTILE)) if known.any() else np.nan


def _over_idle_plate(areas: PlateAreas, soles: Array, pressure: Array, recorded: BoolArray) -> BoolArray:
    """(T, 2) feet that carry nothing: the middle of the sole lies over a plate that is recorded and not loaded."""
    middles = 0.5 * (soles[:, :, 0, :2] + soles[:, :, 2, :2])
    idle = recorded & np.isnan(pressure[:, :, 0])
    inside = areas.contain(middles.reshape(-1, 2)).reshape(len(soles), 2, -1)
    return np.asarray((inside & idle[:, None]).any(axis=2))


def _foot_of_plate(pressure: Array, soles: Array, vertical_n: Array, rate_hz: float) -> Array:
    """(T,) foot on one plate: that of the nearer sole, decided once per stretch of loading unless it changes.

    The vertical force (T,) weighs the frames of a stretch.
    """
    foot = np.full(len(pressure), NEITHER)
    distance = distances_to_soles(pressure, soles)
    usable = np.asarray(~np.isnan(distance).any(axis=1))
    for stretch in stretches(~np.isnan(pressure[:, 0])):
        frames = stretch[usable[stretch]]
        if len(frames) == 0:
            continue
        away, weight = distance[frames], vertical_n[frames]
        mean = ((away * weight[:, None]).sum(axis=0) / weight.sum()).tolist()
        nearer = majority(away[:, 1] < away[:, 0], 2 * int(MAJORITY_S * rate_hz) + 1).astype(int)
        if (nearer != int(mean[1] < mean[0])).mean() > MIXED_SHARE:
            foot[frames] = np.where(away.min(axis=1) <= REACH_M, nearer, NEITHER)
        else:
            foot[frames] = nearer_foot(mean)
    return foot


def _together(soles: Array, areas: PlateAreas, rate_hz: float) -> BoolArray:
    """(T, P) plates on which both feet stand; a plate without an outline is never shared."""
    together = np.zeros((len(soles), len(areas.known)), dtype=bool)
    known = np.flatnonzero(~np.isnan(soles[:, 0, 0, 0]))
    if len(known) < 2:
        return together
    moving = np.gradient(soles, axis=0)[known] * rate_hz
    at = soles[known, :, :, 2].argmin(axis=2)[:, :, None, None]
    lowest = np.take_along_axis(soles[known], at, axis=2)[:, :, 0]
    velocity = np.take_along_axis(moving, at, axis=2)[:, :, 0]
    speed = np.linalg.norm(velocity[:, 0] - velocity[:, 1], axis=1)
    stand = np.asarray(stand_together(lowest[:, 0, 2] - lowest[:, 1, 2], speed))
    inside = areas.contain(lowest[:, :, :2].reshape(-1, 2)).reshape(len(known), 2, -1).all(axis=1)
    together[known] = inside & stand[:, None]
    return together


def _per_foot_pressure(pressure: Array, wrench: Array, foot: Array) -> tuple[Array, Array]:
    """(T, 2, 3) centre of pressure and (T, 2) free moment of the strongest plate under each foot."""
    frames = np.arange(len(foot))
    at_feet = np.full((len(foot), 2, 3), np.nan)
    free = np.full((len(foot), 2), np.nan)
    if foot.shape[1] == 0:
        return at_feet, free
    for side in range(2):
        vertical = np.where(foot == side, wrench[:, :, 2], -np.inf)
        strongest = np.argmax(vertical, axis=1)
        mine = foot[frames, strongest] == side
        point, load = pressure[frames, strongest], wrench[frames, strongest]
        at_feet[mine, side] = point[mine]
        free[mine, side] = free_moment(load, point)[mine]
    return at_feet, free


def _on_plate(foot: Array) -> BoolArray:
    """(T, 2) feet that stand on a loaded plate, of their own or shared; foot (T, P) is that of each plate."""
    return np.stack([((foot == side) | (foot == BOTH)).any(axis=1) for side in range(2)], axis=1)


def _on_silent_plate(
    areas: PlateAreas, soles: Array, on_plate: BoolArray, recorded: BoolArray, rate_hz: float
) -> BoolArray:
    """(T,) frames in which a foot may stand on a plate that was not recorded, of known outline or not."""
    found = np.zeros(len(soles), dtype=bool)
    silent = np.flatnonzero(~recorded.all(axis=1))
    if not len(silent):
        return found
    standing = _touching(soles, on_plate, rate_hz, STANDING.relaxed())
    for t in silent:
        for side in np.flatnonzero(standing[t] & ~on_plate[t]):
            over = areas.contain(soles[t, side, :, :2]).any(axis=0) | ~areas.known
            found[t] |= bool((over & ~recorded[t]).any())
    return found


def _touching(soles: Array, on_plate: BoolArray, rate_hz: float, limits: Touch) -> BoolArray:
    """(T, 2) feet that touch the floor, whose height the soles of feet on plates (T, 2) show."""
    touching = np.zeros((len(soles), 2), dtype=bool)
    known = ~np.isnan(soles[:, 0, 0, 0])
    if len(soles) < 2 or not known.any():  # a single frame has no speed
        return touching
    lowest = soles[:, :, :, 2].min(axis=2)
    loaded = on_plate & known[:, None]
    stood_on = {side: np.median(lowest[loaded[:, side], side]) for side in range(2) if loaded[:, side].any()}
    for side in range(2):
        lowest_ever = np.percentile(lowest[known, side], FLOOR_PERCENTILE)
        floor = stood_on.get(side, min([lowest_ever, *stood_on.values()]))
        speed = np.linalg.norm(np.gradient(soles[:, side], axis=0), axis=2) * rate_hz
        touching[:, side] = np.asarray(limits.holds(soles[:, side, :, 2], floor, speed)).any(axis=1)
    return touching


def falling(height_m: Array, rate_hz: float) -> BoolArray:
    """(T,) frames in which the pelvis (height (T,), NaN where untracked) falls faster than a supported body."""
    found = np.zeros(len(height_m), dtype=bool)
    window = 2 * round(0.5 * FALL_WINDOW_S * rate_hz) + 1
    for stretch in stretches(~np.isnan(height_m)):
        if len(stretch) > max(window, 5):
            curve = second_derivative(height_m[stretch], max(window, 5), 1.0 / rate_hz)
            found[stretch] = falls(curve)
    return dilated(found, max(1, round(FALL_EDGE_S * rate_hz)))


def _validity(
    model: Body,
    touching: BoolArray,
    flight: BoolArray,
    foot: Array,
    wrench: Array,
    pressure: Array,
    recorded: BoolArray,
) -> tuple[BoolArray, tuple[str, ...]]:
    """(T,) frames in which every loaded foot stands on a recorded plate, and warnings."""
    measured = (~touching | _on_plate(foot)).all(axis=1)
    weight = -model.pin_model.gravity.linear[2] * model.mass_kg
    carried = np.where(foot >= 0, wrench[:, :, 2], 0.0).sum(axis=1) > STANDING_SHARE * weight
    stray = (~np.isnan(pressure[:, :, 0]) & (foot < 0)).any(axis=1)
    valid = measured & (carried | flight) & ~stray & recorded.any(axis=1)
    warnings = []
    if stray.any():
        warnings.append(
            f"{int(stray.sum())} frames have a loaded plate with no foot within {REACH_M:.2f} m of its centre of "
            "pressure; check the plate's place and axes, and whether something else stands on it"
        )
    if foot.shape[1] and not valid.any():
        warnings.append(
            "no frame has every loaded foot on a recorded plate; check the plates' places and recordings"
        )
    return valid, tuple(warnings)
