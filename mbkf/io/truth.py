"""The exact truth behind a synthetic capture, as one HDF5 file, ``truth.h5``."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import FileFormatError, ShapeError
from mbkf.io.atomic import replacing
from mbkf.io.hdf5 import DAMAGED, USER_BLOCK, array, check_seal, sealed

FORMAT = "mbkf truth"
FORMAT_VERSION = 1

UNITS = {
    "times_s": "s", "q": "m, unit quaternions (x, y, z, w), rad", "v": "m/s, rad/s", "a": "m/s^2, rad/s^2",
    "tau": "N, N m", "foot_wrench": "N, N m about the world origin, right then left", "centre_of_pressure": "m",
    "markers_m": "m", "support_wrench": "N, N m about the world origin, in the order of support_names",
}  # fmt: skip
"""Unit of every array, also their list."""

NAMES = ("marker_names", "dof_names", "support_names")
"""Lists of names."""

SINCE_SUPPORTS = ("support_names", "support_wrench")
"""What files of earlier versions do not hold: nothing bore but the feet."""


@dataclass(frozen=True)
class Truth:
    """The exact motion behind a synthetic capture.

    Attributes:
        times_s: (T,) times of the camera frames, s.
        q: (T, nq) configuration.
        v: (T, nv) velocity in the tangent space.
        a: (T, nv) acceleration.
        tau: (T, nv) generalised forces; the pelvis's six are 0.
        foot_wrench: (T, 2, 6) ground on right and left foot segment, N and N m about the world origin.
        centre_of_pressure: (T, 2, 3) on the floor, m; NaN for a foot without load.
        marker_names: M names.
        markers_m: (T, M, 3) true marker positions without camera noise and skin artefact, m.
        dof_names: nv names.
        version: Version of mbkf that made it.
        settings: Plain data: motion, seed and noise.
        support_names: S parts of the body that bear besides the feet, see
            :data:`mbkf.synthesis.support.SEGMENTS`.
        support_wrench: (T, S, 6) on the segments of these parts, N and N m about the world origin; 0 without contact.
    """

    times_s: Array
    q: Array
    v: Array
    a: Array
    tau: Array
    foot_wrench: Array
    centre_of_pressure: Array
    marker_names: tuple[str, ...]
    markers_m: Array
    dof_names: tuple[str, ...]
    version: str = ""
    settings: dict[str, object] = field(default_factory=dict)
    support_names: tuple[str, ...] = ()
    support_wrench: Array = field(default_factory=lambda: np.zeros((0, 0, 6)))

    def __post_init__(self) -> None:
        if not self.support_names:
            object.__setattr__(self, "support_wrench", np.zeros((len(self.times_s), 0, 6)))
        for name in UNITS:
            object.__setattr__(self, name, read_only(getattr(self, name)))
        frames = len(self.times_s)
        expected = {
            "q": (frames, *self.q.shape[1:2]), "v": (frames, len(self.dof_names)), "a": (frames, len(self.dof_names)),
            "tau": (frames, len(self.dof_names)), "foot_wrench": (frames, 2, 6),
            "centre_of_pressure": (frames, 2, 3), "markers_m": (frames, len(self.marker_names), 3),
            "support_wrench": (frames, len(self.support_names), 6),
        }  # fmt: skip
        for name, shape in expected.items():
            if getattr(self, name).shape != shape:
                raise ShapeError(name, str(shape), getattr(self, name).shape)


def write_truth(truth: Truth, path: str | Path) -> None:
    """Writes a truth, whole or not at all.

    Raises:
        OSError: The file cannot be written.
    """
    made = BytesIO()
    with h5py.File(made, "w", userblock_size=USER_BLOCK) as file:
        file.attrs["format"] = FORMAT
        file.attrs["format_version"] = FORMAT_VERSION
        file.attrs["axes"] = "x forward, y left, z up; forces are those of the ground on the body"
        file.attrs["version"] = truth.version
        file.attrs["settings"] = json.dumps(truth.settings)
        for name in NAMES:
            file.create_dataset(name, data=list(getattr(truth, name)), dtype=h5py.string_dtype())
        for name, unit in UNITS.items():
            file.create_dataset(name, data=getattr(truth, name)).attrs["unit"] = unit
    with replacing(path) as partial:
        partial.write_bytes(sealed(made))


def read_truth(path: str | Path) -> Truth:
    """Reads a file of :func:`write_truth`.

    Raises:
        FileFormatError: The file is missing, damaged or something else.
    """
    source = Path(path)
    if not source.is_file():
        raise FileFormatError(source, "no such file; make it with 'mbkf synth'")
    try:
        check_seal(source)
        with h5py.File(source, "r") as file:
            if file.attrs.get("format") != FORMAT:
                raise FileFormatError(source, "not a truth file; make it with 'mbkf synth'")
            known = {name for name in (*UNITS, *NAMES) if name in file or name not in SINCE_SUPPORTS}
            arrays: dict[str, Any] = {name: array(file, name) for name in UNITS if name in known}
            names: dict[str, Any] = {
                name: tuple(text.decode() for text in file[name][:]) for name in NAMES if name in known
            }
            return Truth(
                **arrays,
                **names,
                version=str(file.attrs["version"]),
                settings=json.loads(file.attrs["settings"]),
            )
    except FileFormatError:
        raise
    except (*DAMAGED, ShapeError) as error:
        raise FileFormatError(source, f"damaged ({error})") from error
