"""Write reference bands as a table (CSV), with source and convention in its comments.

Examples:
  mbkf norms export norms.toml --out norms.csv
  mbkf norms import norms.csv --out again.toml
"""

from __future__ import annotations

import argparse

from mbkf.cli.options import add_out


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument(
        "file", metavar="FILE.toml", help="norms of 'mbkf norms build' or 'mbkf norms import'"
    )
    add_out(parser, "FILE.csv", "file to write", required=True)


def run(args: argparse.Namespace) -> int:
    """Writes the table."""
    from mbkf.io.norm_files.written import write_norms_table
    from mbkf.io.norms import read_norms

    norms = read_norms(args.file)
    write_norms_table(norms, args.out)
    print(f"{args.out}: {len(norms.curves)} curves and {len(norms.measures)} measures")
    return 0
