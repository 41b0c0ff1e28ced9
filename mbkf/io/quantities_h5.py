"""Declared quantities in HDF5 files: every axis has a dimension scale with its labels, every dataset unit and meaning.

The files follow netCDF-4's conventions for dimension scales and CF's for attributes (``units``, ``long_name``,
``flag_values``, ``flag_meanings``, ``ancillary_variables``), so that ``xarray.open_dataset(path, engine="h5netcdf")``
shows axes and labels. Where the unit differs along the last axis, ``component_units`` lists one
for each of its labels.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from mbkf.conventions import Array
from mbkf.io.dimensions import AXES, axes_text
from mbkf.io.hdf5 import array
from mbkf.io.quantities import Quantity, attributes, quantities
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
    kind: type = type(record)
    for kept in attributes(kind):
        value = getattr(record, kept.name)
        plain = value if kept.read in PLAIN else plain_json(value)
        file.attrs[kept.name] = without_noughts(plain) if isinstance(plain, str) else plain
    declared = [one for one in quantities(kind).values() if one.written]
    for one in declared:
        if one.is_text:
            write_labels(file, one.key, getattr(record, one.name), one.meaning)
    spreads: dict[str, list[str]] = {}
    for one in declared:
        value = getattr(record, one.name)
        if not one.is_text and value is not None:
            write_array(file, one, value)
            if one.beside:
                spreads.setdefault(one.beside, []).append(one.key)
    for key, beside in spreads.items():
        _describe(file[key], ancillary_variables=" ".join(beside))


def read_record(file: h5py.File, record: type) -> Fields:
    """Declared attributes, names and arrays of a type of record, as far as the file has them.

    Raises:
        ValueError: An array claims to be larger than the file can hold.
    """
    values: Fields = {
        kept.name: kept.read(file.attrs[kept.name]) for kept in attributes(record) if kept.name in file.attrs
    }
    for one in quantities(record).values():
        if one.written and one.key in file:
            text = one.is_text
            values[one.name] = tuple(file[one.key].asstr()[:]) if text else array(file, one.key, one.dtype)
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


def write_array(file: h5py.File, one: Quantity, value: Array) -> None:
    """Writes an array with unit, meaning, codes and labelled axes; labels that a trial decides on are there already.

    Args:
        file: The file.
        one: Declaration of the array.
        value: The array.
    """
    packed: dict[str, Any] = {}
    if value.size > _PACKED_FROM:
        packed = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
    dataset = file.create_dataset(one.key, data=value, **packed)
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
        if axis.labels and axis.names not in file:
            write_labels(file, axis.names, axis.labels, axis.meaning)
        dataset.dims[number].attach_scale(file[axis.names])
    if one.unit.by_label:
        labels = file[AXES[one.axes[-1]].names].asstr()[:]
        _describe(dataset, component_units=", ".join(one.unit.of(label) for label in labels))


def _describe(dataset: h5py.Dataset, **texts: str) -> None:
    """Writes attributes, five times as fast as ``dataset.attrs``: a result has hundreds of them."""
    import h5py

    kind = h5py.h5t.py_create(h5py.string_dtype(), logical=True)
    for name, text in texts.items():
        attribute = h5py.h5a.create(dataset.id, name.encode(), kind, h5py.h5s.create(h5py.h5s.SCALAR))
        attribute.write(np.array(without_noughts(text), dtype=h5py.string_dtype()))


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
