"""Files and folders that a command left unfinished."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

NAME = re.compile(r"\..*-[0-9a-f]{32}(\.\w+)?")
"""Name of an unfinished file or folder (:mod:`mbkf.io.leftovers`)."""


NAMED = re.compile(r"\.[^/]*-[0-9a-f]{32}\b")
"""Such a name in a sentence."""


def leftovers(folder: Path) -> Iterator[str]:
    """Unfinished files and folders anywhere below a folder."""
    return (str(path.relative_to(folder)) for path in folder.rglob(".*") if NAME.fullmatch(path.name))
