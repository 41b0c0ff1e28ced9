"""Network work on several places at once, so that a slow one delays no other."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from mbkf.stream.asking import own_addresses

PlaceT = TypeVar("PlaceT")
FoundT = TypeVar("FoundT")

EVERYWHERE = "0.0.0.0"
"""All addresses of this computer."""


def side_by_side(work: Callable[[PlaceT], FoundT | None], places: Iterable[PlaceT]) -> list[FoundT]:
    """Results of a piece of work at each place, in their order, without those that are None."""
    places = list(places)
    with ThreadPoolExecutor(max(1, len(places))) as pool:
        return [found for found in pool.map(work, places) if found is not None]


def at_own_addresses(listen: Callable[[str], FoundT | None], local: str) -> list[FoundT]:
    """Results of listening at each address of this computer.

    Args:
        listen: Listens at an address.
        local: An address of this computer beside those of its name; 0.0.0.0 for all of them at once.
    """
    return side_by_side(listen, [EVERYWHERE] if local == EVERYWHERE else own_addresses(local))
