"""Readers and motions of other installed packages: modules that entry points name, imported when they may be needed.

A package names a module under a group of its ``pyproject.toml``; importing the module registers its readers::

    [project.entry-points."mbkf.readers"]
    xyz = "my_laboratory.xyz_reader"
"""

from __future__ import annotations

import os
import sys
import warnings
from contextlib import suppress
from importlib.machinery import PathFinder
from pathlib import Path
from threading import RLock
from typing import TYPE_CHECKING

from mbkf.errors import FileFormatError, MbkfWarning
from mbkf.io.files_read import read_state_bytes

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

READERS, MOTIONS = "mbkf.readers", "mbkf.motions"
"""Groups of entry points."""

_METADATA = (".dist-info", "egg-info")
"""Endings of the folders that describe installed packages."""

_lock = RLock()
_imported: set[str] = set()


def import_installed(group: str) -> None:
    """Imports the modules of a group, once in a process; one that fails is named in a warning and left out.

    Args:
        group: :data:`READERS` or :data:`MOTIONS`.
    """
    with _lock:  # another thread waits; a module that reads a file while it is imported does not
        if group in _imported:
            return
        _imported.add(group)
        if not _may_be_stated(group):
            return
        from importlib.metadata import entry_points  # costs more than the rest of `mbkf --help`

        for point in entry_points(group=group):
            try:
                point.load()
            except Exception as error:
                warnings.warn(_failure(point, error), MbkfWarning, stacklevel=2)


def _may_be_stated(group: str) -> bool:
    """False where no installed package names the group in its entry points: a quick look at their files."""
    if any(hasattr(finder, "find_distributions") and finder is not PathFinder for finder in sys.meta_path):
        return True
    for place in sys.path:
        try:
            with os.scandir(place or ".") as entries:
                found = [one.path for one in entries if one.name.lower().endswith(_METADATA)]
        except NotADirectoryError:  # an archive
            return True
        except OSError:
            continue
        for path in found:
            with suppress(OSError, FileFormatError):
                if group.encode() in read_state_bytes(Path(path, "entry_points.txt")):
                    return True
    return False


def _failure(point: EntryPoint, error: Exception) -> str:
    package = "an installed package" if point.dist is None else f"the package '{point.dist.name}'"
    return (
        f"'{point.name}' ({point.group}) of {package} could not be loaded and is left out "
        f"({type(error).__name__}: {error}); repair, update or uninstall the package"
    )
