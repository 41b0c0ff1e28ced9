"""Batches: how the time falls with workers, the same through a Dask cluster, faults, and ten thousand trials.

The study is one synthetic walk in many copies. Ratios are of wall times and need two idle processors.
"""

from __future__ import annotations

from time import perf_counter

import pyarrow as pa

from benchmarks.batch.faults import fault_rows
from benchmarks.batch.many import many_rows
from benchmarks.batch.study import fresh, study
from benchmarks.checks import Check, Context, information
from mbkf.study.batch.cluster import LOCAL
from mbkf.study.batch.run import batch

PERSONS, TRIALS, QUICK = 4, 16, (2, 3)
"""Persons and trials of each."""

SPEED_UP, CLUSTER = 1.8, 1.1
"""Bounds: time on one worker over that on two; that through a cluster over that on two processes."""

OF_THE_RUN = ("seconds", "peak_memory_mb", "step_seconds_median", "step_seconds_p99", "realtime_factor")
"""Columns that differ from run to run."""


def run(context: Context) -> list[Check]:
    """All rows; of a small study when quick."""
    persons, trials = QUICK if context.quick else (PERSONS, TRIALS)
    source = study(context.out / "study", persons, trials)
    seconds: dict[str, float] = {}
    tables: dict[str, pa.Table] = {}
    for name, workers, dask in (("one", 1, None), ("two", 2, None), ("cluster", 2, LOCAL)):
        begin = perf_counter()
        tables[name] = batch(source, fresh(context.out / name), workers=workers, dask=dask)
        seconds[name] = perf_counter() - begin
    count = persons * trials
    return [
        Check(f"{count} trials, one worker over two", seconds["one"] / seconds["two"], SPEED_UP, ">="),
        information(f"{count} trials, two workers", seconds["two"], "s"),
        Check(
            "through a cluster of this computer over two workers",
            seconds["cluster"] / seconds["two"],
            CLUSTER,
            "<=",
        ),
        Check(
            "cells of the tables that differ",
            differing(tables["one"], tables["two"], tables["cluster"]),
            0.0,
            "<=",
        ),
        *fault_rows(context),
        *many_rows(context),
    ]


def differing(*tables: pa.Table) -> int:
    """How many cells differ between tables, those of the run itself left out."""
    first, *others = ([_told(row) for row in table.to_pylist()] for table in tables)
    return sum(
        len(set(map(str, a.items())) ^ set(map(str, b.items())))
        for other in others
        for a, b in zip(first, other, strict=True)
    )


def _told(row: dict[str, object]) -> dict[str, object]:
    return {key: value for key, value in row.items() if key not in OF_THE_RUN}
