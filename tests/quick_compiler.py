"""A C compiler that does not optimise: tests of installations ask whether a kernel is made, not how fast it is."""

import os
import shlex
import shutil
from pathlib import Path

import pytest


def quick_compiler(folder: Path) -> str:
    """A program in a folder that calls the compiler of this computer with -O0 last."""
    compiler = os.environ.get("CC", "cc")
    if shutil.which(shlex.split(compiler)[0]) is None:
        pytest.skip("no C compiler here")
    folder.mkdir(parents=True, exist_ok=True)
    program = folder / "cc"
    program.write_text(f'#!/bin/sh\nexec {compiler} "$@" -O0\n')
    program.chmod(0o755)
    return str(program)
