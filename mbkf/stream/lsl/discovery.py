"""Streams of markers that are found in the network now, for a choice before one is followed."""

from __future__ import annotations

from contextlib import closing, suppress

from mbkf.errors import MbkfError
from mbkf.stream.found import FoundStream
from mbkf.stream.libraries import lsl
from mbkf.stream.lsl.format import MARKER_TYPES, StreamInfo
from mbkf.stream.lsl.inlets import streams_of
from mbkf.stream.lsl.source import LslSource

DESCRIBED_S = 0.5
"""A stream that was found describes itself within this time."""


def marker_streams(timeout_s: float) -> list[FoundStream]:
    """The streams of markers that answer in time, in the order of their names.

    Raises:
        MissingDependency: pylsl is not installed.
    """
    return [_found(one) for one in streams_of(lsl(), MARKER_TYPES, timeout_s)]


def _found(info: StreamInfo) -> FoundStream:
    stream, name = None, str(info.name())
    with suppress(MbkfError), closing(LslSource(name)) as source:  # its format is not read
        stream = source.connect(DESCRIBED_S)
    return FoundStream("lsl", name, str(info.hostname()), "", {"stream": name}).described(stream)
