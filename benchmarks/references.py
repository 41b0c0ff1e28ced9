"""Results that other programs stored beside the reference captures, and how two curves are compared."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import SIDES, Array
from mbkf.errors import InvalidInput, UnknownName
from mbkf.io.c3d import read_c3d
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.forces import read_forces_mot
from mbkf.io.records import Capture
from mbkf.io.storage import Table, read_storage
from mbkf.io.trc import read_trc
from mbkf.io.wrench import centre_of_pressure

LOW_PASS_HZ = 6.0
"""Cut-off of the low-pass the reference torques of the walk were made with."""

PLUG_IN_GAIT = {"hip_flexion": "HipAngles", "knee_angle": "KneeAngles", "ankle_angle": "AnkleAngles"}
"""Our flexion coordinates and the points whose first component holds them in Plug-in Gait."""

PRINTED_DIGITS = 5
"""Digits of a coordinate in the TRC file OpenSim stored."""

_MM = 1e3


@dataclass(frozen=True)
class Curve:
    """Values (T,) over times (T,) in s."""

    times_s: Array
    values: Array


@dataclass(frozen=True)
class Agreement:
    """How alike two curves are: correlation, and RMS of the difference as it is and without its mean."""

    r: float
    rms: float
    rms_without_mean: float


def correlation(a: Array, b: Array) -> float:
    """Pearson's r of two curves; NaN where one of them is constant."""
    a, b = a - a.mean(), b - b.mean()
    norm = float(np.linalg.norm(a) * np.linalg.norm(b))
    return float(a @ b) / norm if norm > 0.0 else float("nan")


def rms(values: Array) -> float:
    """Root mean square of the known values; NaN where none is known."""
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if known.size else float("nan")


def rms_without_mean(difference: Array) -> float:
    """RMS of a difference after its mean is removed."""
    return rms(difference - np.nanmean(difference)) if np.isfinite(difference).any() else float("nan")


def low_pass(values: Array, rate_hz: float, cut_off_hz: float = LOW_PASS_HZ, order: int = 2) -> Array:
    """Butterworth low-pass run forwards and backwards, so that nothing is delayed.

    Args:
        values: (T,) or (T, C) evenly spaced samples.
        rate_hz: Their rate in Hz.
        cut_off_hz: Where one of the two passes has lost half the power.
        order: Order of one pass.
    """
    from scipy.signal import butter, sosfiltfilt

    return sosfiltfilt(butter(order, cut_off_hz, fs=rate_hz, output="sos"), values, axis=0)


def low_passed(table: Table) -> Table:
    """The table with every column low-passed at its own rate.

    Raises:
        InvalidInput: Its times are not evenly spaced.
    """
    steps = np.diff(table.times_s)
    if len(steps) == 0 or np.ptp(steps) > 0.01 * steps.mean():
        raise InvalidInput(f"'{table.title}': times are not evenly spaced, so no low-pass can be applied")
    smooth = low_pass(table.columns, 1.0 / float(steps.mean()))
    return Table(table.names, table.times_s, smooth, title=table.title)


def agreement(ours: Curve, theirs: Curve) -> Agreement:
    """Compares two curves at their common times, on the times of the coarser one.

    Raises:
        InvalidInput: They share less than two samples.
    """
    coarse, fine = sorted((ours, theirs), key=_rate)
    inside = (coarse.times_s >= fine.times_s[0] - 1e-9) & (coarse.times_s <= fine.times_s[-1] + 1e-9)
    inside &= np.isfinite(coarse.values)
    if inside.sum() < 2:
        raise InvalidInput("the two curves share no stretch of time")
    known = np.isfinite(fine.values)
    a, b = coarse.values[inside], np.interp(coarse.times_s[inside], fine.times_s[known], fine.values[known])
    return Agreement(correlation(a, b), rms(a - b), rms_without_mean(a - b))


def worst_side(
    ours: Table, theirs: Table, coordinate: str, *, suffix: str = "", sign: float = 1.0, factor: float = 1.0
) -> Agreement:
    """The poorer agreement of the right and the left side, each number for itself.

    Args:
        ours: Our table.
        theirs: The reference, with the same column names.
        coordinate: Column without side, e.g. "hip_flexion".
        suffix: What follows the side, e.g. "_moment".
        sign: −1 where the reference counts the other way.
        factor: What both are multiplied with, e.g. 1 / mass.
    """
    found = []
    for side in SIDES:
        name = f"{coordinate}_{side}{suffix}"
        own = Curve(ours.times_s, factor * ours.column(name))
        found.append(agreement(own, Curve(theirs.times_s, sign * factor * theirs.column(name))))
    largest = (max(a.rms for a in found), max(a.rms_without_mean for a in found))
    return Agreement(min(a.r for a in found), *largest)


def in_degrees(table: Table) -> Table:
    """A table of coordinates in degrees, also where the file's header states no unit or a wrong one."""
    if table.in_degrees:
        return table
    return Table(table.names, table.times_s, np.rad2deg(table.columns), True, table.title)


