"""``python -m benchmarks.screenshots [FOLDER]``: takes all pictures; needs Chromium and the captures of MBKF_DATA."""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

from benchmarks.screenshots.table import FOLDER, take

if __name__ == "__main__":
    if "MBKF_DATA" not in os.environ:
        sys.exit("set MBKF_DATA to the folder of the captures (docs/captures.md)")
    with tempfile.TemporaryDirectory(prefix="mbkf-") as scratch:
        target = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
        for file in take(Path(scratch), target, Path(os.environ["MBKF_DATA"])):
            print(file, file.stat().st_size)
