"""A network streamer of MVN that is heard at a port of this computer: it announces itself by sending."""

from __future__ import annotations

from contextlib import closing, suppress
from dataclasses import replace

from mbkf.errors import MbkfError
from mbkf.stream.found import FoundStream
from mbkf.stream.side_by_side import at_own_addresses
from mbkf.stream.xsens.packets import DEFAULT_PORT, POSES
from mbkf.stream.xsens.source import XsensSource


def xsens_streams(local: str, timeout_s: float, port: int = DEFAULT_PORT) -> list[FoundStream]:
    """The streamers that are heard at this computer's addresses, one at each at most.

    Args:
        local: An address of this computer to listen at, beside those of its name.
        timeout_s: How long to listen; a stream describes itself within a second.
        port: The port.
    """

    def listen(address: str) -> FoundStream | None:
        with suppress(MbkfError), closing(XsensSource(port, address)) as source:
            return _heard(source, port, address, timeout_s)
        return None  # another program listens there

    return at_own_addresses(listen, local)


def _heard(source: XsensSource, port: int, address: str, timeout_s: float) -> FoundStream | None:
    """The streamer that a source hears in time; None where none sends."""
    stream = None
    with suppress(MbkfError):  # data of other types only
        stream = source.connect(timeout_s)
    if source.sender is None:
        return None
    place = "" if port == DEFAULT_PORT else str(port)
    found = FoundStream("xsens", "MVN", source.sender, place, {"local": address})
    if stream is None:
        return found
    found, count = replace(found, rate_hz=stream.rate_hz), len(stream.sensors)
    return replace(found, segments=count) if source.kind == POSES else replace(found, sensors=count)
