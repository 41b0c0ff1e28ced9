"""`mbkf protocol list`: the marker sets that come with mbkf."""

from __future__ import annotations

import argparse
import json
from textwrap import shorten
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mbkf.model.protocol import Protocol

SOURCE_SHOWN = 30
"""Characters of a source that the table shows."""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the group."""
    parser = subparsers.add_parser(
        "list",
        help="the marker sets that come with mbkf",
        description="The marker sets that come with mbkf; --json tells their sources in full.",
        epilog="example:\n  mbkf protocol list",
    )
    parser.add_argument("--json", action="store_true", help="print everything as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Prints the sets as a table or as JSON."""
    from rich.table import Table

    from mbkf.cli.protocol import wide_console
    from mbkf.model.protocol import load_protocol, protocol_names

    rows = [_row(load_protocol(name)) for name in protocol_names()]
    if args.json:
        print(json.dumps(rows, indent=2, ensure_ascii=False))
        return 0
    table = Table()
    for heading in ("name", "title", "markers", "body", "source"):
        wide = max(len(str(row[heading])) for row in rows) if heading == "name" else None
        table.add_column(heading, justify="right" if heading == "markers" else "left", min_width=wide)
    for row in rows:
        short = {**row, "source": shorten(str(row["source"]), SOURCE_SHOWN, placeholder=" …")}
        table.add_row(*(str(value) for value in short.values()))
    wide_console().print(table)
    return 0


def _row(protocol: Protocol) -> dict[str, object]:
    return {
        "name": protocol.name,
        "title": protocol.title,
        "markers": len(protocol.markers),
        "body": protocol.body.name,
        "source": protocol.source,
    }
