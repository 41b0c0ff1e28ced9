"""`mbkf protocol`: marker sets: what there is, how one looks, where one comes from, whether it fits, changing one."""

from __future__ import annotations

import argparse
import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from mbkf.model.protocol import Protocol

SUBCOMMANDS = ("list", "show", "guess", "import", "check", "edit")
"""Each is the module ``mbkf.cli.protocol_<name>``."""

PIPED_WIDTH = 110

_EPILOG = """\
examples:
  mbkf protocol list
  mbkf protocol show plug_in_gait
  mbkf protocol guess static.c3d --trial walk.c3d --out my_markers.toml
  mbkf protocol import model.osim --out my_markers.toml
  mbkf protocol check my_markers.toml static.c3d
  mbkf protocol edit static.c3d --protocol my_markers.toml --out my_markers.toml

`mbkf protocol COMMAND --help` explains a command and gives an example.
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the group to the command line."""
    parser = subparsers.add_parser(
        "protocol",
        help="marker sets: list, show, guess, import, check, change",
        description="Marker sets: which markers there are, on which segment, where.",
        epilog=_EPILOG,
    )
    group = parser.add_subparsers(dest="protocol_command", metavar="COMMAND", required=True, title="commands")
    for name in SUBCOMMANDS:
        importlib.import_module(f"mbkf.cli.protocol_{name}").add_parser(group)


def run(args: argparse.Namespace) -> int:
    """Runs the command of the group that was named."""
    return int(importlib.import_module(f"mbkf.cli.protocol_{args.protocol_command}").run(args))


def wide_console() -> Console:
    """A console that does not break lines early where nobody looks at a terminal."""
    from rich.console import Console

    console = Console(highlight=False, markup=False)
    return console if console.is_terminal else Console(highlight=False, markup=False, width=PIPED_WIDTH)


def marker_table(protocol: Protocol) -> Table:
    """The markers of a set, segment by segment in the order of the body."""
    from rich.table import Table

    from mbkf.trial.protocol.editing import SURE

    table = Table(title=f"{protocol.title} ({protocol.name})", title_justify="left")
    for heading in ("marker", "segment", "landmark", "kind", "x, y, z mm", "may move mm"):
        table.add_column(heading, justify="right" if heading.endswith("mm") else "left")
    in_doubt = any(marker.probability < SURE for marker in protocol.markers)
    if in_doubt:
        table.add_column("sure", no_wrap=True)
    order = {segment.name: k for k, segment in enumerate(protocol.body.segments)}
    for m in sorted(protocol.markers, key=lambda one: order[one.segment]):
        others = "".join(f", or {name.replace('_', ' ')} {100 * p:.0f} %" for name, p in m.alternatives)
        sure = f"{100 * m.probability:.0f} %{others}" if m.probability < SURE else ""
        table.add_row(
            m.name,
            m.segment.replace("_", " "),
            m.landmark.replace("_", " "),
            m.kind,
            ", ".join(f"{1e3 * x:.0f}" for x in m.position_m),
            f"{1e3 * m.placement_sd_m:.0f}",
            *((sure,) if in_doubt else ()),
        )
    return table


def print_set(protocol: Protocol, console: Console) -> None:
    """Prints the markers of a set, what it ignores and where it comes from.

    Args:
        protocol: The set.
        console: Where to print.
    """
    console.print(marker_table(protocol))
    for name, reason in protocol.ignored.items():
        console.print(f"ignored: {name}: {reason}" if reason else f"ignored: {name}", soft_wrap=True)
    if protocol.source:
        console.print(f"source: {protocol.source}", soft_wrap=True)
