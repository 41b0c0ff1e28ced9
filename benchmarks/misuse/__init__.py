"""Hostile use: ordinary acts that destroy, leak or hang; inputs lost or changed, half results and silent ends are 0.

A part is a module or package of this folder with a function ``rows(context)`` that returns checks; it is found by
itself. ``python -m benchmarks misuse --only PART`` runs one part; ``--only`` may be repeated.
"""

from __future__ import annotations

import ast
import importlib
import pkgutil
import signal
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from benchmarks.checks import Check, Context
from benchmarks.parts import part_rows

ENTRY_POINT = "rows"
"""A module or package of this folder that defines a function of this name is a part."""


def run(context: Context) -> list[Check]:
    """Rows of all parts, or of those of ``--only``; each part has a folder of its own, empty at the start.

    Raises:
        UnknownName: A part of ``--only`` does not exist.
    """
    signal.signal(
        signal.SIGINT, signal.default_int_handler
    )  # a job in a shell's background is born ignoring it
    return part_rows(context, {name: partial(_rows, name) for name in parts()})


def _rows(name: str, context: Context) -> list[Check]:
    """Rows of one part, which is imported when it runs."""
    module = importlib.import_module(f"{__name__}.{name}")
    found: list[Check] = getattr(module, ENTRY_POINT)(context)
    return found


def parts() -> tuple[str, ...]:
    """Names of all parts, in alphabetical order; read from the sources, so that none has to be imported."""
    return tuple(sorted(name for folder in __path__ for name in _found_in(Path(folder))))


def _found_in(folder: Path) -> Iterator[str]:
    for module in pkgutil.iter_modules([str(folder)]):
        source = folder / module.name / "__init__.py" if module.ispkg else folder / f"{module.name}.py"
        tree = ast.parse(source.read_text(encoding="utf-8"), str(source))
        if any(isinstance(node, ast.FunctionDef) and node.name == ENTRY_POINT for node in tree.body):
            yield module.name
