"""Real captures for the dynamic benchmark: residual, marker RMS, torques against a reference, a withheld plate."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.checks import Check, number
from benchmarks.dynamic.methods import Mapper, Method, corrected, rows_or_failure
from benchmarks.references import PLUG_IN_GAIT, correlation, low_passed, rms, worst_side
from mbkf.conventions import Array, BoolArray
from mbkf.errors import UnknownName
from mbkf.io.capture import read_capture
from mbkf.io.records import Capture
from mbkf.io.resample import average_over_frames
from mbkf.io.results import Reconstruction
from mbkf.io.results_folder import Summary
from mbkf.io.storage import Table, read_storage
from mbkf.io.subject import Subject
from mbkf.trial.results.summary import summarise
from mbkf.trial.scale import scale

LEFT = 1
MARKER_FACTOR = 1.1
"""How much worse than the kinematic filter's the markers may fit."""

KINEMATIC = Method("kinematic")


@dataclass(frozen=True)
class Source:
    """Where a capture lies, below the data folder.

    Attributes:
        folder: Its folder.
        trial: The capture.
        mass_kg: The person.
        static: Standing trial; the trial itself is scaled from where there is none.
        forces: Ground reactions beside the capture.
    """

    folder: str
    trial: str
    mass_kg: float
    static: str | None = None
    forces: str | None = None


SOURCES: Mapping[str, Source] = {
    "rajagopal walk": Source(
        "rajagopal_walk_run", "motion_capture_walk.trc", 85.07, "static_walk_1.trc", "grf_walk.mot"
    ),
    "rajagopal run": Source(
        "rajagopal_walk_run", "motion_capture_run.trc", 72.84, "static_run.trc", "grf_run.mot"
    ),
    "gait2354": Source(
        "gait2354_walk", "subject01_walk1.trc", 72.6, "subject01_static.trc", "subject01_walk1_grf.mot"
    ),
    "biomechzoo HC032A": Source(
        "biomechzoo_walk_turn", "HC032A_Straight_HC032A03.c3d", 60.3, "HC032A_Static_HC032A01.c3d"
    ),
    "biomechzoo HC044A": Source(
        "biomechzoo_walk_turn", "HC044A_Straight_HC044A15.c3d", 39.4, "HC044A_Static_HC044A01.c3d"
    ),
    "gaitalytics": Source("gaitalytics_walk", "overground_fullbody_4plates.c3d", 63.6),
}


def present(names: Iterable[str], data: Path | None) -> list[str]:
    """Those of some captures whose folders are there.

    Args:
        names: Names in :data:`SOURCES`.
        data: Folder of the public captures; None without any.
    """
    return [name for name in names if data is not None and (data / SOURCES[name].folder).is_dir()]


@dataclass(frozen=True)
class Bounds:
    """Bounds of one capture: residual as share of body weight and lever; marker RMS in mm or by the kinematic's."""

    force_share: float = 0.05
    lever_m: float = 0.03
    marker_mm: float | None = None
    plates_n: float | None = None


BOUNDS: Mapping[str, Bounds] = {
    "rajagopal walk": Bounds(marker_mm=5.5, plates_n=2.0),
    "rajagopal run": Bounds(force_share=0.08, marker_mm=6.5),
    "gait2354": Bounds(),
    "biomechzoo HC032A": Bounds(),
    "biomechzoo HC044A": Bounds(),
    "gaitalytics": Bounds(),
}
"""The residual is a state with standard deviations of 5 % of body weight and 3 cm: an RMS beyond these contradicts it.

A run may reach 8 %, since soft tissue bounces with the steps. Bounds of 5 to 15 N belonged to a residual held at 2 N by
its equation, which the motion paid for (:mod:`mbkf.sensors.root_residual`)."""


@dataclass(frozen=True)
class Person:
    """A capture and the subject scaled for it, with markers corrected on it where asked."""

    name: str
    capture: Capture
    subject: Subject


def load(name: str, data: Path, *, correct: bool = True) -> Person:
    """Reads a capture and scales its person with the default settings of `mbkf scale`.

    Args:
        name: Name in :data:`SOURCES`.
        data: Folder of the reference captures.
        correct: Whether marker positions are corrected on the trial.
    """
    source = SOURCES[name]
    folder = data / source.folder
    forces = None if source.forces is None else folder / source.forces
    capture = read_capture(folder / source.trial, forces=forces)
    static = None if source.static is None else read_capture(folder / source.static)
    subject = scale(static, [capture] if static is None else [], mass_kg=source.mass_kg)
    return Person(name, capture, corrected(subject, capture) if correct else subject)


