"""Force plates of a file one by one: those that cannot be read are left out, with the reason."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from typing import TypeVar

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.capture_options import CaptureOptions

NO_CHANNELS = "no analog channels belong to it"

_NAMED = 6

T = TypeVar("T")
R = TypeVar("R")


def readable_plates(
    named: Iterable[tuple[str, T]],
    read: Callable[[T], R],
    options: CaptureOptions,
    where: str,
    *,
    needs_one: bool = True,
) -> list[R]:
    """Readings of the plates that can be read; the options receive the others with their reasons.

    Args:
        named: Name and stored content of each plate.
        read: Reads one; raises where that is not possible.
        options: Plates that need not be readable; receives those left out.
        where: The file, which the reasons leave out.
        needs_one: True where a file without a readable plate is an error, but for plates that need not be readable.

    Raises:
        FileFormatError: No plate can be read, and one is needed; the error of the first.
        InvalidInput: As before, for readings that cannot be right.
    """
    found: list[R] = []
    first: FileFormatError | InvalidInput | None = None
    for name, one in named:
        try:
            found.append(read(one))
        except (FileFormatError, InvalidInput) as error:
            reason = error.reason if isinstance(error, FileFormatError) else str(error)
            options.left_out[name] = reason.removeprefix(where).lstrip(":, ")
            if name not in options.unneeded_plates:
                first = first or error
    if first is not None and not found and needs_one:
        raise first
    return found


def left_out_notes(left_out: Mapping[str, str]) -> list[str]:
    """Remarks on plates that are left out, those of one reason together."""
    by_reason: dict[str, list[str]] = {}
    for name, reason in left_out.items():
        by_reason.setdefault(_without_subject(name, reason), []).append(name)
    return [_note(names, reason) for reason, names in by_reason.items()]


def _note(names: list[str], reason: str) -> str:
    if len(names) == 1:
        return f"force plate {names[0]} is left out: {reason}"
    named = ", ".join(names[:_NAMED]) + (" …" if len(names) > _NAMED else "")
    each = f"each{reason.removeprefix('it')}" if reason.startswith("it ") else reason
    return f"{len(names)} force plates are left out ({named}): {each}"


def _without_subject(name: str, reason: str) -> str:
    """The reason without the plate's name at its beginning: "it is of type 9", "20 of 600 samples …"."""
    rest = re.sub(rf"^(force plate|plate|set) '?{re.escape(name)}'?", "", reason)
    return reason if rest == reason else rest.removeprefix(": ") if rest.startswith(":") else f"it{rest}"
