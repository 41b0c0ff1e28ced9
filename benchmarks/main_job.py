"""The main job on real and synthetic captures: markers, angles and torques against what others found.

Every capture goes through `mbkf scale` and `mbkf reconstruct` with the same default settings. Where a
reference stands beside the capture, our curves are compared with it; the poorer side of the body counts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, Context, number
from benchmarks.commands import FILTER, Written, mbkf, read_folder, scale_and_reconstruct
from benchmarks.references import (
    PLUG_IN_GAIT,
    in_degrees,
    low_passed,
    plates_against_export,
    plug_in_gait_angles,
    stored_forces,
    stored_markers,
    worst_side,
)
from mbkf.errors import MbkfError
from mbkf.io.c3d import read_c3d
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.results_folder import Summary, read_reconstruction, read_summary
from mbkf.io.storage import Table, read_storage

FLEXIONS = tuple(PLUG_IN_GAIT)
SYNTHETIC_MOTIONS = ("walk", "squat", "jump")
INFORMATION = math.inf
"""The bound of a number that has none."""


def run(context: Context) -> list[Check]:
    """All captures, or the first and one synthetic one when quick."""
    data = context.require_data()
    rows: list[tuple[str, Callable[[Path, Path], list[Check]]]] = [("rajagopal walk", rajagopal_walk)]
    if not context.quick:
        rows += [
            ("rajagopal run", rajagopal_run),
            ("gait2354 walk", gait2354_walk),
            ("biomechzoo HC032A", partial(biomechzoo, person="HC032A", number="03", mass_kg=60.3)),
            ("biomechzoo HC044A", partial(biomechzoo, person="HC044A", number="15", mass_kg=39.4)),
            ("gaitalytics overground", gaitalytics),
            ("opensim walking2", walking2),
            ("exact-truth walk", exact_truth),
        ]
    for motion in ("squat",) if context.quick else SYNTHETIC_MOTIONS:
        rows.append((f"synth {motion}", partial(synthetic, motion=motion)))
    checks: list[Check] = []
    for name, measure in rows:
        folder = context.out / name.replace(" ", "_")
        folder.mkdir(parents=True, exist_ok=True)
        try:
            found = measure(data, folder)
        except MbkfError as error:
            found = [Check(f"does not run: {error}", math.nan, 0.0, "<=")]
        checks += [Check(f"{name}: {c.name}", c.value, c.bound, c.relation, c.unit) for c in found]
    return checks


def rajagopal_walk(data: Path, out: Path) -> list[Check]:
    """Overground walk; torques against OpenSim's inverse dynamics, low-passed as that was."""
    folder = data / "rajagopal_walk_run"
    scaling = (folder / "static_walk_1.trc", "--mass", "85.07")
    trial, forces = folder / "motion_capture_walk.trc", folder / "grf_walk.mot"
    found = scale_and_reconstruct(trial, scaling, out, forces=forces)
    theirs = read_storage(folder / "reference_walk" / "id_walk.sto")
    ours, per_kg = low_passed(found.torques), 1.0 / found.summary["mass_kg"]
    checks = [marker_check(found, 6.0)]
    for coordinate in FLEXIONS:
        r, difference = (0.98, 0.1) if coordinate == "ankle_angle" else (0.88, 0.21)
        agree = worst_side(ours, theirs, coordinate, suffix="_moment", factor=per_kg)
        checks += pair(f"{coordinate} torque", agree.r, r, agree.rms, difference, "N m/kg")
    return checks


def rajagopal_run(data: Path, out: Path) -> list[Check]:
    """Five seconds of treadmill running, timed from the shell."""
    folder = data / "rajagopal_walk_run"
    scaling = (folder / "static_run.trc", "--mass", "72.84")
    trial, forces = folder / "motion_capture_run.trc", folder / "grf_run.mot"
    found = scale_and_reconstruct(trial, scaling, out, forces=forces, fresh=True)
    seconds = f"scale and reconstruct {found.summary['duration_s']:.1f} s of capture, wall time"
    return [marker_check(found, 6.5), Check(seconds, found.seconds, 30.0, "<=", "s")]


