"""A lower triangle of numbers as compact text, each row to a fixed share of its largest number.

The numbers of row n, over the largest one's size, are stored as whole numbers of 20 bits: 0 to 2²⁰ − 1, with 2¹⁹ for
zero. Rows follow each other; the lowest bytes of all numbers come first, then the middle ones, then the highest, which
zlib compresses best. The text is base64. A row's norm is stored apart, so that it is exact to the digits written.
"""

from __future__ import annotations

import base64
import binascii
import zlib

import numpy as np

from mbkf.conventions import Array

BITS, BYTES = 20, 3
"""Of a number: variances of 474 unknowns are right to 0.05 % in every direction; with 16 bits, to 0.7 %."""

HALF = 2 ** (BITS - 1)
"""Whole number of a zero."""

WIDTH = 120
"""Characters of a line."""


def packed(triangle: Array) -> str:
    """The text of a lower triangle (n, n), in lines.

    Args:
        triangle: (n, n), zero above the diagonal.
    """
    largest = np.abs(triangle).max(axis=1, initial=0.0)
    steps = (HALF - 1) / np.where(largest > 0.0, largest, 1.0)
    whole = np.rint(triangle * steps[:, None])[np.tril_indices(len(triangle))]
    planes = (whole + HALF).astype("<u4").view(np.uint8).reshape(-1, 4)[:, :BYTES].T
    text = base64.b64encode(zlib.compress(planes.tobytes(), 9)).decode("ascii")
    return "\n".join(text[at : at + WIDTH] for at in range(0, len(text), WIDTH)) + "\n"


def unpacked(text: str, norms: Array) -> Array | None:
    """(n, n) triangle that :func:`packed` made; None where the text is damaged or has another size.

    Args:
        text: The text; spaces and line breaks do not count.
        norms: (n,) norms of the rows.
    """
    size = len(norms)
    count = size * (size + 1) // 2
    opened = zlib.decompressobj()
    try:
        held = opened.decompress(base64.b64decode("".join(text.split()), validate=True), BYTES * count + 1)
    except (binascii.Error, zlib.error, ValueError):
        return None
    if len(held) != BYTES * count or not opened.eof:
        return None
    numbers = np.zeros((count, 4), np.uint8)
    numbers[:, :BYTES] = np.frombuffer(held, np.uint8).reshape(BYTES, count).T
    triangle = np.zeros((size, size))
    triangle[np.tril_indices(size)] = numbers.view("<u4")[:, 0] - float(HALF)
    found = np.linalg.norm(triangle, axis=1)
    return np.asarray(triangle * (norms / np.where(found > 0.0, found, 1.0))[:, None])
