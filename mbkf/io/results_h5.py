"""A reconstruction as one HDF5 file, ``motion.h5``: everything but the covariance, with units."""

from __future__ import annotations

import dataclasses
import io
import json
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from mbkf.conventions import read_only
from mbkf.errors import FileFormatError, MbkfError
from mbkf.io.atomic import replacing
from mbkf.io.body_covariance import BodyCovariance
from mbkf.io.contacts import foot_sources
from mbkf.io.findings import Finding
from mbkf.io.hdf5 import DAMAGED, USER_BLOCK, array, check_seal, sealed
from mbkf.io.results import ARRAYS, DTYPES, OFFSETS, Reconstruction
from mbkf.io.subject import Subject, SubjectMarker

FORMAT = "mbkf reconstruction"
FORMAT_VERSION = 1

_ANGLE, _RATE, _FORCE = "rad; pelvis_t* m", "rad/s; pelvis_t* m/s", "N m; pelvis_t* N"
UNITS = {
    "times_s": "s", "q": "m; unit quaternions (x, y, z, w); hinges rad",
    "v": _RATE, "a": "rad/s^2; pelvis_t* m/s^2", "tau": _FORCE,
    "sd_q": _ANGLE, "sd_v": _RATE, "sd_tau": _FORCE,
    "angles": _ANGLE, "angle_rates": _RATE, "moments": _FORCE,
    "angles_sd": _ANGLE, "angle_rates_sd": _RATE, "moments_sd": _FORCE,
    "measured_m": "m", "predicted_m": "m", "foot_wrench": "N, N m about the world's origin",
    "foot_cop_m": "m", "foot_free_moment_nm": "N m", "residual_force_n": "N", "residual_moment_nm": "N m",
    "step_seconds": "s", "plate_change": "N, N m", "foot_wrench_sd": "N, N m about the world's origin",
    "plate_corners_m": "m", "heading_rad": "rad", "angles_lab": _ANGLE,
    "support_wrench": "N, N m about the world's origin", "support_wrench_sd": "N, N m about the world's origin",
    "support_point_m": "m", "marker_spread_m": "m",
}  # fmt: skip
UNITS |= {name: UNITS[total] for name, total in OFFSETS.items()}
"""Unit of each array; the others (flags, counts, the innovation statistic) have none and carry "1"."""

_TEXTS = (
    "trial", "protocol", "filter", "version", "direction", "angles_read", "angles_zero", "file_axes",
    "file_axes_source",
)  # fmt: skip
_NAME_LISTS = {
    "dof_names": "dof_names", "coordinate_names": "coordinate_names", "marker_names": "marker_names",
    "unobserved_dofs": "held_dofs", "warnings": "warnings", "support_names": "support_names",
}  # fmt: skip
"""Lists of names and the data sets that hold them."""

_LATER = ("support_names",)
"""Lists that older files lack."""

_KEYS = {"foot_contact": "footing"}
"""Data sets of arrays that have another name in Python."""

_NEVER_WRITTEN = ("covariance",)

_COVARIANCE = "subject_covariance"


def write_h5(reconstruction: Reconstruction, path: str | Path, run_id: str = "") -> None:
    """Writes a reconstruction, whole or not at all.

    Args:
        reconstruction: The result.
        path: The file.
        run_id: What the files of one run share.

    Raises:
        OSError: The file cannot be written.
    """
    made = io.BytesIO()  # HDF5 itself does not survive a disk that is full
    with h5py.File(made, "w", userblock_size=USER_BLOCK) as file:
        file.attrs["format"] = FORMAT
        file.attrs["format_version"] = FORMAT_VERSION
        file.attrs["axes"] = (
            "x forward, y left, z up; forces act on the body; moments in the conventions of mbkf"
        )
        for name in _TEXTS:
            file.attrs[name] = getattr(reconstruction, name)
        file.attrs["smoothed"] = reconstruction.smoothed
        file.attrs["uncorrected"] = reconstruction.uncorrected
        file.attrs["later_frames"] = reconstruction.later_frames  # for readers; it follows from the rest
        file.attrs["rate_hz"] = reconstruction.rate_hz
        file.attrs["settings"] = json.dumps(reconstruction.settings, default=_plain)
        file.attrs["markers_ignored"] = json.dumps(reconstruction.markers_ignored)
        file.attrs["names_exchanged"] = json.dumps(reconstruction.names_exchanged)
        file.attrs["checks"] = json.dumps([check.as_table() for check in reconstruction.checks])
        file.attrs["markers_explained"] = reconstruction.markers_explained
        subject = dataclasses.replace(reconstruction.subject, covariance=None)
        file.attrs["subject"] = json.dumps(dataclasses.asdict(subject), default=_plain)
        _write_covariance(file, reconstruction.subject.covariance)
        for name, key in _NAME_LISTS.items():
            file.create_dataset(key, data=list(getattr(reconstruction, name)), dtype=h5py.string_dtype())
        for name in ARRAYS:
            array = getattr(reconstruction, name)
            if array is None or name in _NEVER_WRITTEN:
                continue
            packed = (
                {"compression": "gzip", "compression_opts": 1, "shuffle": True} if array.size > 256 else {}
            )
            dataset = file.create_dataset(_KEYS.get(name, name), data=array, **packed)
            dataset.attrs["unit"] = UNITS.get(name, "1")
    with replacing(path) as partial:
        partial.write_bytes(sealed(made, run_id))


