"""Declaration of a quantity: axes, unit, meaning and codes of an array stand once, in the field of its record.

    foot_cop_m: Array = quantity("time foot xyz", METRE, "centres of pressure, NaN where not loaded")

The record's checks, its datasets in an HDF5 file with labelled axes, columns of tables, curves of viewers and the
tables of the page on files follow from the declarations (:func:`quantities`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from functools import cache
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import ShapeError
from mbkf.io.dimensions import AXES, ONE, Unit, numbered, shape_of

T = TypeVar("T")

TIME = "time"
"""Name of the axis of frames."""

LATER = cast(Any, object())
"""Default of a quantity that older files and logs lack; there it is NaN."""

_REQUIRED: Any = MISSING
_ABSENT: Any = None

_QUANTITY, _ATTRIBUTE = "quantity", "attribute"
"""Keys of a field's metadata."""


class Column(NamedTuple):
    """Place of a quantity in an OpenSim table.

    Attributes:
        file: Name of the table.
        name: Of a column, with ``{coordinate}`` and the like for the label on an axis, ``{side}`` for r or l, and
            ``{load}`` for "force" along a translation, else "moment".
        instead: Quantity that the column holds in results that lack this one.
    """

    file: str
    name: str
    instead: str = ""


class Plot(NamedTuple):
    """Curve of a quantity in viewers, live and in playback.

    Attributes:
        group: Heading that it is listed under.
        title: Its name there; that of a side or coordinate is added.
        unit: Unit shown.
        factor: From the quantity's unit to that one.
        resolution: Step to which recordings are rounded, in the quantity's unit.
    """

    group: str
    title: str
    unit: str
    factor: float
    resolution: float


@dataclass(frozen=True)
class Quantity:
    """A declared array, or a list of names or texts (:data:`str`).

    Attributes:
        name: Name of the field.
        axes: Names of its axes (:data:`mbkf.io.dimensions.AXES`).
        unit: Unit of its numbers.
        meaning: In words.
        dtype: Type of its numbers.
        codes: Meanings of numbers that are codes.
        key: Name of the dataset.
        written: Kept in files.
        required: Known in every record; others are None, in older files or where nothing computes them.
        spread_of: Array that this one holds standard deviations of.
        offset_of: Standard deviations of which this one holds the part that repeats in the same posture.
        change_of: Standard deviations of which this one holds the change of that part within the trial.
        column: Place in an OpenSim table.
        plot: Curve in viewers.
        section: Label of the section of the documentation that explains it.
    """

    axes: tuple[str, ...]
    unit: Unit
    meaning: str
    name: str = ""
    dtype: type = np.float64
    codes: Mapping[int, str] = field(default_factory=dict)
    key: str = ""
    written: bool = True
    required: bool = True
    spread_of: str = ""
    offset_of: str = ""
    change_of: str = ""
    column: Column | None = None
    plot: Plot | None = None
    section: str = ""

    @property
    def is_text(self) -> bool:
        """True for names and remarks, False for numbers."""
        return self.dtype is str

    @property
    def beside(self) -> str:
        """The array that a standard deviation belongs to, or the standard deviations that a part belongs to."""
        return self.spread_of or self.offset_of or self.change_of


class Attribute(NamedTuple):
    """A declared value other than an array.

    Attributes:
        name: Name of the field.
        meaning: In words.
        read: Makes it of what a file holds: str, bool, int or float; others read JSON.
    """

    name: str
    meaning: str
    read: Callable[[str], object]


def quantity(
    axes: str,
    unit: Unit,
    meaning: str,
    default: T = _REQUIRED,
    *,
    dtype: type = np.float64,
    codes: Mapping[int, str] | None = None,
    key: str = "",
    written: bool = True,
    column: Column | None = None,
    plot: Plot | None = None,
    section: str = "",
) -> T:
    """The field of a declared array.

    Args:
        axes: Names of its axes, e.g. "time foot xyz".
        unit: Unit of its numbers.
        meaning: In words.
        default: None for what not every record has, :data:`LATER` for what older files lack.
        dtype: Type of its numbers.
        codes: Meanings of numbers that are codes.
        key: Name of the dataset, where it is not the field's.
        written: Kept in files.
        column: Place in an OpenSim table.
        plot: Curve in viewers.
        section: Label of the section of the documentation that explains it.
    """
    declared = Quantity(
        tuple(axes.split()),
        unit,
        meaning,
        dtype=np.int64 if codes else dtype,
        codes=codes or {},
        key=key,
        written=written,
        required=default is MISSING,
        column=column,
        plot=plot,
        section=section,
    )
    return field(default=default, metadata={_QUANTITY: declared})


def flag(axes: str, meaning: str, default: T = _REQUIRED, *, section: str = "") -> T:
    """The field of an array of flags.

    Args:
        axes: Names of its axes.
        meaning: In words, of True.
        default: None for what not every record has.
        section: Label of the section of the documentation that explains it.
    """
    return quantity(axes, ONE, meaning, default, dtype=np.bool_, section=section)


def spread(of: str, default: T = _REQUIRED, *, axes: str = "", unit: Unit | None = None) -> T:
    """The field of standard deviations.

    Args:
        of: The array that they belong to.
        default: None for what not every record has.
        axes: Their axes, where they are not the array's.
        unit: Their unit, where it is not the array's.
    """
    declared = Quantity(
        tuple(axes.split()),
        unit or Unit(""),
        f"standard deviations (1 sd) of the whole error of {of}, NaN where not known",
        required=default is MISSING,
        spread_of=of,
    )
    return field(default=default, metadata={_QUANTITY: declared})


