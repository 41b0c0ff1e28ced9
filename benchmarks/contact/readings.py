"""Impossible plate readings put into clean captures: peak torques stay, the fault is told, and clean captures pass.

Each fault is put into the plate that carries most, at its largest force. Torques are judged over the frames that the
faulty run calls valid, those of short faults over all frames as well; a fault that is not told fails its rows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context
from benchmarks.dynamic.captures import load
from mbkf.conventions import Array, BoolArray
from mbkf.errors import MbkfError
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture, PlateReadings
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject
from mbkf.sensors.contact.cleaning import cleaned
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from mbkf.trial.results.summary import summarise
from mbkf.trial.synth import synthesise

FILTERS = ("dynamic", "kinematic")
JOINTS = ("hip_flexion", "knee_angle", "ankle_angle")
MOST_CHANGE = 0.05
SATURATED_FROM = 0.95
SYNTHETIC_SECONDS, SYNTHETIC_SEED = 3.0, 1

CLEAN: Mapping[str, tuple[str, str | None, float]] = {
    "rajagopal walk": (
        "rajagopal_walk_run/motion_capture_walk.trc",
        "rajagopal_walk_run/grf_walk.mot",
        85.07,
    ),
    "rajagopal run": (
        "rajagopal_walk_run/motion_capture_run.trc",
        "rajagopal_walk_run/grf_run.mot",
        72.84,
    ),
    "gait2354": ("gait2354_walk/subject01_walk1.trc", "gait2354_walk/subject01_walk1_grf.mot", 72.6),
    "HC032A": ("biomechzoo_walk_turn/HC032A_Straight_HC032A03.c3d", None, 60.3),
    "HC032A static": ("biomechzoo_walk_turn/HC032A_Static_HC032A01.c3d", None, 60.3),
    "HC044A": ("biomechzoo_walk_turn/HC044A_Straight_HC044A15.c3d", None, 39.4),
    "HC044A static": ("biomechzoo_walk_turn/HC044A_Static_HC044A01.c3d", None, 39.4),
    "gaitalytics": ("gaitalytics_walk/overground_fullbody_4plates.c3d", None, 63.6),
    "rehazenter": ("rehazenter_walk/2014001_C1_01.c3d", None, 67.0),
    "bmc run": ("bmc_walk_run/run.trc", "bmc_walk_run/run_grf.mot", 70.0),
    "bmc lower walk": ("bmc_walk_run/lower_walk1.trc", "bmc_walk_run/lower_walk1.forces", 70.0),
    "stoop neutral": (
        "stoop_lift_box/neu_t169_f250f350.c3d",
        "stoop_lift_box/neu_t169_f250f350_F1Cop1F2Cop2.csv",
        81.7,
    ),
    "stoop 1": (
        "stoop_lift_box/stoop1_t169_f620f800.c3d",
        "stoop_lift_box/stoop1_t169_f620f800_F1Cop1F2Cop2.csv",
        81.7,
    ),
    "stoop 2": (
        "stoop_lift_box/stoop2_t169_f1395f1590.c3d",
        "stoop_lift_box/stoop2_t169_f1395f1590_F1Cop1F2Cop2.csv",
        81.7,
    ),
    "stoop 3": (
        "stoop_lift_box/stoop3_t169_f2101f2300.c3d",
        "stoop_lift_box/stoop3_t169_f2101f2300_F1Cop1F2Cop2.csv",
        81.7,
    ),
    "cgm24": ("cgm24_lowerlimb_walk/CGM24_Walking01.c3d", None, 77.6),
    "biobuddy": ("biobuddy_functional/functional_right_knee.c3d", None, 62.2),
    "opensim gappy walk": ("opensim_gappy_walk/walking2.c3d", None, 75.0),
}
"""Real captures below the data folder: markers, forces, and the person's mass (kg), about where it is not stated."""

CLEAN_MOTIONS = ("walk", "jump", "step_up", "turn", "squat")
CLEAN_SEEDS = 2


