"""Faults of the streams, shared ones and those of a protocol's own messages; the same from the same seed."""

from __future__ import annotations

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

FAULTS: dict[str, dict[str, Fault]] = {"udp": SHARED | UDP}
"""Faults by protocol and name."""
