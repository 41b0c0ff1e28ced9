"""Build reference bands from the results of several persons.

The bands are mean and spread between persons. Each folder holds results as 'mbkf batch' writes them: the first folder
below is a person, and each person counts once. Loads count from cycles that plates measured throughout.

Examples:
  mbkf norms build results --out norms.toml
  mbkf norms build adults/results children/results --out norms.toml --name "Our laboratory, 2026"

Reports show the bands with 'mbkf report DIR --norms FILE'.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from mbkf.cli.options import add_out


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("folders", metavar="FOLDER", nargs="+", help="results of persons, by 'mbkf batch'")
    add_out(parser, "FILE.toml", "file to write", required=True)
    parser.add_argument("--name", metavar="TEXT", help="name of the bands in reports (the file's name)")


def run(args: argparse.Namespace) -> int:
    """Builds and writes the bands."""
    from mbkf.io.norms import write_norms
    from mbkf.study.session.norms import build_norms

    out = Path(args.out)
    norms = build_norms([Path(folder) for folder in args.folders], args.name or out.stem)
    write_norms(norms, out)
    persons = max(band.persons for band in norms.curves.values())
    print(f"{out}: {len(norms.curves)} curves and {len(norms.measures)} measures of {persons} persons")
    return 0
