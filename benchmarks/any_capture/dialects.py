"""Writes one true capture in the dialects of different laboratories: markers and ground reactions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import Array
from mbkf.io.axes import rotation_to_world
from mbkf.io.plate_corners import plate_axes
from mbkf.io.records import MarkerTrajectories

MM = 1e3
_AXES = "xyz"
_QUADRANTS = ("POSX_POSY", "NEGX_POSY", "NEGX_NEGY", "POSX_NEGY")

Naming = Callable[[str, str], str]
"""Name of a column, from the set's name and one of vx … vz, px … pz, mx … mz."""


@dataclass(frozen=True)
class TruePlate:
    """Exact ground reactions of one plate, in world axes.

    Attributes:
        corners_m: (4, 3) corners, in the quadrants that C3D counts.
        force_n: (S, 3) force on the body.
        point_m: (S, 3) centre of pressure; the plate's middle where there is no force.
        torque_nm: (S,) free moment about the vertical.
    """

    corners_m: Array
    force_n: Array
    point_m: Array
    torque_nm: Array

    @property
    def wrench(self) -> Array:
        """(S, 6) force in N and moment in N m about the world's origin."""
        moment = np.cross(self.point_m, self.force_n)
        moment[:, 2] += self.torque_nm
        return np.hstack([self.force_n, moment])

    def about_middle(self) -> Array:
        """(S, 3) moment in N m about the middle of the corners."""
        moment = np.cross(self.point_m - self.corners_m.mean(axis=0), self.force_n)
        moment[:, 2] += self.torque_nm
        return moment


@dataclass(frozen=True)
class TrueCapture:
    """Markers and plates of one base of times; ``rate_hz`` is that of the plates, which start with the markers."""

    markers: MarkerTrajectories
    plates: tuple[TruePlate, ...]
    rate_hz: float

    @property
    def times_s(self) -> Array:
        """(S,) times of the plates' samples."""
        return self.markers.start_time_s + np.arange(len(self.plates[0].force_n)) / self.rate_hz


def _opensim(template: str) -> Naming:
    """Naming by a template of {name}, {word} (force or torque) and {part} (vx, px, or x of a torque)."""

    def name_of(name: str, part: str) -> str:
        word = "torque" if part[0] == "m" else "force"
        return template.format(name=name, word=word, part=part.removeprefix("m")).lstrip("_")

    return name_of


def _fused(letters: dict[str, str]) -> Naming:
    """Naming by a word for each of v, p and m, the axis, and the set's name: Fx1."""
    return lambda name, part: f"{letters[part[0]]}{part[1]}{name}"


_NUMBERS = ("1", "2", "3", "4")

NAMINGS: dict[str, tuple[Naming, tuple[str, ...]]] = {
    "ground_force_r_vx": (_opensim("ground_{word}_{name}_{part}"), ("r", "l", "r2", "l2")),
    "R_ground_force_vx": (_opensim("{name}_ground_{word}_{part}"), ("R", "L", "R2", "L2")),
    "1_ground_torque_x": (_opensim("{name}_ground_{word}_{part}"), ("", "1", "2", "3")),
    "ground_torque_1_x": (_opensim("ground_{word}_{name}_{part}"), _NUMBERS),
    "ground_force4_vx": (_opensim("ground_{word}{name}_{part}"), ("4", "1", "2", "3")),
    "ground_force_1_mx": (lambda name, part: f"ground_force_{name}_{part}", _NUMBERS),
    "ground_moment_1_mx": (
        lambda name, part: f"ground_{'moment' if part[0] == 'm' else 'force'}_{name}_{part}",
        _NUMBERS,
    ),
    "force1_vx": (_opensim("{word}{name}_{part}"), _NUMBERS),
    "f1_1": (lambda name, part: f"{part[0].replace('v', 'f')}{name}_{_AXES.index(part[1]) + 1}", _NUMBERS),
    "Fx1": (_fused({"v": "F", "p": "COP", "m": "T"}), _NUMBERS),
    "FP1.ForX": (
        lambda name, part: f"FP{name}.{ {'v': 'For', 'p': 'Cop', 'm': 'Mom'}[part[0]] }{part[1].upper()}",
        _NUMBERS,
    ),
}
"""Names of force columns in MOT files, by an example."""


