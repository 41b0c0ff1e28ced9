"""Inputs of a result, files by their contents, so that finished and unchanged results are kept."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io.atomic import write_text
from mbkf.io.files_read import opened, read_state
from mbkf.io.plain_data import parse_json
from mbkf.version import __version__

RECORD = "batch.json"
"""File in a result's folder that lists the inputs of the result."""


def fingerprint(files: Sequence[Path], settings: Mapping[str, object]) -> dict[str, object]:
    """Inputs of a result as plain data: contents of files, settings and version.

    Args:
        files: The inputs.
        settings: Plain data.

    Raises:
        OSError: A file cannot be read.
    """
    return {
        "files": {str(file): digest(file) for file in files},
        "settings": json.loads(json.dumps(settings, default=str)),
        "version": __version__,
    }


def is_made_from(record: Path, made_from: Mapping[str, object]) -> bool:
    """True where a record lists the same inputs; file names do not count, contents do."""
    try:
        found = parse_json(read_state(record))
        return _contents(found) == _contents(made_from)
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return False


def read_record(record: Path) -> dict[str, object]:
    """Inputs of a result, and under "events" the strikes and toe-offs by hand, where there are any.

    Raises:
        FileFormatError: It is missing or damaged.
    """
    try:
        return dict(parse_json(read_state(record)))
    except (OSError, ValueError, TypeError) as error:
        raise FileFormatError(record, f"cannot be read ({error}); run the batch again") from error


def write_record(record: Path, made_from: Mapping[str, object]) -> None:
    """Writes the inputs of a result.

    Raises:
        OSError: It cannot be written.
    """
    write_text(record, json.dumps(made_from, indent=2) + "\n")


def _contents(made_from: Mapping[str, object]) -> tuple[list[object], object, object]:
    files = made_from["files"]
    if not isinstance(files, dict):
        raise TypeError("the files' contents are a table")
    return list(files.values()), made_from["settings"], made_from["version"]


def digest(file: Path) -> str:
    """A number that stands for a file's content (SHA-256).

    Raises:
        OSError: It cannot be read.
    """
    with opened(file) as content:
        return hashlib.file_digest(content, "sha256").hexdigest()
