"""The folder ``mbkf reconstruct`` writes: summary.json, motion.h5 and OpenSim's four files, all or none."""

from __future__ import annotations

import json
import math
import shutil
import uuid
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mbkf.errors import FileFormatError
from mbkf.io.atomic import check_folder
from mbkf.io.results import Reconstruction
from mbkf.io.results_h5 import read_h5, write_h5
from mbkf.io.results_opensim import write_opensim

SUMMARY_FILE = "summary.json"
MOTION_FILE = "motion.h5"


def write_reconstruction(
    reconstruction: Reconstruction, summary: Mapping[str, Any], folder: str | Path
) -> Path:
    """Writes a reconstruction and its summary.

    Everything is first written beside the folder and moved into place at the end, summary.json last; other
    files of an existing folder stay.

    Args:
        reconstruction: The result.
        summary: Plain data for summary.json (see ``mbkf.pipelines.results.summary``); NaN becomes null.
        folder: Where to write; made where missing.

    Returns:
        The folder.

    Raises:
        FileFormatError: A file stands where the folder is needed.
        OSError: The folder cannot be written to.
    """
    target = check_folder(folder)
    partial = target.with_name(f".{target.name}-{uuid.uuid4().hex}")
    partial.mkdir(parents=True)
    try:
        write_h5(reconstruction, partial / MOTION_FILE)
        write_opensim(reconstruction, partial)
        text = json.dumps(_without_nan(summary), indent=2, allow_nan=False, ensure_ascii=False)
        (partial / SUMMARY_FILE).write_text(text + "\n", encoding="utf-8")
        target.mkdir(exist_ok=True)
        for file in sorted(partial.iterdir(), key=lambda path: path.name == SUMMARY_FILE):
            file.replace(target / file.name)
    finally:
        shutil.rmtree(partial, ignore_errors=True)
    return target


def read_reconstruction(path: str | Path) -> Reconstruction:
    """Reads a reconstruction from its folder, or from its motion.h5.

    Raises:
        FileFormatError: There is none, or it is damaged.
    """
    source = Path(path)
    if source.is_dir() and not (source / MOTION_FILE).is_file():
        raise FileFormatError(source, f"the folder holds no {MOTION_FILE}; make it with 'mbkf reconstruct'")
    return read_h5(source / MOTION_FILE if source.is_dir() else source)


def read_summary(folder: str | Path) -> dict[str, Any]:
    """The contents of a folder's summary.json.

    Raises:
        FileFormatError: It is missing or damaged.
    """
    path = Path(folder) / SUMMARY_FILE
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise FileFormatError(path, f"cannot be read ({error}); make it with 'mbkf reconstruct'") from error


def _without_nan(value: Any) -> Any:
    """Plain data with numpy's scalars as Python's and NaN and infinities as None."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(key): _without_nan(item) for key, item in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [_without_nan(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if isinstance(value, str | int | float | bool | None) else str(value)
