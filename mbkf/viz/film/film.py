"""A result as a film of its 3-D view."""

from __future__ import annotations

from pathlib import Path

from mbkf.conventions import StageCallback
from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.atomic import replacing
from mbkf.io.results import Reconstruction
from mbkf.viz.film.encoding import write_gif, write_mp4
from mbkf.viz.film.pictures import FilmSettings, film_pictures

FILMS = {
    "mp4": (write_mp4, FilmSettings()),
    "gif": (write_gif, FilmSettings(width=640, height=360)),
}
"""Writer and usual settings of each format."""


def write_film(
    r: Reconstruction,
    kind: str,
    path: str | Path,
    settings: FilmSettings | None = None,
    progress: StageCallback | None = None,
) -> None:
    """Writes a film, whole or not at all.

    Args:
        r: The result.
        kind: "mp4" or "gif".
        path: The file.
        settings: Rate and size; of :data:`FILMS` by default.
        progress: Called with the stage, pictures drawn and their total.

    Raises:
        UnknownName: The format is unknown.
        FileFormatError: The path is a folder.
        MissingDependency: playwright or PyAV is not installed.
        InvalidInput: The result tracks the body in no frame, or no browser draws it.
        OSError: The file cannot be written.
    """
    if kind not in FILMS:
        raise UnknownName("format", kind, FILMS)
    if Path(path).is_dir():
        raise FileFormatError(path, "is a folder; name a file")
    write, usual = FILMS[kind]
    how = settings or usual
    with replacing(path) as partial:
        write(film_pictures(r, how, progress), how.rate_hz, partial)
