"""Streams of all protocols that are found in the network now, for a choice before one is followed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

from mbkf.errors import MbkfError
from mbkf.stream.found import FoundStream
from mbkf.stream.loopback import LOOPBACK

LOOK_S = 1.5
"""Streams of other computers answer within a second."""


@dataclass(frozen=True)
class Found:
    """Outcome of a search.

    Attributes:
        streams: The streams, by protocol.
        not_searched: A sentence for each protocol that could not be searched.
    """

    streams: tuple[FoundStream, ...]
    not_searched: tuple[str, ...]


def _lsl(_: str, timeout_s: float) -> list[FoundStream]:
    from mbkf.stream.lsl.discovery import marker_streams

    return marker_streams(timeout_s)


def _natnet(local: str, timeout_s: float) -> list[FoundStream]:
    from mbkf.stream.natnet.discovery import natnet_streams

    return natnet_streams(local, timeout_s)


def _qualisys(local: str, timeout_s: float) -> list[FoundStream]:
    from mbkf.stream.qualisys.discovery import qualisys_streams

    return qualisys_streams(local, timeout_s)


def _udp(local: str, timeout_s: float) -> list[FoundStream]:
    from mbkf.stream.udp.discovery import udp_streams

    return udp_streams(local, timeout_s)


SEARCHES: Mapping[str, Callable[[str, float], list[FoundStream]]] = {
    "lsl": _lsl,
    "natnet": _natnet,
    "qualisys": _qualisys,
    "udp": _udp,
}
"""Search of each protocol by its name in ``--from``: takes an address of this computer, and how long to look."""


def find_streams(
    kinds: Iterable[str] = tuple(SEARCHES), local: str = LOOPBACK, timeout_s: float = LOOK_S
) -> Found:
    """Searches all protocols at once.

    Args:
        kinds: Their names.
        local: An address of this computer whose network is searched, too; 0.0.0.0 for all of them.
        timeout_s: How long answers are taken.
    """
    kinds = tuple(kinds)
    with ThreadPoolExecutor(len(kinds)) as pool:
        results = list(pool.map(partial(_searched, local, timeout_s), kinds))
    streams = [one for found in results if isinstance(found, list) for one in found]
    return Found(tuple(streams), tuple(one for one in results if isinstance(one, str)))


def _searched(local: str, timeout_s: float, kind: str) -> list[FoundStream] | str:
    """The streams of a protocol, or the reason why it could not be searched."""
    try:
        return SEARCHES[kind](local, timeout_s)
    except MbkfError as error:
        return f"{kind}: not searched ({error})"