def gait2354_walk(data: Path, out: Path) -> list[Check]:
    """Treadmill walk; angles against OpenSim's inverse kinematics, whose knee counts extension."""
    folder = data / "gait2354_walk"
    scaling = (folder / "subject01_static.trc", "--mass", "72.6")
    trial, forces = folder / "subject01_walk1.trc", folder / "subject01_walk1_grf.mot"
    found = scale_and_reconstruct(trial, scaling, out, forces=forces)
    theirs = read_storage(folder / "reference" / "subject01_walk1_ik.mot")
    signs = {"hip_flexion": 1.0, "knee_angle": -1.0}
    return [marker_check(found, 7.0), *angle_checks(found.angles, theirs, signs, 0.98)]


def biomechzoo(data: Path, out: Path, person: str, number: str, mass_kg: float) -> list[Check]:
    """Straight walk of a child; angles against Plug-in Gait's in the same file.

    Args:
        data: Folder of the reference captures.
        out: Folder for files.
        person: Name of the person in the data set.
        number: Number of the trial.
        mass_kg: Body mass.
    """
    folder = data / "biomechzoo_walk_turn"
    trial = folder / f"{person}_Straight_{person}{number}.c3d"
    static = folder / f"{person}_Static_{person}01.c3d"
    found = scale_and_reconstruct(trial, (static, "--mass", str(mass_kg)), out)
    theirs = plug_in_gait_angles(read_c3d(trial, CaptureOptions()))
    return [marker_check(found, 6.0), *angle_checks(found.angles, theirs, dict.fromkeys(FLEXIONS, 1.0), 0.97)]


def gaitalytics(data: Path, out: Path) -> list[Check]:
    """Overground walk without a static trial; plates against the same data exported by another program."""
    folder = data / "gaitalytics_walk"
    trial = folder / "overground_fullbody_4plates.c3d"
    found = scale_and_reconstruct(trial, ("--trial", trial, "--mass", "63.6"), out)
    force, pressure = plates_against_export(trial, folder / "overground_fullbody_4plates_grf.mot")
    return [
        marker_check(found, 7.0),
        Check("plate force against the export, RMS", force, 2.0, "<=", "N"),
        Check("centre of pressure against the export, RMS", pressure, 3.0, "<=", "mm"),
    ]


def walking2(data: Path, out: Path) -> list[Check]:
    """A walk through the volume with 20 to 67 % of each marker missing; readings against OpenSim's."""
    folder = data / "opensim_gappy_walk"
    trial, stored = folder / "walking2.c3d", folder / "reference"
    found = scale_and_reconstruct(trial, ("--trial", trial, "--mass", "75"), out)
    result = read_reconstruction(out)
    lost = float(np.count_nonzero(~np.isfinite(result.q[result.tracked])))
    forces = stored_forces(trial, stored / "std_walking2_grfs.sto", stored / "std_cop_walking2_grfs.sto")
    names = ("force", "moment", "centre of pressure")
    units = ("N", "N m", "mm")
    bounds = (0.001, 0.001, 0.01)
    return [
        Check(
            "marker error in tracked frames, maximum",
            number(found.summary["marker_max_mm"]),
            100.0,
            "<=",
            "mm",
        ),
        Check("postures that are no numbers in tracked frames", lost, 0.0, "<="),
        Check("frames tracked", float(result.tracked.mean()), INFORMATION, "<="),
        Check("marker RMS", number(found.summary["marker_rms_mm"]), INFORMATION, "<=", "mm"),
        Check(
            "markers as OpenSim reads them, maximum",
            stored_markers(trial, stored / "std_walking2_markers.trc"),
            0.01,
            "<=",
            "mm",
        ),
        *(
            Check(f"{name} as OpenSim reads it, maximum", value, bound, "<=", unit)
            for name, value, bound, unit in zip(names, forces, bounds, units, strict=True)
        ),
    ]


