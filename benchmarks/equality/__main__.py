"""Compares the results of two source trees on all captures: every array equal to 1e-9 of its largest value.

Both trees are driven through their command line alone. Each scales the persons and makes the synthetic
motions, which is compared first; then both follow every capture with the old tree's subjects, with every
filter, causal, smoothed and live (from the file, as fast as it goes). The old tree's results stay in the
output folder and are taken from there the next time.

This is no benchmark of ``python -m benchmarks``, which measures one tree: it needs a second one, and an
hour. Run it as ``python -m benchmarks.equality --old TREE``. Exit code 0: all equal; 1: something differs;
2: wrong usage.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from benchmarks.equality.captures import CAPTURES, LEFT_OUT, Captured, Run
from benchmarks.equality.compare import BOUND, Verdict, numbers_in_folder, verdict
from benchmarks.equality.runs import Outcome, Tree
from mbkf.errors import InvalidInput, MbkfError, UnknownName

HERE = Path(__file__).resolve().parents[2]
PREPARED = "prepared"


@dataclass(frozen=True)
class Row:
    """One line of the table.

    Attributes:
        capture: The capture.
        run: Filter and mode, or that it is about what was prepared.
        value: The largest difference as a share of its array's largest value.
        worst: Where it was found, or why the captures cannot be compared.
        arrays: How many arrays were compared; 0 where both trees refuse the command.
        passed: Whether the bound is kept.
    """

    capture: str
    run: str
    value: float
    worst: str
    arrays: int
    passed: bool


@dataclass(frozen=True)
class Comparison:
    """Two trees and how their results are compared.

    Attributes:
        old: The tree that is right.
        new: The tree to compare.
        renamed: Names of the old tree's arrays that the new one gives another.
        keep: Whether the new tree's results stay where they are equal.
    """

    old: Tree
    new: Tree
    renamed: Mapping[str, str]
    keep: bool

    def prepared(self, capture: Captured) -> Row:
        """What both trees prepare for a capture: persons, synthetic motions, virtual sensors."""
        return self._row(capture.name, PREPARED, self.old.prepare(capture), self.new.prepare(capture))

    def followed(self, job: tuple[Captured, Run]) -> Row:
        """What both trees find in a capture with the old tree's person."""
        capture, run = job
        made = self.old.prepare(capture).folder
        old, new = (tree.follow(capture, run, made) for tree in (self.old, self.new))
        return self._row(capture.name, run.name, old, new)

    def _row(self, capture: str, run: str, old: Outcome, new: Outcome) -> Row:
        found = compared_folders(old, new, self.renamed)
        if found.equal and not self.keep and self.new != self.old:
            shutil.rmtree(new.folder, ignore_errors=True)
        return Row(capture, run, found.value, found.worst, found.arrays, found.equal)


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare two trees, or only make the old one's results.

    Args:
        arguments: What follows ``python -m benchmarks.equality``; taken from ``sys.argv`` when None.
    """
    args = _parser().parse_args(arguments)
    try:
        rows = list(_compared(args))
    except (MbkfError, OSError) as error:
        print(f"equality: error: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    failed = [row for row in rows if not row.passed]
    for row in failed:
        print(f"FAIL  {_line(row)}")
    for folder, reason in LEFT_OUT.items():
        print(f"left out: {folder}: {reason}")
    what = "made" if args.baseline else f"equal to {BOUND:g}"
    print(f"{len(rows) - len(failed)} of {len(rows)} rows {what}")
    return 1 if failed else 0


def compared_folders(old: Outcome, new: Outcome, renamed: Mapping[str, str] | None = None) -> Verdict:
    """Compares what two commands left; refusing alike is being equal.

    Args:
        old: The old tree's.
        new: The new tree's.
        renamed: Names of the old tree's arrays that the new one gives another.
    """
    if old.code or new.code:
        value = 0.0 if old.code == new.code else np.inf
        message = "both refuse" if old.code == new.code else f"exit code {old.code} became {new.code}"
        return Verdict(value, f"{message}: {new.message or old.message}", 0)
    return verdict(numbers_in_folder(old.folder, renamed), numbers_in_folder(new.folder))


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.equality",
        description="Compare the results of two source trees of mbkf on all captures.",
        epilog="example:\n  python -m benchmarks.equality --old ../mbkf-before --data captures --out equality",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--old", type=Path, required=True, metavar="TREE", help="the tree that is right")
    parser.add_argument(
        "--new", type=Path, default=HERE, metavar="TREE", help="the tree to compare (default: this one)"
    )
    parser.add_argument(
        "--data",
        type=Path,
        metavar="DIR",
        default=os.environ.get("MBKF_DATA"),
        help="folder of the reference captures (default: $MBKF_DATA)",
    )
    parser.add_argument("--out", type=Path, default=Path("equality"), metavar="DIR", help="results of both")
    parser.add_argument(
        "--only", action="append", metavar="NAME", help="a capture, or a part of names; may be repeated"
    )
    parser.add_argument("--runs", metavar="PART", default="", help="a part of the run's name, e.g. dynamic")
    parser.add_argument(
        "--keep", action="store_true", help="keep the new tree's results where they are equal"
    )
    parser.add_argument(
        "--baseline", action="store_true", help="only make the old tree's results; compare nothing"
    )
    parser.add_argument(
        "--renamed",
        action="append",
        default=[],
        metavar="OLD=NEW",
        help="an array's new name; may be repeated",
    )
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="commands at the same time (1)")
    return parser


def _compared(args: argparse.Namespace) -> Iterator[Row]:
    """Compares, prints each row as it is found, and writes them to equality.json."""
    if args.data is None or not args.data.is_dir():
        raise InvalidInput("no folder of reference captures; give --data DIR")
    captures = _chosen(args.only)
    renamed = dict(pair.split("=", 1) for pair in args.renamed if "=" in pair)
    out, data = args.out.resolve(), args.data.resolve()
    old = Tree(args.old.resolve(), out / "old", data, cached=True)
    new = old if args.baseline else Tree(args.new.resolve(), out / "new", data, cached=False)
    comparison = Comparison(old, new, renamed, args.keep)
    for tree in {old, new}:
        tree.check()
    jobs = [(capture, run) for capture in captures for run in capture.runs if args.runs in run.name]
    rows: list[Row] = []
    with ThreadPoolExecutor(args.workers) as pool:
        # Lazily, so that no run starts before every person is scaled.
        steps = ((comparison.prepared, captures), (comparison.followed, jobs))
        for row in (row for step in steps for row in pool.map(*step)):
            rows.append(row)
            print(f"{'ok   ' if row.passed else 'FAIL '} {_line(row)}", flush=True)
            text = json.dumps([asdict(r) for r in rows], indent=1)
            (out / ("baseline.json" if args.baseline else "equality.json")).write_text(text, encoding="utf-8")
            yield row


def _chosen(parts: Sequence[str] | None) -> list[Captured]:
    names = [capture.name for capture in CAPTURES]
    for part in parts or ():
        if not any(part in name for name in names):
            raise UnknownName("capture", part, names)
    return [c for c in CAPTURES if not parts or c.name in parts or any(part in c.name for part in parts)]


def _line(row: Row) -> str:
    return f"{row.capture:28} {row.run:20} {row.value:9.2e}  {row.arrays:4d} arrays  {row.worst}"


if __name__ == "__main__":
    sys.exit(main())
