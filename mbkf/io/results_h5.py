"""A reconstruction as one HDF5 file, ``motion.h5``: everything but the covariance, with units."""

from __future__ import annotations

import dataclasses
import io
import json
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mbkf.conventions import read_only
from mbkf.errors import FileFormatError, MbkfError
from mbkf.io.atomic import replacing
from mbkf.io.body_covariance import BodyCovariance
from mbkf.io.contacts import foot_sources
from mbkf.io.dimensions import AXES, WORLD, Unit, numbered
from mbkf.io.files_read import check_input
from mbkf.io.hdf5 import DAMAGED, USER_BLOCK, WrittenFile, array, check_seal, seal_file, sealed
from mbkf.io.inertia import SegmentInertia
from mbkf.io.quantities import Quantity
from mbkf.io.quantities_h5 import (
    AxisScales,
    RecordPieces,
    plain_json,
    read_record,
    write_array,
    write_labels,
    write_record,
)
from mbkf.io.results import Reconstruction
from mbkf.io.subject import Subject, SubjectMarker

if TYPE_CHECKING:
    import h5py

FORMAT = "mbkf reconstruction"
FORMAT_VERSION = 1

_COVARIANCE = Quantity(
    ("unknown", "source"),
    Unit("1; rows of markers m"),
    "root L of the covariance L Lᵀ of scale factors and of places of markers on the body",
    key="subject_covariance",
)


def write_h5(reconstruction: Reconstruction, path: str | Path, run_id: str = "") -> None:
    """Writes a reconstruction, whole or not at all.

    Args:
        reconstruction: The result.
        path: The file.
        run_id: Number that the files of one run share.

    Raises:
        OSError: The file cannot be written.
    """
    import h5py

    made = io.BytesIO()  # HDF5 itself does not survive a disk that is full
    with h5py.File(made, "w", userblock_size=USER_BLOCK) as file:
        _write_format(file)
        write_record(file, reconstruction)
        _write_subject(file, reconstruction)
    with replacing(path) as partial:
        partial.write_bytes(sealed(made, run_id))


class ResultPieces:
    """A result that is written in pieces, in a file that has no name yet: it is not sealed until it is whole."""

    def __init__(self, path: Path, frames: int) -> None:
        """Makes the file.

        Args:
            path: The file, in an unfinished folder.
            frames: Frames of the whole result.

        Raises:
            OSError: It cannot be made.
        """
        import h5py

        self._path, self._frames, self._begin = path, frames, 0
        self._written = WrittenFile(path)
        self._file = h5py.File(self._written, "w", userblock_size=USER_BLOCK)
        self._pieces: RecordPieces | None = None
        _write_format(self._file)

    def add(self, piece: Reconstruction) -> None:
        """Writes the arrays of the next piece.

        Args:
            piece: The piece, without margins.

        Raises:
            OSError: It cannot be written.
        """
        with self._written.checked():
            if self._pieces is None:
                self._pieces = RecordPieces(self._file, piece, self._frames)
            else:
                self._pieces.add(piece, self._begin)
            self._file.flush()
        self._begin += piece.frames

    def finish(self, last: Reconstruction, run_id: str, valid: bool) -> None:
        """Writes what holds for the whole trial, and seals the file.

        Args:
            last: The last piece, with the attributes and remarks of the whole trial.
            run_id: Number that the files of one run share.
            valid: False: no frame is valid, whatever the pieces hold.

        Raises:
            OSError: It cannot be written.
        """
        assert self._pieces is not None
        with self._written.checked():
            self._pieces.finish(last)
            if not valid:
                self._file["valid"][:] = False
            _write_subject(self._file, last)
            self.close()
        seal_file(self._path, run_id)

    def close(self) -> None:
        """Closes the file; one that could not be written, too."""
        with suppress(OSError, RuntimeError):
            self._file.close()
        self._written.close()


def _write_format(file: h5py.File) -> None:
    file.attrs["format"] = FORMAT
    file.attrs["format_version"] = FORMAT_VERSION
    file.attrs["missing"] = "NaN where not known"
    file.attrs["axes"] = (
        f"{WORLD}; forces are those of the ground on the body; moments of joints are internal: "
        "positive turns the joint towards positive angles"
    )


def _write_subject(file: h5py.File, reconstruction: Reconstruction) -> None:
    file.attrs["later_frames"] = reconstruction.later_frames  # for readers; it follows from the rest
    subject = dataclasses.replace(reconstruction.subject, covariance=None)
    file.attrs["subject"] = plain_json(dataclasses.asdict(subject))
    _write_covariance(file, reconstruction.subject.covariance)


