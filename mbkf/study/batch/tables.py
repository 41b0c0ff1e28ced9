"""The tables of a batch: a row per trial with all of its summary, and all curves below each other."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

import pyarrow as pa
import pyarrow.csv as pa_csv
import pyarrow.parquet as pq

from mbkf.io.atomic_folder import replacing_beside
from mbkf.io.files_read import read_state
from mbkf.io.plain_data import parse_json
from mbkf.io.results_folder import RUN_ID, SUMMARY_FILE
from mbkf.io.utf8 import storable
from mbkf.study.batch.curves import SCHEMA, read_curves, repeated
from mbkf.study.batch.outcome import Outcome, Status
from mbkf.study.batch.plan import Plan, Trial
from mbkf.study.batch.trial import CURVES_FILE

ROWS = 500
"""Rows held at a time, however many trials there are."""

OWN = pa.schema(
    [
        ("subject", pa.string()),
        ("session", pa.string()),
        ("trial", pa.string()),
        ("capture", pa.string()),
        ("status", pa.string()),
        ("reason", pa.string()),
        ("seconds", pa.float64()),
        ("peak_memory_mb", pa.float64()),
        ("folder", pa.string()),
        ("person_doubts", pa.string()),
        ("condition", pa.string()),
    ]
)
"""Columns of every trial. status: done, unchanged (done before, from the same) or failed, and then why. seconds,
peak_memory_mb: of the worker. folder: of the results, in the batch's folder. person_doubts: about the scaled person,
empty without any. condition: of walking, as session.toml states it. The other columns are those of summary.json, with
a dot between the keys of its tables; lists stand as JSON."""

TABLES = ("summary.parquet", "summary.csv", "curves.parquet", "curves.csv")
"""Files in the batch's folder."""

Row = dict[str, object]


def write_tables(plan: Plan, outcomes: Sequence[Outcome], out: Path, suffix: str = "") -> Path:
    """Writes ``summary`` and ``curves``, each as CSV and Parquet, all as one; returns the summary as Parquet.

    Args:
        plan: The trials.
        outcomes: Outcome of each.
        out: The batch's folder.
        suffix: Ends the tables' names: that of a shard.

    Raises:
        OSError: They cannot be written.
    """
    pairs = list(zip(plan.trials, outcomes, strict=True))
    summary = out / f"summary{suffix}.parquet"
    curves = pa.schema([*OWN][:3]).with_metadata(None)
    for field in SCHEMA:
        curves = curves.append(field)
    with replacing_beside(summary) as made:
        _write(
            made / summary.name, summary_schema(pairs, out), (_rows(part, out) for part in _batched(pairs))
        )
        _write(made / f"curves{suffix}.parquet", curves, _curves(pairs, out))
    return summary


def summary_schema(pairs: Sequence[tuple[Trial, Outcome]], out: Path) -> pa.Schema:
    """The columns of the table of trials: :data:`OWN`, then whatever any summary holds."""
    kinds: dict[str, pa.DataType] = {}
    for trial, outcome in pairs:
        for key, value in _flat(_summary(trial, outcome, out)):
            kind = _kind(value)
            if kind is not None and kinds.setdefault(key, kind) != kind:
                kinds[key] = pa.string()
    schema = OWN
    for key, kind in kinds.items():
        schema = schema.append(pa.field(key, kind))
    return schema


def _batched(pairs: Sequence[tuple[Trial, Outcome]]) -> Iterator[Sequence[tuple[Trial, Outcome]]]:
    for start in range(0, len(pairs), ROWS):
        yield pairs[start : start + ROWS]


