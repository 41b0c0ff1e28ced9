"""`mbkf report`: one page about a result, quality first."""

from __future__ import annotations

import argparse
from pathlib import Path

_EPILOG = """\
examples:
  mbkf report result                         writes result/report.html
  mbkf report result --out walk7.html
  mbkf report result --labels labelled.json  adds what 'mbkf label' wrote beside the labelled capture

The page holds everything and loads nothing: markers, residuals, gaps and remarks first, then gait, angles, torques,
reactions and settings. Over 0-100 % cycles where the trial shows gait.
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    parser = subparsers.add_parser(
        "report",
        help="one page about a result: quality, gait, angles, torques, reactions",
        description="Write one self-contained HTML page about a result.",
        epilog=_EPILOG,
    )
    parser.add_argument("folder", metavar="DIR", help="written by 'mbkf reconstruct' or 'mbkf live'")
    parser.add_argument("--out", metavar="FILE.html", help="file to write (DIR/report.html)")
    parser.add_argument(
        "--labels",
        metavar="FILE.json",
        help="written by 'mbkf label' (TRIAL.json in DIR or beside it, where there is one)",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Writes the report.

    Raises:
        MbkfError: There is no result, or the labels are something else.
        OSError: The page cannot be written.
    """
    from mbkf.io.results_folder import read_reconstruction, read_summary
    from mbkf.viz.report.document import labels_of, read_labels, write_report

    folder = Path(args.folder)
    result = read_reconstruction(folder)
    labels = labels_of(folder, result.trial) if args.labels is None else read_labels(args.labels)
    out = Path(args.out) if args.out else folder / "report.html"
    write_report(result, read_summary(folder), out, labels)
    print(out)
    return 0
