"""``python -m benchmarks --gate`` and ``--update-baseline REASON``."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable
from pathlib import Path
from time import perf_counter

from rich.console import Console
from rich.table import Table

from benchmarks.gate.baseline import FILE, read_baseline, updated, write_baseline
from benchmarks.gate.measured import left_out, measured
from benchmarks.gate.metrics import Change
from benchmarks.gate.verdict import Kind, Verdict, verdicts
from mbkf.errors import InvalidInput


def gate(
    console: Console, out: Path, data: Path | None, file: Path = FILE, change: Change | None = None
) -> bool:
    """Measures, compares and prints; returns whether nothing got worse.

    Args:
        console: Where to print.
        out: Folder for files.
        data: Folder of the reference captures; without it their metrics are left out, except where ``CI`` is set.
        file: The baseline.
        change: Changes the settings of every reconstruction.

    Raises:
        FileFormatError: The baseline is damaged.
        InvalidInput: ``CI`` is set and there is no folder of reference captures.
    """
    if data is None and os.environ.get("CI"):
        raise InvalidInput("the gate needs the reference captures here; give --data DIR or set MBKF_DATA")
    begin = perf_counter()
    shutil.rmtree(out, ignore_errors=True)
    baseline = read_baseline(file)
    found = verdicts(list(measured(out, data, change)), baseline)
    found = [one for one in found if not (one.kind == Kind.GONE and left_out(one.name, data))]
    if data is None:
        console.print("real captures are left out: give --data DIR or set MBKF_DATA")
    console.print(_table(found, perf_counter() - begin))
    worse = [one.name for one in found if not one.passed]
    if worse:
        console.print(
            f"the gate stays shut: {'; '.join(worse)}. A change that is meant: --update-baseline 'WHY'",
            soft_wrap=True,
        )
    elif any(one.kind == Kind.BETTER for one in found):
        console.print("some got better: --update-baseline 'WHY' holds them there")
    return not worse


def update(console: Console, out: Path, data: Path | None, reason: str, file: Path = FILE) -> None:
    """Measures and writes a new baseline.

    Args:
        console: Where to print.
        out: Folder for files.
        data: Folder of the reference captures.
        reason: Why it changes.
        file: The baseline.

    Raises:
        InvalidInput: There is no reason or no folder of reference captures, or a metric is not a number.
        OSError: It cannot be written.
    """
    if data is None:
        raise InvalidInput("a baseline holds the reference captures, too: give --data DIR or set MBKF_DATA")
    before = read_baseline(file)
    updated(before, [], reason)
    write_baseline(updated(before, list(measured(out, data)), reason), file)
    console.print(f"{file}: {len(read_baseline(file).metrics)} metrics")


def _table(found: Iterable[Verdict], seconds: float) -> Table:
    table = Table("metric", title=f"gate ({seconds:.0f} s)", title_justify="left")
    for heading in ("value", "was", "worse by", "may"):
        table.add_column(heading, justify="right")
    table.add_column("unit")
    table.add_column("")
    for one in found:
        was, may, unit = ("", "", "") if one.held is None else (
            f"{one.held.value:.4g}", f"{one.held.tolerance:.2g}", one.held.unit,
        )  # fmt: skip
        colour = "green" if one.passed else "bold red"
        table.add_row(
            one.name,
            f"{one.value:.4g}",
            was,
            f"{one.worse_by:.2g}",
            may,
            unit,
            f"[{colour}]{one.kind}[/{colour}]",
        )
    return table