def read_h5(path: str | Path) -> Reconstruction:
    """Reads a file of :func:`write_h5`.

    Raises:
        FileFormatError: The file is missing, damaged or something else.
    """
    source = Path(path)
    if not source.is_file():
        raise FileFormatError(source, "no such file; make it with 'mbkf reconstruct'")
    try:
        check_seal(source)
        with h5py.File(source, "r") as file:
            if file.attrs.get("format") != FORMAT:
                raise FileFormatError(source, "not a reconstruction; make it with 'mbkf reconstruct'")
            if file.attrs["format_version"] > FORMAT_VERSION:
                raise FileFormatError(source, "written by a newer mbkf; upgrade to read it")
            # Older files lack direction, reading, axes, checks, ignored and exchanged markers: theirs are the defaults.
            values: dict[str, Any] = {name: str(file.attrs[name]) for name in _TEXTS if name in file.attrs}
            values["smoothed"] = bool(file.attrs["smoothed"])
            values["uncorrected"] = int(file.attrs.get("uncorrected", 0))
            values["rate_hz"] = float(file.attrs["rate_hz"])
            values["settings"] = json.loads(file.attrs["settings"])
            values["markers_ignored"] = json.loads(file.attrs.get("markers_ignored", "{}"))
            exchanged = json.loads(file.attrs.get("names_exchanged", "[]"))
            values["names_exchanged"] = tuple((a, b, int(frames)) for a, b, frames in exchanged)
            values["checks"] = tuple(Finding(**one) for one in json.loads(file.attrs.get("checks", "[]")))
            values["markers_explained"] = float(file.attrs.get("markers_explained", 1.0))
            values["subject"] = _subject(json.loads(file.attrs["subject"]), _read_covariance(file))
            for name, key in _NAME_LISTS.items():
                values[name] = tuple(file[key].asstr()[:]) if key in file or name not in _LATER else ()
            for name in ARRAYS:
                key = _KEYS.get(name, name)
                if key in file:
                    values[name] = array(file, key, DTYPES.get(name, np.float64))
        if "measured" not in values:  # in older files only feet bear, and only what is measured is valid
            values["measured"] = values["valid"]
            values["foot_source"] = foot_sources(values.get("foot_contact"), values["foot_wrench"])
            none = np.zeros((len(values["valid"]), 0, 6))
            values |= {"support_wrench": none, "support_wrench_sd": none, "support_point_m": none[..., :3]}
        return Reconstruction(**values)
    except FileFormatError:
        raise
    except DAMAGED as error:
        raise FileFormatError(source, f"damaged or not a reconstruction ({error})") from error
    except MbkfError as error:
        raise FileFormatError(source, f"damaged: {error}") from error


def _write_covariance(file: h5py.File, known: BodyCovariance | None) -> None:
    """What is not known of the subject's body: the root of its covariance, with the names it belongs to."""
    if known is None:
        return
    packed = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
    dataset = file.create_dataset(_COVARIANCE, data=known.root, **packed)
    dataset.attrs["unit"] = "1; rows of markers m"
    for name in ("factors", "markers"):
        dataset.attrs[name] = json.dumps(getattr(known, name))


def _read_covariance(file: h5py.File) -> BodyCovariance | None:
    if _COVARIANCE not in file:
        return None
    factors, markers = (tuple(json.loads(file[_COVARIANCE].attrs[name])) for name in ("factors", "markers"))
    return BodyCovariance(factors, markers, array(file, _COVARIANCE, np.float64))


def _subject(table: dict[str, Any], covariance: BodyCovariance | None) -> Subject:
    markers = tuple(
        SubjectMarker(**{**entry, "position_m": read_only(entry["position_m"])}) for entry in table["markers"]
    )
    return Subject(**{**table, "markers": markers, "covariance": covariance})


def _plain(value: Any) -> Any:
    """Types that JSON lacks, as plain data: numpy's scalars and arrays, paths, records, sets."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return dataclasses.asdict(value)
    if isinstance(value, set | frozenset):
        return sorted(value)
    return str(value)
