"""The laboratory of the page's folder, for the head of its reports: shown, and changed by the page."""

from __future__ import annotations

import base64
import binascii
from collections.abc import Mapping
from dataclasses import replace

from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.io.laboratory import (
    MOST_LOGO,
    Laboratory,
    laboratory_above,
    media_type_of,
    write_laboratory,
)

Plain = dict[str, object]


def laboratory_of(workspace: Workspace) -> Laboratory:
    """The laboratory of the page's folder; an empty one before it is stated.

    Raises:
        FileFormatError: Its file is damaged.
    """
    return laboratory_above([workspace.root])


def plain_laboratory(workspace: Workspace) -> Plain:
    """Name and address, and whether there is a logo."""
    found = laboratory_of(workspace)
    return {"name": found.name, "address": found.address, "logo": bool(found.logo)}


def change_laboratory(workspace: Workspace, sent: object) -> Plain:
    """Changes the entries that a page sends: ``name``, ``address``, and ``logo`` in base64, empty to remove it.

    Args:
        workspace: The page's folder.
        sent: The entries.

    Raises:
        InvalidInput: An entry is no text, or the logo no picture of at most 1 MB.
        FileFormatError: The file is damaged.
        OSError: It cannot be written.
    """
    if not isinstance(sent, Mapping) or not all(isinstance(one, str) for one in sent.values()):
        raise InvalidInput("the page sent no entries of a laboratory")
    found = laboratory_of(workspace)
    found = replace(found, name=sent.get("name", found.name), address=sent.get("address", found.address))
    if "logo" in sent:
        content = _picture(sent["logo"])
        found = replace(found, logo=content, media_type=media_type_of(content), logo_file="")
    write_laboratory(found, workspace.root)
    return plain_laboratory(workspace)


def _picture(text: str) -> bytes:
    """The content of a logo.

    Raises:
        InvalidInput: It is no picture of at most 1 MB.
    """
    try:
        content = base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError) as error:
        raise InvalidInput("the page sent a logo that is no picture") from error
    if content and (len(content) > MOST_LOGO or not media_type_of(content)):
        raise InvalidInput("the logo must be a picture in PNG or JPEG of at most 1 MB; choose another file")
    return content
