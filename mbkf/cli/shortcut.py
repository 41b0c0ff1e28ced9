"""A shortcut that opens the laboratory's page: in the menu of Linux, on the desktop of macOS, and on that of Windows.

Each opens a terminal window with ``mbkf app``; closing that window ends the page's server.
"""

from __future__ import annotations

import os
import re
import shlex
import sys
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path

from mbkf.cli.windows import NATIVE, windows_desktop
from mbkf.errors import InvalidInput
from mbkf.io.atomic import write_text
from mbkf.io.written import MARK

NAME = "mbkf"
PLAIN = re.compile(r"[\w./:~-]+", re.ASCII)
"""A word that a batch file need not quote."""


def write_shortcut(words: Sequence[str]) -> Path:
    """Writes the shortcut of this system's kind.

    Args:
        words: Words after ``mbkf``.

    Returns:
        Its file.

    Raises:
        InvalidInput: The desktop of Windows is not found.
        ProtectedFile: A file of its name is there that mbkf did not write.
        OSError: It cannot be written.
    """
    command = [sys.executable, "-m", "mbkf", *words]
    distribution = os.environ.get("WSL_DISTRO_NAME")
    if distribution or NATIVE:
        file, text = _desktop() / f"{NAME}.cmd", windows_text(command, distribution)
    elif sys.platform == "darwin":
        file, text = Path.home() / "Desktop" / f"{NAME}.command", macos_text(command)
    else:
        file, text = _menu() / f"{NAME}.desktop", linux_text(command)
    file.parent.mkdir(parents=True, exist_ok=True)
    write_text(file, text)
    file.chmod(0o755)
    return file


def linux_text(command: Sequence[str]) -> str:
    """An entry of the menu (freedesktop.org, "Desktop Entry Specification" 1.5).

    Args:
        command: The program and its words.
    """
    icon = files("mbkf") / "viz" / "assets" / "icon.svg"
    lines = (
        "[Desktop Entry]", f"# {MARK}", "Type=Application", f"Name={NAME}",
        "Comment=Angles, torques and reports from motion capture",
        "Comment[es]=Ángulos, momentos e informes de captura de movimiento",
        f"Exec={' '.join(_entry_word(one) for one in command)}", f"Icon={_value(str(icon))}", "Terminal=true",
        "Categories=Science;MedicalSoftware;",
    )  # fmt: skip
    return "\n".join(lines) + "\n"


def macos_text(command: Sequence[str]) -> str:
    """A script that the Finder opens in the Terminal.

    Args:
        command: The program and its words.
    """
    return f"#!/bin/sh\n# {MARK}\nexec {shlex.join(command)}\n"


def windows_text(command: Sequence[str], distribution: str | None) -> str:
    """A batch file; its lines end as Windows ends them, and page 65001 reads it as UTF-8.

    Args:
        command: The program and its words.
        distribution: That of WSL which starts it; None for Windows itself.
    """
    start = () if distribution is None else ("wsl.exe", "-d", distribution, "--cd", "~", "--exec")
    line = " ".join(_batch_word(one) for one in (*start, *command))
    return f"@echo off\r\nrem {MARK}\r\nchcp 65001 >nul\r\n{line}\r\nif errorlevel 1 pause\r\n"


def _desktop() -> Path:
    """The desktop of Windows.

    Raises:
        InvalidInput: Windows does not answer under WSL.
    """
    found = windows_desktop()
    if found is None and NATIVE:
        return Path.home() / "Desktop"
    if found is None:
        raise InvalidInput(
            "the desktop of Windows is not found: WSL starts no powershell.exe; permit programs of Windows in "
            "/etc/wsl.conf ([interop] enabled = true, appendWindowsPath = true), then run 'wsl --shutdown'"
        )
    return found


def _menu() -> Path:
    """Folder of the user's entries of the menu (freedesktop.org, "XDG Base Directory Specification")."""
    stated = Path(os.environ.get("XDG_DATA_HOME", ""))
    return (stated if stated.is_absolute() else Path.home() / ".local" / "share") / "applications"


def _entry_word(word: str) -> str:
    """A word of Exec in quotes; a string's escapes are laid over those of the quotes."""
    for letter in '\\"`$':
        word = word.replace(letter, "\\" + letter)
    return _value('"' + word.replace("%", "%%") + '"')


def _value(text: str) -> str:
    """A text as the value of a string."""
    return text.replace("\\", "\\\\").replace("\n", "\\n")


def _batch_word(word: str) -> str:
    """A word of a batch file, in quotes where it needs them.

    Raises:
        InvalidInput: It holds a quote or an end of line, which a batch file cannot quote.
    """
    if any(one in word for one in '"\r\n'):
        raise InvalidInput(
            f"a shortcut of Windows cannot hold the name {word!r}; rename the folder without quotes"
        )
    if PLAIN.fullmatch(word):
        return word
    last = word[len(word.rstrip("\\")) :]  # a backslash before the closing quote would escape it
    return '"' + word.replace("%", "%%") + last + '"'
