"""A picture of a page: its name, its size, and the small file that it becomes."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

COLOURS = 256
MOST_BYTES = 150_000
"""Largest file of a picture that the repository takes."""


class Taken(NamedTuple):
    """A picture that was taken: its name in the table, and its content as PNG."""

    name: str
    png: bytes


Taking = Iterator[Taken]


def keep(png: bytes, target: Path) -> None:
    """Writes a picture with a palette: half of it for the colours of large areas, half for those far from them.

    Args:
        png: Its content.
        target: File to write.
    """
    from PIL import Image

    picture = Image.open(io.BytesIO(png)).convert("RGB")
    palette: list[int] = []
    for method in (Image.Quantize.MEDIANCUT, Image.Quantize.MAXCOVERAGE):
        half = picture.quantize(COLOURS // 2, method=method, dither=Image.Dither.NONE).getpalette() or []
        palette += half[: 3 * (COLOURS // 2)]
    values, place = np.unique(np.asarray(picture).reshape(-1, 3), axis=0, return_inverse=True)
    _, nearest = cKDTree(np.reshape(palette, (-1, 3))).query(values)
    numbers = nearest[place].reshape(picture.height, picture.width)
    small = Image.fromarray(numbers.astype(np.uint8), "P")
    small.putpalette(palette)
    small.save(target, optimize=True)


def pixels(file: Path) -> NDArray[np.uint8]:
    """(height, width, 3) colours of a picture.

    Args:
        file: Its file.
    """
    from PIL import Image

    return np.asarray(Image.open(file).convert("RGB"))


def still(page: Any, pause_ms: float = 300.0, most: int = 60) -> bytes:
    """A picture of a page or element once two in a row are equal; the last one where that never happens.

    Args:
        page: A page or element of the browser.
        pause_ms: Time between two.
        most: Number of tries.
    """
    before: bytes = page.screenshot()
    for _ in range(most):
        page_of = getattr(page, "page", page)
        page_of.wait_for_timeout(pause_ms)
        now: bytes = page.screenshot()
        if now == before:
            break
        before = now
    return before


def stacked(pictures: list[bytes], gap: int, beside: bool = False) -> bytes:
    """Pictures below or beside each other on white.

    Args:
        pictures: Their contents.
        gap: Distance between two, px.
        beside: Whether they stand beside each other, with the same distance to the edge.
    """
    from PIL import Image

    opened = [Image.open(io.BytesIO(one)) for one in pictures]
    along, across = (0, 1) if beside else (1, 0)
    edge = gap if beside else 0
    length = sum(one.size[along] for one in opened) + gap * (len(opened) - 1) + 2 * edge
    width = max(one.size[across] for one in opened) + 2 * edge
    whole = Image.new("RGB", (length, width) if beside else (width, length), "white")
    at = edge
    for one in opened:
        whole.paste(one, (at, edge) if beside else (edge, at))
        at += one.size[along] + gap
    held = io.BytesIO()
    whole.save(held, "PNG")
    return held.getvalue()
