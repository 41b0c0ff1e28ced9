"""Streams that are found in the network now, for a choice before one is followed."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType

from mbkf.stream.libraries import lsl
from mbkf.stream.lsl.format import MARKER_TYPES, StreamInfo

LOOK_S = 1.5
"""Streams of other computers answer within a second."""


@dataclass(frozen=True)
class FoundStream:
    """A stream of markers in the network.

    Attributes:
        name: By which it is followed.
        host: The computer that sends it.
        rate_hz: Its stated frame rate; 0 where it states none.
    """

    name: str
    host: str
    rate_hz: float


def marker_streams(timeout_s: float = LOOK_S) -> tuple[FoundStream, ...]:
    """The streams of markers that answer in time, in the order of their names.

    Raises:
        MissingDependency: pylsl is not installed.
    """
    found = streams_of(lsl(), MARKER_TYPES, timeout_s)
    return tuple(FoundStream(one.name(), one.hostname(), float(one.nominal_srate())) for one in found)


def streams_of(library: ModuleType, types: tuple[str, ...], timeout_s: float) -> list[StreamInfo]:
    """The streams of some types that answer in time, in the order of their names.

    Args:
        library: pylsl.
        types: In lower case.
        timeout_s: How long to listen.
    """
    found = [stream for stream in library.resolve_streams(timeout_s) if stream.type().lower() in types]
    return sorted(found, key=lambda stream: str(stream.name()))
