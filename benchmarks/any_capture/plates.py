"""Plates of public captures: against known masses before anything is scaled, in odd encodings, clocks and axes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.checks import Check
from mbkf.conventions import Array
from mbkf.io.capture import read_capture
from mbkf.io.findings import Finding
from mbkf.io.records import Capture
from mbkf.trial.checks.unscaled_mass import unscaled_mass_finding

KNOWN_KG = {
    "biomechzoo_walk_turn/HC032A_Static_HC032A01.c3d": 60.3,
    "biomechzoo_walk_turn/HC032A_Straight_HC032A03.c3d": 60.3,
    "biomechzoo_walk_turn/HC044A_Static_HC044A01.c3d": 39.4,
    "biomechzoo_walk_turn/HC044A_Straight_HC044A15.c3d": 39.4,
    "bmc_walk_run/run.trc": 70.0,
    "cgm24_lowerlimb_walk/CGM24_Walking01.c3d": 77.6,
    "foreign_truth/adult/run/trial.trc": 85.3,
    "foreign_truth/adult/squat/trial.trc": 85.3,
    "foreign_truth/adult/walk/trial.trc": 85.3,
    "foreign_truth/child/run/trial.trc": 23.0,
    "foreign_truth/child/squat/trial.trc": 23.0,
    "foreign_truth/child/walk/trial.trc": 23.0,
    "fukuchi_run/RBDS001runT35.c3d": 60.3,
    "functional_walk/FunctionalStatic.c3d": 60.0,
    "functional_walk/FunctionalWalk.c3d": 60.0,
    "gait2354_walk/subject01_walk1.trc": 72.6,
    "gaitalytics_walk/overground_fullbody_4plates.c3d": 63.6,
    "judgement/walk7_static.c3d": 71.86,
    "judgement/walk7_120frames.c3d": 71.86,
    "rajagopal_walk_run/motion_capture_run.trc": 72.84,
    "rajagopal_walk_run/motion_capture_walk.trc": 85.07,
    "rehazenter_walk/2014001_C1_01.c3d": 67.0,
    "stoop_lift_box/neu_t169_f250f350.c3d": 81.7,
    "stoop_lift_box/stoop1_t169_f620f800.c3d": 81.7,
    "stoop_lift_box/stoop2_t169_f1395f1590.c3d": 81.7,
    "stoop_lift_box/stoop3_t169_f2101f2300.c3d": 81.7,
    "synthetic_exact_truth/subject01_walk2_markers.trc": 72.84,
}
"""Masses that the captures' readme files state, kg; captures whose mass only their own plates show are left out."""

HEAVIER_KG = {"flywheel_squat/S1_FlywheelSquat.c3d": 81.3, "opencap_s6_walk/s6_walking1.trc": 59.0}
"""Captures whose plates carry more than the person, kg: a device pulls with 64 % of body weight (mass by the plates of
the standing trial before it); over one step of the walk they carry 63 kg."""

FORCES = {
    **{
        f"foreign_truth/{person}/{motion}/trial.trc": "grf.mot"
        for person in ("adult", "child")
        for motion in ("run", "squat", "walk")
    },
    "bmc_walk_run/run.trc": "run_grf.mot",
    "gait2354_walk/subject01_walk1.trc": "subject01_walk1_grf.mot",
    "opencap_s6_walk/s6_walking1.trc": "s6_walking1_forces.mot",
    "rajagopal_walk_run/motion_capture_run.trc": "grf_run.mot",
    "rajagopal_walk_run/motion_capture_walk.trc": "grf_walk.mot",
    "synthetic_exact_truth/subject01_walk2_markers.trc": "subject01_walk2_grf.mot",
}

FAULTS = (0.9, 1.1)
"""Gains of all plates that are to be reported."""

DETERMINED_PERCENT = 2.0
"""Standard deviation of the mass of a standing trial, or of whole cycles."""

STANDING_N, STANDING_BOUND_N = 300.0, 0.1
MOMENT_BOUND_NM = 0.01


def plate_rows(data: Path) -> list[Check]:
    """Rows of plates against masses, encodings, torques, clocks and plates that cannot be read."""
    return [
        *mass_rows(data),
        *encoding_rows(data),
        *torque_rows(data),
        *clock_rows(data),
        *unreadable_rows(data),
    ]


