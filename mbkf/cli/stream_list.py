"""The streams of the network as a table, each with the words that follow it: ``mbkf live --list``."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

from mbkf.cli.following import say
from mbkf.cli.tables import table, terminal

if TYPE_CHECKING:
    from mbkf.stream.found import FoundStream

NOTHING = (
    "no stream was found; start the camera system's real-time output, check that this computer is in its network, and "
    "name another network card's address by --local"
)


def list_streams(source: str | None, local: str) -> int:
    """Searches the network and prints what was found.

    Args:
        source: The only protocol to search, with its place after a colon where it is not the usual one; None for all.
        local: An address of this computer whose network is searched, too.

    Raises:
        UnknownName: Streams of the source cannot be searched for.
    """
    from mbkf.errors import UnknownName
    from mbkf.stream.discovery import PLACED, SEARCHES, find_streams

    kind, colon, _ = (source or "").partition(":")
    if source is not None and (kind not in SEARCHES or (colon and kind not in PLACED)):
        raise UnknownName("source", source, tuple(SEARCHES), "--from")
    say("searching the network …")
    found = find_streams(SEARCHES if source is None else [source], local)
    for sentence in found.not_searched:
        say(f"mbkf: {sentence}")
    if not found.streams:
        say(NOTHING)
        return 0
    shown = table("", "kind", "name", "address", "carries", words=4)
    for one in found.streams:
        shown.add_row(one.kind, one.name, one.address, one.carries)
    console = terminal()
    console.print(shown)
    for one in found.streams:
        console.print(f"mbkf live {following(one)} …", soft_wrap=True)
    return 0


def following(found: FoundStream) -> str:
    """The words of ``mbkf live`` that follow a stream."""
    words = ["--from", found.source]
    for name, value in found.options.items():
        words += [f"--{name}", value]
    return shlex.join(words)
