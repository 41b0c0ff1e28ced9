"""Inlets of Lab Streaming Layer, and the search for a stream that broke off."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any, TypeAlias, TypeVar

from mbkf.errors import MbkfError
from mbkf.stream.lsl.format import StreamInfo

T = TypeVar("T")

Inlet: TypeAlias = Any
"""An inlet as pylsl holds it; the library carries no types."""

OPEN_S = 3.0
"""Time in which a stream that was found has to answer."""

KEPT_S = 10
"""Duration of samples that liblsl buffers."""


def streams_of(library: ModuleType, types: tuple[str, ...], timeout_s: float) -> list[StreamInfo]:
    """The streams of some types that answer in time, in the order of their names.

    Args:
        library: pylsl.
        types: In lower case.
        timeout_s: How long to listen.
    """
    found = [stream for stream in library.resolve_streams(timeout_s) if stream.type().lower() in types]
    return sorted(found, key=lambda stream: str(stream.name()))


def inlet_of(library: ModuleType, info: StreamInfo, synchronised: bool) -> Inlet:
    """An inlet that receives nothing yet.

    Args:
        library: pylsl.
        info: The stream.
        synchronised: Whether its time stamps are corrected to this computer's clock.
    """
    flags = library.proc_clocksync if synchronised else 0
    return library.StreamInlet(info, max_buflen=KEPT_S, recover=False, processing_flags=flags, as_numpy=True)


def opened(library: ModuleType, inlet: Inlet, synchronised: bool) -> bool:
    """Begins to receive; false where the stream does not answer.

    Args:
        library: pylsl.
        inlet: The inlet.
        synchronised: Whether its time stamps are corrected; the first correction is measured before frames come.
    """
    try:
        if synchronised:  # else the first frames wait for it
            inlet.time_correction(OPEN_S)
        inlet.open_stream(OPEN_S)
    except (library.util.LostError, library.util.TimeoutError):
        return False
    return True


class LostStream:
    """Looks in the background for a stream that broke off, by its name."""

    def __init__(self, library: ModuleType, name: str) -> None:
        """Args: pylsl, and the stream's name."""
        self._lsl = library
        self._resolver = library.ContinuousResolver("name", name, forget_after=2.0)
        self._refused: set[str] = set()

    def found(self) -> StreamInfo | None:
        """The newest stream of that name that was not refused; None while there is none.

        The one that broke off is still listed for a while.
        """
        others = [one for one in self._resolver.results() if one.uid() not in self._refused]
        return max(others, key=lambda one: one.created_at(), default=None)

    def returned(
        self, synchronised: bool, read: Callable[[StreamInfo], T], refused: Callable[[MbkfError], object]
    ) -> tuple[StreamInfo, Inlet, T] | None:
        """The stream once it is back: its information, its inlet, which receives, and its description.

        Args:
            synchronised: As for :func:`inlet_of`.
            read: Description of a stream from its full information; raises MbkfError where the stream that has the name
                is another one, which is passed over from then on.
            refused: Called with that error.
        """
        info = self.found()
        if info is None:
            return None
        inlet = inlet_of(self._lsl, info, synchronised)
        try:
            description = read(inlet.info(OPEN_S))
        except MbkfError as error:
            self._refused.add(info.uid())
            refused(error)
            return None
        except (self._lsl.util.LostError, self._lsl.util.TimeoutError):  # gone again
            return None
        return (info, inlet, description) if opened(self._lsl, inlet, synchronised) else None
