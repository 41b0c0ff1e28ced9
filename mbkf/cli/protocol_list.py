"""List the marker sets that come with mbkf.

--json prints their sources in full.

Example:
  mbkf protocol list
"""

from __future__ import annotations

import argparse
import json
from textwrap import shorten

SOURCE_SHOWN = 30
"""Characters of a source that the table shows."""


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("--json", action="store_true", help="print everything as JSON")


def run(args: argparse.Namespace) -> int:
    """Prints the sets as a table or as JSON."""
    from rich.table import Table

    from mbkf.cli.tables import terminal
    from mbkf.model.protocol import load_protocol, protocol_names

    rows: list[dict[str, object]] = [
        {
            "name": one.name,
            "title": one.title,
            "markers": len(one.markers),
            "body": one.body.name,
            "source": one.source,
        }
        for one in map(load_protocol, protocol_names())
    ]
    if args.json:
        print(json.dumps(rows, indent=2, ensure_ascii=False))
        return 0
    table = Table()
    for heading in rows[0]:
        wide = max(len(str(row[heading])) for row in rows) if heading == "name" else None
        table.add_column(heading, justify="right" if heading == "markers" else "left", min_width=wide)
    for row in rows:
        short = {**row, "source": shorten(str(row["source"]), SOURCE_SHOWN, placeholder=" …")}
        table.add_row(*(str(value) for value in short.values()))
    terminal().print(table)
    return 0