@dataclass(frozen=True)
class FaultyPlate:
    """How a plate is broken.

    Attributes:
        name: In the rows.
        change: Makes readings (S, 6) at a rate in Hz faulty, from a sample on.
        lasting: Whether the plate is gone for so long that only frames stated to be valid can be compared.
    """

    name: str
    change: Callable[[Array, float, int], Array]
    lasting: bool = False


def _pulse(force_n: float, samples: int) -> Callable[[Array, float, int], Array]:
    def change(wrench: Array, _rate_hz: float, at: int) -> Array:
        wrench[at : at + samples, 2] = force_n
        return wrench

    return change


def _no_numbers(wrench: Array, rate_hz: float, at: int) -> Array:
    wrench[at : at + round(0.02 * rate_hz)] = np.nan
    return wrench


def _dropout(wrench: Array, rate_hz: float, at: int) -> Array:
    wrench[at : at + round(0.02 * rate_hz)] = 0.0
    return wrench


def _stuck(wrench: Array, _rate_hz: float, at: int) -> Array:
    wrench[at:] = wrench[at]
    return wrench


def _saturated(wrench: Array, _rate_hz: float, _at: int) -> Array:
    wrench[:, 2] = np.minimum(wrench[:, 2], SATURATED_FROM * wrench[:, 2].max())
    return wrench


def _wrong_sign(wrench: Array, _rate_hz: float, _at: int) -> Array:
    return -wrench


FAULTS = (
    FaultyPlate("one sample of 1e5 N", _pulse(1e5, 1)),
    FaultyPlate("twenty samples of 2e4 N", _pulse(2e4, 20)),
    FaultyPlate("one sample of 1e9 N", _pulse(1e9, 1)),
    FaultyPlate("three samples of 4000 N", _pulse(4e3, 3)),
    FaultyPlate("20 ms without numbers", _no_numbers),
    FaultyPlate("20 ms of zeros in stance", _dropout),
    FaultyPlate("stuck from its peak on", _stuck, lasting=True),
    FaultyPlate("saturated at 95 % of its peak", _saturated, lasting=True),
    FaultyPlate("wrong sign", _wrong_sign, lasting=True),
)


def readings_rows(context: Context) -> list[Check]:
    """Rows of every fault on a real and a synthetic walk with two filters, and of clean captures."""
    data = context.require_data()
    rows = []
    for name, capture, subject in _walks(data):
        for chosen in FILTERS[:1] if context.quick else FILTERS:
            rows += fault_rows(f"{name}, {chosen}", capture, subject, chosen)
    rows.append(Check("clean real captures: samples refused", refused(_real(data)), 0.0, "<="))
    rows.append(Check("clean synthetic captures: samples refused", refused(_synthetic()), 0.0, "<="))
    return rows


def _walks(data: Path) -> Iterator[tuple[str, Capture, Subject]]:
    person = load("rajagopal walk", data)
    yield "rajagopal walk", person.capture, person.subject
    subject, made = synthesise("walk", seconds=SYNTHETIC_SECONDS, seed=SYNTHETIC_SEED)
    yield "synthetic walk", made.trial, subject


def fault_rows(label: str, capture: Capture, subject: Subject, chosen: str) -> list[Check]:
    """Rows of every fault in one capture.

    Args:
        label: Beginning of the rows' names.
        capture: A clean capture.
        subject: Its person.
        chosen: Name of the filter.
    """
    settings = ReconstructSettings(filter=chosen, smooth=False)
    clean = reconstruct(capture, subject, settings=settings)
    rows = []
    for fault in FAULTS:
        name = f"{label}, {fault.name}"
        try:
            found = reconstruct(broken(capture, fault), subject, settings=settings)
        except MbkfError:  # refused with a message of one line; any other error ends the benchmark
            rows.append(Check(f"{name}: refused", 1.0, 1.0 if fault.change is _wrong_sign else inf, ">="))
            if fault.change is not _wrong_sign:
                rows.append(Check(f"{name}: change of peak torques", inf, MOST_CHANGE, "<="))
            continue
        rows += _judged(name, clean, found, fault)
    return rows