def capture_rows(name: str, data: Path, methods: Sequence[Method]) -> list[Check]:
    """Residual, marker errors and the other rows of a capture; a method that does not run fails its rows.

    Args:
        name: Name in :data:`SOURCES`.
        data: Folder of the reference captures.
        methods: Filters with their settings.
    """
    person = load(name, data)
    kinematic = summarise(KINEMATIC.run(person.capture, person.subject))
    rows = [
        Check(f"{name}: kinematic, marker RMS", number(kinematic["marker_rms_mm"]), np.inf, "<=", "mm"),
        Check(
            f"{name}: kinematic, residual force", number(kinematic["residual_force_rms_n"]), np.inf, "<=", "N"
        ),
        Check(
            f"{name}: kinematic, residual moment",
            number(kinematic["residual_moment_rms_nm"]),
            np.inf,
            "<=",
            "N m",
        ),
    ]
    for method in methods:
        label = f"{name}: {method.label}"
        rows += rows_or_failure(label, partial(_method_rows, label, person, method, kinematic, data))
    return rows


def _method_rows(label: str, person: Person, method: Method, kinematic: Summary, data: Path) -> list[Check]:
    found = method.run(person.capture, person.subject)
    rows = summary_rows(label, summarise(found), kinematic, BOUNDS[person.name])
    if person.name == "rajagopal walk":
        rows += flexion_rows(label, found, data, method.smooth)
        rows += withheld_rows(label, person, method)
    return rows


def summary_rows(label: str, summary: Summary, kinematic: Summary, bounds: Bounds) -> list[Check]:
    """The rows of one method's summary.json beside the kinematic filter's.

    Args:
        label: Beginning of the rows' names.
        summary: The method's summary.json.
        kinematic: The kinematic filter's summary.json.
        bounds: Bounds of the capture.
    """
    marker = bounds.marker_mm
    if marker is None:
        marker = MARKER_FACTOR * number(kinematic["marker_rms_mm"])
    rows = [
        Check(f"{label}, marker RMS", number(summary["marker_rms_mm"]), marker, "<=", "mm"),
        Check(
            f"{label}, residual force",
            100.0 * number(summary["residual_force_share"]),
            100.0 * bounds.force_share,
            "<=",
            "% BW",
        ),
        Check(
            f"{label}, lever of the residual moment",
            100.0 * number(summary["residual_lever_m"]),
            100.0 * bounds.lever_m,
            "<=",
            "cm",
        ),
        Check(
            f"{label}, measured frames", summary["measured_frames"], 0.95 * kinematic["measured_frames"], ">="
        ),
    ]
    if bounds.plates_n is not None:
        moved = number(summary["plate_force_change_rms_n"])
        rows.append(Check(f"{label}, plates moved, force", moved, bounds.plates_n, "<=", "N"))
    return rows


def flexion_rows(label: str, found: Reconstruction, data: Path, smooth: bool) -> list[Check]:
    """Hip, knee and ankle torques against OpenSim's, as they are and low-passed as those were.

    The reference was made from motion and plates low-passed at 6 Hz, so it lacks what lies above. The bound is on the
    low-passed curves, like against like, as `main_job` compares them; the difference as it is stands beside it.

    Args:
        label: Beginning of the rows' names.
        found: The method's results.
        data: Folder of the reference captures.
        smooth: Whether the results are smoothed.
    """
    theirs = read_storage(data / "rajagopal_walk_run" / "reference_walk" / "id_walk.sto")
    ours = moment_table(found)
    smooth_ours = low_passed(ours)
    per_kg = 1.0 / found.subject.mass_kg
    rows = []
    for coordinate in PLUG_IN_GAIT:
        like = worst_side(smooth_ours, theirs, coordinate, suffix="_moment", factor=per_kg).rms
        plain = worst_side(ours, theirs, coordinate, suffix="_moment", factor=per_kg).rms
        name = f"{label}, {coordinate} torque against the 6 Hz reference"
        rows.append(Check(f"{name}, both at 6 Hz", like, 0.12 if smooth else np.inf, "<=", "N m/kg"))
        rows.append(Check(f"{name}, ours unfiltered", plain, np.inf, "<=", "N m/kg"))
    return rows


