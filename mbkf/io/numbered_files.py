"""Files of one trial that hold a numbered plate each, beside each other in a folder."""

from __future__ import annotations

import re
from pathlib import Path


def plate_files(path: Path, name: re.Pattern[str]) -> tuple[Path, ...]:
    """The files of a trial's plates, in the order of their numbers, beside one of them or the file of the trial's name.

    ``name`` matches the stem of a plate's file, with groups ``trial`` and ``plate``.
    """
    match = name.fullmatch(path.stem)
    trial = match["trial"] if match else path.stem
    found = {}
    for other in path.parent.iterdir() if path.parent.is_dir() else ():
        plate = name.fullmatch(other.stem)
        if plate and plate["trial"] == trial and other.suffix.lower() == path.suffix.lower():
            found[int(plate["plate"])] = other
    return tuple(found[number] for number in sorted(found))


def numbered_files(path: Path, name: re.Pattern[str], notes: list[str]) -> tuple[Path, ...]:
    """The files to read for a file of ground reactions: those of all plates, or the file alone.

    Args:
        path: The file.
        name: As for :func:`plate_files`.
        notes: Receives the names of files that are read together.
    """
    files = plate_files(path, name)
    if not files or (path not in files and name.fullmatch(path.stem)):
        return (path,)
    if len(files) > 1:
        notes.append(f"plates of one trial were read together: {', '.join(one.name for one in files)}")
    return files