def exact_truth(data: Path, out: Path) -> list[Check]:
    """A walk made from another model's own motion: its angles and torques are exact for that model."""
    folder = data / "synthetic_exact_truth"
    trial, forces = folder / "subject01_walk2_markers.trc", folder / "subject01_walk2_grf.mot"
    found = scale_and_reconstruct(trial, ("--trial", trial, "--mass", "72.84"), out, forces=forces)
    angles = in_degrees(read_storage(folder / "subject01_coordinates_TRUTH.sto"))
    torques = read_storage(folder / "subject01_id_TRUTH.sto")
    checks = [marker_check(found, 6.0)]
    for coordinate in FLEXIONS:
        angle = worst_side(found.angles, angles, coordinate)
        checks += pair(f"{coordinate}", angle.r, 0.98, angle.rms_without_mean, INFORMATION, "°")
    for coordinate in FLEXIONS:
        torque = worst_side(found.torques, torques, coordinate, suffix="_moment", factor=1.0 / 72.84)
        checks += pair(f"{coordinate} torque", torque.r, 0.97, torque.rms, INFORMATION, "N m/kg")
    return checks


def synthetic(_data: Path, out: Path, motion: str) -> list[Check]:
    """A synthetic capture with camera noise only, on the known body and on the one scaled from its static.

    Args:
        _data: Not used.
        out: Folder for files.
        motion: Name of the synthetic motion.
    """
    mbkf("synth", "--motion", motion, "--markers-mm", "0.5", "--skin-mm", "0", "--out", out)
    trial = out / "trial.c3d"
    mbkf("reconstruct", trial, "--subject", out / "subject.toml", *FILTER, "--out", out / "known_body")
    known = _angle_error(read_summary(out / "known_body"))
    mass = read_folder(out / "known_body").summary["mass_kg"]
    scaling = (out / "static.c3d", "--mass", str(mass))
    scaled = _angle_error(scale_and_reconstruct(trial, scaling, out / "scaled_body").summary)
    return [
        Check("joint angles against the truth, RMS", number(known), 0.5, "<=", "°"),
        Check("the same with the body scaled from static.c3d", number(scaled), INFORMATION, "<=", "°"),
    ]


def _angle_error(summary: Summary) -> float | None:
    return (summary["truth"] or {})["angle_rms_deg"]


def marker_check(found: Written, bound_mm: float) -> Check:
    """RMS distance of measured and reconstructed markers."""
    return Check("marker RMS", number(found.summary["marker_rms_mm"]), bound_mm, "<=", "mm")


def angle_checks(ours: Table, theirs: Table, signs: dict[str, float], r: float) -> list[Check]:
    """Correlation and RMS after removing the mean difference (zero is defined differently), at most 5°.

    Args:
        ours: Angles found.
        theirs: Reference angles.
        signs: Sign of each angle relative to the reference, by name.
        r: Least correlation.
    """
    checks: Sequence[Check] = ()
    for coordinate, sign in signs.items():
        agree = worst_side(ours, theirs, coordinate, sign=sign)
        checks = [*checks, *pair(coordinate, agree.r, r, agree.rms_without_mean, 5.0, "°")]
    return list(checks)


def pair(name: str, r: float, least_r: float, rms: float, most_rms: float, unit: str) -> list[Check]:
    """The two checks of a curve.

    Args:
        name: Name of the curve.
        r: Correlation.
        least_r: Its bound.
        rms: RMS difference.
        most_rms: Its bound.
        unit: Unit of the difference.
    """
    label = name.replace("_flexion", "").replace("_angle", "")
    return [
        Check(f"{label}, r", r, least_r, ">="),
        Check(f"{label}, RMS difference", rms, most_rms, "<=", unit),
    ]
