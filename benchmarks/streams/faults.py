"""Faults of the streams, shared ones and those of a protocol's own messages; the same from the same seed."""

from __future__ import annotations

import struct
from collections.abc import Callable

import numpy as np

from benchmarks.robustness.stream_kinds import KINDS, NATNET, Fault
from benchmarks.robustness.stream_schedule import Schedule

SHARED: dict[str, Fault] = {
    name: kind.fault
    for name, kind in KINDS.items()
    if NATNET in kind.protocols and not name.startswith(("packets", "frames of a stranger", "descriptions"))
}
"""Faults of frames, counts, values, plates and connections, which every protocol may have."""


def _packets(make: Callable[[np.random.Generator], bytes], stranger: bool = False) -> Fault:
    def fault(s: Schedule) -> None:
        for n in range(s.begin, s.end):
            s.packet(n, make(s.rng), stranger)

    return fault


def _garbage(rng: np.random.Generator) -> bytes:
    return rng.bytes(int(rng.integers(1, 2000)))


def _hostile_json(rng: np.random.Generator) -> bytes:
    return (
        b"[" * 60_000,
        b'{"frame": ' + b"9" * 5000 + b"}",
        b'{"frame": 1e400, "markers": {"RASI": [1e400]}}',
        b'{"frame": 5, "markers": {"RASI": [1, 2]}}',
        b'{"frame": 5, "markers": [[1, 2, 3]], "points": "x"}',
        b'{"frame": 5, "forces": [[[1, 2, 3, 4, 5, 6]]], "sample": -1e300}',
        b'{"frame": null, "points": {}}',
        b"null\n\n7\n",
    )[int(rng.integers(0, 8))]


def _half_json(rng: np.random.Generator) -> bytes:
    whole = b'{"frame": 17, "markers": {"RASI": [1.0, 2.0, 3.0], "LASI": [1.0, 2.1, 3.0]}}'
    return whole[: int(rng.integers(1, len(whole) - 1))]


def _foreign_json(rng: np.random.Generator) -> bytes:
    return b'{"frame": %d, "rate": 50, "markers": {"RASI": [0, 0, 0]}}' % int(rng.integers(0, 10**6))


def _described(text: bytes, back: bytes) -> Fault:
    """A description that cannot be right for a while, and the right one again."""

    def fault(s: Schedule) -> None:
        s.packet(s.begin, text)
        s.packet(s.end, back)
        s.whole = False

    return fault


UDP: dict[str, Fault] = {
    "packets of garbage": _packets(_garbage),
    "packets of hostile JSON": _packets(_hostile_json),
    "half packets": _packets(_half_json),
    "frames of a stranger": _packets(_foreign_json, stranger=True),
    "markers renamed for a while": _described(b'{"names": ["x", "y"]}', b'{"names": []}'),
    "unit changes for a while": _described(b'{"unit": "mm"}', b'{"unit": "m"}'),
    "unit that does not exist": _described(b'{"unit": "parsec"}', b'{"unit": "m"}'),
    "rate changes for a while": _described(b'{"rate": 50}', b'{"rate": 100}'),
    "axes change for a while": _described(b'{"up": "y"}', b'{"up": "z"}'),
}


def _half_frame(rng: np.random.Generator) -> bytes:
    """A packet of data that ends in its components."""
    points = struct.pack("<QII", 5, int(rng.integers(0, 10**6)), 1) + struct.pack("<IIIhh", 496, 9, 30, 0, 0)
    return bytes([3]) + points + rng.bytes(int(rng.integers(0, 300)))


def _claims(rng: np.random.Generator) -> bytes:
    """Components whose counts are those of a million things."""
    kind = int(rng.choice([1, 2, 4, 9, 10]))
    return bytes([3]) + struct.pack("<QIIIIII", 5, 7, 1, 24, kind, 10**6, 10**6) + rng.bytes(4)


def _garbage_data(rng: np.random.Generator) -> bytes:
    return bytes([3]) + rng.bytes(int(rng.integers(0, 2000)))


def _any_type(rng: np.random.Generator) -> bytes:
    return bytes([int(rng.choice([0, 1, 2, 4, 5, 6, 8, 99]))]) + rng.bytes(int(rng.integers(0, 200)))


def _acts(first: str, back: str) -> Fault:
    """Two acts of the wire, at the fault's begin and end."""

    def fault(s: Schedule) -> None:
        s.act(s.begin, first)
        s.act(s.end, back)
        s.whole = False

    return fault


def _unreadable(s: Schedule) -> None:
    s.act(s.begin, "forget_size")
    s.whole = False


QUALISYS: dict[str, Fault] = {
    "half packets": _packets(_half_frame),
    "packets that claim a million things": _packets(_claims),
    "packets of garbage": _packets(_garbage_data),
    "packets of any type": _packets(_any_type),
    "labels renamed for a while": _acts("rename", "rename_back"),
    "bytes that are no packet": _unreadable,
}


def _half_object(rng: np.random.Generator) -> bytes:
    """Objects the last of which ends too early."""
    head = struct.pack("<III", 5, 4, int(rng.integers(0, 10**6)))
    cut = struct.pack("<II", int(rng.choice([2, 6, 7, 10, 20])), 500)
    return head + cut + rng.bytes(int(rng.integers(0, 400)))


def _claiming_object(rng: np.random.Generator) -> bytes:
    """Objects whose counts are those of a million things, without a frame."""
    claims = struct.pack("<8I", *[10**6] * 8)
    return struct.pack("<II", int(rng.choice([2, 4, 6, 7, 10, 11, 12, 100004])), len(claims)) + claims


def _garbage_object(rng: np.random.Generator) -> bytes:
    data = rng.bytes(int(rng.integers(0, 900)))
    return struct.pack("<II", int(rng.choice([3, 6, 7, 10, 11, 12])), len(data)) + data


def _foreign_object(rng: np.random.Generator) -> bytes:
    data = rng.bytes(int(rng.integers(0, 200)))
    return struct.pack("<II", int(rng.choice([14, 16, 22, 26, 42, 100003, 99999])), len(data)) + data


VICON: dict[str, Fault] = {
    "half packets": _packets(_half_object),
    "objects that claim a million things": _packets(_claiming_object),
    "objects of garbage": _packets(_garbage_object),
    "objects of other types": _packets(_foreign_object),
    "markers renamed for a while": _acts("rename", "rename_back"),
    "axis that points up changes for a while": _acts("turn_world", "turn_back"),
    "rate stated otherwise for a while": _acts("halve_rate", "rate_back"),
    "bytes that are no packet": _unreadable,
}

FAULTS: dict[str, dict[str, Fault]] = {
    "udp": SHARED | UDP,
    "qualisys": SHARED | QUALISYS,
    "vicon": SHARED | VICON,
}
"""Faults by protocol and name."""
