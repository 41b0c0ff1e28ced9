"""Names of points that the header of a capture states, read without its samples."""

from __future__ import annotations

from functools import lru_cache
from itertools import islice
from pathlib import Path

from mbkf.errors import MbkfError
from mbkf.io.c3d_decode import values_of
from mbkf.io.c3d_layout import Processor, check_layout
from mbkf.io.c3d_parameters import C3dParameters
from mbkf.io.files_read import opened
from mbkf.io.labels import without_subject

KEPT = 20_000
"""Files whose names are kept, so that a page that plans a study again and again reads each once."""

TRC_NAMES, TRC_FIRST = 3, 2
"""Line of a TRC file with the names, and titles before them."""


def stated_markers(path: Path) -> frozenset[str]:
    """Names of the points of a C3D or TRC file, without a subject's; empty where they cannot be read.

    Args:
        path: The file.
    """
    try:
        state = path.stat()
        return _read(path, state.st_size, state.st_mtime_ns)
    except (MbkfError, OSError, ValueError):
        return frozenset()


@lru_cache(maxsize=KEPT)
def _read(path: Path, size: int, changed_ns: int) -> frozenset[str]:
    del size, changed_ns  # a changed file is another one
    names = list[str]()
    if path.suffix.lower() == ".c3d":
        layout = check_layout(path)
        values = values_of(layout.section.groups, layout.section.records, Processor(layout.processor))
        names = C3dParameters(values).texts("POINT", "LABELS")
    elif path.suffix.lower() == ".trc":
        with opened(path) as file:
            lines = [line.decode("utf-8", "replace") for line in islice(file, TRC_NAMES, TRC_NAMES + 1)]
        names = [name for line in lines for name in line.split()[TRC_FIRST:]]
    return frozenset(name for name in without_subject(names) if name)
