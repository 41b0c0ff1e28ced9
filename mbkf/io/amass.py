"""Motions of the AMASS archive: parameters of the body models SMPL, SMPL-H and SMPL-X, without their meshes.

A file is an archive of arrays (.npz): ``poses`` (F, 3 J) rotation vectors of J joints, each in its parent's frame, the
first in the world; ``trans`` (F, 3) translation of the root, m; ``mocap_framerate`` or ``mocap_frame_rate``, Hz. The
first 22 joints are those of the body, in one order in all three models; hands and face come after them. ``betas``,
which give the body's shape through a licensed model, are left alone (docs/references.md, keys ``Mahmood 2019`` and
``Loper 2015``).
"""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np

from mbkf.conventions import Array, read_only
from mbkf.errors import FileFormatError, InvalidInput, ShapeError
from mbkf.io.files_read import check_input, read_bytes

JOINTS = (
    "pelvis", "left_hip", "right_hip", "spine1", "left_knee", "right_knee", "spine2", "left_ankle", "right_ankle",
    "spine3", "left_foot", "right_foot", "neck", "left_collar", "right_collar", "head", "left_shoulder",
    "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist",
)  # fmt: skip
"""The body's joints, in the order of the files."""

PARENTS = (-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19)
"""Place of each joint's parent among :data:`JOINTS`; −1 for the root."""

MOST_BYTES = 1 << 30
"""Size of the largest array that is unpacked: days of motion."""

RATES_HZ = (10.0, 1000.0)
"""Range of the frame rates of motion capture."""

_RATE_KEYS = ("mocap_framerate", "mocap_frame_rate")
_HINT = "name an AMASS file of SMPL, SMPL-H or SMPL-X parameters"


@dataclass(frozen=True)
class SmplMotion:
    """A motion of the SMPL family's skeleton.

    The body at rest stands with its arms to the sides, palms down; its axes are x left, y up, z forward.

    Attributes:
        rate_hz: Frame rate.
        rotations: (F, 22, 3) rotation vectors of :data:`JOINTS` in their parents' frames, the root's in the world, rad.
        trans_m: (F, 3) translation of the root in the world, m.
    """

    rate_hz: float
    rotations: Array
    trans_m: Array

    def __post_init__(self) -> None:
        frames = len(self.rotations)
        for name, shape in (("rotations", (frames, len(JOINTS), 3)), ("trans_m", (frames, 3))):
            array = read_only(getattr(self, name))
            if array.shape != shape:
                raise ShapeError(name, str(shape), array.shape)
            object.__setattr__(self, name, array)
        if not RATES_HZ[0] <= self.rate_hz <= RATES_HZ[1]:
            raise InvalidInput(
                f"a frame rate lies between {RATES_HZ[0]:g} and {RATES_HZ[1]:g} Hz, got {self.rate_hz:g} Hz"
            )


def read_amass(path: str | Path) -> SmplMotion:
    """Reads a motion of AMASS.

    Args:
        path: The file, ``.npz``.

    Raises:
        FileFormatError: The file is missing, damaged, holds no motion or no frame rate, or a number is missing.
    """
    path = Path(path)
    check_input(path, _HINT)
    try:
        arrays = _arrays(path, read_bytes(path, hint=_HINT))
        poses, trans, rate_hz = _poses(path, arrays), _named(path, arrays, "trans"), _rate_hz(path, arrays)
        if poses.ndim != 2 or poses.shape[1] < 3 * len(JOINTS) or poses.shape[1] % 3:
            raise FileFormatError(
                path,
                f"'poses' has shape {poses.shape}; the body's 22 joints take 66 columns or more; {_HINT}",
            )
        if not (np.isfinite(poses).all() and np.isfinite(trans).all()):
            raise FileFormatError(path, "a number of 'poses' or 'trans' is missing; cut the file there")
        rotations = poses[:, : 3 * len(JOINTS)].reshape(len(poses), len(JOINTS), 3)
        return SmplMotion(rate_hz, rotations, trans)
    except (ShapeError, InvalidInput) as error:
        raise FileFormatError(path, f"{error}; {_HINT}") from error


def _arrays(path: Path, content: bytes) -> dict[str, Array]:
    """The arrays that are read here, as floats; members that need Python's own code are never opened."""
    wanted = ("poses", "root_orient", "pose_body", "trans", *_RATE_KEYS)
    try:
        with zipfile.ZipFile(BytesIO(content)) as archive:
            there = {info.filename.removesuffix(".npy"): info for info in archive.infolist()}
            found = {}
            for name in wanted:
                if name not in there:
                    continue
                if there[name].file_size > MOST_BYTES:
                    raise FileFormatError(
                        path, f"'{name}' takes {there[name].file_size} bytes; cut the motion"
                    )
                array = np.load(BytesIO(archive.read(there[name])), allow_pickle=False)
                found[name] = np.asarray(array, dtype=np.float64)
    except FileFormatError:
        raise
    except Exception as error:  # zipfile and NumPy raise a dozen kinds for damaged bytes
        raise FileFormatError(path, f"damaged, or no AMASS file ({error}); {_HINT}") from error
    if "poses" not in found and not {"root_orient", "pose_body"} <= found.keys():
        names = ", ".join(sorted(there)[:8]) or "nothing"
        raise FileFormatError(path, f"holds no 'poses' (found: {names}); {_HINT}, not a shape file")
    return found


def _poses(path: Path, arrays: dict[str, Array]) -> Array:
    """(F, 3 J) poses, or those that SMPL-X files hold in parts."""
    if "poses" in arrays:
        return arrays["poses"]
    parts = arrays["root_orient"], arrays["pose_body"]
    if any(part.ndim != 2 for part in parts) or len(parts[0]) != len(parts[1]):
        raise FileFormatError(path, "'root_orient' and 'pose_body' differ in length; download the file again")
    return np.hstack(parts)


def _named(path: Path, arrays: dict[str, Array], name: str) -> Array:
    if name not in arrays:
        raise FileFormatError(path, f"holds no '{name}'; {_HINT}")
    return arrays[name]


def _rate_hz(path: Path, arrays: dict[str, Array]) -> float:
    for key in _RATE_KEYS:
        if key in arrays and arrays[key].size == 1:
            return float(arrays[key].item())
    raise FileFormatError(
        path, f"states no frame rate ('{_RATE_KEYS[0]}' or '{_RATE_KEYS[1]}', one number); {_HINT}"
    )
