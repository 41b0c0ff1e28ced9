"""A study of one synthetic walk in many copies."""

from __future__ import annotations

import shutil
from pathlib import Path

from mbkf.trial.synth import synthesise, write_folder

SECONDS = 4.0


def study(folder: Path, persons: int, trials: int, seconds: float = SECONDS) -> Path:
    """Persons P1, P2, … with a standing trial and so many walks each; returns the folder.

    Args:
        folder: Where to write.
        persons: How many.
        trials: Walks of each.
        seconds: Duration of a walk.
    """
    shutil.rmtree(folder, ignore_errors=True)
    made = folder.with_name(f"{folder.name}-walk")
    subject, walk = synthesise("walk", seconds=seconds)
    write_folder(subject, walk, made)
    for person in range(1, persons + 1):
        own = folder / f"P{person}"
        own.mkdir(parents=True)
        shutil.copy(made / "static.c3d", own)
        for trial in range(1, trials + 1):
            shutil.copy(made / "trial.c3d", own / f"walk{trial:02d}.c3d")
    return folder


def fresh(folder: Path) -> Path:
    """A folder that is not there yet, whatever an earlier run left."""
    number = 0
    while (found := folder.with_name(f"{folder.name}-{number}")).exists():
        number += 1
    return found