def write_mot(true: TrueCapture, path: Path, naming: str, promised_rows: int | None = None) -> None:
    """A MOT file, y up, m, N and N m.

    Args:
        true: The truth.
        path: The file.
        naming: Key of :data:`NAMINGS`.
        promised_rows: Rows that the header counts; those that are there by default.
    """
    name_of, sets = NAMINGS[naming]
    turn = rotation_to_world("y")
    parts = [f"{kind}{axis}" for kind in "vpm" for axis in _AXES]
    names = [name_of(name, part) for name, _ in zip(sets, true.plates, strict=False) for part in parts]
    columns = [true.times_s[:, None]]
    for plate in true.plates:
        torque = np.outer(plate.torque_nm, [0.0, 0.0, 1.0])
        columns += [vectors @ turn for vectors in (plate.force_n, plate.point_m, torque)]
    rows = np.hstack(columns)
    head = [
        "grf",
        "version=1",
        f"nRows={promised_rows or len(rows)}",
        f"nColumns={rows.shape[1]}",
        "inDegrees=no",
    ]
    _write(path, [*head, "endheader", "\t".join(["time", *names]), *_lines(rows)])


def write_cortex(true: TrueCapture, path: Path, up: str) -> None:
    """A ``.forces`` file of Cortex: mm, N and N mm, the free moment as MZ whatever axis is up.

    Args:
        true: The truth.
        path: The file.
        up: Axis of the file that points up.
    """
    turn = rotation_to_world(up)
    count = len(true.plates)
    columns = [np.arange(1.0, len(true.times_s) + 1.0)[:, None]]
    for plate in true.plates:
        columns += [plate.force_n @ turn, MM * plate.point_m @ turn, MM * plate.torque_nm[:, None]]
    names = [f"{kind}{k}" for k in range(1, count + 1) for kind in ("FX", "FY", "FZ", "X", "Y", "Z", "MZ")]
    head = [
        "[Force Data]",
        f"NumberOfForcePlates={count}",
        f"SampleRate={true.rate_hz:.6f}",
        f"NumberOfSamples={len(true.times_s)}",
        "\t".join(["#Sample", *names]),
    ]
    _write(path, [*head, *_lines(np.hstack(columns))])


def write_qualisys(true: TrueCapture, path: Path, *, in_plate_axes: bool, with_times: bool) -> None:
    """TSV files of Qualisys: trajectories (z up, mm) and one file per plate, with the forces on the plate.

    Args:
        true: The truth.
        path: File of the trajectories; those of the plates stand beside it.
        in_plate_axes: Whether force, moment (N m, about the middle) and centre of pressure (mm) are in plate axes.
        with_times: Whether frame and time stand before the values.
    """
    markers = true.markers
    head = [
        ("NO_OF_FRAMES", markers.frames), ("NO_OF_CAMERAS", 12), ("NO_OF_MARKERS", len(markers.names)),
        ("FREQUENCY", f"{markers.rate_hz:g}"), ("NO_OF_ANALOG", 0), ("ANALOG_FREQUENCY", 0), ("DESCRIPTION", "--"),
        ("TIME_STAMP", "2026-01-02, 10:11:12.000\t1234.5"), ("DATA_INCLUDED", "3D"),
        ("MARKER_NAMES", "\t".join(markers.names)),
        ("TRAJECTORY_TYPES", "\t".join(["Measured"] * len(markers.names))),
    ]  # fmt: skip
    titles = [f"{name} {axis}" for name in markers.names for axis in "XYZ"]
    values = MM * markers.positions_m.reshape(markers.frames, -1)
    if with_times:
        titles = ["Frame", "Time", *titles]
        values = np.column_stack([np.arange(1, markers.frames + 1), markers.times_s, values])
    lines = [f"{key}\t{value}" for key, value in head]
    _write(path, [*lines, "\t".join(titles), *_lines(values)] if with_times else [*lines, *_lines(values)])
    for number, plate in enumerate(true.plates, start=1):
        _write_qualisys_plate(
            true, plate, path.with_name(f"{path.stem}_f_{number}.tsv"), in_plate_axes, with_times
        )


def _write_qualisys_plate(
    true: TrueCapture, plate: TruePlate, path: Path, local: bool, with_times: bool
) -> None:
    axes = plate_axes(plate.corners_m) if local else np.eye(3)
    point = (plate.point_m - plate.corners_m.mean(axis=0)) @ axes if local else plate.point_m
    values = [-plate.force_n @ axes, -plate.about_middle() @ axes, MM * point]
    titles = [f"{kind}_{axis}" for kind in ("Force", "Moment", "COP") for axis in "XYZ"]
    if with_times:
        titles = ["SAMPLE", "TIME", *titles]
        values = [np.arange(1.0, len(point) + 1.0)[:, None], true.times_s[:, None], *values]
    head = [
        ("NO_OF_SAMPLES", len(point)), ("FREQUENCY", f"{true.rate_hz:g}"), ("TIME_STAMP", "2026-01-02, 10:11:12.000"),
        ("FIRST_SAMPLE", 1),
        ("DESCRIPTION", f"Force data in {'local (force plate)' if local else 'world (lab)'} coordinates"),
        ("DATA_INCLUDED", "Force"), ("FORCE_PLATE_TYPE", "AMTI"), ("FORCE_PLATE_MODEL", "Unknown"),
        ("FORCE_PLATE_NAME", f"Force-plate {path.stem[-1]}"),
    ]  # fmt: skip
    head += [
        (f"FORCE_PLATE_CORNER_{quadrant}_{axis}", f"{MM * value:.9g}")
        for quadrant, corner in zip(_QUADRANTS, plate.corners_m, strict=True)
        for axis, value in zip("XYZ", corner, strict=True)
    ]
    lines = [f"{key}\t{value}" for key, value in head]
    _write(path, [*lines, "\t".join(titles), *_lines(np.hstack(values))])


