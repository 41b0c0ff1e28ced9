"""Which foot stands on which plate, and in which frames every contact is measured (SPEC S8, DESIGN §4 fact 6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import binary_dilation, median_filter
from scipy.signal import savgol_filter

from mbkf.conventions import GRAVITY_M_S2, Array, BoolArray
from mbkf.io.records import PlateReadings
from mbkf.io.resample import average_over_frames
from mbkf.io.wrench import centre_of_pressure
from mbkf.model.human import HumanModel
from mbkf.model.newton_euler import FEET
from mbkf.sensors.markers import MarkerSensor

REACH_M = 0.20
"""A centre of pressure further than this from a sole belongs to no foot."""

TOUCH_HEIGHT_M = 0.025
TOUCH_SPEED_M_S = 0.4
"""A sole point lower and slower than this touches the floor."""

STANDING_SHARE = 0.05
"""Share of body weight that the plates must carry when someone stands on the floor."""

FALL_SHARE = 0.4
FALL_WINDOW_S = 0.07
FALL_EDGE_S = 0.02
"""Flight: the pelvis falls with this share of gravity, judged over a short window, give or take an edge."""


@dataclass(frozen=True)
class FootLoads:
    """Ground reactions sorted by foot.

    Attributes:
        wrench: (T, 2, 6) force N and moment N m about the world's origin on right and left foot, world axes.
        centre_of_pressure_m: (T, 2, 3) of the stronger plate under each foot; NaN unloaded.
        free_moment_nm: (T, 2) about the vertical through the centre of pressure; NaN unloaded.
        plate_wrench: (T, P, 6) every plate about the world's origin; zero outside its recording.
        foot_of_plate: (T, P) 0 right, 1 left, -1 nobody.
        valid: (T,) every loaded foot on a measured plate.
        warnings: What a person should know.
    """

    wrench: Array
    centre_of_pressure_m: Array
    free_moment_nm: Array
    plate_wrench: Array
    foot_of_plate: Array
    valid: BoolArray
    warnings: tuple[str, ...]


def sole_locals(model: HumanModel) -> tuple[tuple[str, ...], Array]:
    """Heel, ball and toe end of right and left sole: their segments (6) and places (6, 3) in those, m."""
    sole = model.description.sole
    middle = 0.5 * (sole.inner_y_m + sole.outer_y_m)
    segments, places = [], []
    for segment, sign in zip(FEET, (1.0, -1.0), strict=True):
        toes = model.description.segment(segment.replace("foot", "toes"))
        for x in (sole.heel_x_m, toes.origin_m[0], sole.toe_x_m):
            segments.append(segment)
            places.append(np.array([x, sign * middle, sole.height_m]))
        scale = model.axis_scale(model.description.segment(segment))
        places[-3:] = [place * scale for place in places[-3:]]
    return tuple(segments), np.array(places)


def sole_points(model: HumanModel, q: Array) -> Array:
    """(T, 2, 3, 3) world positions of heel, ball and toe end of right and left sole; NaN where q is NaN."""
    sensor = MarkerSensor(model, *sole_locals(model))
    points = np.full((len(q), 2, 3, 3), np.nan)
    for t in np.flatnonzero(~np.isnan(q).any(axis=1)):
        points[t] = sensor.positions(q[t]).reshape(2, 3, 3)
    return points


def assign_feet(
    model: HumanModel, q: Array, times_s: Array, rate_hz: float, plates: tuple[PlateReadings, ...]
) -> FootLoads:
    """Sorts plate readings to feet by the distance of the centre of pressure to each sole.

    Args:
        model: The body.
        q: (T, nq) configurations of the trial, NaN where untracked.
        times_s: (T,) times of the frames.
        rate_hz: Frame rate.
        plates: The plates of the trial.
    """
    soles = sole_points(model, q)
    wrench = np.zeros((len(q), len(plates), 6))
    recorded = np.zeros((len(q), len(plates)), dtype=bool)
    pressure = np.full((len(q), len(plates), 3), np.nan)
    foot = np.full((len(q), len(plates)), -1)
    for p, plate in enumerate(plates):
        wrench[:, p], recorded[:, p] = _about_world_origin(plate, times_s, rate_hz)
        pressure[:, p] = _pressure(wrench[:, p], surface_height(plate), plate.threshold_n)
        foot[:, p] = _nearest_foot(pressure[:, p], soles, wrench[:, p, 2], rate_hz)
    total = np.zeros((len(q), 2, 6))
    for side in range(2):
        total[:, side] = (wrench * (foot == side)[:, :, None]).sum(axis=1)
    at_feet, free = _per_foot_pressure(pressure, wrench, foot)
    touching = _touching(soles, foot, rate_hz)
    flight = ~touching.any(axis=1) & _falling(q[:, 2], rate_hz)
    valid, warnings = _validity(model, touching, flight, foot, wrench, pressure, recorded)
    return FootLoads(total, at_feet, free, wrench, foot, valid, warnings)


def plate_wrenches(plates: tuple[PlateReadings, ...], times_s: Array, rate_hz: float) -> Array:
    """(T, P, 6) mean force N and moment N m about the world's origin of every plate over each frame.

    NaN where a plate was not recorded.

    Args:
        plates: The plates.
        times_s: (T,) times of the frames.
        rate_hz: Frame rate.
    """
    wrench = np.full((len(times_s), len(plates), 6), np.nan)
    for p, plate in enumerate(plates):
        found, recorded = _about_world_origin(plate, times_s, rate_hz)
        wrench[recorded, p] = found[recorded]
    return wrench


def surface_height(plate: PlateReadings) -> float:
    """Height of a plate's surface in the world, m."""
    return float(plate.origin_m[2] if plate.corners_m is None else plate.corners_m[:, 2].mean())


