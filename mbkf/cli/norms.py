"""`mbkf norms build`: the laboratory's own reference bands, from any set of its sessions."""

from __future__ import annotations

import argparse

_EPILOG = """\
examples:
  mbkf norms build results --out norms.toml
  mbkf norms build adults/results children/results --out norms.toml --name "Our laboratory, 2026"

Each folder holds results as 'mbkf batch' puts them: the first folder below is a person, and each person counts once.
Loads count from cycles that were measured throughout. Reports show the bands with 'mbkf report DIR --norms FILE'.
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    parser = subparsers.add_parser(
        "norms",
        help="the laboratory's own reference bands for reports",
        description="Reference bands of gait: mean and spread between persons.",
        epilog=_EPILOG,
    )
    actions = parser.add_subparsers(dest="action", metavar="ACTION", required=True)
    build = actions.add_parser(
        "build",
        help="from the results of persons",
        description="Build reference bands from the results of persons.",
        epilog=_EPILOG,
        formatter_class=parser.formatter_class,
    )
    build.add_argument("folders", metavar="FOLDER", nargs="+", help="results of persons, by 'mbkf batch'")
    build.add_argument("--out", metavar="FILE.toml", required=True, help="file to write")
    build.add_argument("--name", metavar="TEXT", help="how reports call the bands (the file's name)")
    build.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Builds and writes the bands.

    Raises:
        MbkfError: There are no results, or of fewer than two persons.
        OSError: The file cannot be written.
    """
    from pathlib import Path

    from mbkf.io.norms import write_norms
    from mbkf.study.session.norms import build_norms

    out = Path(args.out)
    norms = build_norms([Path(folder) for folder in args.folders], args.name or out.stem)
    write_norms(norms, out)
    persons = max(band.persons for band in norms.curves.values())
    print(f"{out}: {len(norms.curves)} curves and {len(norms.measures)} measures of {persons} persons")
    return 0
