"""Two trees' files, number by number: the largest difference as a share of the array's largest value."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from mbkf.errors import FileFormatError

BOUND = 1e-9

Numbers = dict[str, np.ndarray]

TIMES = ("step_seconds", "realtime_factor", "latency_ms", "wall_s")
"""First letters of names under which wall time stands; it differs from run to run."""

WORDS = ("warnings", "version", "settings", "format_version")
"""Names of what is no result: texts, and settings, which only matter for what they change."""

LIVE_NUMBERS = ("frames_in", "frames_lost", "frames_processed", "frames_not_written", "starts")
"""What of live.json depends on the frames alone."""


@dataclass(frozen=True)
class Verdict:
    """How far apart two sets of named arrays are.

    Attributes:
        value: The largest of all differences, each as a share of its array's largest value.
        worst: The array where it was found, with the reason where no difference could be taken.
        arrays: How many arrays were compared.
        beyond: The arrays beyond the bound and their differences.
    """

    value: float
    worst: str
    arrays: int
    beyond: Mapping[str, float] = field(default_factory=dict)

    @property
    def equal(self) -> bool:
        """Whether every array is equal within the bound."""
        return self.value <= BOUND


def difference(old: np.ndarray, new: np.ndarray) -> tuple[float, str]:
    """The largest |old − new| over the largest |old|, and what forbids such a number, if anything.

    Arrays of another shape, or with NaN or infinity elsewhere, are infinitely far apart. So are texts that
    differ, and an array that was all zeros and is not any more.
    """
    if old.shape != new.shape:
        return np.inf, f"shape {old.shape} became {new.shape}"
    if old.dtype.kind not in "fiub" or new.dtype.kind not in "fiub":
        return (0.0, "") if np.array_equal(old, new) else (np.inf, "texts differ")
    a, b = old.astype(float), new.astype(float)
    known = np.isfinite(a)
    if not np.array_equal(a[~known], b[~known], equal_nan=True) or not np.isfinite(b[known]).all():
        return np.inf, "NaN or infinity elsewhere"
    apart = np.abs(a[known] - b[known]).max(initial=0.0)
    if apart == 0.0:
        return 0.0, ""
    largest = np.abs(a[known]).max()
    return (float(apart / largest), "") if largest > 0.0 else (np.inf, "was zero everywhere")


def verdict(old: Mapping[str, np.ndarray], new: Mapping[str, np.ndarray]) -> Verdict:
    """Compares every array of the old tree; what only the new one has is an addition, not a difference."""
    if not old:
        return Verdict(np.inf, "nothing to compare", 0)
    worst, value, beyond = "", 0.0, {}
    for name, array in old.items():
        found, why = difference(array, new[name]) if name in new else (np.inf, "missing")
        if found > value:
            worst, value = f"{name} ({why})" if why else name, found
        if found > BOUND:
            beyond[name] = found
    return Verdict(value, worst, len(old), beyond)


def numbers_in_folder(folder: Path, renamed: Mapping[str, str] | None = None) -> Numbers:
    """All results of a run's or a preparation's folder, with the file's name before each array's.

    Args:
        folder: Read with its subfolders: every ``.h5``, ``.toml``, ``.csv``, summary.json and live.json.
        renamed: What an array's name, without its file, is to be replaced with.

    Raises:
        FileFormatError: A file cannot be read.
    """
    found: Numbers = {}
    for path in sorted(folder.rglob("*")):
        place = path.relative_to(folder).as_posix()
        for name, array in _numbers_in_file(path):
            found[f"{place}: {(renamed or {}).get(name, name)}"] = array
    return found


def _numbers_in_file(path: Path) -> Iterable[tuple[str, np.ndarray]]:
    try:
        if path.suffix == ".h5":
            return _in_h5(path)
        if path.suffix == ".toml":
            return _in_tree(tomllib.loads(path.read_text(encoding="utf-8")))
        if path.suffix == ".csv":
            return [("table", np.genfromtxt(path, delimiter=",", skip_header=1))]
        if path.name == "summary.json":
            return _in_tree(json.loads(path.read_text(encoding="utf-8")))
        if path.name == "live.json":
            counts = json.loads(path.read_text(encoding="utf-8"))
            return [(name, np.array(counts[name])) for name in LIVE_NUMBERS if name in counts]
    except (OSError, ValueError, KeyError) as error:
        raise FileFormatError(path, f"cannot be compared ({error})") from error
    return []


def _in_h5(path: Path) -> list[tuple[str, np.ndarray]]:
    found: list[tuple[str, np.ndarray]] = []

    def visit(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and _is_result(name.rpartition("/")[2]):
            found.append((name, np.asarray(item[()])))

    with h5py.File(path) as file:
        file.visititems(visit)
    return found


def _in_tree(value: Any, name: str = "") -> Iterator[tuple[str, np.ndarray]]:
    """The numbers of nested tables and lists under dotted names; a list of numbers is one array.

    List entries that have a name are known by it, so that their order does not matter.
    """
    if isinstance(value, Mapping):
        for key, item in value.items():
            if _is_result(key):
                yield from _in_tree(item, f"{name}.{key}" if name else key)
    elif isinstance(value, list) and not all(_is_number(item) for item in value):
        for index, item in enumerate(value):
            label = item.get("name", index) if isinstance(item, Mapping) else index
            yield from _in_tree(item, f"{name}.{label}")
    elif isinstance(value, list):
        yield name, np.array(value, dtype=float)
    elif _is_number(value):
        yield name, np.array(np.nan if value is None else value, dtype=float)


def _is_number(value: Any) -> bool:
    return value is None or isinstance(value, int | float)


def _is_result(name: str) -> bool:
    return not name.startswith(TIMES) and name not in WORDS
