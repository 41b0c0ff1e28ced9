r"""laboratory.toml: name, address and logo of a laboratory for the head of its reports, beside its sessions.

name = "Gait laboratory"
address = "1 Example Road\nExampletown"
logo = "logo.png"
trend = ["Speed", "Step length"]
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from mbkf.errors import FileFormatError
from mbkf.io import fields
from mbkf.io.atomic import replacing, write_text
from mbkf.io.edited_toml import edited_toml
from mbkf.io.files_read import read_bytes
from mbkf.io.plain_data import plain_text
from mbkf.io.toml import Entries, toml_text

LABORATORY_FILE = "laboratory.toml"

MOST_LOGO = 1024 * 1024
"""Most bytes of a logo; every report carries it."""

_TYPES = {b"\x89PNG\r\n\x1a\n": "image/png", b"\xff\xd8\xff": "image/jpeg"}
"""First bytes of pictures, and their media types."""

_NAME = fields.text("name", "name of the laboratory", empty=True)
_ADDRESS = fields.text("address", "address, in several lines where you like", empty=True)
_LOGO = fields.text("logo", "picture beside this file, PNG or JPEG of at most 1 MB", empty=True)
_TREND = fields.texts("trend", "measures of the page on several visits; by default speed, steps and support")
LABORATORY = fields.record("laboratory", _NAME, _ADDRESS, _LOGO, _TREND)
"""Entries of a laboratory's file."""

_KIND, _HINT = "a laboratory's file", "see the documentation of files edited by hand"


@dataclass(frozen=True)
class Laboratory:
    """A laboratory; empty where an entry is not stated.

    Attributes:
        name, address: Texts; the address has several lines.
        logo: Content of the picture.
        media_type: "image/png" or "image/jpeg"; empty without a logo.
        trend: Measures of the page on several visits; empty for the usual ones.
        logo_file: Name of the picture beside the file; empty for one that is not written yet.
    """

    name: str = ""
    address: str = ""
    logo: bytes = b""
    media_type: str = ""
    trend: tuple[str, ...] = ()
    logo_file: str = ""


def read_laboratory(path: str | Path) -> Laboratory:
    """Reads a laboratory's file and its logo.

    Raises:
        UnknownEntry: It has an entry that laboratories do not have.
        FileFormatError: It is missing or damaged, or its logo is missing, too large or no picture.
    """
    read = Entries.of_file(LABORATORY, path, _KIND, _HINT)
    logo = read.get(_LOGO) or ""
    content = _logo(Path(path), logo, read) if logo else b""
    return Laboratory(
        read.get(_NAME) or "",
        read.get(_ADDRESS) or "",
        content,
        media_type_of(content),
        read.get(_TREND) or (),
        logo,
    )


def laboratory_above(folders: Iterable[Path]) -> Laboratory:
    """The laboratory of the first folder that has a file of one; an empty one without it.

    Args:
        folders: Folders in the order in which they count.

    Raises:
        FileFormatError: The file is damaged.
    """
    for folder in folders:
        if (file := folder / LABORATORY_FILE).is_file():
            return read_laboratory(file)
    return Laboratory()


def media_type_of(content: bytes) -> str:
    """The media type, "image/png" or "image/jpeg", by the first bytes of a picture; empty for anything else."""
    return next((kind for first, kind in _TYPES.items() if content.startswith(first)), "")


def write_laboratory(laboratory: Laboratory, folder: Path) -> None:
    """Writes a laboratory's file into a folder, and a new logo beside it; comments of people in the file stay.

    Raises:
        OSError: A file cannot be written.
    """
    name = laboratory.logo_file
    if laboratory.logo and not name:
        content = hashlib.sha256(laboratory.logo).hexdigest()[:8]  # so that no other picture is replaced
        name = f"logo-{content}.{laboratory.media_type.removeprefix('image/')}"
        with replacing(folder / name, edits=True) as partial:
            partial.write_bytes(laboratory.logo)
    table = {"name": laboratory.name, "address": laboratory.address, "logo": name}
    found: dict[str, object] = {key: text for key, text in table.items() if text}
    if laboratory.trend:
        found["trend"] = list(laboratory.trend)
    file, text = folder / LABORATORY_FILE, toml_text("A laboratory, for the head of its reports.", found)
    write_text(file, edited_toml(plain_text(file), text) if file.is_file() else text, edits=True)


def _logo(file: Path, name: str, read: Entries) -> bytes:
    """The picture beside the file.

    Raises:
        FileFormatError: It is missing, too large or no picture.
    """
    if Path(name).name != name:
        raise read.fault(f"logo must be the name of a picture beside this file, got {name}", "logo")
    try:
        content = read_bytes(file.parent / name, MOST_LOGO)
    except OSError as error:
        raise read.fault(f"the logo {name} is not beside this file", "logo") from error
    if not media_type_of(content):
        raise FileFormatError(file.parent / name, "no picture; the logo must be PNG or JPEG")
    return content
