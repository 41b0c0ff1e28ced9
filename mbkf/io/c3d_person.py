"""Statements of a C3D file about its person: name, mass and height, read without its samples."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from mbkf.errors import MbkfError
from mbkf.io.c3d_decode import values_of
from mbkf.io.c3d_layout import Processor, check_layout
from mbkf.io.c3d_parameters import C3dParameters
from mbkf.io.plausible import MASSES_KG

HEIGHTS_M = (0.3, 2.8)
"""Possible heights."""

MM_PER_M = 1e3

KEPT = 20_000
"""Files whose statements are kept, so that a page that plans a study again and again reads each once."""


@dataclass(frozen=True)
class StatedPerson:
    """A person as a file states it.

    Attributes:
        names: Names of its subjects, several for a capture of several persons.
        mass_kg: Body mass; None where not stated.
        height_m: Body height; None where not stated.
    """

    names: tuple[str, ...] = ()
    mass_kg: float | None = None
    height_m: float | None = None


def person_of_c3d(path: Path) -> StatedPerson:
    """Statements of a C3D file about its person; empty where the file cannot be read or is of another format.

    Args:
        path: The file.
    """
    if path.suffix.lower() != ".c3d":
        return StatedPerson()
    try:
        state = path.stat()
        return _read(path, state.st_size, state.st_mtime_ns)
    except (MbkfError, OSError, ValueError):
        return StatedPerson()


def stated_mass(parameters: C3dParameters) -> float | None:
    """Body mass in kg stated in PROCESSING or SUBJECTS; None where it is missing or impossible."""
    for group, name in (("PROCESSING", "BODYMASS"), ("SUBJECTS", "BODYMASS"), ("SUBJECTS", "WEIGHT")):
        mass = parameters.number(group, name)
        if MASSES_KG[0] <= mass <= MASSES_KG[1]:
            return mass
    return None


def _stated_height(parameters: C3dParameters) -> float | None:
    """Body height in m; files state it in mm or m."""
    for group in ("PROCESSING", "SUBJECTS"):
        stated = parameters.number(group, "HEIGHT")
        for height in (stated, stated / MM_PER_M):
            if HEIGHTS_M[0] <= height <= HEIGHTS_M[1]:
                return height
    return None


@lru_cache(maxsize=KEPT)
def _read(path: Path, size: int, changed_ns: int) -> StatedPerson:
    del size, changed_ns  # a changed file is another one
    layout = check_layout(path)
    parameters = C3dParameters(
        values_of(layout.section.groups, layout.section.records, Processor(layout.processor))
    )
    names = tuple(name for name in parameters.texts("SUBJECTS", "NAMES") if name)
    return StatedPerson(names, stated_mass(parameters), _stated_height(parameters))
