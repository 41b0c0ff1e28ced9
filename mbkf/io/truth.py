"""The exact truth behind a synthetic capture, as one HDF5 file, ``truth.h5``."""

from __future__ import annotations

import json
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from mbkf.conventions import Array
from mbkf.errors import FileFormatError, ShapeError
from mbkf.io.atomic import replacing
from mbkf.io.dimensions import ACCELERATION, CONFIGURATION, FORCE, METRE, RATE, SECOND, WRENCH
from mbkf.io.files_read import check_input
from mbkf.io.hdf5 import DAMAGED, USER_BLOCK, check_seal, sealed
from mbkf.io.quantities import attribute, check, quantity, texts
from mbkf.io.quantities_h5 import read_record, write_record

FORMAT = "mbkf truth"
FORMAT_VERSION = 1

_EMPTY: Any = None
"""Loads on no parts, as the constructor makes them."""


@dataclass(frozen=True, kw_only=True)
class Truth:
    """The exact motion behind a synthetic capture."""

    times_s: Array = quantity("time", SECOND, "times of the camera frames")
    dof_names: tuple[str, ...] = texts("degrees of freedom of the tangent space", axis="dof")
    configuration_names: tuple[str, ...] = texts("numbers of the configuration", (), axis="configuration")
    q: Array = quantity("time configuration", CONFIGURATION, "configuration")
    v: Array = quantity("time dof", RATE, "velocity in the tangent space")
    a: Array = quantity("time dof", ACCELERATION, "acceleration in the tangent space")
    tau: Array = quantity("time dof", FORCE, "generalised forces; those of the root are 0")
    foot_wrench: Array = quantity(
        "time foot wrench", WRENCH, "force and moment of the ground on the foot's segment"
    )
    centre_of_pressure: Array = quantity("time foot xyz", METRE, "on the floor, NaN for a foot without load")
    marker_names: tuple[str, ...] = texts("markers", axis="marker")
    markers_m: Array = quantity(
        "time marker xyz", METRE, "true marker positions without camera noise and skin artefact"
    )
    support_names: tuple[str, ...] = texts(
        "parts of the body that bear load besides the feet, see mbkf.synthesis.support.SEGMENTS",
        (),
        axis="part",
    )
    support_wrench: Array = quantity(
        "time part wrench",
        WRENCH,
        "force and moment on the segments of these parts, 0 without contact",
        _EMPTY,
    )
    version: str = attribute("version of mbkf that made it", "")
    settings: dict[str, object] = attribute("motion, seed and noise", read=json.loads, factory=dict)

    def __post_init__(self) -> None:
        """Checks the arrays.

        Raises:
            ShapeError: The sizes of two arrays differ.
        """
        if not self.support_names:
            object.__setattr__(self, "support_wrench", np.zeros((len(self.times_s), 0, 6)))
        check(self)


def write_truth(truth: Truth, path: str | Path) -> None:
    """Writes a truth, whole or not at all.

    Raises:
        OSError: The file cannot be written.
    """
    import h5py

    made = BytesIO()
    with h5py.File(made, "w", userblock_size=USER_BLOCK) as file:
        file.attrs["format"] = FORMAT
        file.attrs["format_version"] = FORMAT_VERSION
        file.attrs["axes"] = "x forward, y left, z up; forces are those of the ground on the body"
        write_record(file, truth)
    with replacing(path) as partial:
        partial.write_bytes(sealed(made))


def read_truth(path: str | Path) -> Truth:
    """Reads a file of :func:`write_truth`.

    Raises:
        FileFormatError: The file is missing, damaged or something else.
    """
    import h5py

    source = Path(path)
    check_input(source, "make it with 'mbkf synth'")
    try:
        check_seal(source)
        with h5py.File(source, "r") as file:
            if file.attrs.get("format") != FORMAT:
                raise FileFormatError(source, "not a truth file; make it with 'mbkf synth'")
            return Truth(**read_record(file, Truth))
    except FileFormatError:
        raise
    except (*DAMAGED, ShapeError) as error:
        raise FileFormatError(source, f"damaged ({error})") from error
