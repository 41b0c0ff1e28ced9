"""Streams of all protocols that are found in the network now, for a choice before one is followed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

from mbkf.errors import InvalidInput, MbkfError
from mbkf.stream.found import FoundStream
from mbkf.stream.loopback import LOOPBACK

LAST_PORT = 65535

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


def _lsl(_: str, timeout_s: float, __: str) -> list[FoundStream]:
    from mbkf.stream.lsl.discovery import marker_streams

    return marker_streams(timeout_s)


def _natnet(local: str, timeout_s: float, _: str) -> list[FoundStream]:
    from mbkf.stream.natnet.discovery import natnet_streams

    return natnet_streams(local, timeout_s)


def _qualisys(local: str, timeout_s: float, place: str) -> list[FoundStream]:
    from mbkf.stream.qualisys.client import BASE_PORT
    from mbkf.stream.qualisys.discovery import qualisys_at, qualisys_streams

    if place:
        return qualisys_at(*_host_port(place, BASE_PORT))
    return qualisys_streams(local, timeout_s)


def _udp(local: str, timeout_s: float, place: str) -> list[FoundStream]:
    from mbkf.stream.udp.discovery import udp_streams
    from mbkf.stream.udp.messages import DEFAULT_PORT

    return udp_streams(local, timeout_s, _port(place, DEFAULT_PORT))


def _vicon(_: str, timeout_s: float, place: str) -> list[FoundStream]:
    from mbkf.stream.vicon.client import PORT
    from mbkf.stream.vicon.discovery import vicon_streams

    return vicon_streams(timeout_s, *_host_port(place, PORT))


def _xsens(local: str, timeout_s: float, place: str) -> list[FoundStream]:
    from mbkf.stream.xsens.discovery import xsens_streams
    from mbkf.stream.xsens.packets import DEFAULT_PORT

    return xsens_streams(local, timeout_s, _port(place, DEFAULT_PORT))


def _host_port(place: str, default: int) -> tuple[str, int]:
    host, _, port = place.partition(":")
    return host or LOOPBACK, _port(port, default)


def _port(text: str, default: int) -> int:
    return port_number(text) if text else default


def port_number(text: str) -> int:
    """The port that a text states.

    Raises:
        InvalidInput: It is not one.
    """
    if not (text.isascii() and text.isdigit() and len(text) <= 5 and 0 < int(text) <= LAST_PORT):
        raise InvalidInput(f"'{text}' is not a port; write a number from 1 to {LAST_PORT}")
    return int(text)


Search = Callable[[str, float, str], list[FoundStream]]

SEARCHES: Mapping[str, Search] = {
    "lsl": _lsl,
    "natnet": _natnet,
    "qualisys": _qualisys,
    "udp": _udp,
    "vicon": _vicon,
    "xsens": _xsens,
}
"""Search of each protocol by its name in ``--from``: takes an address of this computer, how long to look, and the place
that follows the name and a colon, empty for the usual one."""

PLACED = ("qualisys", "udp", "vicon", "xsens")
"""Protocols whose name a place may follow."""


def find_streams(
    kinds: Iterable[str] = tuple(SEARCHES), local: str = LOOPBACK, timeout_s: float = LOOK_S
) -> Found:
    """Searches all protocols at once.

    Args:
        kinds: Their names, those of :data:`PLACED` also with a colon and a place.
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
    name, _, place = kind.partition(":")
    try:
        return SEARCHES[name](local, timeout_s, place)
    except MbkfError as error:
        return f"{kind}: not searched ({error})"
