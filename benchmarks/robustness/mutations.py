"""Damage to files: bytes of any kind, and words and lines of text; the same from the same seed."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np

WORDS = (
    b"", b"nan", b"inf", b"-inf", b"-1", b"0", b"1e308", b"-1e308", b"1e9", b"1e-320", b"99999999999999999999",
    b"true", b"null", b"[]", b"{}", b"\xff\xfe", b"abc", b"0x10", b"1,5", b'"', b"\t\t", b"[[", b"../x",
)  # fmt: skip
"""What stands in place of a word of text."""

NUMBERS = (b"\x00", b"\xff", b"\x7f", b"\x80", b"\x01")
"""What stands in place of a byte."""

_WORD = re.compile(rb"[^\s,;=\[\]{}\"']+")

Damage = Callable[[bytes, np.random.Generator], bytes]


def mutated(content: bytes, seed: int, text: bool) -> bytes:
    """A damaged copy.

    Args:
        content: The file.
        seed: Which damage.
        text: Whether the file is text, whose words and lines are damaged as well.
    """
    rng = np.random.default_rng(seed)
    kinds: tuple[Damage, ...] = (_bytes, _bytes_at_the_start, _slice)
    if text:
        kinds = (*kinds, _words, _words, _words, _lines, _lines)
    for _ in range(int(rng.integers(1, 4))):
        content = kinds[rng.integers(len(kinds))](content, rng)
    return content


def _bytes(content: bytes, rng: np.random.Generator) -> bytes:
    """A few bytes anywhere are other ones."""
    damaged = bytearray(content)
    for at in rng.integers(0, max(len(damaged), 1), int(rng.integers(1, 9))):
        if at < len(damaged):
            damaged[at] = (
                NUMBERS[rng.integers(len(NUMBERS))][0] if rng.random() < 0.5 else int(rng.integers(256))
            )
    return bytes(damaged)


def _bytes_at_the_start(content: bytes, rng: np.random.Generator) -> bytes:
    """The same among the first two thousand, where headers are."""
    return _bytes(content[:2048], rng) + content[2048:]


def _slice(content: bytes, rng: np.random.Generator) -> bytes:
    """A stretch is gone, there twice, all zero, or all that follows is gone."""
    first, last = sorted(int(at) for at in rng.integers(0, len(content) + 1, 2))
    if rng.random() < 0.5:
        last = min(last, first + int(rng.integers(1, 200)))
    middle = content[first:last]
    put = (b"", middle + middle, bytes(len(middle)))
    kind = int(rng.integers(4))
    return content[:first] if kind == 3 else content[:first] + put[kind] + content[last:]


def _words(content: bytes, rng: np.random.Generator) -> bytes:
    """A few words are other ones."""
    for _ in range(int(rng.integers(1, 4))):
        begin = int(rng.integers(0, max(len(content) - 1, 1)))
        found = _WORD.search(content, begin)
        if found is not None:
            content = content[: found.start()] + WORDS[rng.integers(len(WORDS))] + content[found.end() :]
    return content


def _lines(content: bytes, rng: np.random.Generator) -> bytes:
    """A line is gone, there twice, or in another's place."""
    lines = content.split(b"\n")
    a, b = rng.integers(0, len(lines), 2)
    kind = rng.integers(3)
    if kind == 0:
        del lines[a]
    elif kind == 1:
        lines.insert(b, lines[a])
    else:
        lines[a], lines[b] = lines[b], lines[a]
    return b"\n".join(lines)