def write_motive(true: TrueCapture, path: Path) -> None:
    """Motive's CSV: markers (y up, m) beside the columns of a rigid body that a solver fitted."""
    markers = true.markers
    count = len(markers.names)
    entries = [
        "Format Version", "1.23", "Take Name", "walk", "Capture Frame Rate", f"{markers.rate_hz:.6f}",
        "Export Frame Rate", f"{markers.rate_hz:.6f}", "Total Frames in Take", f"{markers.frames}",
        "Total Exported Frames", f"{markers.frames}", "Rotation Type", "Quaternion", "Length Units", "Meters",
        "Coordinate Space", "Global",
    ]  # fmt: skip
    body = ["Rotation"] * 4 + ["Position"] * 3
    titles = [
        ["", "Type", *["Rigid Body"] * 7, *["Marker"] * (3 * count)],
        ["", "Name", *["Pelvis"] * 7, *(f"Anna:{name}" for name in markers.names for _ in range(3))],
        ["", "ID", *["1"] * 7, *(f"{k}" for k in range(count) for _ in range(3))],
        ["", "", *body, *["Position"] * (3 * count)],
        ["Frame", "Time (Seconds)", *"XYZWXYZ", *"XYZ" * count],
    ]
    positions = (markers.positions_m @ rotation_to_world("y")).reshape(markers.frames, -1)
    solved = np.tile([0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0], (markers.frames, 1))
    values = np.column_stack([np.arange(markers.frames), markers.times_s, solved, positions])
    lines = [",".join(entries), "", *(",".join(row) for row in titles), *_lines(values, ",")]
    _write(path, lines)


def write_plate_tables(true: TrueCapture, folder: Path) -> Path:
    """One CSV per plate with its channels in plate axes and its corners (y up, m), as a program of plates stores it.

    Returns:
        The file of the first plate.
    """
    turn = rotation_to_world("y")
    for number, plate in enumerate(true.plates, start=1):
        axes = plate_axes(plate.corners_m)
        head = [f"Name,Force Plate {number}", f"Rate,{true.rate_hz:.6f}"]
        for k, corner in enumerate(plate.corners_m @ turn):
            head.append(",".join([f"Corner {k}", *(f"{value:.9g}" for value in corner)]))
        times = true.times_s
        values = np.column_stack(
            [np.arange(len(times)), times, plate.force_n @ axes, plate.about_middle() @ axes]
        )
        titles = "Frame,Time (Seconds),Fx,Fy,Fz,Mx,My,Mz"
        _write(folder / f"walk_force plate {number}.csv", [*head, titles, *_lines(values, ",")])
    return folder / "walk_force plate 1.csv"


def write_devices_table(true: TrueCapture, path: Path) -> None:
    """One CSV of all plates with a line of units: forces on the plates, moments about their middles in N mm."""
    values = [np.repeat(np.arange(1, len(true.times_s) + 1), 1)[:, None], true.times_s[:, None]]
    titles, units = ["Frame", "Time"], ["", "s"]
    for _ in true.plates:
        titles += [f"{kind}{axis}" for kind in "FMC" for axis in _AXES]
        units += ["N"] * 3 + ["N.mm"] * 3 + ["mm"] * 3
    for plate in true.plates:
        values += [-plate.force_n, -MM * plate.about_middle(), MM * plate.point_m]
    _write(
        path,
        ["Devices", f"{true.rate_hz:g}", ",".join(titles), ",".join(units), *_lines(np.hstack(values), ",")],
    )


def _lines(rows: Array, mark: str = "\t") -> list[str]:
    """Rows as text, NaN as a blank."""
    return [mark.join("" if np.isnan(value) else f"{value:.12g}" for value in row) for row in rows]


def _write(path: Path, lines: Sequence[str]) -> None:
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