def pressure_and_free_moment(wrench: Array, surface_m: float, threshold_n: float) -> tuple[Array, Array]:
    """(T, 2, 3) centre of pressure at a height and (T, 2) free moment of feet's wrenches (T, 2, 6); NaN unloaded."""
    pressure = np.stack([_pressure(wrench[:, foot], surface_m, threshold_n) for foot in range(2)], axis=1)
    free = wrench[..., 5] - (pressure[..., 0] * wrench[..., 1] - pressure[..., 1] * wrench[..., 0])
    return pressure, free


def _about_world_origin(plate: PlateReadings, times_s: Array, rate_hz: float) -> tuple[Array, BoolArray]:
    loads = average_over_frames(plate, times_s, rate_hz)
    recorded = np.asarray(~np.isnan(loads.force_n).any(axis=1))
    force = np.nan_to_num(loads.force_n)
    moment = np.nan_to_num(loads.moment_nm) + np.cross(plate.origin_m, force)
    return np.concatenate([force, moment], axis=1), recorded


def _pressure(wrench: Array, surface_m: float, threshold_n: float) -> Array:
    """(T, 3) centre of pressure on a horizontal surface from wrenches about the world's origin (eq. 4.9)."""
    below = np.array([0.0, 0.0, surface_m])
    moment = wrench[:, 3:] - np.cross(below, wrench[:, :3])
    return centre_of_pressure(wrench[:, :3], moment, below, np.array([0.0, 0.0, 1.0]), threshold_n)


def _nearest_foot(pressure: Array, soles: Array, vertical_n: Array, rate_hz: float) -> Array:
    """(T,) foot on one plate: the nearer sole, decided per stretch of loading."""
    foot = np.full(len(pressure), -1)
    distance = np.stack([_distance_to_sole(pressure, soles[:, side]) for side in range(2)], axis=1)
    usable = np.asarray(~np.isnan(distance).any(axis=1))
    for stretch in stretches(~np.isnan(pressure[:, 0])):
        frames = stretch[usable[stretch]]
        if len(frames) == 0:
            continue
        weight = vertical_n[frames]
        near = (distance[frames] * weight[:, None]).sum(axis=0) / weight.sum()
        per_frame = median_filter(
            np.argmin(distance[frames], axis=1), size=2 * int(0.05 * rate_hz) + 1, mode="nearest"
        )
        best = int(np.argmin(near))
        changes = (per_frame != best).mean() > 0.2
        foot[frames] = np.where(distance[frames].min(axis=1) <= REACH_M, per_frame, -1) if changes else best
        if not changes and near[best] > REACH_M:
            foot[frames] = -1
    return foot


