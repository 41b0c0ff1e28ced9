"""`mbkf info`: what a capture holds, as tables or as JSON."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable
from dataclasses import asdict
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from mbkf.trial.info import AxesSummary, CaptureSummary, MarkerSummary, ProtocolSummary

_MOST_WITH_GAPS = 30
_PIPED_WIDTH = 110


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the parser of this command."""
    from mbkf.cli.options import CAPTURE_FILES, FORCE_FILES, add_axes_options

    parser = subparsers.add_parser(
        "info",
        help="what a capture holds: markers, gaps, plates, channels, axes",
        description="What a capture holds: markers and their gaps, force plates and their offsets, analog "
        "channels, events, rates, axes and units.",
        epilog="example:\n  mbkf info walk.c3d\n  mbkf info walk.trc --forces walk_grf.mot --json",
    )
    parser.add_argument("file", metavar="FILE", help=f"capture ({CAPTURE_FILES})")
    parser.add_argument(
        "--forces", metavar="FILE", help=f"ground reactions that belong to the capture ({FORCE_FILES})"
    )
    add_axes_options(parser)
    parser.add_argument("--json", action="store_true", help="print everything as JSON")
    parser.set_defaults(func=run, run=run)


def run(args: argparse.Namespace) -> int:
    """Read the capture and print its summary.

    Args:
        args: ``file``, ``forces``, ``up``, ``axes``, ``unit`` and ``json``.

    Returns:
        0.

    Raises:
        MbkfError: The capture cannot be read.
    """
    from mbkf.cli.options import axes_options
    from mbkf.io.capture import read_capture
    from mbkf.trial.info import describe

    summary = describe(read_capture(args.file, forces=args.forces, **axes_options(args)))
    if args.json:
        print(json.dumps(asdict(summary), indent=2, ensure_ascii=False, allow_nan=False))
        return 0
    from rich.console import Console

    console = Console(highlight=False)
    if not console.is_terminal:
        console = Console(highlight=False, width=_PIPED_WIDTH)
    show(summary, console)
    return 0


def show(summary: CaptureSummary, console: Console) -> None:
    """Print a summary as tables.

    Args:
        summary: What the capture holds.
        console: Where to print.
    """
    from rich.markup import escape

    console.print(f"[bold]{escape(summary.path)}[/]", soft_wrap=True)
    console.print(_overview(summary))
    named = [marker for marker in summary.markers if not marker.name.startswith("*")]
    if named:
        console.print(f"[bold]Markers[/]  {escape(' '.join(marker.name for marker in named))}")
    gaps = sorted(
        (marker for marker in summary.markers if marker.missing_fraction > 0.0),
        key=lambda marker: -marker.missing_fraction,
    )
    if gaps:
        console.print(_gaps(gaps[:_MOST_WITH_GAPS], len(gaps)))
    if summary.plates:
        console.print(_plates(summary))
    if summary.events:
        console.print(_events(summary))
    for note in summary.notes:
        console.print(f"[yellow]note[/]  {escape(note)}")


def _overview(summary: CaptureSummary) -> Table:
    from rich.markup import escape
    from rich.table import Table

    table = Table(show_header=False, box=None, pad_edge=False)
    table.add_column(style="dim", justify="right")
    table.add_column()
    frames = f"{summary.frames} at {summary.rate_hz:g} Hz, {summary.duration_s:.2f} s"
    table.add_row("frames", f"{frames}, from {summary.start_time_s:.3f} s")
    table.add_row("axes, unit", f"{summary.up_axis} up, {summary.length_unit}")
    table.add_row("axes checked", escape(_axes(summary.axes)))
    missing = f"{100 * summary.missing_fraction:.2f} % of samples missing"
    table.add_row("markers", f"{summary.labelled} labelled, {summary.unlabelled} unlabelled; {missing}")
    if summary.extent_m is not None:
        low, high = ([f"{value:.2f}" for value in corner] for corner in summary.extent_m)
        spans = [f"{axis} {a} … {b}" for axis, a, b in zip("xyz", low, high, strict=True)]
        table.add_row("extent", ", ".join(spans) + " m (z up)")
    table.add_row("protocol", escape(_protocol(summary.protocol)))
    table.add_row("derived", _counted(summary.derived.items()) or "none")
    table.add_row("plates", str(len(summary.plates)) if summary.plates else "none")
    table.add_row("analog", escape(_channels(summary)))
    table.add_row("events", str(len(summary.events)) if summary.events else "none")
    if summary.subject_mass_kg is not None:
        table.add_row("body mass", f"{summary.subject_mass_kg:g} kg")
    return table


