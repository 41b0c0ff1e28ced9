"""Frames, units and array shapes used everywhere in mbkf, and where its data files lie.

World frame: right-handed, z up; a standing subject facing +x has y to the left.
Units inside: metre, second, kilogram, newton, radian. Files are converted in ``mbkf.io`` only.
Arrays: first axis time, last axis component. A missing sample is NaN, never 0.
Forces are those of the ground on the body. Spatial vectors are (linear, angular), as in Pinocchio.
Quaternions are (x, y, z, w).

Symbols in equations: q configuration, v velocity (tangent space, dimension nv), a acceleration,
k scale factors, P covariance, H measurement Jacobian, R measurement covariance.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

GRAVITY_M_S2 = 9.80665
"""Standard gravity, m/s² (CGPM 1901)."""

SIDES = ("r", "l")
"""Suffixes of right and left, in the order used by every paired array."""

Array = NDArray[np.float64]
"""Floating-point array; its shape stands in the docstring beside its use."""

BoolArray = NDArray[np.bool_]

Int32Array = NDArray[np.int32]
"""Indices as compiled code takes them."""

TomlTable: TypeAlias = dict[str, Any]
"""A table of a TOML file as tomllib reads it; readers check each value that they take."""

JsonTable: TypeAlias = Mapping[str, Any]
"""An object of a JSON file, of this version or an older one; readers check each value that they take."""

READING_KINDS = ("markers", "plates", "law", "other")
"""Kinds of readings whose innovations are stated apart: markers, force plates, Newton's law, all else."""

StageCallback = Callable[[str, int, int], None]
"""Progress callback: name of the stage, items done, items in all."""


def data_folder(kind: str) -> Path:
    """Folder of the data files of one kind, wherever the package is installed.

    Args:
        kind: ``"models"`` or ``"markers"``.

    Returns:
        The folder beside the package in a source tree, inside it in an installed wheel.
    """
    package = Path(__file__).resolve().parent
    inside = package / kind
    return inside if inside.is_dir() else package.parent / kind


def read_only(array: object, dtype: type = np.float64) -> NDArray:
    """A contiguous copy of an array that cannot be written to, or the array itself where it is one already."""
    if type(array) is np.ndarray and array.dtype == dtype:
        flags = array.flags
        if flags.owndata and flags.c_contiguous and not flags.writeable:
            return array
    copy: NDArray = np.array(array, dtype=dtype, copy=True, order="C")
    copy.setflags(write=False)
    return copy
