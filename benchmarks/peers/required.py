"""The tools compared with, which come with the extra `peers`; without them there is nothing to compare."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from typing import Any

from mbkf.errors import MissingDependency


def opensim() -> Any:
    """Python module of OpenSim, silent.

    Raises:
        MissingDependency: It is not installed.
    """
    module = _module("opensim")
    module.Logger.setLevelString("Off")
    module.Logger.removeFileSink()  # else it writes opensim.log wherever it is called
    return module


def biorbd() -> Any:
    """Python module of biorbd.

    Raises:
        MissingDependency: It is not installed.
    """
    return _module("biorbd")


def _module(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        raise MissingDependency(name, "the comparison with other tools", "peers") from None


@contextmanager
def quiet() -> Iterator[None]:
    """Inside, what the tools print on standard output is left out, also what they print from C++."""
    sys.stdout.flush()
    kept = os.dup(1)
    with Path(os.devnull).open("w", encoding="utf-8") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        try:
            with redirect_stdout(nowhere):
                yield
        finally:
            os.dup2(kept, 1)
            os.close(kept)
