"""`mbkf protocol check`: whether a marker set explains a capture."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from mbkf.trial.protocol.check import SetCheck

WORST_SHOWN = 8

_EPILOG = """\
A body is scaled to the capture by the set, with the stated mass or a nominal one. Exit code 1 where the set does not
explain the capture.

examples:
  mbkf protocol check my_markers.toml static.c3d
  mbkf protocol check plug_in_gait walk.c3d
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the group."""
    from mbkf.cli.options import CAPTURE_FILES, add_axes_options

    parser = subparsers.add_parser(
        "check",
        help="whether a marker set explains a capture",
        description="Whether a marker set explains a capture: markers, segments, and how well a person fits.",
        epilog=_EPILOG,
    )
    parser.add_argument("protocol", metavar="NAME|FILE", help="marker set")
    parser.add_argument("capture", metavar="CAPTURE", help=f"capture ({CAPTURE_FILES})")
    add_axes_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Prints what the set makes of the capture.

    Returns:
        0, or 1 where the set does not explain it.

    Raises:
        MbkfError: The set or the capture cannot be read.
    """
    from mbkf.cli.options import axes_options
    from mbkf.cli.progress import stages
    from mbkf.cli.protocol import wide_console
    from mbkf.io.capture import read_capture
    from mbkf.model.protocol import load_protocol
    from mbkf.trial.protocol.check import BAD, check_set

    protocol = load_protocol(args.protocol)
    capture = read_capture(args.capture, **axes_options(args))
    with stages() as report:
        found = check_set(protocol, capture, report)
    _show(found, wide_console())
    return 1 if found.verdict == BAD else 0


def _show(found: SetCheck, console: Console) -> None:
    from mbkf.trial.preparation.coverage import UNKNOWN, listed

    console.print(found.use.told, soft_wrap=True)
    if found.use.unknown:
        console.print(f"unknown: {listed(found.use.unknown)}", soft_wrap=True)
    others = {name: reason for name, reason in found.use.ignored.items() if reason != UNKNOWN}
    for name, reason in others.items():
        console.print(f"not used: {name}: {reason}", soft_wrap=True)
    if found.absent:
        console.print(f"not in the capture: {listed(found.absent)}", soft_wrap=True)
    if found.bare:
        names = ", ".join(name.replace("_", " ") for name in found.bare)
        console.print(f"segments without a marker: {names}", soft_wrap=True)
    if found.rms_mm is not None:
        console.print(_worst(found))
        console.print(f"markers fit a scaled person to {found.rms_mm:.1f} mm RMS")
    for reason in found.reasons:
        console.print(f"- {reason}", soft_wrap=True)
    console.print(f"verdict: {found.verdict}")


def _worst(found: SetCheck) -> Table:
    from rich.table import Table

    table = Table(title="Markers that fit worst", title_justify="left")
    for heading in ("marker", "segment", "RMS mm", "from its place mm", ""):
        table.add_column(heading, justify="right" if heading.endswith("mm") else "left")
    for one in found.markers[:WORST_SHOWN]:
        note = "not there" if one.wrong else "far" if one.far else ""
        segment = one.segment.replace("_", " ")
        table.add_row(one.name, segment, f"{one.rms_mm:.1f}", f"{one.moved_mm:.0f}", note)
    return table
