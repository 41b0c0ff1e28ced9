"""Compares the results of two source trees on all captures: every array equal to 1e-9 of its largest value.

Both trees are driven through their command line alone. Each scales the persons and makes the synthetic
motions, which is compared first; then both follow every capture with the old tree's subjects, with every
filter, causal, smoothed and live (from the file, as fast as it goes). The old tree's results stay in the
output folder and are taken from there the next time.

A filter with gates and matrices near singular enlarges rounding: where sums are taken in another order, 1e-9
may be beyond reach although nothing was changed. ``--rounding`` shows how far: rows beyond the bound are
followed again by the old tree with the mass and the marker positions of the subject one last binary digit up
and down, and each array's difference is shown beside what that moves. The bound stays as it is.

This is no benchmark of ``python -m benchmarks``, which measures one tree: it needs a second one, and an
hour. Run it as ``python -m benchmarks.equality --old TREE``, or with ``--kernels`` to compare this tree's compiled
kernel with its reference. Exit code 0: all equal; 1: something differs;
2: wrong usage.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, replace
from pathlib import Path

from benchmarks.equality.captures import CAPTURES, LEFT_OUT, Captured
from benchmarks.equality.compare import BOUND
from benchmarks.equality.comparison import Comparison, Row
from benchmarks.equality.runs import Tree
from mbkf.errors import InvalidInput, MbkfError, UnknownName
from mbkf.kernel.loading import COMPILED, REFERENCE

HERE = Path(__file__).resolve().parents[2]

SHOWN = 6
"""Arrays beyond the bound that are printed of each row; equality.json has them all."""

NEAR = 10.0
"""Up to how many times the old tree's own rounding a difference is counted as rounding."""


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
        for found in row.beyond[:SHOWN]:
            print(f"          {found.value:9.2e}  {found.rounding:9.2e}  {found.name}")
    for folder, reason in LEFT_OUT.items():
        print(f"left out: {folder}: {reason}")
    what = "made" if args.baseline else f"equal to {BOUND:g}"
    print(f"{len(rows) - len(failed)} of {len(rows)} rows {what}")
    if args.rounding and failed:
        near = sum(row.times_rounding <= NEAR for row in failed)
        print(
            f"{near} of the other {len(failed)}: no array differs by more than {NEAR:g} times what the last "
            "digit of the subject's numbers moves it in the old tree"
        )
    return 1 if failed else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.equality",
        description="Compare the results of two source trees of mbkf on all captures.",
        epilog="example:\n  python -m benchmarks.equality --old ../mbkf-before --data captures --out equality",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument("--old", type=Path, metavar="TREE", help="the tree that is right")
    which.add_argument(
        "--kernels", action="store_true", help="compare the compiled kernel with the reference, in one tree"
    )
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
    parser.add_argument(
        "--rounding",
        action="store_true",
        help="where something differs, also what the last digit of the subject's numbers does in the old tree",
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
    right, tried = (REFERENCE, COMPILED) if args.kernels else ("", "")
    source = args.new if args.old is None else args.old
    old = Tree(source.resolve(), out / "old", data, cached=True, kernel=right)
    new = old if args.baseline else Tree(args.new.resolve(), out / "new", data, cached=False, kernel=tried)
    nudged = replace(old, out=out / "nudged")
    comparison = Comparison(old, new, renamed, args.keep, nudged if args.rounding else None)
    for tree in {old, new, nudged} if args.rounding else {old, new}:
        tree.check()
    jobs = [(capture, run) for capture in captures for run in capture.runs if args.runs in run.name]
    rows: list[Row] = []
    with ThreadPoolExecutor(args.workers) as pool:
        # Lazily, so that no run starts before every person is scaled.
        prepared = [capture for capture in captures if capture.prepare]
        steps = ((comparison.prepared, prepared), (comparison.followed, jobs))
        for row in (row for step in steps for row in pool.map(*step)):
            rows.append(row)
            print(f"{'ok   ' if row.passed else 'FAIL '} {_line(row)}", flush=True)
            text = json.dumps([asdict(r) for r in rows], indent=1)
            (out / ("baseline.json" if args.baseline else "equality.json")).write_text(text, encoding="utf-8")
            yield row


def _chosen(parts: Sequence[str] | None) -> list[Captured]:
    """The captures of these names; a word that is no name stands for all names it is a part of."""
    names = [capture.name for capture in CAPTURES]
    chosen: set[str] = set()
    for part in names if parts is None else parts:
        found = {part} if part in names else {name for name in names if part in name}
        if not found:
            raise UnknownName("capture", part, names)
        chosen |= found
    return [capture for capture in CAPTURES if capture.name in chosen]


def _line(row: Row) -> str:
    """A row as it is printed; with a known rounding, how many times as large the difference is."""
    times = (
        f"  ({row.times_rounding:.3g} x rounding)" if row.beyond and row.times_rounding < float("inf") else ""
    )
    return f"{row.capture:28} {row.run:20} {row.value:9.2e}  {row.arrays:4d} arrays  {row.worst}{times}"


if __name__ == "__main__":
    sys.exit(main())
