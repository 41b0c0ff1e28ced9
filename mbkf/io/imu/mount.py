"""Where inertial sensors sit on a body, as a TOML file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.atomic import replacing
from mbkf.io.plain_data import read_toml

FARTHEST_M, LONGEST = 3.0, 1e6
"""No sensor sits further from the origin of its segment, and no quaternion is so far from length one."""


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
    lines = [
        "# Inertial sensors on a body; positions in the segment's frame, quaternions sensor -> segment (x, y, z, w)."
    ]
    for mount in mounts:
        position = ", ".join(repr(float(x)) for x in mount.position_m)
        rotation = ", ".join(repr(float(x)) for x in mount.rotation)
        lines += [
            "",
            "[[imu]]",
            f'name = "{mount.name}"',
            f'segment = "{mount.segment}"',
            f"position_m = [{position}]",
            f"rotation = [{rotation}]",
        ]
    with replacing(path) as partial:
        partial.write_text("\n".join(lines) + "\n", encoding="utf-8")


def read_mounts(path: str | Path) -> tuple[ImuMount, ...]:
    """Reads a file of :func:`write_mounts`.

    Raises:
        FileFormatError: The file is missing or lacks an entry.
    """
    source = Path(path)
    try:
        table = read_toml(source)
        return tuple(
            ImuMount(
                entry["name"],
                entry["segment"],
                np.array(entry["position_m"], dtype=float),
                np.array(entry["rotation"], dtype=float),
            )
            for entry in table["imu"]
        )
    except (FileNotFoundError, IsADirectoryError) as error:
        raise FileFormatError(
            source, "no such file; 'mbkf imu synth' and 'mbkf imu angles' write one"
        ) from error
    except InvalidInput as error:
        raise FileFormatError(source, str(error)) from error
    except (KeyError, TypeError, ValueError) as error:
        raise FileFormatError(source, f"not a file of sensor mounts ({error})") from error
