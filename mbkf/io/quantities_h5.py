"""Declared quantities in HDF5 files: every axis has a dimension scale with its labels, every dataset unit and meaning.

The files follow netCDF-4's conventions for dimension scales and CF's for attributes (``units``, ``long_name``,
``flag_values``, ``flag_meanings``, ``ancillary_variables``), so that ``xarray.open_dataset(path, engine="h5netcdf")``
shows axes and labels. Where the unit differs along the last axis, ``component_units`` lists one
for each of its labels.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterable, Sequence
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from mbkf.conventions import Array
from mbkf.io.dimensions import AXES, Axis, Unit, axes_text
from mbkf.io.hdf5 import array
from mbkf.io.packed_arrays import packed_dataset, put_packed, write_packed
from mbkf.io.quantities import TIME, Quantity, attributes, quantities
from mbkf.io.utf8 import without_noughts

if TYPE_CHECKING:
    import h5py

Fields: TypeAlias = dict[str, Any]
"""Values by the name of a record's field."""

PLAIN = (str, bool, int, float)
"""Attributes that HDF5 holds as they are; others are JSON."""

_PACKED_FROM = 256
"""Arrays of more numbers are compressed."""


def write_record(file: h5py.File, record: object) -> None:
    """Writes declared attributes, names and arrays of a record."""
    write_attributes(file, record)
    write_texts(file, record, _texts(record))
    write_arrays(file, record)


def write_attributes(file: h5py.File, record: object) -> None:
    """Writes the declared attributes of a record."""
    kind: type = type(record)
    for kept in attributes(kind):
        value = getattr(record, kept.name)
        plain = value if kept.read in PLAIN else plain_json(value)
        file.attrs[kept.name] = without_noughts(plain) if isinstance(plain, str) else plain


def write_texts(file: h5py.File, record: object, declared: Iterable[Quantity]) -> None:
    """Writes lists of names or remarks of a record.

    Args:
        file: The file.
        record: The record.
        declared: The lists.
    """
    for one in declared:
        write_labels(file, one.key, getattr(record, one.name), one.meaning)


def write_arrays(file: h5py.File, record: object, frames: int | None = None) -> None:
    """Writes the declared arrays of a record, whose names are there already.

    Args:
        file: The file.
        record: The record, or the first piece of one.
        frames: Frames of the whole record, of which more are to come; None: the record is whole.
    """
    spreads: dict[str, list[str]] = {}
    scales = AxisScales(file)
    for one in _arrays(record):
        write_array(scales, one, getattr(record, one.name), frames)
        if one.beside:
            spreads.setdefault(one.beside, []).append(one.key)
    for key, beside in spreads.items():
        _describe(file[key], ancillary_variables=" ".join(beside))


class RecordPieces:
    """A record that is written in pieces along its frames; its attributes and remarks come last."""

    def __init__(self, file: h5py.File, first: object, frames: int) -> None:
        """Writes the names of axes and the first piece's arrays, with room for the others.

        Args:
            file: The file.
            first: The first piece.
            frames: Frames of all pieces.
        """
        self._file, self._frames = file, frames
        write_texts(file, first, [one for one in _texts(first) if one.axes])
        write_arrays(file, first, frames)

    def add(self, record: object, begin: int) -> None:
        """Writes the arrays of a further piece.

        Args:
            record: The piece, as long as the first one unless it is the last.
            begin: Its first frame.
        """
        for one in _arrays(record):
            if one.axes[0] == TIME:
                value, dataset = getattr(record, one.name), self._file[one.key]
                if dataset.chunks is None:
                    dataset[begin : begin + len(value)] = value
                else:
                    put_packed(dataset, value, begin)

    def finish(self, record: object) -> None:
        """Writes attributes and remarks.

        Args:
            record: A record that holds those of all pieces.
        """
        write_attributes(self._file, record)
        write_texts(self._file, record, [one for one in _texts(record) if not one.axes])


def _texts(record: object) -> list[Quantity]:
    kind: type = type(record)
    return [one for one in quantities(kind).values() if one.written and one.is_text]


def _arrays(record: object) -> list[Quantity]:
    """The arrays that a record has."""
    kind: type = type(record)
    declared = (one for one in quantities(kind).values() if one.written and not one.is_text)
    return [one for one in declared if getattr(record, one.name) is not None]


def read_record(file: h5py.File, record: type, frames: slice | None = None) -> Fields:
    """Declared attributes, names and arrays of a type of record, as far as the file has them.

    Args:
        file: The file.
        record: The type.
        frames: The frames to read; None for all.

    Raises:
        ValueError: An array claims to be larger than the file can hold.
    """
    values: Fields = {
        kept.name: kept.read(file.attrs[kept.name]) for kept in attributes(record) if kept.name in file.attrs
    }
    for one in quantities(record).values():
        if one.written and one.key in file:
            if one.is_text:
                values[one.name] = tuple(file[one.key].asstr()[:])
            else:
                rows = frames if one.axes[0] == TIME else None
                values[one.name] = array(file, one.key, one.dtype, rows)
    return values


