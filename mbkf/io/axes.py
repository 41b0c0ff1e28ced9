"""Axes and length units of files: how their numbers become metres in mbkf's z-up world."""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array, BoolArray
from mbkf.errors import InvalidInput, UnknownName
from mbkf.numerics.percentiles import known_percentiles
from mbkf.numerics.runs import spread_indices

METRES_PER_UNIT = {"mm": 1e-3, "cm": 1e-2, "dm": 1e-1, "m": 1.0, "in": 0.0254, "ft": 0.3048}
"""Length units a file may state, and their size in metres."""

UNIT_SPELLINGS = {
    "millimeter": "mm", "millimeters": "mm", "millimetre": "mm", "millimetres": "mm",
    "centimeter": "cm", "centimeters": "cm", "centimetre": "cm", "centimetres": "cm",
    "meter": "m", "meters": "m", "metre": "m", "metres": "m",
    "inch": "in", "inches": "in", "foot": "ft", "feet": "ft",
}  # fmt: skip
"""Longer spellings of the same units."""

WORLD_AXES = {
    "z": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "-z": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "y": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "-y": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "x": ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
    "-x": ((0, 1, 0), (0, 0, -1), (-1, 0, 0)),
}
"""World x, y and z expressed in the file's axes, for each axis of the file that may point up."""

BODY_EXTENT_M = (0.3, 30.0)
"""A person's markers spread over more than the first and less than the second length."""

ODD_EXTENT_M = 8.0
"""One person's markers hardly spread over more than this; worth a remark, no error."""

_CHECKED_FRAMES = 200
_LEAST_LETTERS = 4


def up_axis(name: str) -> str:
    """The canonical name of an axis, ``"y"`` for ``"+Y"``.

    Raises:
        UnknownName: It names no axis.
    """
    axis = name.strip().lower().removeprefix("+")
    if axis not in WORLD_AXES:
        raise UnknownName("up axis", name, WORLD_AXES)
    return axis


def rotation_to_world(up: str) -> Array:
    """Rotation (3, 3) R with ``p_world = R @ p_file``, for the axis of the file that points up.

    For a file with z up it is the identity, for y up (OpenSim) file x → x, file −z → y, file y → z.

    Raises:
        UnknownName: ``up`` names no axis.
    """
    return np.array(WORLD_AXES[up_axis(up)], dtype=np.float64)


def axes_matrix(axes: str) -> Array:
    """Matrix (3, 3) A with ``p_world = A @ p_file`` of stored axes that point forward, left and up.

    It is a signed permutation, ``"x,-z,y"`` for OpenSim's axes; its determinant is −1 where the file is mirrored.

    Raises:
        InvalidInput: These are not three different axes.
    """
    words = [word.strip().lower().removeprefix("+") for word in axes.split(",")]
    if len(words) != 3 or any(word not in WORLD_AXES for word in words) or len({w[-1] for w in words}) != 3:
        raise InvalidInput(
            f"axes '{axes}': name the stored axes that point forward, left and up, for example x,-z,y"
        )
    matrix = np.zeros((3, 3))
    for row, word in zip(matrix, words, strict=True):
        row["xyz".index(word[-1])] = -1.0 if word.startswith("-") else 1.0
    return matrix


def axes_text(matrix: Array) -> str:
    """The text that :func:`axes_matrix` reads, of a signed permutation (3, 3)."""
    return ",".join(nearest_axis(row) for row in matrix)


def nearest_axis(direction: Array) -> str:
    """Name of the axis that a direction (3,) is nearest to, ``"-y"`` for (0.1, −0.9, 0.2)."""
    axis = int(np.argmax(np.abs(direction)))
    return ("-" if direction[axis] < 0.0 else "") + "xyz"[axis]


