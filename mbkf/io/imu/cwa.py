"""Recordings of Axivity's sensors AX3 and AX6 (.cwa): blocks of 512 bytes with samples in counts.

By the published description (Open Movement, ``cwa.md``) a block states its time, rate, scales and axes: x, y, z of the
accelerometer (AX3), or the gyroscope's before them (AX6), and the magnetometer's behind. Samples are 16-bit numbers,
or three of 10 bits with a common exponent.
"""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, Array
from mbkf.errors import FileFormatError
from mbkf.io.files_read import check_input, read_bytes
from mbkf.io.imu.even_times import even_times
from mbkf.io.imu.readings import ImuReadings
from mbkf.io.imu.signals import Signal, readings_of

_BLOCK = np.dtype(
    [
        ("mark", "S2"), ("length", "<u2"), ("fraction", "<u2"), ("session", "<u4"), ("sequence", "<u4"),
        ("stamp", "<u4"), ("scales", "<u2"), ("temperature", "<u2"), ("events", "u1"), ("battery", "u1"),
        ("rate", "u1"), ("axes", "u1"), ("offset", "<i2"), ("count", "<u2"), ("data", "u1", (480,)),
        ("checksum", "<u2"),
    ]
)  # fmt: skip
_HEADER_BYTES = 1024
_ORDERS = {3: ("acc",), 6: ("gyr", "acc"), 9: ("gyr", "acc", "mag")}
_USUAL_RANGE_DEG_S, _COUNTS_PER_UT = 2000.0, 16.0


def read_cwa(path: Path) -> tuple[ImuReadings, ...]:
    """The sensor of a recording, its times from the first sample's.

    Raises:
        FileFormatError: The file is missing, damaged, or no such recording.
    """
    check_input(path, "name a recording of Axivity (.cwa)")
    content = read_bytes(path)
    if content[:2] != b"MD":
        raise FileFormatError(
            path, "its first bytes are not MD, so it is another kind of file; name a recording of Axivity"
        )
    whole = (len(content) - _HEADER_BYTES) // _BLOCK.itemsize
    blocks = (
        np.frombuffer(content, _BLOCK, max(0, whole), _HEADER_BYTES) if whole > 0 else np.zeros(0, _BLOCK)
    )
    words = blocks.view("<u2").reshape(-1, _BLOCK.itemsize // 2)
    blocks = blocks[(blocks["mark"] == b"AX") & (words.sum(axis=1, dtype=np.uint16) == 0)]
    if not len(blocks):
        raise FileFormatError(path, "no block of samples is whole; export it again")
    first = blocks[0]
    for name in ("rate", "axes"):
        if (blocks[name] != first[name]).any():
            raise FileFormatError(path, "its rate or axes change on the way; export one recording only")
    axes, packing = int(first["axes"]) >> 4, int(first["axes"]) & 15
    per_sample = 2 * axes if packing == 2 else 4
    if axes not in _ORDERS or packing not in (0, 2) or (packing == 0 and axes != 3):
        raise FileFormatError(path, f"{axes} axes in packing {packing} are unknown; export it as CSV")
    if (blocks["count"].astype(int) * per_sample > blocks["data"].shape[1]).any():
        raise FileFormatError(path, "a block counts more samples than it holds; export it again")
    counts = np.concatenate([_counts(block, axes, packing) for block in blocks])
    times = _times(path, blocks, 3200.0 / (1 << (15 - (int(first["rate"]) & 15))))
    scales = _scales(int(first["scales"]))
    signals = [
        Signal("", kind, times, scales[kind] * counts[:, 3 * k : 3 * k + 3])
        for k, kind in enumerate(_ORDERS[axes])
    ]
    return readings_of(path, signals)


def _counts(block: np.void, axes: int, packing: int) -> Array:
    """(n, axes) counts of a block."""
    count = int(block["count"])
    if packing == 2:
        return block["data"][: 2 * axes * count].view("<i2").reshape(count, axes).astype(float)
    packed = block["data"][: 4 * count].view("<u4").astype(np.int64)
    tens = np.stack([(packed >> shift) & 1023 for shift in (0, 10, 20)], axis=1)
    signed = np.where(tens > 511, tens - 1024, tens)
    return np.asarray(signed << (packed >> 30)[:, None], dtype=float)


def _scales(stated: int) -> dict[str, float]:
    """Factors of counts to m/s², rad/s and µT."""
    turning = (stated >> 10) & 7
    largest = 8000.0 / (1 << turning) if turning else _USUAL_RANGE_DEG_S
    return {
        "acc": GRAVITY_M_S2 / (1 << (8 + (stated >> 13))),
        "gyr": np.radians(largest) / 32768.0,
        "mag": 1.0 / _COUNTS_PER_UT,
    }


def _times(path: Path, blocks: np.ndarray, rate_hz: float) -> Array:
    """(T,) s from the first sample: the line through the blocks' stamps, each valid at the sample that it names."""
    starts = np.empty(len(blocks))
    for k, block in enumerate(blocks):
        stamp, parts, offset = int(block["stamp"]), 0, int(block["offset"])
        if block["fraction"] & 0x8000:
            # For readers of whole seconds, the sensor subtracts the fraction's samples from the offset.
            parts = (int(block["fraction"]) & 0x7FFF) << 1
            offset += (parts * int(rate_hz)) >> 16
        starts[k] = _seconds(path, stamp) + parts / 65536.0 - offset / rate_hz
    stamps = [start + np.arange(n) / rate_hz for start, n in zip(starts, blocks["count"], strict=True)]
    return even_times(np.concatenate(stamps) - starts[0])


def _seconds(path: Path, stamp: int) -> float:
    """Seconds since 1970 of years since 2000 (6 bits), month (4), day (5), hour (5), minute (6), second (6)."""
    year, month, day = (stamp >> 26) & 63, (stamp >> 22) & 15, (stamp >> 17) & 31
    hour, minute, second = (stamp >> 12) & 31, (stamp >> 6) & 63, stamp & 63
    try:
        return datetime(2000 + year, month, day, hour, minute, second, tzinfo=UTC).timestamp()
    except ValueError as error:
        raise FileFormatError(path, f"a block's time is damaged ({error}); export it again") from error
