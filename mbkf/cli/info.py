"""Show the contents of a capture: markers, gaps, plates, channels, axes.

Lists markers and their gaps, force plates and their offsets, analog channels, events, rates, axes and units.

Examples:
  mbkf info walk.c3d
  mbkf info walk.trc --forces walk_grf.mot --json
  mbkf info walk.c3d --without-plate 2
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

from mbkf.cli.options import CAPTURE_FILES, FORCE_FILES, add_axes_options, add_without_plate, axes_options
from mbkf.cli.tables import terminal
from mbkf.numerics.printed import percent

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from mbkf.trial.info import AxesSummary, CaptureSummary, MarkerSummary, PlatesMass, ProtocolSummary
    from mbkf.trial.persons import PersonSummary

_MOST_WITH_GAPS = 30


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("file", metavar="FILE", help=f"capture ({CAPTURE_FILES})")
    parser.add_argument("--forces", metavar="FILE", help=f"ground reactions of the capture ({FORCE_FILES})")
    add_without_plate(parser)
    add_axes_options(parser)
    parser.add_argument("--json", action="store_true", help="print everything as JSON")


def run(args: argparse.Namespace) -> int:
    """Reads the capture and prints its summary."""
    from mbkf.io.capture import read_capture
    from mbkf.trial.info import describe
    from mbkf.trial.preparation.selection import without_plates

    without = tuple(args.without_plate)
    capture = read_capture(args.file, forces=args.forces, unneeded_plates=without, **axes_options(args))
    summary = describe(without_plates(capture, without))
    if args.json:
        print(json.dumps(asdict(summary), indent=2, ensure_ascii=False, allow_nan=False))
    else:
        _show(summary, terminal())
    return 0


def _show(summary: CaptureSummary, console: Console) -> None:
    console.print(summary.path, soft_wrap=True, style="bold")
    console.print(_overview(summary))
    named = [marker.name for marker in summary.markers if not marker.name.startswith("*")]
    if named:
        console.print(f"Markers  {' '.join(named)}")
    gaps = sorted(
        (marker for marker in summary.markers if marker.missing_fraction > 0.0),
        key=lambda marker: -marker.missing_fraction,
    )
    if gaps:
        console.print(_gaps(gaps[:_MOST_WITH_GAPS], len(gaps)))
    if summary.persons:
        console.print(_persons(summary.persons))
    if summary.plates:
        console.print(_plates(summary))
    if summary.events:
        events = _bare("Events", "time>", "context", "label")
        for event in summary.events:
            events.add_row(f"{event.time_s:.3f} s", event.context, event.label)
        console.print(events)
    if summary.plates_mass is not None and summary.plates_mass.verdict == "outside":
        console.print(f"warning: {summary.plates_mass.note}", soft_wrap=True)
    for contradiction in summary.plate_contradictions:
        console.print(f"warning: {contradiction}", soft_wrap=True)
    for note in summary.notes:
        console.print(f"note: {note}")


def _persons(persons: Sequence[PersonSummary]) -> Table:
    found = _bare("Persons", "name", "markers>", "height>", "middle (x, y)>")
    for one in persons:
        height = "never seen" if one.height_m is None else f"{one.height_m:.2f} m"
        place = "" if one.place_m is None else "{:.2f}, {:.2f} m".format(*one.place_m)
        found.add_row(one.name, str(one.markers), height, place)
    return found


def _bare(title: str, *headings: str) -> Table:
    """A table without lines; columns whose heading ends in > hold numbers."""
    from rich.table import Table

    table = Table(title=title, title_justify="left", title_style="bold", box=None, pad_edge=False)
    for heading in headings:
        table.add_column(heading.removesuffix(">"), justify="right" if heading.endswith(">") else "left")
    return table


def _overview(summary: CaptureSummary) -> Table:
    extent, mass = summary.extent_m, summary.subject_mass_kg
    rows = {
        "frames": f"{summary.frames} at {summary.rate_hz:g} Hz, {summary.duration_s:.2f} s, "
        f"from {summary.start_time_s:.3f} s",
        "axes, unit": f"{summary.up_axis} up, {summary.length_unit}",
        "axes checked": _axes(summary.axes),
        "markers": f"{summary.labelled} labelled, {summary.unlabelled} unlabelled; "
        f"{percent(summary.missing_fraction, 2)} of samples missing",
        "extent": ", ".join(f"{axis} {a:.2f} … {b:.2f}" for axis, a, b in zip("xyz", *extent, strict=True))
        + " m (z up)"
        if extent
        else "",
        "protocol": _protocol(summary.protocol, summary.refusal),
        "derived": _counted(summary.derived.items()) or "none",
        "plates": str(len(summary.plates) or "none"),
        "analog": _channels(summary),
        "events": str(len(summary.events) or "none"),
        "body mass": "" if mass is None else f"{mass:g} kg",
        "by plates": _plates_mass(summary.plates_mass),
    }
    table = _bare("", ">", "")
    table.show_header = False
    table.columns[0].style = "dim"
    for name, text in rows.items():
        if text:
            table.add_row(name, text)
    return table


def _plates_mass(found: PlatesMass | None) -> str:
    if found is None or found.kg is None:
        return "" if found is None else f"mass not determined: {found.note}"
    return f"{found.kg:.1f} kg"


def _counted(kinds: Iterable[tuple[str, int]]) -> str:
    return ", ".join(f"{count} {kind}{'s' if count != 1 else ''}" for kind, count in kinds)


def _channels(summary: CaptureSummary) -> str:
    if not summary.channels:
        return "none"
    rates = sorted({channel.rate_hz for channel in summary.channels})
    names = ", ".join(f"{c.name} ({c.unit})" if c.unit else c.name for c in summary.channels)
    return f"{len(summary.channels)} at {', '.join(f'{rate:g}' for rate in rates)} Hz: {names}"


def _protocol(protocol: ProtocolSummary | None, refusal: str) -> str:
    from mbkf.trial.preparation.coverage import listed

    if protocol is None:
        return refusal
    if protocol.told:
        return protocol.told
    text = (
        f"{protocol.name}, knows {protocol.known} of {protocol.markers} markers ({percent(protocol.share)})"
    )
    if protocol.ignored:
        text += f"; ignored: {listed(protocol.ignored)}"
    return text if protocol.accepted else f"{text}; too few, and {refusal}"


def _axes(axes: AxesSummary) -> str:
    text = f"{axes.read} (forward, left, up; {axes.source}): {axes.verdict}"
    return f"{text}; {axes.note}" if axes.note else text


def _gaps(gaps: list[MarkerSummary], total: int) -> Table:
    shown = f"worst {len(gaps)} of {total}" if total > len(gaps) else str(total)
    columns = min(3, len(gaps))
    table = _bare(
        f"Gaps ({shown} marker{'s' if total > 1 else ''})", *("marker", "missing>", "pieces>") * columns
    )
    cells = [(m.name, percent(m.missing_fraction, 1), str(m.pieces)) for m in gaps]
    for start in range(0, len(cells), columns):
        table.add_row(*(cell for row in cells[start : start + columns] for cell in row))
    return table


def _plates(summary: CaptureSummary) -> Table:
    table = _bare("Force plates", "plate", "rate>", "offset>", "loaded>", "peak>", "corners x, y in m")
    for plate in summary.plates:
        corners = "not in the file"
        if plate.corners_m is not None:
            corners = "  ".join(f"({x:.2f}, {y:.2f})" for x, y, _ in plate.corners_m)
        table.add_row(
            plate.name,
            f"{plate.rate_hz:g} Hz",
            f"{plate.offset_n:+.1f} N",
            percent(plate.loaded_fraction),
            f"{plate.peak_n:.0f} N",
            corners,
        )
    return table
