"""Faults of plates as strangers' files have them: torques about other points, wrong units, signs and corners."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.any_capture.plates import FORCES, KNOWN_KG, read
from benchmarks.checks import Check
from mbkf.conventions import Array
from mbkf.io.capture import read_capture
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.force_table import ForceTable, plates_of_table
from mbkf.io.records import Capture, PlateReadings
from mbkf.io.wrench import centre_of_pressure
from mbkf.trial.checks.plate_contradictions import plate_contradictions
from mbkf.trial.checks.unscaled_mass import plate_notes

POINTS: Mapping[str, tuple[float, Array]] = {
    "the plate's middle": (1.0, np.array([0.03, -0.02, 0.0])),
    "the plate's corner": (1.0, np.array([0.25, 0.3, 0.0])),
    "a point 4 cm below the surface": (1.0, np.array([0.03, -0.02, -0.04])),
    "a place in the laboratory": (0.0, np.array([1.5, -0.7, 0.9])),
}
"""Points that torques refer to: share of the mean centre of pressure, and what is added, m."""

MOMENT_BOUND_NM = 0.05
UP = np.array([0.0, 0.0, 1.0])

CHOSEN_ON = (
    "gaitalytics_walk/overground_fullbody_4plates.c3d",
    "functional_walk/FunctionalWalk.c3d",
    "cgm24_lowerlimb_walk/CGM24_Walking01.c3d",
    "judgement/walk7_static.c3d",
    "biomechzoo_walk_turn/HC032A_Static_HC032A01.c3d",
    "fukuchi_run/RBDS001runT35.c3d",
)
"""Captures on which the bounds of :mod:`mbkf.trial.checks.plate_contradictions` were chosen."""

SHOWN_ON = {
    "biomechzoo_walk_turn/HC044A_Straight_HC044A15.c3d": 39.4,
    "functional_walk/FunctionalStatic.c3d": 60.0,
    "judgement/walk7_120frames.c3d": 71.86,
    "landings/doubleLegLanding.c3d": None,
    "rehazenter_walk/2014001_C1_01.c3d": None,
    "biobuddy_functional/functional_right_knee.c3d": None,
    "unipd_walk/Walking1.c3d": None,
    "flywheel_squat/S1_StandingRef.c3d": None,
    "opensim_gappy_walk/walking2.c3d": None,
}
"""Captures with corners that faults are put into, and the masses that are known, kg."""

CLEAN = (
    *KNOWN_KG,
    *SHOWN_ON,
    "opencap_s6_walk/s6_walking1.trc",
    "flywheel_squat/S1_FlywheelSquat.c3d",
)
"""Captures whose plates are right in sign, unit and place."""


@dataclass(frozen=True)
class Fault:
    """Factors on force, moment and corners of all plates, and a shift of the corners, m."""

    force: float = 1.0
    moment: float = 1.0
    corners: float = 1.0
    shift_m: float = 0.0

    def put_into(self, capture: Capture) -> Capture:
        """The capture with the fault."""
        return replace(capture, plates=tuple(self._of(plate) for plate in capture.plates))

    def _of(self, plate: PlateReadings) -> PlateReadings:
        force, moment = self.force * plate.force_n, self.moment * plate.moment_nm
        assert plate.corners_m is not None
        corners = self.corners * plate.corners_m + [self.shift_m, 0.0, 0.0]
        origin = corners.mean(axis=0)
        pressed = centre_of_pressure(force, moment, origin, UP, plate.threshold_n)
        return replace(
            plate,
            force_n=force,
            moment_nm=moment,
            corners_m=corners,
            origin_m=origin,
            centre_of_pressure_m=pressed,
        )


FAULTS: Mapping[str, Fault] = {
    "sign": Fault(force=-1.0, moment=-1.0),
    "kN": Fault(force=1e-3, moment=1e-3),
    "N mm": Fault(moment=1e3),
    "moments divided by 1000": Fault(moment=1e-3),
    "corners in mm": Fault(corners=1e3),
    "corners in dm": Fault(corners=0.1),
    "corners 1.5 m away": Fault(shift_m=1.5),
    "gain of 2": Fault(force=2.0, moment=2.0),
}


def plate_point_rows(data: Path) -> list[Check]:
    """Rows of torques about other points and in other units, and of faults of plates.

    Args:
        data: Folder of the reference captures.
    """
    return [*point_rows(data), *fault_rows(data)]


def point_rows(data: Path) -> Iterator[Check]:
    """Largest difference of moments about the world's origin, of all public MOT files."""
    tables = [table for name, forces in FORCES.items() if (table := _table(data, name, forces)) is not None]
    for point, (share, added) in POINTS.items():
        off = [_off(table, _about(table, share, added)) for table in tables]
        yield Check(f"torques about {point}, moments", float(np.max(off)), MOMENT_BOUND_NM, "<=", "N m")
    for name, scaled in (("points in mm", (1e3, 1.0)), ("torques in N mm", (1.0, 1e3)), ("both", (1e3, 1e3))):
        off = [_off(table, _in_units(table, *scaled)) for table in tables]
        yield Check(f"{name}, moments", float(np.max(off)), MOMENT_BOUND_NM, "<=", "N m")


