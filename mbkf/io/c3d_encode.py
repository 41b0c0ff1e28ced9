"""Parameters, points and analog samples as the bytes of a C3D file: floats, Intel byte order.

The header's words end at 65535; longer trials count on in TRIAL:ACTUAL_END_FIELD and POINT:LONG_FRAMES, as other
software does. Lists that outgrow a record go on in LABELS2, LABELS3 … Source: The C3D File Format (c3d.org).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping, Sequence
from typing import cast

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array
from mbkf.errors import InvalidInput
from mbkf.io.c3d_layout import BLOCK_BYTES, LAST_FRAME_OF_HEADER

Value = Sequence[str] | float | int | Array | NDArray[np.int16] | NDArray[np.str_]
"""A parameter: texts (a table of them as an array), or numbers, which are stored as floats but for integers."""

INTEL, KEY = 84, 0x50
PARAMETER_BLOCK = 2

MOST_ENTRIES, MOST_LETTERS, MOST_BYTES = 255, 255, 30000
"""Room of a record: entries of a dimension, letters of a text, and bytes."""

MOST_PARAMETER_BLOCKS = 255


def encoded(
    groups: Mapping[str, Mapping[str, Value]],
    points: Array,
    residuals: Array,
    analogs: Array,
    rate_hz: float,
    first_frame: int,
) -> bytes:
    """A file's bytes.

    Args:
        groups: Parameters by group and name, without those that follow from the data.
        points: (T, N, 3) points in the file's unit.
        residuals: (T, N) fourth numbers: −1 where a point is missing, else its residual in steps of −POINT:SCALE.
        analogs: (C, S) analog channels; S is a multiple of T.
        rate_hz: Frame rate.
        first_frame: Number of the first frame, counted from 1.

    Raises:
        InvalidInput: The parameters do not fit.
    """
    frames, count, _ = points.shape
    channels = len(analogs)
    per_frame = analogs.shape[1] // frames if channels else 0
    numbers = np.zeros((frames, 4 * count + channels * per_frame), dtype="<f4")
    corners = numbers[:, : 4 * count].reshape(frames, count, 4)
    corners[:, :, :3], corners[:, :, 3] = points, residuals
    numbers[:, : 4 * count] = corners.reshape(frames, -1)
    if channels:
        numbers[:, 4 * count :] = analogs.T.reshape(frames, -1)
    counted = _counts(groups, points.shape[:2], channels, (rate_hz, per_frame * rate_hz), first_frame)
    section = _section({**groups, **counted})
    blocks = len(section) // BLOCK_BYTES
    scale = float(cast(float, counted["POINT"]["SCALE"]))
    counts = count, channels, per_frame, first_frame, frames
    header = _header(*counts, PARAMETER_BLOCK + blocks, scale, rate_hz)
    data = numbers.tobytes()
    return header + section + data + bytes(-len(data) % BLOCK_BYTES)


def _counts(
    groups: Mapping[str, Mapping[str, Value]],
    shape: tuple[int, int],
    channels: int,
    rates_hz: tuple[float, float],
    first_frame: int,
) -> dict[str, dict[str, Value]]:
    """The groups that describe the data: parameters so far, completed for so many frames and points, and channels."""
    frames, count = shape
    point: dict[str, Value] = {
        "USED": count,
        "SCALE": -1.0,
        "RATE": rates_hz[0],
        "DATA_START": 0,  # put in when the section's length is known
        "FRAMES": min(frames, LAST_FRAME_OF_HEADER),
        **groups.get("POINT", {}),
    }
    analog: dict[str, Value] = {
        "USED": channels,
        "RATE": rates_hz[1],
        "GEN_SCALE": 1.0,
        "SCALE": np.ones(channels),
        "OFFSET": np.zeros(channels, dtype=np.int16),
        "FORMAT": ["SIGNED"],
        **groups.get("ANALOG", {}),
    }
    counted = {"POINT": point, "ANALOG": analog}
    last = first_frame + frames - 1
    if last > LAST_FRAME_OF_HEADER:
        point["LONG_FRAMES"] = float(frames)
        words = {"ACTUAL_START_FIELD": first_frame, "ACTUAL_END_FIELD": last}
        trial = {
            name: np.array([n % 65536, n // 65536]).astype(np.uint16).view(np.int16)
            for name, n in words.items()
        }
        counted["TRIAL"] = {**groups.get("TRIAL", {}), **trial}
    return counted


def _header(
    points: int,
    channels: int,
    per_frame: int,
    first: int,
    frames: int,
    data_block: int,
    scale: float,
    rate_hz: float,
) -> bytes:
    last = min(first + frames - 1, LAST_FRAME_OF_HEADER)
    known = struct.pack(
        "<BB5HfHHf",
        PARAMETER_BLOCK, KEY, points, channels * per_frame, min(first, LAST_FRAME_OF_HEADER), last, 0, scale,
        data_block, per_frame, rate_hz,
    )  # fmt: skip
    return known + bytes(BLOCK_BYTES - len(known))


def _section(groups: Mapping[str, Mapping[str, Value]]) -> bytes:
    """The parameter section in whole blocks."""
    records: list[bytes] = []
    start_at = 0
    for number, (group, members) in enumerate(groups.items(), start=1):
        records.append(_record(-number, group, b""))
        for name, value in members.items():
            for own, body in _bodies(name, value):
                if (group, own) == ("POINT", "DATA_START"):
                    start_at = len(records)
                records.append(_record(number, own, body))
    length = 4 + sum(map(len, records)) + 2
    blocks = -(-length // BLOCK_BYTES)
    if blocks > MOST_PARAMETER_BLOCKS:
        raise InvalidInput(
            f"{length} bytes of names and parameters; a C3D file holds 130 560: leave some away"
        )
    group_of_start = struct.unpack_from("b", records[start_at], 1)[0]
    body = next(_bodies("DATA_START", PARAMETER_BLOCK + blocks))[1]
    records[start_at] = _record(group_of_start, "DATA_START", body)
    whole = bytes([1, KEY, blocks, INTEL]) + b"".join(records)
    return whole + bytes(blocks * BLOCK_BYTES - len(whole))


def _record(number: int, name: str, body: bytes) -> bytes:
    """A group (negative number) or parameter, with an empty description."""
    letters = name.encode("ascii")
    return struct.pack("bb", len(letters), number) + letters + struct.pack("<H", len(body) + 3) + body + b"\0"


def _bodies(name: str, value: Value) -> Iterator[tuple[str, bytes]]:
    """Name and bytes of a parameter, and of its continuations."""
    if isinstance(value, Sequence):
        words = [word.encode("utf-8", "replace") for word in value]
        length = max([len(word) for word in words], default=0) or 1
        if length > MOST_LETTERS:
            raise InvalidInput(
                f"a text of {name} has {length} letters; a C3D file holds {MOST_LETTERS}: shorten it"
            )
        most = min(MOST_ENTRIES, MOST_BYTES // length)
        for number, at in enumerate(range(0, max(len(words), 1), most), start=1):
            some = words[at : at + most]
            text = b"".join(word.ljust(length) for word in some)
            yield (
                name + (str(number) if number > 1 else ""),
                struct.pack("bBBB", -1, 2, length, len(some)) + text,
            )
        return
    numbers = np.asarray(value)
    if numbers.dtype.kind == "U":
        yield name, _table(numbers)
        return
    if max((*numbers.shape, 0)) > MOST_ENTRIES or 4 * numbers.size > MOST_BYTES:
        raise InvalidInput(
            f"{name} has {numbers.size} numbers; a C3D file holds {MOST_ENTRIES}: leave some away"
        )
    if numbers.dtype.kind in "iu":
        kind, flat = 2, numbers.astype(np.uint16 if numbers.size and numbers.max() > 32767 else np.int16)
    else:
        kind, flat = 4, numbers.astype("<f4")
    shape = struct.pack(f"bB{numbers.ndim}B", kind, numbers.ndim, *numbers.shape)
    yield name, shape + flat.tobytes(order="F")


def _table(words: NDArray[np.str_]) -> bytes:
    """Body of a parameter of texts in rows and columns; in the file, the columns count first."""
    letters = np.char.encode(words, "ascii")
    length = max(letters.dtype.itemsize, 1)
    shape = struct.pack("bBB", -1, words.ndim + 1, length) + bytes(reversed(words.shape))
    return shape + b"".join(word.ljust(length) for word in letters.ravel().tolist())