def write_labels(file: h5py.File, key: str, labels: Sequence[str], meaning: str) -> None:
    """Writes the labels of an axis, as its dimension scale.

    Args:
        file: The file.
        key: Name of the dataset and of the dimension.
        labels: One for each entry of the axis.
        meaning: Of the entries.
    """
    import h5py

    dataset = file.create_dataset(
        key, data=[without_noughts(label) for label in labels], dtype=h5py.string_dtype()
    )
    _describe(dataset, long_name=meaning)
    dataset.make_scale(key)


class AxisScales:
    """Dimension scales of a file, each looked up once: nearly every array has the axis of time.

    Attributes:
        file: The file.
    """

    def __init__(self, file: h5py.File) -> None:
        """Args: the file."""
        self.file = file
        self._scales: dict[str, h5py.Dataset] = {}
        self._labels: dict[str, tuple[str, ...]] = {}

    def of(self, axis: Axis) -> h5py.Dataset:
        """The scale of an axis; labels that are the same in every file are written at their first use."""
        if axis.names not in self._scales:
            if axis.labels and axis.names not in self.file:
                write_labels(self.file, axis.names, axis.labels, axis.meaning)
            self._scales[axis.names] = self.file[axis.names]
        return self._scales[axis.names]

    def labels(self, axis: Axis) -> tuple[str, ...]:
        """The labels of an axis."""
        if axis.names not in self._labels:
            self._labels[axis.names] = tuple(self.of(axis).asstr()[:])
        return self._labels[axis.names]


def write_array(scales: AxisScales, one: Quantity, value: Array, frames: int | None = None) -> None:
    """Writes an array with unit, meaning, codes and labelled axes; labels that a trial decides on are there already.

    Args:
        scales: Scales of the file.
        one: Declaration of the array.
        value: The array, or its first frames.
        frames: Frames of the whole array, if it has an axis of time; None: the array is whole.
    """
    import h5py

    file = scales.file
    if frames is None or one.axes[0] != TIME or len(value) == frames:
        packs = value.size > _PACKED_FROM
        dataset = write_packed(file, one.key, value) if packs else file.create_dataset(one.key, data=value)
    elif value.size > _PACKED_FROM:  # each piece is a chunk
        dataset = packed_dataset(file, one.key, (frames, *value.shape[1:]), value.dtype, len(value))
        put_packed(dataset, value)
    else:
        dataset = file.create_dataset(one.key, (frames, *value.shape[1:]), value.dtype)
        dataset[: len(value)] = value
    unit = one.unit.text
    _describe(dataset, unit=unit, units=unit, long_name=one.meaning, axes=axes_text(one.axes))
    if one.codes:
        dataset.attrs["flag_values"] = np.array(list(one.codes), dtype=value.dtype)
        _describe(dataset, flag_meanings=" ".join(one.codes.values()))
    for number, name in enumerate(one.axes):
        axis = AXES[name]
        if axis.names == one.key:
            dataset.make_scale(one.key)
            continue
        h5py.h5ds.attach_scale(dataset.id, scales.of(axis).id, number)
    if one.unit.by_label:
        _describe(dataset, component_units=_component_units(one.unit, scales.labels(AXES[one.axes[-1]])))


@lru_cache(maxsize=64)
def _component_units(unit: Unit, labels: tuple[str, ...]) -> str:
    """Units of the entries with these labels, in a list."""
    return ", ".join(unit.of(label) for label in labels)


def _describe(dataset: h5py.Dataset, **texts: str) -> None:
    """Writes attributes, five times as fast as ``dataset.attrs``: a result has hundreds of them."""
    import h5py

    dtype, kind, scalar = _text_type()
    for name, text in texts.items():
        attribute = h5py.h5a.create(dataset.id, name.encode(), kind, scalar)
        attribute.write(np.array(without_noughts(text), dtype=dtype))


@cache
def _text_type() -> tuple[np.dtype, h5py.h5t.TypeID, h5py.h5s.SpaceID]:
    """Type of a text for NumPy and for HDF5, and the shape of a single one."""
    import h5py

    dtype = h5py.string_dtype()
    return dtype, h5py.h5t.py_create(dtype, logical=True), h5py.h5s.create(h5py.h5s.SCALAR)


def plain_json(value: object) -> str:
    """JSON text of a value, numpy's types, paths, records and sets in it as plain data."""
    return json.dumps(value, default=_plain)


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return dataclasses.asdict(value)
    if isinstance(value, set | frozenset):
        return sorted(value)
    return str(value)
