"""Benchmarks with parts: all of them, or those of ``--only``, each in an empty folder of its own."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace

from benchmarks.checks import Check, Context
from mbkf.errors import UnknownName

Part = Callable[[Context], Iterable[Check]]
"""Rows of one part; its context names a folder that is its own."""


def part_rows(context: Context, parts: Mapping[str, Part]) -> list[Check]:
    """Rows of all parts, or of those of ``--only``, each with the part's name before its own.

    Args:
        context: The benchmark's input.
        parts: Parts by name.

    Raises:
        UnknownName: A part of ``--only`` does not exist.
    """
    for name in context.only:
        if name not in parts:
            raise UnknownName("part", name, tuple(parts), "--only")
    checks = []
    for name in context.only or parts:
        folder = context.out / name
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        found = parts[name](replace(context, out=folder))
        checks += [replace(check, name=f"{name}: {check.name}") for check in found]
    return checks
