"""`mbkf demo`: the whole chain on a synthetic capture, with its error against the known truth."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING

from mbkf.cli.synth import add_motion_options

if TYPE_CHECKING:
    from mbkf.trial.demo import Demo


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    parser = subparsers.add_parser(
        "demo",
        help="the whole chain on a synthetic capture, with its error",
        description="A synthetic person is captured; from the points without names, ghosts among them, labels, motion "
        "and torques are found, and compared with what really happened.",
        epilog="example:\n  mbkf demo\n  mbkf demo --motion jump --seed 3 --out jump3",
    )
    add_motion_options(parser)
    parser.add_argument(
        "--filter", choices=("dynamic", "kinematic", "torque"), default="dynamic", help="which filter"
    )
    parser.add_argument(
        "--report",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="write report.html beside the result (yes)",
    )
    parser.add_argument("--out", metavar="DIR", default="mbkf-demo", help="folder to write (mbkf-demo)")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Runs the chain and prints the errors.

    Raises:
        MbkfError: The folder is a file, or an option makes no sense.
    """
    from mbkf.cli.label import print_labels
    from mbkf.cli.progress import stages
    from mbkf.cli.reconstruct import print_summary
    from mbkf.errors import InvalidInput
    from mbkf.trial.demo import LABELLED, run_demo

    if args.seed < 0:
        raise InvalidInput(f"--seed must be 0 or more, got {args.seed}")
    with stages() as report:
        demo = run_demo(
            args.motion,
            args.out,
            seconds=args.seconds,
            seed=args.seed,
            filter_name=args.filter,
            progress=report,
        )
    print_labels(demo.labels, demo.folder / LABELLED)
    print_summary(demo.summary, demo.folder / "result")
    _print_errors(demo)
    if args.report:
        _write_report(demo)
    return 0


def _write_report(demo: Demo) -> None:
    from mbkf.viz.report.document import labels_of, write_report

    path = demo.folder / "report.html"
    write_report(demo.result, demo.summary, path, labels_of(demo.folder / "result", demo.result.trial))
    print(path)


def _print_errors(demo: Demo) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(title="Against the known truth", title_justify="left")
    for heading in ("coordinate", "offset °", "angle RMS °", "torque RMS N m", "torque range N m"):
        table.add_column(heading, justify="left" if heading == "coordinate" else "right")
    for error in demo.errors:
        table.add_row(
            error.name,
            f"{math.degrees(error.angle_offset):.1f}",
            f"{math.degrees(error.angle_rms):.2f}",
            f"{error.moment_rms:.1f}",
            f"{error.moment_range:.0f}",
        )
    console = Console(highlight=False)
    console.print(table)
    console.print(
        "offset: how far the scaled segments' axes stand from the true ones, constant over the trial; "
        "angle RMS is without it"
    )