def fault_rows(data: Path) -> Iterator[Check]:
    """Shares of faults that are named, and right captures that are accused."""
    accused = sum(len(plate_contradictions(read(data, name))) > 0 for name in CLEAN)
    yield Check("signs, units and places of plates, accused falsely", accused, 0, "<=")
    captures = {name: read(data, name) for name in SHOWN_ON}
    for name, fault in FAULTS.items():
        known = [one for one, kg in SHOWN_ON.items() if kg is not None or fault.force != 2.0]
        named = [bool(plate_notes([fault.put_into(captures[one])], SHOWN_ON[one])) for one in known]
        yield Check(f"plates with {name}, named", 100.0 * float(np.mean(named)), 100.0, ">=", "%")


@dataclass(frozen=True)
class _Stated:
    """Force, point of application and torque there of each set, (S, 3) each in world axes."""

    sets: tuple[tuple[Array, Array, Array], ...]
    rate_hz: float


def _table(data: Path, name: str, forces: str) -> _Stated | None:
    """The sets of a file as OpenSim states them; None without a loaded one."""
    path = data / name
    capture = read_capture(path, forces=path.parent / forces)
    sets = []
    for plate in capture.plates:
        pressed = plate.centre_of_pressure_m
        if not np.isfinite(pressed).all(axis=1).any():
            continue
        point = np.where(np.isfinite(pressed), pressed, 0.0)
        torque = plate.moment_nm - np.cross(point - plate.origin_m, plate.force_n)
        loaded = np.isfinite(pressed).all(axis=1, keepdims=True)
        sets.append((plate.force_n * loaded, point, torque * loaded * UP))
    return _Stated(tuple(sets), capture.plates[0].rate_hz) if sets else None


def _about(stated: _Stated, share: float, added: Array) -> _Stated:
    """The torques about another point."""
    found = []
    for force, point, torque in stated.sets:
        origin = share * point[force[:, 2] > 0.0].mean(axis=0) + added
        found.append((force, point, torque + np.cross(point - origin, force)))
    return replace(stated, sets=tuple(found))


def _in_units(stated: _Stated, length: float, moment: float) -> _Stated:
    return replace(stated, sets=tuple((f, length * p, moment * t) for f, p, t in stated.sets))


def _off(stated: _Stated, faulty: _Stated) -> float:
    """Largest difference of moments about the world's origin, N m."""
    right = [torque + np.cross(point, force) for force, point, torque in stated.sets]
    read_as = _read(faulty)
    off = [
        np.abs(plate.moment_nm + np.cross(plate.origin_m, plate.force_n) - one).max()
        for plate, one in zip(read_as, right, strict=True)
    ]
    return float(np.max(off))


def _read(stated: _Stated) -> tuple[PlateReadings, ...]:
    names = tuple(f"{kind}{axis}{k}" for k in range(len(stated.sets)) for kind in "FPM" for axis in "xyz")
    values = np.hstack([column for one in stated.sets for column in one])
    table = ForceTable("made.mot", names, values, stated.rate_hz, 0.0, metres=None)
    return plates_of_table(table, CaptureOptions(up="z", tare=False))
