"""Opens a page in the browser by a file that only its user may read, so that no secret stands in a command line.

A browser's command line is readable by every user of the computer. It therefore gets the address of a small file, which
leads on to the page with a ticket that works once; the file is removed as soon as the page has come.
"""

from __future__ import annotations

import atexit
import os
import sys
import tempfile
import webbrowser
from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import Protocol

from mbkf.cli.windows import opened_by_windows

PREFIX = "mbkf-open-"
"""Beginning of the file's name; it lies in the home folder, since confined browsers see no folder of the system's."""

PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="referrer" content="no-referrer"><title>mbkf</title>
<meta http-equiv="refresh" content="0;url={address}"></head>
<body><a rel="noreferrer" href="{address}">Open mbkf</a></body></html>
"""


class Served(Protocol):
    """A server with a page.

    Attributes:
        url: Its address, token included.
    """

    url: str

    def entrance(self, used: Callable[[], None]) -> str:
        """An address that admits a browser once; ``used`` is called then."""


def printed_address(server: Served, browser: bool) -> str:
    """The address to print: without the token where a browser is opened and the output may be kept in a log.

    Args:
        server: The server.
        browser: A browser is opened.
    """
    return server.url if sys.stdout.isatty() or not browser else server.url.partition("?")[0]


def open_file(file: Path) -> None:
    """Opens a file in the user's browser; under WSL in that of Windows, which knows no path of Linux.

    Args:
        file: A page.
    """
    if not opened_by_windows(file):
        webbrowser.open(file.absolute().as_uri())


def open_page(server: Served) -> None:
    """Opens a server's page in the user's browser.

    Raises:
        OSError: The file cannot be written.
    """
    descriptor, name = _made()
    file = Path(name)

    def remove() -> None:
        file.unlink(missing_ok=True)

    atexit.register(remove)
    with os.fdopen(descriptor, "w", encoding="utf-8") as text:
        text.write(PAGE.format(address=escape(server.entrance(remove))))
    open_file(file)


def _made() -> tuple[int, str]:
    """A new file that only this user may read, open for writing, and its name."""
    try:
        return tempfile.mkstemp(".html", PREFIX, Path.home())
    except (OSError, RuntimeError):  # no home, or one that cannot be written to
        return tempfile.mkstemp(".html", PREFIX)
