"""Texts as UTF-8, whatever they hold: bytes of a file's name that are no UTF-8 are kept as their codes.

Python carries such a byte through as half a letter, U+DC80 to U+DCFF, which no file in UTF-8 can hold.
"""

from __future__ import annotations


def encoded(text: str) -> bytes:
    """A text as UTF-8, with halves of letters as codes."""
    return text.encode("utf-8", "backslashreplace")


def storable(text: str) -> str:
    """A text without halves of letters, which are codes then; another text stays as it is."""
    return text if text.isascii() else encoded(text).decode("utf-8")


def without_noughts(text: str) -> str:
    """A storable text as HDF5 holds it: without noughts, which streams may send, and which are codes then."""
    return storable(text).replace("\0", "\\x00")
