"""Pictures of pages in README and docs: each one is made by one command, shown, of its size, and as pages are today.

All are taken again; a picture of an old page differs from the new one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.checks import Check
from benchmarks.screenshots.picture import MOST_BYTES, pixels
from benchmarks.screenshots.table import FOLDER, PICTURES, take

ROOT = Path(__file__).resolve().parents[2]
SHOWN = re.compile(r"!\[[^\]]*\]\([^)]*?(screenshot_\w+)\.png\)")
"""A picture in a page of Markdown."""

DIFFERENT, MOST_DIFFERENT = 24, 0.8
"""Difference of a colour, of 255, that is seen; largest share of pixels with one, per cent: times and paths change 0.5,
a new button in the list of sessions 0.96 or more."""

LEAST_COLOURED = 3.0
"""Least share of pixels that have another colour than the most frequent one, per cent."""


def screenshot_rows(data: Path, out: Path) -> Iterator[Check]:
    """All rows.

    Args:
        data: Folder of the shared captures.
        out: An empty folder, where the new pictures stay.
    """
    shown = shown_pictures()
    there = {file.stem for file in FOLDER.glob("screenshot_*.png")}
    yield Check(
        "pictures in README and docs that the command does not make", len(shown - set(PICTURES)), 0, "<="
    )
    yield Check("pictures of the command that no page shows", len(set(PICTURES) - shown), 0, "<=")
    yield Check("files of pictures that are missing or too many", len(there ^ set(PICTURES)), 0, "<=")
    made = {file.stem: file for file in take(out / "scratch", out, data)}
    yield Check(
        "pictures of the table that the command did not make", len(set(PICTURES) ^ set(made)), 0, "<="
    )
    largest = max(file.stat().st_size for file in FOLDER.glob("screenshot_*.png"))
    yield Check("largest picture", largest / 1000.0, MOST_BYTES / 1000.0, "<=", "kB")
    for name, size in PICTURES.items():
        yield from _picture_rows(name, size, made[name])


def _picture_rows(name: str, size: tuple[int, int], new: Path) -> Iterator[Check]:
    kept, taken = pixels(FOLDER / new.name), pixels(new)
    wrong = sum(one.shape[:2] != size[::-1] for one in (kept, taken))
    yield Check(f"{name}: of another size than the table's", wrong, 0, "<=")
    yield Check(f"{name}: pixels beside the most frequent colour", coloured(kept), LEAST_COLOURED, ">=", "%")
    yield Check(
        f"{name}: pixels that differ from the page of today",
        different(kept, taken),
        MOST_DIFFERENT,
        "<=",
        "%",
    )


def shown_pictures() -> set[str]:
    """Names of the pictures that README and docs show."""
    pages = (ROOT / "README.md", *(ROOT / "docs").rglob("*.md"))
    return {name for file in pages for name in SHOWN.findall(file.read_text(encoding="utf-8"))}


def coloured(picture: np.ndarray) -> float:
    """Share of pixels that have another colour than the most frequent one, per cent.

    Args:
        picture: (height, width, 3) colours.
    """
    _, counts = np.unique(picture.reshape(-1, 3), axis=0, return_counts=True)
    return 100.0 * (1.0 - float(counts.max() / counts.sum()))


def different(one: np.ndarray, other: np.ndarray) -> float:
    """Share of pixels whose colours differ so that it is seen, per cent; 100 for another size.

    Args:
        one: (height, width, 3) colours.
        other: The same of another picture.
    """
    if one.shape != other.shape:
        return 100.0
    apart = np.abs(one.astype(int) - other.astype(int)).max(axis=-1) > DIFFERENT
    return 100.0 * float(apart.mean())
