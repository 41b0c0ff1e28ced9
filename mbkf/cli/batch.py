"""Reconstruct many trials: a folder for each, tables over all.

Scales every person once, reconstructs every trial and writes tables of all of them. A person is scaled from standing
and from other trials that help: a walk, a deep flexion, a movement of the arms (--static-only: from standing alone).

Examples:
  mbkf batch study --out results
  mbkf batch trials.csv --out results --workers 8
  mbkf batch trials.toml --out results --dask tcp://10.0.0.1:8786    (a cluster's scheduler; "local" for this computer)
  mbkf batch study --out results --shard 3/16                        (one of 16 independent jobs)

A folder with captures (.c3d, .trc, or of an installed reader) is a session; the first folder on the way to it names the
person. Captures of several persons in one folder are separated by codes in their names and by subject, mass and height
in the files, else by their movements: each trial gets the standing trial that it fits, and one that fits none fails.
Standing trials are known by their names (static, calibration, t-pose, …); ground reactions lie beside their trial under
its name with "grf" or "forces"; session.toml states mass_kg, height_m and protocol where captures and plates do not. A
list names them instead, and is taken at its word:

  subject,trial,static,forces,mass_kg                    [[subject]]
  P01,P01/walk1.c3d,P01/static.c3d,,71.2                 name = "P01"
  P01,P01/walk2.c3d,,,                                   static = "P01/static.c3d"
                                                         trials = ["P01/walk1.c3d", "P01/walk2.c3d"]

Results stand in DIR/SUBJECT[/SESSION]/TRIAL. DIR/summary.csv has a row for each trial, DIR/curves.csv all gait cycles
at 0 to 100 %; both also as .parquet. The last lines name the trials that are not to be used and those to look at, with
the reason, and the persons whose bodies are doubtful, and count the words; --strict exits with 3 if one is "do not
use". A trial that is done and unchanged is skipped. A bad file fails alone, with its reason in the table.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbkf.cli.options import (
    EXIT_DO_NOT_USE,
    add_convention,
    add_lag_option,
    add_out,
    add_preset_options,
    add_spreads_option,
    add_static_only,
    add_strict,
    asked_spreads,
    count,
    lag_seconds,
    with_chosen,
)

if TYPE_CHECKING:
    import pyarrow as pa

    from mbkf.io.verdict import Verdict

EXIT_FAILED = 1
"""Exit code after a trial that failed."""

DOUBTS = "person_doubts"
"""Column of the table with the doubts about a trial's person."""

SEPARATOR = "; "
"""Text between two doubts."""

REASONS = "verdict.reasons"
"""Column of the table with the reasons of verdicts."""


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("source", metavar="FOLDER|LIST", help="folder of captures, or a list in TOML or CSV")
    parser.add_argument(
        "--workers", type=count, metavar="N", help="processes of one thread each (one for each processor)"
    )
    parser.add_argument("--dask", metavar="ADDRESS", help="a Dask scheduler whose workers compute; or local")
    parser.add_argument(
        "--shard",
        metavar="I/N",
        help="only every N-th trial, beginning with the I-th; a last run without it makes the tables of all",
    )
    parser.add_argument("--filter", choices=("kinematic", "torque", "dynamic"), help="default: dynamic")
    add_preset_options(parser)
    later = parser.add_mutually_exclusive_group()
    later.add_argument("--causal", action="store_true", help="use no later frames")
    add_lag_option(later)
    add_convention(parser, "model", "model")
    add_spreads_option(parser)
    add_static_only(parser)
    add_strict(parser)
    add_out(parser, "DIR", "folder to write", required=True)


def run(args: argparse.Namespace) -> int:
    """Runs the batch and prints the trials that failed."""
    from mbkf.cli.progress import stages
    from mbkf.study.batch.run import batch
    from mbkf.trial.preparation.settings import ReconstructSettings

    settings = ReconstructSettings(
        filter=args.filter or "dynamic",
        smooth=not args.causal and args.lag is None,
        lag_s=lag_seconds(args),
        spreads=asked_spreads(args),
        convention=args.convention,
    )
    settings = with_chosen(settings, args)
    with stages() as report:
        table = batch(
            args.source,
            args.out,
            workers=args.workers,
            dask=args.dask,
            shard=shard_of(args.shard),
            settings=settings,
            static_only=args.static_only,
            progress=report,
        )
    failed, words = _print(table, args.out)
    if failed:
        return EXIT_FAILED
    return EXIT_DO_NOT_USE if args.strict and words["do not use"] else 0


def shard_of(text: str | None) -> tuple[int, int] | None:
    """(I, N) of a text ``I/N``.

    Raises:
        InvalidInput: The text has another form.
    """
    from mbkf.errors import InvalidInput

    if text is None:
        return None
    number, _, total = text.partition("/")
    if not (number.isascii() and number.isdecimal() and total.isascii() and total.isdecimal()):
        raise InvalidInput(f"--shard '{text}': write I/N, such as 3/16")
    return int(number), int(total)


def _print(table: pa.Table, out: str) -> tuple[int, Counter[str]]:
    """Prints counts of trials and of verdicts, the reason of each failure and of each trial that may not be used.

    Returns:
        Number of trials that failed, and of those with each word.
    """
    from mbkf.io.verdict import WORDS

    statuses = table["status"].to_pylist()
    for row in table.select(["folder", "status", "reason"]).to_pylist():
        if row["status"] == "failed":
            print(f"failed: {row['folder']}: {row['reason']}", file=sys.stderr)
    verdicts = dict(_verdicts(table))
    for folder, verdict in verdicts.items():
        if verdict.overall != WORDS[0]:
            print(f"{folder}: {verdict.line}")
    for person, doubts in _doubtful_persons(table).items():
        print(f"person {person}: {doubts}")
    done, unchanged, failed = (statuses.count(status) for status in ("done", "unchanged", "failed"))
    words = Counter(verdict.overall for verdict in verdicts.values())
    if verdicts:
        print("may they be used? " + ", ".join(f"{words[word]} {word}" for word in WORDS))
    print(f"{out}: {done} trials done, {unchanged} unchanged, {failed} failed")
    return failed, Counter(words)


def _doubtful_persons(table: pa.Table) -> dict[str, str]:
    """Doubts about persons, by the names of person and session."""
    columns = ["subject", "session", DOUBTS]
    if DOUBTS not in table.column_names:
        return {}
    found: dict[str, dict[str, None]] = {}
    for row in table.select(columns).to_pylist():
        name, session, doubts = (row[column] for column in columns)
        if doubts:
            parts = found.setdefault(f"{name}/{session}" if session else name, {})
            parts.update(dict.fromkeys(doubts.split(SEPARATOR)))
    return {person: SEPARATOR.join(parts) for person, parts in found.items()}


def _verdicts(table: pa.Table) -> Iterator[tuple[str, Verdict]]:
    """Folder and verdict of each trial that has one, the gravest word first."""
    from mbkf.io.verdict import WORDS, verdict_of_text

    if REASONS not in table.column_names:
        return
    rows = table.select(["folder", REASONS]).to_pylist()
    found = [
        (row["folder"], verdict)
        for row in rows
        if row[REASONS] is not None
        and (verdict := verdict_of_text(f'{{"reasons": {row[REASONS]}}}')) is not None
    ]
    yield from sorted(found, key=lambda one: -WORDS.index(one[1].overall))
