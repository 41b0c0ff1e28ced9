"""Number of files in the largest folder of the rooms that hold the user's questions."""

from __future__ import annotations

from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2] / "mbkf"
ROOMS = ("trial", "study")
MOST_FILES = 25


def largest_folder() -> int:
    """Python files in the folder that has most of them."""
    folders = {path.parent for room in ROOMS for path in (PACKAGE / room).rglob("*.py")}
    return max(sum(1 for _ in folder.glob("*.py")) for folder in folders)