def _judged(name: str, clean: Reconstruction, found: Reconstruction, fault: FaultyPlate) -> list[Check]:
    valid = clean.measured & found.measured
    told = sum("impossible and refused" in warning for warning in summarise(found)["warnings"])
    everywhere = peak_change(clean, found, clean.tracked)
    return [
        Check(f"{name}: told, lines", told, 1.0, ">="),
        Check(f"{name}: change of peak torques", peak_change(clean, found, valid), MOST_CHANGE, "<="),
        Check(f"{name}: the same over all frames", everywhere, inf if fault.lasting else MOST_CHANGE, "<="),
        Check(
            f"{name}: largest change of a torque, of its peak",
            curve_change(clean, found, valid),
            inf if fault.lasting else MOST_CHANGE,
            "<=",
        ),
    ]


def broken(capture: Capture, fault: FaultyPlate) -> Capture:
    """The capture with a fault in the plate that carries most, from the sample of its largest force on.

    Args:
        capture: A clean capture.
        fault: What is done to the plate.
    """
    most = int(np.argmax([plate.force_n[:, 2].sum() / plate.rate_hz for plate in capture.plates]))
    plate = capture.plates[most]
    wrench = fault.change(
        np.hstack([plate.force_n, plate.moment_nm]), plate.rate_hz, int(np.argmax(plate.force_n[:, 2]))
    )
    faulty = replace(plate, force_n=wrench[:, :3], moment_nm=wrench[:, 3:])
    plates = tuple(faulty if one is plate else one for one in capture.plates)
    return replace(capture, plates=plates)


def peak_change(clean: Reconstruction, found: Reconstruction, frames: BoolArray) -> float:
    """Largest relative change of the peak torque of hips, knees or ankles.

    Args:
        clean: The run on clean plates.
        found: The run on a faulty one.
        frames: (T,) frames that are compared.
    """
    changes = []
    for before, after in _torques(clean, found, frames):
        least = float(np.abs(before).max(initial=0.0))
        most = float(np.abs(after).max(initial=0.0))
        changes.append(abs(most - least) / least if least > 0.0 else inf)
    return max(changes)


def curve_change(clean: Reconstruction, found: Reconstruction, frames: BoolArray) -> float:
    """Largest change of a torque of hips, knees or ankles in any frame, over its clean peak.

    Args:
        clean: The run on clean plates.
        found: The run on a faulty one.
        frames: (T,) frames that are compared.
    """
    return max(
        float(np.abs(after - before).max(initial=0.0) / np.abs(before).max(initial=1e-9))
        for before, after in _torques(clean, found, frames)
    )


def _torques(
    clean: Reconstruction, found: Reconstruction, frames: BoolArray
) -> Iterator[tuple[Array, Array]]:
    """(n, 2) torques of both sides over some frames, of the clean and the faulty run, joint by joint."""
    for coordinate in JOINTS:
        columns = [c for c, name in enumerate(clean.coordinate_names) if name[:-2] == coordinate]
        yield clean.moments[frames][:, columns], found.moments[frames][:, columns]


def refused(captures: Iterator[tuple[tuple[PlateReadings, ...], float]]) -> float:
    """How many samples of clean captures, each with the person's mass in kg, are not as they were read."""
    count = 0
    for plates, mass_kg in captures:
        for one, given in zip(cleaned(plates, mass_kg)[0], plates, strict=True):
            if one is not given:
                count += max(1, int((one.force_n != given.force_n).any(axis=1).sum()))
    return float(count)


def _real(data: Path) -> Iterator[tuple[tuple[PlateReadings, ...], float]]:
    for trial, forces, mass_kg in CLEAN.values():
        capture = read_capture(data / trial, forces=None if forces is None else data / forces)
        yield capture.plates, mass_kg


def _synthetic() -> Iterator[tuple[tuple[PlateReadings, ...], float]]:
    for motion in CLEAN_MOTIONS:
        for seed in range(CLEAN_SEEDS):
            subject, made = synthesise(motion, seed=seed)
            yield made.trial.plates, subject.mass_kg
