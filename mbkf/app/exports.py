"""Files of a result or a session for other programs, as their content."""

from __future__ import annotations

import tempfile
import threading
from pathlib import Path

from mbkf.errors import UnknownName
from mbkf.io.results_folder import read_reconstruction
from mbkf.study.session.records import Session
from mbkf.study.session.tables import write_session_curves
from mbkf.trial.export import RESULT_FORMATS, export_result
from mbkf.viz.film.film import FILMS, write_film

_FILMING = threading.Lock()
"""One film at a time: each has a browser of its own, which takes a processor."""


def export(result: Path, to: str) -> bytes:
    """A result as a file of another program.

    Args:
        result: The folder of the result.
        to: The format.

    Raises:
        UnknownName: The format is unknown.
        FileFormatError: The result is damaged.
        MissingDependency: A library that films need is not installed.
        InvalidInput: The result holds no motion, or no browser draws it.
        OSError: The file cannot be written.
    """
    if to not in RESULT_FORMATS and to not in FILMS:
        raise UnknownName("format", to, (*RESULT_FORMATS, *FILMS))
    r = read_reconstruction(result)
    with tempfile.TemporaryDirectory(prefix="mbkf-export-") as folder:
        file = Path(folder) / f"trial.{to}"
        if to in RESULT_FORMATS:
            export_result(r, to, file)
        else:
            with _FILMING:
                write_film(r, to, file)
        return file.read_bytes()


def session_curves(session: Session, kind: str) -> bytes:
    """All curves of a session as "csv" or "parquet"."""
    with tempfile.TemporaryDirectory(prefix="mbkf-export-") as folder:
        file = Path(folder) / f"curves.{kind}"
        write_session_curves(session, file)
        return file.read_bytes()
