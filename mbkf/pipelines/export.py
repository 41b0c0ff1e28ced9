"""A scaled subject as a model file of another program."""

from __future__ import annotations

from pathlib import Path

from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.atomic import replacing
from mbkf.io.subject import Subject
from mbkf.model.human import HumanModel
from mbkf.model.mjcf import to_mjcf
from mbkf.model.urdf import to_urdf

FORMATS = {"urdf": to_urdf, "mjcf": to_mjcf}
"""What a subject can be exported to, by name."""


def export_subject(subject: Subject, kind: str, path: str | Path) -> None:
    """Writes a subject's body with its markers, whole or not at all.

    Args:
        subject: The scaled person.
        kind: A key of :data:`FORMATS`.
        path: The file to write.

    Raises:
        UnknownName: The format, the body, or a marker's segment is unknown.
        FileFormatError: A folder stands where the file is needed.
        OSError: The file cannot be written.
    """
    if kind not in FORMATS:
        raise UnknownName("format", kind, FORMATS)
    if Path(path).is_dir():
        raise FileFormatError(path, "is a folder; name a file")
    model = HumanModel.of(subject)
    text = FORMATS[kind](model, subject.markers)
    with replacing(path) as partial:
        partial.write_text(text, encoding="utf-8")
