"""Blocks of an AX6 and an AX3, written by the published description, are read in SI units; damaged ones are gaps."""

import struct

import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.imu.files import read_imu

RATE_HZ = 100.0
STAMP = (26 << 26) | (11 << 22) | (26 << 17) | (10 << 12) | (30 << 6)


def block(number, samples, axes, per_block, stamp_s):
    """One block: 16 g at 2048 counts for 1 g, 1000 deg/s; the stamp holds at its first sample.

    The sensor's program subtracts the samples of the fraction from the sample that the stamp names.
    """
    second = int(stamp_s)
    parts = int((stamp_s - second) * 32768.0)
    fraction, offset = 0x8000 | parts, -((2 * parts * int(RATE_HZ)) >> 16)
    scales = (3 << 13) | (3 << 10)
    head = struct.pack(
        "<2sHHIIIHHBBBBhH", b"AX", 508, fraction, 1, number, STAMP + second, scales, 0, 0, 0, 0x4A, axes << 4 | 2,
        offset, per_block,
    )  # fmt: skip
    body = (head + samples.astype("<i2").tobytes()).ljust(510, b"\0")
    total = int(np.frombuffer(body, "<u2").sum(dtype=np.uint16))
    return body + struct.pack("<H", -total % 65536)


def recording(path, axes=6, blocks=10):
    """A recording whose accelerometer counts 2048 along z, and whose gyroscope counts up."""
    per_block = 480 // (2 * axes)
    chunks = []
    for k in range(blocks):
        samples = np.zeros((per_block, axes), dtype=int)
        samples[:, -1] = 2048
        if axes == 6:
            samples[:, 0] = k * per_block + np.arange(per_block)
        chunks.append(block(k, samples, axes, per_block, k * per_block / RATE_HZ))
    path.write_bytes(b"MD" + struct.pack("<H", 1020) + bytes(1020) + b"".join(chunks))
    return per_block * blocks


@pytest.mark.parametrize("axes", [3, 6])
def test_counts_become_si_units_on_a_steady_clock(tmp_path, axes):
    count = recording(tmp_path / "a.cwa", axes)
    (one,) = read_imu(tmp_path / "a.cwa")
    assert (one.name, one.samples, round(one.rate_hz, 2)) == ("a", count, RATE_HZ)
    np.testing.assert_allclose(one.specific_force_mps2[-1], [0.0, 0.0, 9.80665])
    turning = np.degrees(one.angular_velocity_rad_s[:, 0])
    if axes == 6:
        np.testing.assert_allclose(turning, np.arange(count) * 1000.0 / 32768.0)
    else:
        assert np.isnan(turning).all()


def test_a_damaged_block_leaves_a_gap(tmp_path):
    count = recording(tmp_path / "a.cwa")
    content = bytearray((tmp_path / "a.cwa").read_bytes())
    content[1024 + 512 * 4 + 100] ^= 1
    (tmp_path / "a.cwa").write_bytes(content)
    (one,) = read_imu(tmp_path / "a.cwa")
    assert one.samples == count - 40
    assert np.diff(one.time_s).max() == pytest.approx(0.41, abs=0.005)


def test_ten_bits_with_an_exponent(tmp_path):
    recording(tmp_path / "a.cwa", 3)
    content = bytearray((tmp_path / "a.cwa").read_bytes())
    packed = 0b01 << 30 | (128 << 20) | (1023 << 10) | 3  # exponent 1; z 128, y -1, x 3
    for k in range(10):
        start = 1024 + 512 * k
        one = content[start : start + 510]
        one[18:20], one[25], one[28:30] = bytes(2), 0x30, struct.pack("<H", 80)
        one[30:510] = (struct.pack("<I", packed) * 80).ljust(480, b"\0")
        total = int(np.frombuffer(bytes(one), "<u2").sum(dtype=np.uint16))
        content[start : start + 512] = one + struct.pack("<H", -total % 65536)
    (tmp_path / "a.cwa").write_bytes(content)
    (found,) = read_imu(tmp_path / "a.cwa")
    np.testing.assert_allclose(found.specific_force_mps2[0] / 9.80665, [6 / 256, -2 / 256, 1.0])


@pytest.mark.parametrize(
    ("content", "told"), [(b"XX" + bytes(3000), "not MD"), (b"MD" + bytes(3000), "no block")]
)
def test_other_files_are_refused(tmp_path, content, told):
    (tmp_path / "a.cwa").write_bytes(content)
    with pytest.raises(FileFormatError, match=told):
        read_imu(tmp_path / "a.cwa")
