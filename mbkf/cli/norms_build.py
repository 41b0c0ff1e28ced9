"""Build reference bands from the results of several persons.

The bands are mean and spread between persons. Each folder holds results as 'mbkf batch' writes them: the first folder
below is a person, and each person counts once. Walks count whose verdict is 'use', of persons whose session.toml states
age and sex. Who counts and who is left out, with the reason, is printed first. Loads count from cycles that plates
measured throughout.

Examples:
  mbkf norms build results --out norms.toml
  mbkf norms build adults/results children/results --out norms.toml --name "Our laboratory, 2026"
  mbkf norms build results --without P07 --out norms.toml    norms to compare P07 with

Reports show the bands with 'mbkf report DIR --norms FILE'.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from mbkf.cli.options import add_convention, add_out


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("folders", metavar="FOLDER", nargs="+", help="results of persons, by 'mbkf batch'")
    add_out(parser, "FILE.toml", "file to write", required=True)
    add_convention(parser, None, "that of the results")
    parser.add_argument("--name", metavar="TEXT", help="name of the bands in reports (the file's name)")
    parser.add_argument(
        "--without",
        metavar="PERSON",
        action="append",
        default=[],
        help="a person to leave out, e.g. the one that the norms are for; repeatable",
    )


def run(args: argparse.Namespace) -> int:
    """Prints who counts, then writes the bands."""
    from mbkf.io.norms import write_norms
    from mbkf.study.session.norm_selection import norm_selection
    from mbkf.study.session.norms import norms_from, person_sessions
    from mbkf.trial.gait.convention import convention_of

    out = Path(args.out)
    convention = None if args.convention is None else convention_of(args.convention)
    sessions = person_sessions([Path(folder) for folder in args.folders], convention)
    selection = norm_selection(sessions, args.without)
    norms = norms_from(selection, args.name or out.stem)
    for one in selection.persons:
        facts = one.facts
        print(
            f"{facts.name}: {facts.sex}, {facts.age:g} years, {facts.speed_m_s:.2f} m/s, {facts.cycles} cycles"
        )
    for left in selection.left_out:
        print(f"left out: {left.sentence}")
    print(f"{len(selection.persons)} persons, {selection.cycles} cycles")
    write_norms(norms, out)
    print(
        f"{out}: {len(norms.curves)} curves and {len(norms.measures)} measures of {len(norms.persons)} persons"
    )
    return 0
