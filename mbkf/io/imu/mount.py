"""Places of inertial sensors on a body, as a TOML file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import InvalidInput
from mbkf.io import fields
from mbkf.io.toml import Entries, write_toml

FARTHEST_M, LONGEST = 3.0, 1e6
"""Largest coordinate of a sensor in its segment, and of a quaternion before it is normalised."""


_NAME = fields.text("name", "the sensor, as in its readings", required=True)
_SEGMENT = fields.text("segment", "segment that carries it", required=True)
_POSITION = fields.numbers("position_m", "place in the segment's frame", 3, FARTHEST_M, "m", required=True)
_ROTATION = fields.numbers("rotation", "quaternion (x, y, z, w), sensor → segment", 4, LONGEST, required=True)
MOUNT = fields.record("mount", _NAME, _SEGMENT, _POSITION, _ROTATION)
_IMUS = fields.part("imu", "a sensor", "[[imu]]", required=True)
MOUNTS = fields.record("mounts", _IMUS)
"""Entries of a file of mounts."""


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
        UnknownEntry: The file has an entry that mounts do not have.
        FileFormatError: The file is missing or lacks an entry.
        InvalidInput: A place is impossible.
    """
    read = Entries.of_file(
        MOUNTS, path, "a file of sensor mounts", "'mbkf imu synth' and 'mbkf imu angles' write one"
    )
    read.need(_IMUS)
    mounts: dict[str, ImuMount] = {}
    for one in read.list_of_tables(_IMUS, MOUNT) or ():
        name = one.need(_NAME)
        if name in mounts:
            raise one.fault(f"sensor {name} stands twice; keep one of both")
        try:
            mounts[name] = ImuMount(name, one.need(_SEGMENT), one.need(_POSITION), one.need(_ROTATION))
        except InvalidInput as error:
            raise InvalidInput(f"{path}: {error}") from error
    return tuple(mounts.values())
