"""Scores of chosen persons, motions, scalings and filters, as tables; makes persons of our own, and the baseline."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from benchmarks.__main__ import DATA_VARIABLE
from benchmarks.dynamic.methods import in_parallel
from benchmarks.foreign import SESSION
from benchmarks.foreign.calibration import write_page
from benchmarks.foreign.errors import Judged
from benchmarks.foreign.followed import FILTERS, SCALINGS, SMOOTHED, Job, followed, jobs
from benchmarks.foreign.making import make
from benchmarks.foreign.making.skin import MODELS
from benchmarks.foreign.medians import medians, write_baseline
from benchmarks.foreign.own_body import OwnBody, judged_own
from benchmarks.foreign.score import score
from benchmarks.foreign.sets import own_sets, shared_set
from benchmarks.foreign.tables import group_table, offset_table, score_table
from benchmarks.foreign.truth import FOLDER, foreigners
from mbkf.errors import InvalidInput, MbkfError

WIDTH = 150

OWN_SEEDS = (40, 41, 42, 44, 45, 46)
"""Synthetic persons of the calibration page; others than those that settings were chosen on. The 43rd cannot walk."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Scores persons and prints tables.

    Args:
        arguments: What follows ``python -m benchmarks.foreign``; taken from ``sys.argv`` when None.

    Returns:
        0, or 2 on bad input.
    """
    args = _parser().parse_args(arguments)
    try:
        if args.make is not None:
            make(_data(args), args.make, args.seed, args.persons)
        elif args.update_baseline is not None:
            _update(args)
        elif args.page is not None:
            _write_page(args)
        else:
            _show(args)
    except (MbkfError, OSError) as error:
        print(f"benchmarks.foreign: error: {error}", file=sys.stderr)
        return 2
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.foreign", description=__doc__)
    data = os.environ.get(DATA_VARIABLE)
    parser.add_argument(
        "--data", type=Path, default=data, metavar="DIR", help="folder of the reference captures"
    )
    parser.add_argument("--made", type=Path, metavar="DIR", help="persons of this folder instead")
    parser.add_argument(
        "--persons", nargs="+", default=[], metavar="NAME", help="these persons (default: all)"
    )
    parser.add_argument(
        "--motions", nargs="+", default=[], metavar="NAME", help="these motions (default: all)"
    )
    parser.add_argument(
        "--make", type=Path, metavar="DIR", help="make persons of our own here (extra `peers`)"
    )
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="of what is made at random")
    parser.add_argument(
        "--update-baseline",
        type=Path,
        metavar="DIR",
        help="write the medians of the shared persons and of those made in this folder as the new baseline",
    )
    parser.add_argument(
        "--page", type=Path, metavar="DIR", help="write the calibration page here, with the persons of --made"
    )
    parser.add_argument("--scaling", nargs="+", default=list(SCALINGS), choices=list(SCALINGS))
    parser.add_argument("--filter", nargs="+", default=[SMOOTHED], choices=list(FILTERS))
    return parser


def _data(args: argparse.Namespace) -> Path:
    if args.data is None:
        raise InvalidInput(f"the reference captures are needed; give --data DIR or set {DATA_VARIABLE}")
    return Path(args.data)


def _update(args: argparse.Namespace) -> None:
    sets = [shared_set(_data(args)), *own_sets(args.update_baseline)]
    with in_parallel() as mapper:
        write_baseline({f"{one.name}, {SESSION}": medians(one.found(SESSION, mapper)) for one in sets})


def _write_page(args: argparse.Namespace) -> None:
    if args.made is None:
        raise InvalidInput("the page needs persons of our own; make them with --make DIR and give --made DIR")
    with in_parallel() as mapper:
        sets = {"shared adult, child": shared_set(_data(args)).found(SESSION, mapper)}
        for model, one in zip(MODELS, [held for held in own_sets(args.made) if held.shown], strict=True):
            sets[f"own, {model} skin"] = one.found(SESSION, mapper)
        own = mapper(judged_own, [OwnBody(seed) for seed in OWN_SEEDS])
        sets["made from our body"] = [one for held in own for one in held]
    write_page(args.page, Path(__file__).parent, sets)


def _show(args: argparse.Namespace) -> None:
    persons = foreigners(args.made or _data(args) / FOLDER, args.persons)
    found: dict[str, list[Judged]] = {}
    work: list[tuple[str, Job]] = [
        (f"{scaling}, {name}", job)
        for scaling in args.scaling
        for name in args.filter
        for job in jobs(persons, scaling, args.motions, name)
    ]
    with in_parallel() as mapper:
        results = mapper(followed, [job for _, job in work])
    for (label, _), result in zip(work, results, strict=True):
        found.setdefault(label, []).extend(result)
    console = Console(width=WIDTH)
    scores = {label: score(held) for label, held in found.items()}
    console.print(score_table("legs; calibration error and median sd of all angles", scores))
    console.print(group_table("groups of angles", scores))
    for label, held in found.items():
        console.print(offset_table(f"hip flexion, {label}", held))


if __name__ == "__main__":
    sys.exit(main())