def read_h5(path: str | Path) -> Reconstruction:
    """Reads a file of :func:`write_h5`, of this version or an older one.

    Raises:
        FileFormatError: The file is missing, damaged or something else.
    """
    (whole,) = read_h5_blocks(path, None)
    return whole


def read_h5_blocks(path: str | Path, size: int | None) -> Iterator[Reconstruction]:
    """Reads a file of :func:`write_h5` in blocks of so many frames; None: as one.

    Raises:
        FileFormatError: The file is missing, damaged or something else.
    """
    import h5py

    source = Path(path)
    check_input(source, "make it with 'mbkf reconstruct'")
    try:
        check_seal(source)
        with h5py.File(source, "r") as file:
            if file.attrs.get("format") != FORMAT:
                raise FileFormatError(source, "not a reconstruction; make it with 'mbkf reconstruct'")
            if file.attrs["format_version"] > FORMAT_VERSION:
                raise FileFormatError(source, "written by a newer mbkf; upgrade to read it")
            subject = _subject(json.loads(file.attrs["subject"]), _read_covariance(file))
            frames = len(file["valid"])
            for begin in range(0, max(frames, 1), size or max(frames, 1)):
                rows = None if size is None else slice(begin, begin + size)
                yield _result(read_record(file, Reconstruction, rows), subject)
    except FileFormatError:
        raise
    except DAMAGED as error:
        raise FileFormatError(source, f"damaged or not a reconstruction ({error})") from error
    except MbkfError as error:
        raise FileFormatError(source, f"damaged: {error}") from error


def _result(values: dict[str, Any], subject: Subject) -> Reconstruction:
    """A result by its fields; in older files only feet bear, and only what is measured is valid."""
    if "measured" not in values:
        values["measured"] = values["valid"]
        values["foot_source"] = foot_sources(values.get("foot_contact"), values["foot_wrench"])
        none = np.zeros((len(values["valid"]), 0, 6))
        values |= {"support_names": (), "support_wrench": none, "support_wrench_sd": none}
        values["support_point_m"] = none[..., :3]
    return Reconstruction(**values, subject=subject)


def _write_covariance(file: h5py.File, known: BodyCovariance | None) -> None:
    """Writes the root of the covariance of the subject's body, with the names that it belongs to."""
    if known is None:
        return
    places = [f"{marker}_{axis}" for marker in known.markers for axis in "xyz"]
    slides = [f"{place}_by_flexion_{d + 1}" for d in range(known.flexions) for place in places]
    for axis, labels in zip(
        _COVARIANCE.axes,
        ((*known.factors, *known.centres, *places, *slides), numbered(len(known.root))),
        strict=True,
    ):
        write_labels(file, AXES[axis].names, labels, AXES[axis].meaning)
    write_array(AxisScales(file), _COVARIANCE, known.root)
    for name in ("factors", "markers", "flexions", "centres"):
        file[_COVARIANCE.key].attrs[name] = json.dumps(getattr(known, name))


def _read_covariance(file: h5py.File) -> BodyCovariance | None:
    if _COVARIANCE.key not in file:
        return None
    factors, markers = (
        tuple(json.loads(file[_COVARIANCE.key].attrs[name])) for name in ("factors", "markers")
    )
    centres = tuple(json.loads(file[_COVARIANCE.key].attrs.get("centres", "[]")))
    flexions = int(json.loads(file[_COVARIANCE.key].attrs.get("flexions", "0")))
    return BodyCovariance(factors, markers, array(file, _COVARIANCE.key, np.float64), flexions, centres)


def _subject(table: dict[str, Any], covariance: BodyCovariance | None) -> Subject:
    markers = tuple(
        SubjectMarker(
            **entry
            | {
                "position_m": read_only(entry["position_m"]),
                "slides_m": read_only(np.reshape(entry.get("slides_m", []), (-1, 3))),
                "slid": read_only(entry.get("slid", [])),
            }
        )
        for entry in table["markers"]
    )
    inertia = {
        segment: SegmentInertia(
            **own | {key: read_only(own[key]) for key in ("centre_shift_m", "centre_shift_sd_m")}
        )
        for segment, own in table.get("inertia", {}).items()
    }
    return Subject(**{**table, "markers": markers, "inertia": inertia, "covariance": covariance})
