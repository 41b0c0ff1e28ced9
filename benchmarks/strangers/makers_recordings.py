"""Further files of makers of inertial sensors, by their published descriptions: logs with settings, and blocks."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from benchmarks.inertial.makers import DEGREES, RATE_HZ, Truth
from mbkf.conventions import GRAVITY_M_S2, Array

_X_IMU_RATE = 128.0
_STAMP = (26 << 26) | (11 << 22) | (26 << 17) | (10 << 12)
_BLOCK_SAMPLES = 40
_COUNTS_PER_G, _RANGE_DEG_S = 2048.0, 1000.0


def mt_manager_ticks(one: Truth, folder: Path) -> Path:
    """An export of MT Manager without a rate in its header: ``SampleTimeFine`` counts 0.1 ms.

    Args:
        one: The sensor.
        folder: Where to write.
    """
    names = [
        "PacketCounter",
        "SampleTimeFine",
        *(f"{kind}_{axis}" for kind in ("Acc", "Gyr", "Mag") for axis in "XYZ"),
    ]
    count = np.arange(len(one.time_s))
    parts = [count + 512, np.round(1e4 * one.time_s) + 70000, one.force, one.turning, one.field]
    head = ["// General information:", "//  MT Manager version: 2022.0", "\t".join(names)]
    return _write(folder / f"MT_0001-000_{one.name}.txt", head, np.column_stack(parts), "\t")


def x_imu(one: Truth, folder: Path) -> Path:
    """A recording of the first x-IMU: calibrated readings at 128 Hz, counted in packets, and the registers.

    Args:
        one: The sensor; readings between its samples are interpolated.
        folder: Where to write.
    """
    times = np.arange(0.0, one.time_s[-1], 1.0 / _X_IMU_RATE)
    force, turning, field = (
        np.column_stack([np.interp(times, one.time_s, values[:, axis]) for axis in range(3)])
        for values in (one.force, one.turning, one.field)
    )
    words = "Gyroscope {} (deg/s)", "Accelerometer {} (g)", "Magnetometer {} (G)"
    names = ["Packet number", *(word.format(axis) for word in words for axis in "XYZ")]
    rows = np.column_stack(
        [113 + 2 * np.arange(len(times)), DEGREES * turning, force / GRAVITY_M_S2, field / 100.0]
    )
    _write(folder / "00033_CalInertialAndMag.csv", [",".join(names)], rows)
    registers = [
        "Packet number,Address,Value,Fixed-point value,Name",
        "70,69,8,NaN,InertialAndMagneticDataRate",
    ]
    (folder / "00033_Registers.csv").write_text("\n".join(registers) + "\n", encoding="utf-8")
    return folder


def cwa(one: Truth, folder: Path) -> Path:
    """A recording of an AX6: blocks of 40 samples of gyroscope and accelerometer in 16 bits, 16 g and 1000 deg/s.

    Args:
        one: The sensor; samples after the last whole block are left out.
        folder: Where to write.
    """
    scales = DEGREES * 32768.0 / _RANGE_DEG_S, _COUNTS_PER_G / GRAVITY_M_S2
    counts = np.hstack([scales[0] * one.turning, scales[1] * one.force])
    counts = np.clip(np.round(counts), -32768, 32767).astype("<i2")
    blocks = counts[: len(counts) // _BLOCK_SAMPLES * _BLOCK_SAMPLES].reshape(-1, _BLOCK_SAMPLES, 6)
    head = b"MD" + struct.pack("<H", 1020) + bytes(1020)
    path = folder / f"{one.name}.cwa"
    path.write_bytes(head + b"".join(_block(k, samples) for k, samples in enumerate(blocks)))
    return path


def _block(number: int, samples: Array) -> bytes:
    """A block whose stamp holds at its first sample; the sum of its words is zero."""
    at_s = number * _BLOCK_SAMPLES / RATE_HZ
    minutes, seconds = divmod(int(at_s), 60)
    parts = int((at_s - int(at_s)) * 32768.0)
    # The sensor's program subtracts the samples of the fraction from the sample that the stamp names.
    offset = -((2 * parts * int(RATE_HZ)) >> 16)
    head = struct.pack(
        "<2sHHIIIHHBBBBhH", b"AX", 508, 0x8000 | parts, 1, number, _STAMP + (minutes << 6) + seconds,
        (3 << 13) | (3 << 10), 0, 0, 0, 0x4A, 6 << 4 | 2, offset, len(samples),
    )  # fmt: skip
    body = (head + samples.tobytes()).ljust(510, b"\0")
    total = int(np.frombuffer(body, "<u2").sum(dtype=np.uint16))
    return body + struct.pack("<H", -total % 65536)


def _write(path: Path, head: list[str], rows: Array, mark: str = ",") -> Path:
    lines = [*head, *(mark.join(repr(float(value)) for value in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path
