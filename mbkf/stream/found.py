"""A stream that was found in the network, with the choices that follow it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from mbkf.stream.source import StreamDescription


@dataclass(frozen=True)
class FoundStream:
    """A stream in the network.

    Attributes:
        kind: Its protocol, as ``--from`` names it.
        name: The name that it states.
        address: Of the computer that sends it.
        place: What follows the kind and a colon in ``--from``; empty for nothing.
        options: Further options by name, without dashes.
        markers: Number of named markers, 0 for points without names; None where it is not known.
        rate_hz: Its frame rate; None where it is not known.
        plates: Number of its force plates; None where it is not known.
        segments: Number of body segments whose orientations it has.
        sensors: Number of its inertial sensors.
    """

    kind: str
    name: str
    address: str
    place: str = ""
    options: Mapping[str, str] = field(default_factory=dict)
    markers: int | None = None
    rate_hz: float | None = None
    plates: int | None = None
    segments: int = 0
    sensors: int = 0

    @property
    def source(self) -> str:
        """The value of ``--from``."""
        return f"{self.kind}:{self.place}" if self.place else self.kind

    @property
    def carries(self) -> str:
        """Its contents in words."""
        rate = "" if self.rate_hz is None else f" at {self.rate_hz:g} Hz"
        if self.segments or self.sensors:
            return f"{self.segments} segments{rate}" if self.segments else f"{self.sensors} sensors{rate}"
        if self.markers is None:
            return "not known"
        points = f"{self.markers} markers" if self.markers else "points without names"
        return f"{points}{rate}, {self.plates or 'no'} plate{'' if self.plates == 1 else 's'}"

    def described(self, stream: StreamDescription | None) -> FoundStream:
        """With the contents that a description states, if there is one."""
        if stream is None:
            return self
        return replace(
            self, markers=len(stream.marker_names), rate_hz=stream.rate_hz, plates=len(stream.plates)
        )