def offset(of: str, default: T = _ABSENT) -> T:
    """The field of the part of standard deviations that repeats in the same posture; 0 where a record lacks it."""
    meaning = f"part of {of} that repeats in the same posture, because the body is not known exactly"
    declared = Quantity((), Unit(""), meaning, required=False, offset_of=of, section="what-an-interval-means")
    return field(default=default, metadata={_QUANTITY: declared})


def change(of: str, default: T = _ABSENT, *, written: bool = True) -> T:
    """The field of the change of that part with the posture, about its trial mean; 0 where a record lacks it.

    Args:
        of: The standard deviations.
        default: None for what not every record has.
        written: Kept in files.
    """
    meaning = f"change within the trial of the part of {of} that repeats in the same posture, about its mean"
    declared = Quantity(
        (),
        Unit(""),
        meaning,
        dtype=np.float32,
        written=written,
        required=False,
        change_of=of,
        section="what-an-interval-means",
    )
    return field(default=default, metadata={_QUANTITY: declared})


def texts(meaning: str, default: T = _REQUIRED, *, axis: str = "", key: str = "") -> T:
    """The field of a list of names or remarks.

    Args:
        meaning: In words.
        default: () for what not every record has; names of an axis are numbers then.
        axis: The axis that it labels.
        key: Name of the dataset, where it is not the field's.
    """
    declared = Quantity(
        (axis,) if axis else (), Unit(""), meaning, dtype=str, key=key, required=default is MISSING
    )
    return field(default=default, metadata={_QUANTITY: declared})


def attribute(
    meaning: str,
    default: T = _REQUIRED,
    *,
    read: Callable[[str], object] = str,
    factory: Callable[[], T] | None = None,
) -> T:
    """The field of a value other than an array.

    Args:
        meaning: In words.
        default: Its value in older files.
        read: Makes it of what a file holds: str, bool, int or float; others read JSON.
        factory: Makes the default, where that can be changed.
    """
    declared = {_ATTRIBUTE: Attribute("", meaning, read)}
    if factory is not None:
        return field(default_factory=factory, metadata=declared)
    return field(default=default, metadata=declared)


@cache
def quantities(record: type) -> Mapping[str, Quantity]:
    """Declared arrays and lists of a record's type by name, in the order of its fields."""
    found: dict[str, Quantity] = {}
    for held in fields(record):
        if _QUANTITY in held.metadata:
            declared: Quantity = held.metadata[_QUANTITY]
            found[held.name] = replace(declared, name=held.name, key=declared.key or held.name)
    for name, one in found.items():  # a spread stands after its array
        total = found.get(one.beside)
        if total is not None:
            axes, unit = one.axes or total.axes, one.unit if one.unit.text else total.unit
            found[name] = replace(one, axes=axes, unit=unit)
    return MappingProxyType(found)


@cache
def attributes(record: type) -> tuple[Attribute, ...]:
    """Declared values of a record's type that are no arrays."""
    return tuple(
        one.metadata[_ATTRIBUTE]._replace(name=one.name)
        for one in fields(record)
        if _ATTRIBUTE in one.metadata
    )


def check(record: object) -> None:
    """Makes every declared array of a new record a read-only one of its type, and lists tuples.

    Offsets and changes that are missing become 0, other arrays that older files lack NaN, missing names of an axis
    numbers from 1.

    Raises:
        ShapeError: The sizes of two arrays, or of an array and the names of its axis, differ.
    """
    kind: type = type(record)
    declared = quantities(kind)
    sizes = {name: len(axis.labels) for name, axis in AXES.items() if axis.labels}
    sizes["time"] = len(getattr(record, AXES["time"].names))
    for name, one in declared.items():
        value = getattr(record, name)
        if one.is_text:
            object.__setattr__(record, name, tuple(value))
            if one.axes and (one.required or value):
                sizes[one.axes[0]] = len(value)
        elif (one.offset_of or one.change_of) and value is None:
            total = getattr(record, one.beside)
            zero = None if total is None else np.where(np.isnan(total), np.nan, 0.0)
            object.__setattr__(record, name, zero)
    for name, one in declared.items():
        value = getattr(record, name)
        if one.is_text or value is None:
            continue
        if value is LATER:
            value = unknown(one, sizes)
        array = read_only(value, dtype=one.dtype)
        wanted = [sizes.setdefault(axis, n) for axis, n in zip(one.axes, array.shape, strict=False)]
        if len(one.axes) != array.ndim or tuple(wanted) != array.shape:
            raise ShapeError(name, _described(one.axes, sizes), array.shape)
        object.__setattr__(record, name, array)
    for name, one in declared.items():
        if one.is_text and one.axes and not getattr(record, name):
            object.__setattr__(record, name, numbered(sizes.get(one.axes[0], 0)))


def unknown(one: Quantity, sizes: Mapping[str, int]) -> Array:
    """A quantity of which nothing is known.

    Args:
        one: Its declaration.
        sizes: Sizes of the axes that have other ones in every trial.
    """
    return np.full(shape_of(one.axes, sizes), np.nan)


def _described(axes: Sequence[str], sizes: Mapping[str, int]) -> str:
    return f"({', '.join(str(sizes.get(axis, AXES[axis].symbol)) for axis in axes)})"