def moment_table(found: Reconstruction) -> Table:
    """The clinical moments over the frames in which all are known, named as OpenSim names them."""
    known = np.isfinite(found.moments).all(axis=1)
    names = tuple(f"{name}_moment" for name in found.coordinate_names)
    return Table(names, found.times_s[known], found.moments[known])


@dataclass(frozen=True)
class Withheld:
    """Estimated against withheld vertical force.

    Attributes:
        r: Correlation over the judged frames.
        rms_n: RMS difference over the judged frames, N.
        rms_everywhere_n: The same over all frames the plate recorded.
        flagged: Share of the frames with load that the reconstruction flags as not measured.
    """

    r: float
    rms_n: float
    rms_everywhere_n: float
    flagged: float


def withheld_left(person: Person, method: Method) -> Withheld:
    """Withholds the plate under the left foot and estimates its vertical force.

    Judged are the frames in which the plates together carry the person (measured with all plates): before and after, a
    foot stands beside the plates and there is nothing to compare with.
    """
    name = plate_under(person, LEFT)
    plate = next(p for p in person.capture.plates if p.name == name)
    judged = KINEMATIC.run(person.capture, person.subject).measured
    found = method.run(person.capture, person.subject, without_plates=(name,))
    measured = average_over_frames(plate, found.times_s, found.rate_hz).force_n[:, 2]
    return compare_withheld(found.foot_wrench[:, LEFT, 2], measured, judged, found.measured)


def compare_withheld(
    estimated_n: Array, measured_n: Array, judged: BoolArray, still_measured: BoolArray
) -> Withheld:
    """Compares two vertical forces; a force that is not estimated counts as 0 N.

    Args:
        estimated_n: (T,) estimated force, N.
        measured_n: (T,) measured force, N.
        judged: (T,) frames that are compared.
        still_measured: (T,) frames that are stated to be measured.
    """
    estimate = np.nan_to_num(estimated_n)
    error = estimate - measured_n
    known = judged & np.isfinite(measured_n)
    loaded = known & (measured_n > 0.0)
    return Withheld(
        correlation(estimate[known], measured_n[known]),
        rms(error[known]),
        rms(error[np.isfinite(measured_n)]),
        float((~still_measured[loaded]).mean()) if loaded.any() else float("nan"),
    )


def plate_under(person: Person, side: int) -> str:
    """Name of the plate that one foot stands on most.

    Raises:
        UnknownName: No plate is under that foot.
    """
    found = KINEMATIC.run(person.capture, person.subject)
    own = found.foot_wrench[:, side, 2]
    scores = {}
    for plate in person.capture.plates:
        load = np.nan_to_num(average_over_frames(plate, found.times_s, found.rate_hz).force_n[:, 2])
        scores[plate.name] = correlation(load, own) if load.any() and own.any() else -1.0
    if not scores or max(scores.values()) < 0.5:
        raise UnknownName("plate", ("right", "left")[side], list(scores))
    return max(scores, key=lambda name: scores[name])


def withheld_rows(label: str, person: Person, method: Method) -> list[Check]:
    """The rows of the withheld left plate.

    Args:
        label: Beginning of the rows' names.
        person: The capture and its scaled person.
        method: The filter with its settings.
    """
    found = withheld_left(person, method)
    least, most = (0.98, 45.0) if method.smooth else (0.9, 130.0)
    name = f"{label}, without the left plate: its vertical force"
    return [
        Check(f"{name}, r", found.r, least, ">="),
        Check(f"{name}, RMS", found.rms_n, most, "<=", "N"),
        Check(f"{name}, RMS over all frames", found.rms_everywhere_n, np.inf, "<=", "N"),
        Check(f"{name}, frames flagged of those with load", 100.0 * found.flagged, np.inf, "<=", "%"),
    ]


def all_capture_rows(
    names: Sequence[str], data: Path, methods: Sequence[Method], mapper: Mapper
) -> list[Check]:
    """The rows of several captures.

    Args:
        names: Names in :data:`SOURCES`.
        data: Folder of the reference captures.
        methods: Filters with their settings.
        mapper: Runs a function on many items, in turn or on several processes.
    """
    found = mapper(partial(capture_rows, data=data, methods=tuple(methods)), names)
    return [row for rows in found for row in rows]
