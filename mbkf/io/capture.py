"""One door to all capture files: chooses the format by the suffix and joins ground reactions.

A reader of one's own joins the built-in ones by a decorator (docs/own_reader.md)::

    @register_reader(".xyz", title="XYZ text")
    def read_xyz(path: Path, options: CaptureOptions) -> Capture: ...
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.atomic import check_file
from mbkf.io.axes import axes_matrix, axes_text, rotation_to_world, vertical_of
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.emg_file import read_emg
from mbkf.io.emg_on_capture import emg_beside, with_emg
from mbkf.io.files_read import check_regular, files_read
from mbkf.io.persons import one_person
from mbkf.io.plausible import plausible
from mbkf.io.readable_plates import left_out_notes
from mbkf.io.readers import FileFormat, FormatRegistry, either, lazily
from mbkf.io.records import AxesSource, Capture, MarkerTrajectories, PlateReadings
from mbkf.io.shared_plates import without_others_plates
from mbkf.io.turning import turned
from mbkf.io.wrench import DEFAULT_COP_THRESHOLD_N, offset_remarks

_SAME_FRAMES = 2.5
"""Difference of durations, in frames, that recordings of one trial show."""

Read = Callable[[Path, CaptureOptions], Capture]
Write = Callable[[Capture, Path], None]
ReadForces = Callable[[Path, CaptureOptions], tuple[PlateReadings, ...]]


@dataclass(frozen=True, kw_only=True)
class CaptureFormat(FileFormat):
    """A format of captures.

    Attributes:
        read: Reads a file.
        write: Writes a capture; None where that is not possible.
        brings_plates: Such a file may hold force plates of its own.
        forces_share_up: ``up`` is also the axis of a separate file of ground reactions.
        in_folders: Such files are captures wherever they lie, so that a study's folders are searched for them.
    """

    read: Read
    write: Write | None = None
    brings_plates: bool = False
    forces_share_up: bool = False
    in_folders: bool = True


@dataclass(frozen=True, kw_only=True)
class ForceFormat(FileFormat):
    """A format of ground reactions; ``read`` reads a file."""

    read: ReadForces


CAPTURES: FormatRegistry[CaptureFormat] = FormatRegistry("captures")
FORCES: FormatRegistry[ForceFormat] = FormatRegistry("ground reactions")


def register_reader(
    *suffixes: str,
    title: str,
    recognises: Callable[[Path], bool] | None = None,
    write: Write | None = None,
    brings_plates: bool = False,
    forces_share_up: bool = False,
    in_folders: bool = True,
) -> Callable[[Read], Read]:
    """Decorator that registers the reader of a format of captures.

    Args:
        suffixes: Lower-case endings of its files, each with its dot.
        title: Name of the format, for people.
        recognises: True for a file of this kind, by its content; needed where another format has the suffix.
        write: Writes a capture to such a file.
        brings_plates: Such a file may hold force plates of its own.
        forces_share_up: ``up`` is also the axis of a separate file of ground reactions.
        in_folders: A study's folders are searched for such files.

    Raises:
        InvalidInput: A suffix is not one, or is taken.
    """

    def register(read: Read) -> Read:
        CAPTURES.add(
            CaptureFormat(
                title=title,
                suffixes=suffixes,
                recognises=recognises,
                read=read,
                write=write,
                brings_plates=brings_plates,
                forces_share_up=forces_share_up,
                in_folders=in_folders,
            )
        )
        return read

    return register


def register_force_reader(*suffixes: str, title: str) -> Callable[[ReadForces], ReadForces]:
    """Decorator that registers the reader of a format of ground reactions.

    Raises:
        InvalidInput: A suffix is not one, or is taken.
    """

    def register(read: ReadForces) -> ReadForces:
        FORCES.add(ForceFormat(title=title, suffixes=suffixes, read=read))
        return read

    return register


def read_capture(
    path: str | Path,
    *,
    forces: str | Path | None = None,
    up: str | None = None,
    unit: str | None = None,
    cop_threshold_n: float = DEFAULT_COP_THRESHOLD_N,
    tare: bool = True,
    axes: str | None = None,
    unneeded_plates: Sequence[str] = (),
    person: str | None = None,
    emg: str | Path | None = None,
    emg_offset_s: float | None = None,
) -> Capture:
    """Read a capture, and its ground reactions where they stand in a file of their own.

    Args:
        path: File of a registered format: C3D, TRC, Motive's CSV or Qualisys's TSV.
        forces: File of ground reactions (MOT, STO, .forces, TSV or CSV); it then replaces the plates of the file.
            Its up is that of the markers where these are no C3D file, else the axis that carries the weight; a plate
            with corners faces up. It keeps its own times.
        up: Axis of the file that points up; by default the one that the file states or its format has.
        unit: Length unit of the markers; by default the one that the file states.
        cop_threshold_n: Vertical force in N below which no centre of pressure is given.
        tare: Remove the offset that an unloaded plate shows.
        axes: Axes of the file that point forward, left and up, as ``"x,-z,y"``, instead of ``up``; a left-handed
            choice mirrors the file. They hold, whatever the body of the person looks like in them.
        unneeded_plates: Names of plates that will be withheld; a file of ground reactions may hold only those that
            cannot be read among them.
        person: Of a capture of several persons the one to take, by name ("Anna" of "Anna:LASI") or by number in the
            order of the file, from 1 on. Plates on which only others stand are left out, with a remark.
        emg: Table of electromyograms (:mod:`mbkf.io.emg_file`); None: ``walk_emg.csv`` beside ``walk.c3d``, where there
            is one.
        emg_offset_s: Seconds to add to the table's times; None: as the table states, else 0.

    Returns:
        The capture in SI units and world axes. A plate that cannot be read is left out, with a remark.

    Raises:
        FileFormatError: A file is missing, of an unknown kind, or broken.
        InvalidInput: No set of ``forces`` can be read, the length unit or a rate cannot be right, ``axes`` name no
            axes, or contradict ``up``, or the capture has no such person.
        UnknownName: Unknown axis, unit, or naming of force columns.
    """
    path = _input(Path(path))
    kind = CAPTURES.format_of(path)
    matrix = None if axes is None else axes_matrix(axes)
    up = vertical_of(up, axes)
    options = CaptureOptions(
        up=up,
        unit=unit,
        cop_threshold_n=cop_threshold_n,
        tare=tare,
        plates=forces is None,
        unneeded_plates=tuple(unneeded_plates),
    )
    capture = _declared(kind.read(path, options), up)
    if forces is not None:
        capture = _with_forces(capture, Path(forces), kind, options)
    capture = plausible(_with_left_out(capture, options), None if forces is None else Path(forces))
    capture = without_others_plates(one_person(capture, person))
    beside = emg_beside(path) if emg is None else Path(emg)
    if beside is not None:
        capture = with_emg(capture, read_emg(beside), emg_offset_s)
    if matrix is None:
        return capture
    return turned(capture, matrix @ axes_matrix(capture.axes).T, AxesSource.GIVEN)


def _input(path: Path) -> Path:
    """The file, checked if it is there; a reader states which kind of file is missing."""
    return check_regular(path) if path.exists() and not path.is_dir() else path


def _with_left_out(capture: Capture, options: CaptureOptions) -> Capture:
    """The capture with remarks on the plates that were left out."""
    if not options.left_out:
        return capture
    notes = (*capture.notes, *left_out_notes(options.left_out))
    return replace(capture, plates_left_out=dict(options.left_out), notes=notes)


def _declared(capture: Capture, up: str | None) -> Capture:
    """The capture of a reader that leaves ``axes`` alone, with those that its ``up_axis`` means."""
    if capture.axes_source is not AxesSource.MADE:
        return capture
    source = AxesSource.DEFAULT if up is None else AxesSource.UP_GIVEN
    return replace(capture, axes=axes_text(rotation_to_world(capture.up_axis)), axes_source=source)


def _with_forces(capture: Capture, forces: Path, kind: CaptureFormat, options: CaptureOptions) -> Capture:
    """The capture with ground reactions of a file of their own."""
    markers, share = capture.markers, kind.forces_share_up
    options = replace(
        options,
        up=options.up if share else None,
        shared_up=capture.up_axis if share else None,
        trial_end_s=markers.start_time_s + (markers.frames - 2) / markers.rate_hz,  # but for the last frame
        notes=[],
    )
    plates = FORCES.format_of(_input(forces)).read(forces, options)
    notes = [*capture.notes, f"ground reactions from {forces.name}", *options.notes]
    plates = _on_time_of(plates, markers, notes)
    notes += [*_coverage(plates, markers), *offset_remarks(plates)]
    return replace(capture, plates=plates, notes=tuple(notes))


def _on_time_of(
    plates: tuple[PlateReadings, ...], markers: MarkerTrajectories, notes: list[str]
) -> tuple[PlateReadings, ...]:
    """Ground reactions that last as long as the markers, on another clock, moved to the time of the markers.

    One of the two counts time from the beginning of the recording, the other from that of the exported part. Times that
    overlap are moved only if one of them begins at 0 and the other at a later frame of its own file.
    """
    starts = {plate.start_time_s for plate in plates}
    if len(starts) != 1 or not markers.frames:
        return plates
    start_s, frame_s = starts.pop(), 1.0 / markers.rate_hz
    lasting_s = markers.frames * frame_s
    begins_s = markers.start_time_s
    if any(abs(len(plate.force_n) / plate.rate_hz - lasting_s) > _SAME_FRAMES * frame_s for plate in plates):
        return plates
    apart = abs(start_s - begins_s) >= lasting_s
    rebased = abs(start_s) < 0.5 * frame_s and begins_s > _SAME_FRAMES * frame_s
    if not apart and not rebased:
        return plates
    notes.append(
        f"ground reactions begin at {start_s:.4g} s, the markers at {begins_s:.4g} s, and both last {lasting_s:.4g} s; "
        f"they are taken as simultaneous: the ground reactions are moved by {begins_s - start_s:+.4g} s"
    )
    return tuple(replace(plate, start_time_s=begins_s) for plate in plates)


def _coverage(plates: tuple[PlateReadings, ...], markers: MarkerTrajectories) -> list[str]:
    """Remarks on ground reactions that leave out the trial or a part of it."""
    slack_s = 1.5 / markers.rate_hz
    first_s, last_s = markers.start_time_s, markers.start_time_s + (markers.frames - 1) / markers.rate_hz
    notes: list[str] = []
    parts: dict[tuple[float, float], list[str]] = {}
    for plate in plates:
        start_s, end_s = plate.start_time_s, float(plate.times_s[-1])
        if end_s < first_s or start_s > last_s + slack_s:
            notes.append(f"ground reactions of '{plate.name}' lie outside the time of the markers")
        elif start_s > first_s + slack_s or end_s < last_s - slack_s:
            parts.setdefault((round(start_s, 3), round(end_s, 3)), []).append(plate.name)
    for (start_s, end_s), names in parts.items():
        notes.append(
            f"ground reactions of {', '.join(names)} last from {start_s:g} to {end_s:g} s, the markers from "
            f"{first_s:.4g} to {last_s:.4g} s"
        )
    return notes


def write_capture(capture: Capture, path: str | Path) -> None:
    """Writes a capture in the format of the file's suffix, whole or not at all.

    Raises:
        FileFormatError: The suffix is unknown, or the format can only be read.
        OSError: The file cannot be written.
    """
    path = Path(path)
    kind = CAPTURES.format_of(path)
    if kind.write is None:
        raise FileFormatError(path, f"{kind.title} is not written; name a {either(writable_suffixes())} file")
    check_file(path)
    kind.write(capture, path)
    files_read().wrote(path)


def writable_suffixes() -> tuple[str, ...]:
    """Suffixes of captures that can be written."""
    return tuple(suffix for one in CAPTURES if one.write is not None for suffix in one.suffixes)


def folder_suffixes() -> tuple[str, ...]:
    """Suffixes of captures that a study's folders are searched for, the more telling ones first."""
    return tuple(suffix for one in CAPTURES if one.in_folders for suffix in one.suffixes)


def _write_trc(capture: Capture, path: Path) -> None:
    from mbkf.io.trc import write_trc

    write_trc(capture.markers, path)


register_reader(".c3d", title="C3D", write=lazily("c3d_write", "write_c3d"), brings_plates=True)(
    lazily("c3d", "read_c3d")
)
register_reader(".trc", title="TRC", write=_write_trc, forces_share_up=True)(lazily("trc", "read_trc"))
register_reader(".csv", title="CSV of Motive", forces_share_up=True, in_folders=False)(
    lazily("motive", "read_motive")
)
register_reader(".tsv", title="TSV of Qualisys", brings_plates=True, forces_share_up=True, in_folders=False)(
    lazily("qualisys", "read_qualisys")
)
register_force_reader(".mot", ".sto", title="OpenSim storage")(lazily("forces", "read_forces_mot"))
register_force_reader(".forces", title="Cortex forces")(lazily("cortex", "read_forces_cortex"))
register_force_reader(".tsv", title="TSV of a Qualisys plate")(lazily("qualisys", "read_forces_qualisys"))
register_force_reader(".csv", ".txt", title="table with named columns")(
    lazily("force_csv", "read_forces_csv")
)