def plug_in_gait_angles(capture: Capture) -> Table:
    """Hip, knee and ankle flexion that Plug-in Gait stored in a C3D file, under our column names.

    Raises:
        UnknownName: The file holds no such angles.
    """
    stored = {point.name: point for point in capture.derived if point.kind == "angle"}
    names, columns = [], []
    for coordinate, label in PLUG_IN_GAIT.items():
        for side in SIDES:
            point = stored.get(side.upper() + label)
            if point is None:
                raise UnknownName("angle", side.upper() + label, stored, capture.path)
            names.append(f"{coordinate}_{side}")
            columns.append(point.values[:, 0])
    return Table(tuple(names), capture.markers.times_s, np.column_stack(columns), True, "Plug-in Gait")


def plates_against_export(c3d: Path, mot: Path) -> tuple[float, float]:
    """RMS difference of force in N and of centre of pressure in mm between a C3D's plates and their export.

    The offset found in the C3D is taken off the export's forces and points, too. The export's torques are
    left aside, since it writes them with the opposite sign (its unloaded plate shows it), and so are its
    samples below the threshold, where it names the middle of the plate.
    """
    exported = {plate.name: plate for plate in read_forces_mot(mot, CaptureOptions(tare=False, up="y"))}
    force, pressure = [], []
    for plate in read_c3d(c3d, CaptureOptions()).plates:
        other = exported[plate.name]
        count = min(len(plate.force_n), len(other.force_n))
        theirs, point = other.force_n[:count], other.centre_of_pressure_m[:count]
        zeroed = (plate.force_n[:count] == 0.0).all(axis=1)
        bare = np.where(zeroed[:, None], theirs, theirs - plate.offset[:3])
        moment = np.cross(point - plate.origin_m, theirs) - plate.offset[3:]
        tared = centre_of_pressure(bare, moment, plate.origin_m, np.array([0.0, 0.0, 1.0]), plate.threshold_n)
        force.append(plate.force_n[:count] - bare)
        pressure.append(_MM * (plate.centre_of_pressure_m[:count] - tared))
    return _rms_of_norm(np.concatenate(force)), _rms_of_norm(np.concatenate(pressure))


def stored_markers(c3d: Path, trc: Path) -> float:
    """Largest difference in mm to the markers OpenSim read, beyond its rounding; ∞ where a gap differs."""
    capture, theirs = read_c3d(c3d, CaptureOptions()), read_trc(trc, CaptureOptions(up="z")).markers
    rows = np.rint((_trc_times(trc) - capture.markers.start_time_s) * capture.markers.rate_hz).astype(int)
    names = tuple(name for name in theirs.names if name in capture.markers.names)
    own, stored = (_MM * m.positions_m for m in (capture.markers.select(names), theirs.select(names)))
    own = own[rows]
    if not np.array_equal(np.isnan(own), np.isnan(stored)):
        return float("inf")
    return float(np.nanmax(np.maximum(np.abs(own - stored) - rounding(stored), 0.0)))


def rounding(printed: Array, digits: int = PRINTED_DIGITS) -> Array:
    """How far a number printed with so many digits may lie from what it was: half its last digit."""
    size = np.floor(np.log10(np.maximum(np.abs(printed), 1e-12)))
    return 0.5 * 10.0 ** (size - digits + 1)


def stored_forces(c3d: Path, at_plates: Path, at_pressure: Path) -> tuple[float, float, float]:
    """Largest differences of force in N, moment in N m and centre of pressure in mm to what OpenSim read.

    Args:
        c3d: The capture, read without removing offsets.
        at_plates: OpenSim's forces and moments in the middle of the plates.
        at_pressure: OpenSim's forces at the centre of pressure; compared while loaded.
    """
    middle, pressed = read_storage(at_plates), read_storage(at_pressure)
    forces, moments, pressures = [], [], []
    for number, plate in enumerate(read_c3d(c3d, CaptureOptions(tare=False)).plates, start=1):
        rows = np.rint((middle.times_s - plate.start_time_s) * plate.rate_hz).astype(int)
        f, p, m = (_vectors(middle, f"{kind}{number}_{{}}") for kind in "fpm")
        moment = plate.moment_nm[rows] + np.cross(plate.origin_m - p / _MM, plate.force_n[rows])
        forces.append(np.abs(plate.force_n[rows] - f).max())
        moments.append(np.abs(moment - m / _MM).max())
        points = _MM * plate.centre_of_pressure_m[rows] - _vectors(pressed, f"p{number}_{{}}")
        pressures.append(np.nanmax(np.abs(points)))
    return float(max(forces)), float(max(moments)), float(max(pressures))


def _vectors(table: Table, pattern: str) -> Array:
    """(T, 3) values of the columns a pattern names with 1, 2 and 3."""
    return np.column_stack([table.column(pattern.format(i)) for i in (1, 2, 3)])


def _trc_times(path: Path) -> Array:
    """The Time column; OpenSim writes only some frames there, without saying so in the header."""
    lines = path.read_text(encoding="utf-8").splitlines()[5:]
    return np.array([float(line.split("\t")[1]) for line in lines if line.strip()])


def _rate(curve: Curve) -> float:
    return len(curve.times_s) / max(float(np.ptp(curve.times_s)), 1e-9)


def _rms_of_norm(vectors: Array) -> float:
    return rms(np.linalg.norm(vectors, axis=-1))
