"""C3D files made byte by byte for tests, in the formats of all three processors; independent of reader and writer."""

from __future__ import annotations

import struct

import numpy as np

INTEL, DEC, MIPS = 84, 85, 86
GROUPS = ("POINT", "ANALOG", "TRIAL", "FORCE_PLATFORM")


def integers(values, processor):
    return np.asarray(values).astype(">i2" if processor == MIPS else "<i2").tobytes()


def floats(values, processor):
    flat = np.asarray(values, dtype=np.float32).ravel()
    if processor == INTEL:
        return flat.astype("<f4").tobytes()
    if processor == MIPS:
        return flat.astype(">f4").tobytes()
    words = (flat * 4.0).astype(np.float32).view(np.uint32)
    return np.stack([words >> 16, words & 0xFFFF], axis=1).astype("<u2").tobytes()


def parameter(number, name, kind, shape, data, processor):
    order = ">" if processor == MIPS else "<"
    body = struct.pack(f"bB{len(shape)}B", kind, len(shape), *shape) + data
    head = struct.pack("bb", len(name), number) + name.encode()
    return head + struct.pack(f"{order}H", len(body) + 3) + body + b"\0"


def group(number, name, processor):
    order = ">" if processor == MIPS else "<"
    return struct.pack("bb", len(name), -number) + name.encode() + struct.pack(f"{order}H", 3) + b"\0"


def c3d_bytes(
    points,
    analogs=None,
    *,
    processor=INTEL,
    scale=None,
    offset=0,
    gain=1.0,
    extra=(),
    seen=None,
    header_analogs=None,
    first=1,
    last=None,
    events=(),
    without=(),
    rate_hz=100.0,
):
    """A file of points (T, N, 3) and analog samples (T, samples per frame, C).

    scale: of integer points; None for floats. offset: of all channels; gain: of all or each. extra: records of the
    GROUPS, counted from 1, as (number, name, kind, shape, data). seen: (T, N). header_analogs: what the header counts
    instead of the truth. without: names of ANALOG that are left out.
    """
    frames, count, _ = points.shape
    samples = np.zeros((frames, 0, 0)) if analogs is None else analogs
    per_frame, channels = samples.shape[1:]
    quad = np.zeros((frames, count, 4))
    quad[:, :, :3] = points if scale is None else np.round(points / scale)
    quad[:, :, 3] = 0.0 if seen is None else np.where(seen, 0.0, -1.0)
    numbers = np.hstack([quad.reshape(frames, -1), (samples / gain + offset).reshape(frames, -1)])
    data = floats(numbers, processor) if scale is None else integers(np.round(numbers) % 65536, processor)
    records = [group(k, name, processor) for k, name in enumerate(GROUPS, start=1)]
    own = [
        (1, "USED", 2, (), integers([count], processor)),
        (1, "SCALE", 4, (), floats([-1.0 if scale is None else scale], processor)),
        (1, "RATE", 4, (), floats([rate_hz], processor)),
        (1, "UNITS", -1, (2,), b"mm"),
        (1, "LABELS", -1, (4, count), b"".join(f"M{k}".ljust(4).encode() for k in range(count))),
        (2, "USED", 2, (), integers([channels], processor)),
        (2, "RATE", 4, (), floats([rate_hz * per_frame], processor)),
        (2, "GEN_SCALE", 4, (), floats([1.0], processor)),
        (2, "SCALE", 4, (channels,), floats(np.full(channels, gain), processor)),
        (2, "OFFSET", 2, (channels,), integers(np.full(channels, offset) % 65536, processor)),
        *extra,
    ]
    records += [parameter(*one, processor) for one in own if not (one[0] == 2 and one[1] in without)]
    body = b"".join(records)
    blocks = -(-(len(body) + 6) // 512)
    section = (bytes([1, 0x50, blocks, processor]) + body).ljust(512 * blocks, b"\0")
    counted = per_frame * channels if header_analogs is None else header_analogs
    ends = min(first + frames - 1, 65535) if last is None else last
    header = bytearray(512)
    header[:2] = bytes([2, 0x50])
    header[2:12] = integers(np.array([count, counted, first, ends, 0]) % 65536, processor)
    header[12:16] = floats([-1.0 if scale is None else scale], processor)
    header[16:20] = integers([2 + blocks, per_frame], processor)
    header[20:24] = floats([rate_hz], processor)
    if events:
        header[298:302] = integers([12345, len(events)], processor)
        header[304 : 304 + 4 * len(events)] = floats([time for _, time in events], processor)
        for k, (label, _) in enumerate(events):
            header[396 + 4 * k : 400 + 4 * k] = label.ljust(4).encode()
    return bytes(header) + section + data.ljust(-(-len(data) // 512) * 512, b"\0")
