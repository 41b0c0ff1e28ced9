"""Marker sets: list, show, guess, import, check, change.

A marker set names the markers, the segment of each and its place.

Examples:
  mbkf protocol list
  mbkf protocol show plug_in_gait
  mbkf protocol guess static.c3d --trial walk.c3d --out my_markers.toml
  mbkf protocol import model.osim --out my_markers.toml
  mbkf protocol check my_markers.toml static.c3d
  mbkf protocol edit static.c3d --protocol my_markers.toml --out my_markers.toml

`mbkf protocol COMMAND --help` explains a command and gives an example.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mbkf.cli.tables import table
from mbkf.numerics.printed import percent

if TYPE_CHECKING:
    from rich.console import Console

    from mbkf.model.protocol import Protocol

SUBCOMMANDS = ("list", "show", "guess", "import", "check", "edit")
"""Each is the module ``mbkf.cli.protocol_<name>``."""


def print_set(protocol: Protocol, console: Console) -> None:
    """Prints the markers of a set in the order of the body, the ignored ones and the source."""
    from mbkf.trial.protocol.editing import SURE

    shown = table(f"{protocol.title} ({protocol.name})", "marker", "segment", "landmark", "kind", words=4)
    for heading in ("x, y, z mm", "may move mm"):
        shown.add_column(heading, justify="right")
    if in_doubt := any(marker.probability < SURE for marker in protocol.markers):
        shown.add_column("probability", no_wrap=True)
    order = {segment.name: k for k, segment in enumerate(protocol.body.segments)}
    for m in sorted(protocol.markers, key=lambda one: order[one.segment]):
        others = "".join(f", or {name.replace('_', ' ')} {percent(p)}" for name, p in m.alternatives)
        probability = f"{percent(m.probability)}{others}" if m.probability < SURE else ""
        shown.add_row(
            m.name,
            m.segment.replace("_", " "),
            m.landmark.replace("_", " "),
            m.kind,
            ", ".join(f"{1e3 * x:.0f}" for x in m.position_m),
            f"{1e3 * m.placement_sd_m:.0f}",
            *((probability,) if in_doubt else ()),
        )
    console.print(shown)
    for name, reason in protocol.ignored.items():
        console.print(f"ignored: {name}: {reason}" if reason else f"ignored: {name}", soft_wrap=True)
    if protocol.source:
        console.print(f"source: {protocol.source}", soft_wrap=True)
