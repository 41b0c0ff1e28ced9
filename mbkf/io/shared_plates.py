"""Force plates on which another person of the capture stands: their forces are not those of the chosen person."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mbkf.conventions import Array
from mbkf.io.records import Capture, MarkerTrajectories, PlateReadings
from mbkf.numerics.runs import spread_indices

LOW_M = 0.3
"""Greatest height above the lowest marker of both persons of a marker of the foot or ankle."""

MOSTLY, FRAMES = 0.8, 100
"""Share of a plate's loaded time that belongs to one person, and samples that are looked at."""

NEAR_M = 0.3
"""Level distance from the centre of pressure within which a person's foot stands there."""


def without_others_plates(capture: Capture) -> Capture:
    """The capture without the plates that only other persons load; remarks on these, and on plates that both load.

    Args:
        capture: A capture of which one person was chosen.
    """
    others = capture.others
    if others is None or not capture.plates:
        return capture
    kept, left_out, notes = [], dict(capture.plates_left_out), list(capture.notes)
    floor_m = min(_lowest(capture.markers), _lowest(others))
    for plate in capture.plates:
        share = _others_share(plate, capture.markers, others, floor_m)
        if share >= MOSTLY:
            left_out[plate.name] = "another person stands on it"
            notes.append(f"plate {plate.name} is left out: another person stands on it, not the chosen one")
            continue
        kept.append(plate)
        if share > 1.0 - MOSTLY:
            notes.append(
                f"plate {plate.name} carries another person in {100 * share:.0f} % of its loaded time; its force goes "
                "to a foot of the chosen person only where that foot stands at the centre of pressure"
            )
    return replace(capture, plates=tuple(kept), plates_left_out=left_out, notes=tuple(notes))


def _lowest(markers: MarkerTrajectories) -> float:
    heights = markers.positions_m[:, :, 2]
    return float(np.nanquantile(heights, 0.01)) if np.isfinite(heights).any() else np.inf


def _others_share(
    plate: PlateReadings, own: MarkerTrajectories, others: MarkerTrajectories, floor_m: float
) -> float:
    """Share of a plate's loaded samples at whose centre of pressure only other persons stand; 0 without a load."""
    loaded = np.flatnonzero(np.isfinite(plate.centre_of_pressure_m[:, 0]))
    loaded = loaded[spread_indices(len(loaded), FRAMES)]
    frames = np.round((plate.times_s[loaded] - own.start_time_s) * own.rate_hz).astype(np.intp)
    inside = (frames >= 0) & (frames < own.frames)
    if not inside.any():
        return 0.0
    centres, frames = plate.centre_of_pressure_m[loaded[inside]], frames[inside]
    mine, theirs = (_feet_apart(one.positions_m[frames], centres, floor_m) for one in (own, others))
    return float(((theirs < NEAR_M) & np.isfinite(mine) & (mine > NEAR_M)).mean())


def _feet_apart(places_m: Array, centres_m: Array, floor_m: float) -> Array:
    """(S,) level distance of the nearest low marker from centres of pressure (S, 3); infinite without one."""
    apart = np.linalg.norm(places_m[:, :, :2] - centres_m[:, None, :2], axis=2)
    low = places_m[:, :, 2] < floor_m + LOW_M
    return np.asarray(np.where(low & np.isfinite(apart), apart, np.inf).min(axis=1, initial=np.inf))