def _rows(pairs: Sequence[tuple[Trial, Outcome]], out: Path) -> list[Row]:
    rows = []
    for trial, outcome in pairs:
        row: Row = {
            "subject": trial.person.name,
            "session": trial.person.session,
            "trial": trial.name or trial.path.stem,
            "capture": str(trial.path),
            "status": str(outcome.status),
            "reason": outcome.reason,
            "seconds": outcome.seconds,
            "peak_memory_mb": outcome.peak_memory_mb,
            "folder": trial.place.as_posix(),
            "person_doubts": outcome.doubts,
            "condition": trial.condition,
        }
        rows.append({**dict(_flat(_summary(trial, outcome, out))), **row})
    return rows


def _summary(trial: Trial, outcome: Outcome, out: Path) -> Mapping[str, object]:
    """The trial's summary without its run's number; nothing for one that failed."""
    if outcome.status == Status.FAILED:
        return {}
    try:
        found = parse_json(read_state(out / trial.place / SUMMARY_FILE))
    except (OSError, ValueError):
        return {}
    return {key: value for key, value in found.items() if key != RUN_ID}


def _flat(values: Mapping[str, object], above: str = "") -> Iterator[tuple[str, object]]:
    """Entries of a table and the tables in it; those of the trial's own columns go without saying."""
    for key, value in values.items():
        name = f"{above}{key}"
        if isinstance(value, dict):
            yield from _flat(value, f"{name}.")
        elif name not in OWN.names:
            yield name, json.dumps(value, ensure_ascii=False) if isinstance(value, list) else value


def _kind(value: object) -> pa.DataType | None:
    """Type of a column that holds such a value; None where the value leaves it open."""
    if value is None:
        return None
    if isinstance(value, bool):
        return pa.bool_()
    return pa.float64() if isinstance(value, int | float) else pa.string()


def _as(kind: pa.DataType, value: object) -> object:
    """A value in its column."""
    if value is None:
        return None
    if kind == pa.string():
        return storable(value) if isinstance(value, str) else json.dumps(value)
    return float(value) if kind == pa.float64() and isinstance(value, int | float) else value


def _curves(pairs: Sequence[tuple[Trial, Outcome]], out: Path) -> Iterator[pa.Table]:
    """The curves of every trial, with its names before them."""
    for trial, outcome in pairs:
        file = out / trial.place / CURVES_FILE
        if outcome.status == Status.FAILED or not file.is_file():
            continue
        table = read_curves(file)
        for place, name in enumerate(
            (trial.person.name, trial.person.session, trial.name or trial.path.stem)
        ):
            table = table.add_column(
                place, OWN.names[place], pa.repeat(pa.scalar(storable(name), pa.string()), len(table))
            )
        yield table


def _write(path: Path, schema: pa.Schema, parts: Iterator[pa.Table | list[Row]]) -> None:
    """Writes a table piece by piece, as Parquet and at the same time as CSV beside it, into an unfinished folder."""
    plain = _plain(schema)

    def write_text(table: pa.Table) -> None:
        rows.write_table(table.cast(plain))

    with ExitStack() as files:
        partials = [path.with_suffix(end) for end in (".parquet", ".csv")]
        parquet, text = (files.enter_context(partial.open("wb")) for partial in partials)
        columns = files.enter_context(
            pq.ParquetWriter(parquet, schema, compression="zstd", use_dictionary=repeated(schema))
        )
        rows = files.enter_context(pa_csv.CSVWriter(text, plain))
        beside = files.enter_context(ThreadPoolExecutor(1))
        written: Future[None] | None = None
        for part in parts:
            table = part if isinstance(part, pa.Table) else _table(part, schema)
            if written is not None:
                written.result()
            written = beside.submit(write_text, table)
            columns.write_table(table)
        if written is not None:
            written.result()


def _table(rows: Sequence[Row], schema: pa.Schema) -> pa.Table:
    columns = {f.name: [_as(f.type, row.get(f.name)) for row in rows] for f in schema}
    return pa.table(columns, schema=schema)


def _plain(schema: pa.Schema) -> pa.Schema:
    """The columns as text has them: words in full."""
    return pa.schema([pa.field(f.name, pa.string()) if pa.types.is_dictionary(f.type) else f for f in schema])