def _counted(kinds: Iterable[tuple[str, int]]) -> str:
    return ", ".join(f"{count} {kind}{'s' if count != 1 else ''}" for kind, count in kinds)


def _channels(summary: CaptureSummary) -> str:
    if not summary.channels:
        return "none"
    rates = sorted({channel.rate_hz for channel in summary.channels})
    names = ", ".join(f"{c.name} ({c.unit})" if c.unit else c.name for c in summary.channels)
    return f"{len(summary.channels)} at {', '.join(f'{rate:g}' for rate in rates)} Hz: {names}"


def _protocol(protocol: ProtocolSummary | None) -> str:
    from mbkf.trial.preparation.coverage import listed

    if protocol is None:
        return "none knows these markers, and no person was found among them; scaling needs --protocol"
    if protocol.told:
        return protocol.told
    told = f"{protocol.name}, knows {protocol.known} of {protocol.markers} markers ({100 * protocol.share:.0f} %)"
    if protocol.ignored:
        told += f"; ignored: {listed(protocol.ignored)}"
    return told if protocol.accepted else f"{told}; too few, scaling needs --protocol"


def _axes(axes: AxesSummary) -> str:
    told = f"{axes.read} (forward, left, up; {axes.source}): {axes.verdict}"
    return f"{told}; {axes.note}" if axes.note else told


def _gaps(gaps: list[MarkerSummary], total: int) -> Table:
    from rich.markup import escape
    from rich.table import Table

    shown = f"Gaps ({total} markers)"
    if total > len(gaps):
        shown = f"Gaps (worst {len(gaps)} of {total} markers)"
    table = Table(title=f"[bold]{shown}[/]", title_justify="left", box=None, pad_edge=False)
    columns = 3
    for _ in range(columns):
        table.add_column("marker")
        table.add_column("missing", justify="right")
        table.add_column("pieces", justify="right")
    cells = [(escape(m.name), f"{100 * m.missing_fraction:.1f} %", str(m.pieces)) for m in gaps]
    for start in range(0, len(cells), columns):
        table.add_row(*(cell for row in cells[start : start + columns] for cell in row))
    return table


def _plates(summary: CaptureSummary) -> Table:
    from rich.markup import escape
    from rich.table import Table

    table = Table(title="[bold]Force plates[/]", title_justify="left", box=None, pad_edge=False)
    table.add_column("plate")
    for name in ("rate", "offset", "loaded", "peak"):
        table.add_column(name, justify="right")
    table.add_column("corners x, y in m")
    for plate in summary.plates:
        corners = "not in the file"
        if plate.corners_m is not None:
            corners = "  ".join(f"({x:.2f}, {y:.2f})" for x, y, _ in plate.corners_m)
        table.add_row(
            escape(plate.name),
            f"{plate.rate_hz:g} Hz",
            f"{plate.offset_n:+.1f} N",
            f"{100 * plate.loaded_fraction:.0f} %",
            f"{plate.peak_n:.0f} N",
            corners,
        )
    return table


def _events(summary: CaptureSummary) -> Table:
    from rich.markup import escape
    from rich.table import Table

    table = Table(title="[bold]Events[/]", title_justify="left", box=None, pad_edge=False)
    for name in ("time", "context", "label"):
        table.add_column(name, justify="right" if name == "time" else "left")
    for event in summary.events:
        table.add_row(f"{event.time_s:.3f} s", escape(event.context), escape(event.label))
    return table
