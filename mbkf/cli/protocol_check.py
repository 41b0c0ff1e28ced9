"""Check a marker set against a capture: markers, segments, fit of a person.

A body is scaled to the capture by the set, with the stated mass or a nominal one. Exit code 1 if the set does not
explain the capture.

Examples:
  mbkf protocol check my_markers.toml static.c3d
  mbkf protocol check plug_in_gait walk.c3d
"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from mbkf.cli.options import CAPTURE_FILES, add_axes_options, axes_options
from mbkf.cli.tables import table, terminal

if TYPE_CHECKING:
    from mbkf.trial.protocol.check import SetCheck

WORST_SHOWN = 8


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("protocol", metavar="NAME|FILE", help="marker set")
    parser.add_argument("capture", metavar="CAPTURE", help=f"capture ({CAPTURE_FILES})")
    add_axes_options(parser)


def run(args: argparse.Namespace) -> int:
    """Prints the findings; returns 1 if the set does not explain the capture."""
    from mbkf.cli.progress import stages
    from mbkf.io.capture import read_capture
    from mbkf.model.protocol import load_protocol
    from mbkf.trial.protocol.check import BAD, check_set

    protocol = load_protocol(args.protocol)
    capture = read_capture(args.capture, **axes_options(args))
    with stages() as report:
        found = check_set(protocol, capture, report)
    _show(found)
    return 1 if found.verdict == BAD else 0


def _show(found: SetCheck) -> None:
    from mbkf.trial.preparation.coverage import UNKNOWN, listed

    lines = [found.use.summary]
    if found.use.unknown:
        lines.append(f"unknown: {listed(found.use.unknown)}")
    others = {name: reason for name, reason in found.use.ignored.items() if reason != UNKNOWN}
    lines += [f"not used: {name}: {reason}" for name, reason in others.items()]
    if found.absent:
        lines.append(f"not in the capture: {listed(found.absent)}")
    if found.bare:
        lines.append(f"segments without a marker: {', '.join(found.bare)}".replace("_", " "))
    console = terminal()
    for line in lines:
        console.print(line, soft_wrap=True)
    if found.rms_mm is not None:
        worst = table(
            "Markers that fit worst", "marker", "segment", "RMS mm", "from its place mm", "", words=2
        )
        for one in found.markers[:WORST_SHOWN]:
            note = "not there" if one.wrong else "far" if one.far else ""
            segment = one.segment.replace("_", " ")
            worst.add_row(one.name, segment, f"{one.rms_mm:.1f}", f"{one.moved_mm:.0f}", note)
        console.print(worst)
        console.print(f"markers fit a scaled person to {found.rms_mm:.1f} mm RMS")
    for reason in found.reasons:
        console.print(f"- {reason}", soft_wrap=True)
    console.print(f"verdict: {found.verdict}")
