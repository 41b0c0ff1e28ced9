"""The known truth that lies beside a synthetic capture."""

from __future__ import annotations

from pathlib import Path

from mbkf.io.truth import Truth, read_truth

FILE_NAME = "truth.h5"


def truth_beside(trial: str | Path) -> Truth | None:
    """The truth of a synthetic trial; None: its folder holds no ``truth.h5``.

    Static trials have their own posture, so only ``trial.c3d`` and ``raw.c3d`` have a truth.
    """
    path = Path(trial)
    beside = path.with_name(FILE_NAME)
    return read_truth(beside) if path.stem in ("trial", "raw") and beside.is_file() else None