def vertical_of(up: str | None, axes: str | None) -> str | None:
    """Axis of a file that points up, as ``up`` or ``axes`` name it; None where neither does.

    Raises:
        InvalidInput: They contradict each other, or ``axes`` name no axes.
        UnknownName: ``up`` names no axis.
    """
    if axes is None:
        return up
    vertical = nearest_axis(axes_matrix(axes)[2])
    if up is not None and up_axis(up) != vertical:
        raise InvalidInput(
            f"up axis '{up}' contradicts axes '{axes}', in which {vertical} points up; give one"
        )
    return vertical


def length_unit(name: str) -> str:
    """The canonical short name of a length unit, ``"mm"`` for ``"Millimeters"``.

    Raises:
        UnknownName: It is not a known unit of length.
    """
    word = name.strip().lower()
    word = UNIT_SPELLINGS.get(word) or UNIT_SPELLINGS.get(_completed(word), word)
    if word not in METRES_PER_UNIT:
        raise UnknownName("length unit", name, METRES_PER_UNIT)
    return word


def _completed(word: str) -> str:
    """A longer spelling of which a word is the beginning, as programs cut it at four letters; else the word."""
    begun = [one for one in UNIT_SPELLINGS if one.startswith(word)] if len(word) >= _LEAST_LETTERS else []
    return begun[0] if begun and len({UNIT_SPELLINGS[one] for one in begun}) == 1 else word


def finite(values: Array) -> BoolArray:
    """True where all components along the last axis are finite; shape of ``values`` without that axis."""
    return np.asarray(np.isfinite(values).all(axis=-1))


def positions_to_world(values: Array, present: BoolArray, up: str, unit: str) -> Array:
    """(T, M, 3) marker positions of a file in metres and world axes, NaN where missing.

    Args:
        values: (T, M, 3) coordinates in the file's axes and unit.
        present: (T, M) the file holds a measurement there; exact (0, 0, 0) never counts as one.
        up: Axis of the file that points up.
        unit: Length unit of the values.

    Raises:
        UnknownName: Unknown axis or unit.
    """
    seen = present & finite(values) & (values != 0.0).any(axis=2)
    with np.errstate(all="ignore"):  # missing points may be any number, or NaN
        metres = values @ rotation_to_world(up).T * METRES_PER_UNIT[length_unit(unit)]
    return np.where(seen[:, :, None], metres, np.nan)


def body_extent_m(positions_m: Array) -> float:
    """Spread of a capture's markers (T, M, 3) at one instant, m; NaN where no frame has four markers.

    The longest side of the box around the markers of a frame without the outermost tenth on either side
    (ghosts), median over up to 200 frames spread over the trial; all markers where fewer than ten are seen.
    """
    points = positions_m[spread_indices(len(positions_m), _CHECKED_FRAMES)]
    seen = np.asarray(~np.isnan(points).any(axis=2))
    count = seen.sum(axis=1)
    known = np.where(seen[:, :, None], points, np.nan)[count >= 4]
    least, low, high, most = known_percentiles(known.swapaxes(0, 1), (0.0, 10.0, 90.0, 100.0))
    sides = np.where((count[count >= 4] >= 10)[:, None], high - low, most - least)
    return float(np.median(sides.max(axis=1))) if len(sides) else float("nan")


def check_body_size(positions_m: Array, unit: str, where: str) -> tuple[str, ...]:
    """Refuses markers that spread as no body does, which means that the unit is wrong; remarks on an odd spread.

    Args:
        positions_m: (T, M, 3) positions in m.
        unit: The length unit they were read with, for the message.
        where: The file, for the message.

    Raises:
        InvalidInput: The markers spread over less than 0.3 m or more than 30 m.
    """
    extent = body_extent_m(positions_m)
    low, high = BODY_EXTENT_M
    if extent < low or extent > high:
        raise InvalidInput(
            f"{where}: read in {unit}, the markers spread over {extent:.3g} m, unlike any person; "
            "give the right unit with --unit (mm, cm or m)"
        )
    if extent > ODD_EXTENT_M:
        return (f"markers spread over {extent:.1f} m at one instant: several people, or not in {unit}",)
    return ()
