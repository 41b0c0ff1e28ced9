"""Verdicts on results for the page, read from their summaries and cached until these change."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

from mbkf.errors import MbkfError
from mbkf.io.results_folder import SUMMARY_FILE, read_summary
from mbkf.io.verdict import Verdict, Word, gravest

Plain = dict[str, object]


def verdict_on(folder: Path) -> Plain | None:
    """The verdict on a result: ``word``, ``line`` and ``reasons`` in words; None without a result or a verdict.

    Args:
        folder: The folder of the result.
    """
    found = _verdict(folder)
    if found is None:
        return None
    return {"word": found.overall, "line": found.line, "reasons": list(found.sentences)}


def gravest_on(folders: Iterable[Path], incomplete: bool = False) -> Word | None:
    """The gravest word on results; None where no result has a verdict.

    Args:
        folders: Folders of results.
        incomplete: Whether other trials of theirs were not done, so that the whole calls for a look.
    """
    words = [found.overall for folder in folders if (found := _verdict(folder)) is not None]
    return gravest([*words, "look" if incomplete else "use"]) if words else None


def _verdict(folder: Path) -> Verdict | None:
    try:
        return _read(folder, (folder / SUMMARY_FILE).stat().st_mtime_ns)
    except (MbkfError, OSError):
        return None


@lru_cache(maxsize=4096)
def _read(folder: Path, _stamp: int) -> Verdict | None:
    told = read_summary(folder).get("verdict")
    return None if told is None else Verdict.of_table(told)