def mass_rows(data: Path) -> Iterator[Check]:
    """Masses by plates: right ones accused, wrong ones reported."""
    captures = {name: read(data, name) for name in KNOWN_KG}
    found = {name: unscaled_mass_finding(one, KNOWN_KG[name]) for name, one in captures.items()}
    judged = {name: one for name, one in found.items() if one.value is not None}
    accused = sum(one.verdict == "outside" for one in judged.values())
    yield Check("plates against known mass, captures judged", len(judged), 0.8 * len(found), ">=")
    yield Check("plates against known mass, accused falsely", accused, 0, "<=")
    close = [name for name, one in judged.items() if _determined(one)]
    told = [
        unscaled_mass_finding(_amplified(captures[name], gain), KNOWN_KG[name]).verdict == "outside"
        for name in close
        for gain in FAULTS
    ]
    yield Check("plates 10 % off, standing or whole cycles, reported", _percent(told), 100.0, ">=", "%")
    heavier = [
        unscaled_mass_finding(read(data, name), kg).verdict == "outside" for name, kg in HEAVIER_KG.items()
    ]
    yield Check("plates that carry more than the person, reported", _percent(heavier), 100.0, ">=", "%")


def encoding_rows(data: Path) -> Iterator[Check]:
    """One standing load as signed floats, unsigned floats and unsigned integers."""
    names = ("signed_real", "unsigned16_real", "unsigned16_integer")
    vertical = [
        plate.force_n[:, 2] for name in names for plate in read(data, f"strangers3/{name}.c3d").plates
    ]
    off = float(np.abs(np.concatenate(vertical) - STANDING_N).max())
    yield Check("encodings of one load, largest difference", off, STANDING_BOUND_N, "<=", "N")


def torque_rows(data: Path) -> Iterator[Check]:
    """Torques about the laboratory's origin against the same about the centre of pressure."""
    folder = data / "strangers3"
    moments = [
        _moments(
            read_capture(folder / "grf_torque_markers.trc", forces=folder / f"grf_torque_about_{name}.mot")
        )
        for name in ("cop", "origin")
    ]
    off = float(np.abs(moments[0] - moments[1]).max())
    yield Check("torques about the origin, largest difference", off, MOMENT_BOUND_NM, "<=", "N m")


def clock_rows(data: Path) -> Iterator[Check]:
    """Ground reactions on the clock of the recording beside captures that begin at zero."""
    names = [name for name in KNOWN_KG if name.startswith("stoop_lift_box")]
    aligned = [
        plate.start_time_s == one.markers.start_time_s
        for one in (read(data, name) for name in names)
        for plate in one.plates
    ]
    yield Check("ground reactions on another clock, aligned", _percent(aligned), 100.0, ">=", "%")


def unreadable_rows(data: Path) -> Iterator[Check]:
    """Plates with samples that are not numbers, or crossed corners: left out and named, the others used."""
    broken, crossed = read(data, "breaker/an_nan.c3d"), read(data, "breaker/pl_order.c3d")
    right = sorted(broken.plates_left_out) == ["2", "3"] and len(broken.plates) == 7
    right = right and len(crossed.plates_left_out) == 9 and not crossed.plates
    named = all(any("left out" in note for note in one.notes) for one in (broken, crossed))
    yield Check("plates that cannot be read, left out and named", float(right and named), 1.0, ">=")


def read(data: Path, name: str) -> Capture:
    """A capture with its ground reactions."""
    path = data / name
    forces = FORCES.get(name)
    if name.startswith("stoop_lift_box"):
        forces = f"{path.stem}_F1Cop1F2Cop2.csv"
    return read_capture(path, forces=None if forces is None else path.parent / forces)


def _determined(found: Finding) -> bool:
    return found.expected_sd is not None and found.expected_sd < DETERMINED_PERCENT


def _amplified(capture: Capture, gain: float) -> Capture:
    """The capture with a gain on all forces."""
    plates = tuple(replace(plate, force_n=gain * plate.force_n) for plate in capture.plates)
    return replace(capture, plates=plates)


def _moments(capture: Capture) -> Array:
    """(P · S, 3) moments about the world's origin, N m."""
    return np.concatenate([one.moment_nm + np.cross(one.origin_m, one.force_n) for one in capture.plates])


def _percent(votes: list[bool]) -> float:
    return 100.0 * float(np.mean(votes)) if votes else float("nan")
