"""Run the whole chain on a synthetic capture and state its error.

A synthetic person is captured. From points without names, with ghosts among them, the command finds names, motion and
torques, and compares them with the known truth.

Examples:
  mbkf demo
  mbkf demo --motion jump --seed 3 --out jump3
"""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING

from mbkf.cli.options import add_out
from mbkf.cli.synth import add_motion_options

if TYPE_CHECKING:
    from mbkf.trial.demo import Demo


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    add_motion_options(parser)
    parser.add_argument(
        "--filter",
        choices=("dynamic", "kinematic", "torque"),
        default="dynamic",
        help="the filter (dynamic)",
    )
    parser.add_argument(
        "--report",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="write report.html beside the result (yes)",
    )
    add_out(parser, "DIR", "folder to write (mbkf-demo)", default="mbkf-demo")


def run(args: argparse.Namespace) -> int:
    """Runs the chain and prints the errors."""
    from mbkf.cli.label import print_labels
    from mbkf.cli.progress import stages
    from mbkf.cli.reconstruct import print_summary
    from mbkf.trial.demo import LABELLED, run_demo

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
        from mbkf.io.atomic import write_text
        from mbkf.viz.report.document import labels_of, report_page

        path, labels = demo.folder / "report.html", labels_of(demo.folder / "result", demo.result.trial)
        write_text(path, report_page(demo.result, demo.summary, labels))
        print(path)
    return 0


def _print_errors(demo: Demo) -> None:
    from mbkf.cli.tables import table, terminal

    shown = table(
        "Against the known truth",
        "coordinate",
        "offset °",
        "angle RMS °",
        "torque RMS N m",
        "torque range N m",
    )
    for error in demo.errors:
        shown.add_row(
            error.name,
            f"{math.degrees(error.angle_offset):.1f}",
            f"{math.degrees(error.angle_rms):.2f}",
            f"{error.moment_rms:.1f}",
            f"{error.moment_range:.0f}",
        )
    terminal().print(shown)
    print(
        "offset: constant difference between the scaled segments' axes and the true ones; angle RMS is without it"
    )
