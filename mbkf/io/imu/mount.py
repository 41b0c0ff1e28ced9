"""Places of inertial sensors on a body, as a TOML file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import InvalidInput
from mbkf.io.plain_data import read_toml
from mbkf.io.toml import one_line_errors, write_toml

FARTHEST_M, LONGEST = 3.0, 1e6
"""Largest coordinate of a sensor in its segment, and of a quaternion before it is normalised."""


@dataclass(frozen=True)
class ImuMount:
    """One sensor on a segment.

    Attributes:
        name: Sensor name, as in its readings.
        segment: Segment that carries it.
        position_m: (3,) in the segment's frame, m.
        rotation: (4,) unit quaternion (x, y, z, w), sensor → segment.
    """

    name: str
    segment: str
    position_m: Array
    rotation: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "position_m", read_only(self.position_m))
        rotation = np.asarray(self.rotation, dtype=float)
        far = rotation.shape != (4,) or not (np.abs(rotation) <= LONGEST).all()
        size = 0.0 if far else float(np.sqrt((rotation * rotation).sum()))
        if self.position_m.shape != (3,) or not size > 0.5:
            raise InvalidInput(
                f"sensor {self.name}: a position of three and a quaternion of four numbers are needed"
            )
        if not (np.abs(self.position_m) <= FARTHEST_M).all():
            raise InvalidInput(
                f"sensor {self.name}: its position lies more than {FARTHEST_M:g} m from its segment's origin"
            )
        object.__setattr__(self, "rotation", read_only(rotation / size))


def write_mounts(mounts: Sequence[ImuMount], path: str | Path) -> None:
    """Writes mounts, whole or not at all.

    Raises:
        OSError: The file cannot be written.
    """
    entries = [
        {"name": one.name, "segment": one.segment, "position_m": one.position_m, "rotation": one.rotation}
        for one in mounts
    ]
    frames = "positions in the segment's frame, quaternions sensor -> segment (x, y, z, w)"
    write_toml(path, f"Inertial sensors on a body, written by mbkf; {frames}.", {"imu": entries})


def read_mounts(path: str | Path) -> tuple[ImuMount, ...]:
    """Reads a file of :func:`write_mounts`.

    Raises:
        FileFormatError: The file is missing or lacks an entry.
        InvalidInput: A place is impossible.
    """
    source = Path(path)
    with one_line_errors(
        source, "a file of sensor mounts", "'mbkf imu synth' and 'mbkf imu angles' write one"
    ):
        return tuple(
            ImuMount(
                entry["name"],
                entry["segment"],
                np.array(entry["position_m"], dtype=float),
                np.array(entry["rotation"], dtype=float),
            )
            for entry in read_toml(source)["imu"]
        )
