"""Plates and analog channels of a result's C3D file: those of the trial, and loads that the filter alone knows.

An estimated load becomes a plate of type 2 as large as the places where it acts: programs that read the file compute
the force, its centre of pressure and the joints' moments from it as from a plate of a laboratory.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.capture import read_capture
from mbkf.io.contacts import Source
from mbkf.io.plate_corners import QUADRANTS
from mbkf.io.records import AnalogChannel, Capture, MarkerTrajectories, PlateReadings
from mbkf.io.results import Reconstruction
from mbkf.io.wrench import DEFAULT_COP_THRESHOLD_N
from mbkf.trial.exchange.even_frames import at_rows

_MARGIN_M = 0.2
"""Between the outermost places where a load acts and the edge of its plate: half a foot and more."""

_SAME_M, _COMPARED = 1e-3, 50
"""Distance of markers that are those of the result, and the number of frames in which they are compared."""


def trial_of(r: Reconstruction, path: str | Path, forces: str | Path | None = None) -> Capture:
    """The capture that a result was made from, in the result's axes.

    Args:
        r: The result.
        path: The capture's file.
        forces: File of ground reactions, where the result was made with one.

    Raises:
        InvalidInput: Its markers are not those of the result.
        FileFormatError: A file cannot be read.
    """
    capture = read_capture(path, forces=forces, axes=r.file_axes)
    frames = _frames_of(capture.markers, r)
    inside = np.flatnonzero((frames >= 0) & (frames < capture.markers.frames))
    seen = inside[np.linspace(0, len(inside) - 1, min(len(inside), _COMPARED)).astype(int)]
    apart = [_distances(r.measured_m[t], capture.markers.positions_m[frames[t]]) for t in seen]
    distances = np.concatenate([np.zeros(0), *apart])
    if len(inside) < r.frames or not len(distances) or np.median(distances) > _SAME_M:
        found = "no marker of the result is seen in it"
        if len(inside) < r.frames:
            found = f"it has {len(inside)} of these frames"
        elif len(distances):
            found = f"its markers lie {1e3 * np.median(distances):.0f} mm from those of the result"
        raise InvalidInput(
            f"{path} is not the trial of this result ('{r.trial}', {r.frames} frames): {found}; name the file that "
            "'mbkf reconstruct' read"
        )
    return capture


def _frames_of(markers: MarkerTrajectories, r: Reconstruction) -> NDArray[np.intp]:
    """(T,) frame of the capture for each row of the result."""
    return np.round((r.times_s - markers.start_time_s) * markers.rate_hz).astype(np.intp)


def _distances(of: Array, among: Array) -> Array:
    """Distance of each seen point (M, 3) from the nearest of others (N, 3), m."""
    of, among = of[np.isfinite(of).all(axis=1)], among[np.isfinite(among).all(axis=1)]
    if not len(among):
        return np.full(len(of), np.inf)
    return np.asarray(np.linalg.norm(of[:, None] - among, axis=2).min(axis=1))


def analog_of(
    markers: MarkerTrajectories, r: Reconstruction, trial: Capture | None
) -> tuple[AnalogChannel, ...]:
    """Analog channels of the trial over the frames of the file.

    Args:
        markers: The markers of the file.
        r: The result.
        trial: The capture that it was made from.
    """
    if trial is None or not r.frames:
        return ()
    first = int(_frames_of(trial.markers, r)[0])
    cut = []
    for channel in trial.analog:
        per_frame = channel.rate_hz / trial.markers.rate_hz  # Delsys samples 19.26 times a frame
        values = channel.values[round(first * per_frame) : round((first + markers.frames) * per_frame)]
        cut.append(replace(channel, values=values))
    return tuple(cut)


def plates_of(
    r: Reconstruction, rows: NDArray[np.intp], start_s: float, trial: Capture | None
) -> tuple[PlateReadings, ...]:
    """The trial's plates that the filter read, and those of loads that it estimates.

    Args:
        r: The result.
        rows: (F,) row of the result for every frame of the file, −1 for lost ones.
        start_s: Time of the file's first frame.
        trial: The capture that the result was made from; without it, all loads are the filter's.
    """
    later_s = start_s - float(r.times_s[0]) if r.frames else 0.0
    read = () if trial is None else tuple(p for p in trial.plates if p.name in r.read_plate_names)
    measured = tuple(
        replace(
            plate,
            start_time_s=plate.start_time_s + later_s,
            description=f"measured: plate {plate.name}, offset removed",
        )
        for plate in read
    )
    return (*measured, *_estimated(r, rows, start_s, beside=bool(measured)))


def _estimated(
    r: Reconstruction, rows: NDArray[np.intp], start_s: float, beside: bool
) -> Iterator[PlateReadings]:
    """A plate for each part that bears; ``beside`` measured ones, only where no plate reads it."""
    loads = r.loads
    own = (loads.source == Source.ESTIMATED) if beside else (loads.source != Source.NONE)
    where = ", where no plate reads it" if beside else ""
    for k, part in enumerate(loads.names):
        bears = own[:, k] & np.isfinite(loads.wrench[:, k]).all(axis=1)
        if not bears.any():
            continue
        wrench = np.where(bears[:, None], loads.wrench[:, k], 0.0)
        places = loads.point_m[bears, k]
        corners = _outline(places[np.isfinite(places).all(axis=1)])
        even = np.nan_to_num(at_rows(wrench, rows))
        origin = corners.mean(axis=0)
        force = even[:, :3]
        pressure = at_rows(np.where(bears[:, None], loads.point_m[:, k], np.nan), rows)
        yield PlateReadings(
            name=part,
            rate_hz=r.rate_hz,
            start_time_s=start_s,
            origin_m=origin,
            force_n=force,
            moment_nm=even[:, 3:] - np.cross(origin, force),
            centre_of_pressure_m=pressure,
            threshold_n=DEFAULT_COP_THRESHOLD_N,
            corners_m=corners,
            description=f"estimated by mbkf: load on {part}{where}",
        )


def _outline(places_m: Array) -> Array:
    """(4, 3) corners, m, of a level plate around places (n, 3); about the world's origin without any."""
    if not len(places_m):
        places_m = np.zeros((1, 3))
    low, high = places_m.min(axis=0), places_m.max(axis=0)
    half = 0.5 * (high - low)[:2] + _MARGIN_M
    corners = np.tile([*(0.5 * (low + high))[:2], np.median(places_m[:, 2])], (4, 1))
    corners[:, :2] += QUADRANTS * [1.0, -1.0] * half  # so that its z points down
    return corners
