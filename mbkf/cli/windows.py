"""Windows, itself or around WSL: paths and programs of the system that shows the browser and the desktop.

WSL carries ``wslpath`` and starts programs of Windows by their names (Microsoft, "Working across Windows and Linux file
systems"). On systems without ``wslpath`` and PowerShell every function gives None or False.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

NATIVE = os.name == "nt"
"""True on Windows itself, False under WSL."""

PATIENCE_S = 20.0
"""Longest wait for a program of Windows."""

_DESKTOP = "[Console]::OutputEncoding = [Text.Encoding]::UTF8; [Environment]::GetFolderPath('Desktop')"
"""PowerShell's question for the desktop, which OneDrive may have moved out of the user's folder."""


def windows_path(path: Path) -> str | None:
    """The path of a file of WSL as Windows names it; None outside WSL.

    Args:
        path: The file.
    """
    return _said("wslpath", "-w", str(path.absolute()))


def opened_by_windows(path: Path) -> bool:
    """Opens a file of WSL in the program that Windows has for it; False outside WSL.

    Args:
        path: The file.
    """
    explorer, named = shutil.which("explorer.exe"), windows_path(path)
    if explorer is None or named is None:
        return False
    try:  # its exit code is 1 also where it has opened the file
        subprocess.run([explorer, named], capture_output=True, timeout=PATIENCE_S, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return False
    return True


def windows_desktop() -> Path | None:
    """The folder of the Windows desktop, under WSL as WSL names it; None where Windows does not answer."""
    desktop = _said("powershell.exe", "-NoProfile", "-Command", _DESKTOP)
    if NATIVE and desktop is not None:
        return Path(desktop)
    named = None if desktop is None else _said("wslpath", "-u", desktop)
    return None if named is None else Path(named)


def _said(*words: str) -> str | None:
    """The answer of a program; None where it is missing, fails or says nothing."""
    program = shutil.which(words[0])
    if program is None:
        return None
    try:
        done = subprocess.run([program, *words[1:]], capture_output=True, timeout=PATIENCE_S, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return None
    text = done.stdout.decode("utf-8", "replace").strip()
    return text if done.returncode == 0 and text else None