def _distance_to_sole(point: Array, sole: Array) -> Array:
    """(T,) horizontal distance from a point (T, 3) to the line from heel to toe end (T, 3, 3)."""
    heel, toe = sole[:, 0, :2], sole[:, 2, :2]
    along = toe - heel
    share = np.clip(((point[:, :2] - heel) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    return np.linalg.norm(point[:, :2] - heel - share[:, None] * along, axis=1)


def stretches(mask: BoolArray) -> list[Array]:
    """Frame numbers of each unbroken run of True in a mask (T,)."""
    frames = np.flatnonzero(mask)
    return np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1) if len(frames) else []


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
        moment = load[:, 5] - (point[:, 0] * load[:, 1] - point[:, 1] * load[:, 0])
        free[mine, side] = moment[mine]
    return at_feet, free


def _touching(soles: Array, foot: Array, rate_hz: float) -> BoolArray:
    """(T, 2) feet that touch the floor: a sole point is low and slow."""
    touching = np.zeros((len(soles), 2), dtype=bool)
    known = ~np.isnan(soles[:, 0, 0, 0])
    if not known.any():
        return touching
    lowest = soles[:, :, :, 2].min(axis=2)
    loaded = np.stack([(foot == side).any(axis=1) & known for side in range(2)], axis=1)
    stood_on = {side: np.median(lowest[loaded[:, side], side]) for side in range(2) if loaded[:, side].any()}
    for side in range(2):
        lowest_ever = np.percentile(lowest[known, side], 5)
        floor = stood_on.get(side, min([lowest_ever, *stood_on.values()]))
        speed = np.linalg.norm(np.gradient(soles[:, side], axis=0), axis=2) * rate_hz
        low = soles[:, side, :, 2] < floor + TOUCH_HEIGHT_M
        touching[:, side] = (low & (speed < TOUCH_SPEED_M_S)).any(axis=1)
    return touching


def _falling(height_m: Array, rate_hz: float) -> BoolArray:
    """(T,) the pelvis accelerates downwards as nobody does whom a floor carries."""
    falling = np.zeros(len(height_m), dtype=bool)
    window = 2 * round(0.5 * FALL_WINDOW_S * rate_hz) + 1
    for stretch in stretches(~np.isnan(height_m)):
        if len(stretch) > max(window, 5):
            curve = savgol_filter(height_m[stretch], max(window, 5), 2, deriv=2, delta=1.0 / rate_hz)
            falling[stretch] = curve < -FALL_SHARE * GRAVITY_M_S2
    return np.asarray(binary_dilation(falling, iterations=max(1, round(FALL_EDGE_S * rate_hz))))


def _validity(
    model: HumanModel,
    touching: BoolArray,
    flight: BoolArray,
    foot: Array,
    wrench: Array,
    pressure: Array,
    recorded: BoolArray,
) -> tuple[BoolArray, tuple[str, ...]]:
    on_plate = np.stack([(foot == side).any(axis=1) for side in range(2)], axis=1)
    measured = (~touching | on_plate).all(axis=1)
    weight = -model.pin_model.gravity.linear[2] * model.mass_kg
    carried = np.where(foot >= 0, wrench[:, :, 2], 0.0).sum(axis=1) > STANDING_SHARE * weight
    stray = (~np.isnan(pressure[:, :, 0]) & (foot < 0)).any(axis=1)
    valid = measured & (carried | flight) & ~stray & recorded.any(axis=1)
    warnings = []
    if stray.any():
        warnings.append(f"{int(stray.sum())} frames have a loaded plate with no foot within {REACH_M:.2f} m")
    if foot.shape[1] and not valid.any():
        warnings.append("no frame has every loaded foot on a measured plate")
    return valid, tuple(warnings)
