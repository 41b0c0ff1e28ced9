"""Show a marker set on the body.

Prints the markers and opens a page that shows them on the body, each in the colour of its segment. The page is one file
that needs nothing else and can be mailed; without --out it is a temporary one.

Examples:
  mbkf protocol show plug_in_gait
  mbkf protocol show my_markers.toml --out my_markers.html --no-browser
"""

from __future__ import annotations

import argparse
from pathlib import Path

from mbkf.cli.options import add_out


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("protocol", metavar="NAME|FILE", help="marker set: its name, or its TOML file")
    add_out(parser, "FILE.html", "page to write")
    parser.add_argument("--no-browser", action="store_true", help="do not open the page")


def run(args: argparse.Namespace) -> int:
    """Prints the set, and writes and opens its page."""
    import tempfile

    from mbkf.cli.opening import open_file
    from mbkf.cli.protocol import print_set
    from mbkf.cli.tables import terminal
    from mbkf.io.atomic import write_text
    from mbkf.model.protocol import load_protocol
    from mbkf.viz.protocol.page import show_page

    protocol, console = load_protocol(args.protocol), terminal()
    print_set(protocol, console)
    if args.out is None and args.no_browser:
        return 0
    out = Path(args.out or Path(tempfile.mkdtemp(prefix="mbkf-")) / "marker_set.html")
    write_text(out, show_page(protocol))
    console.print(str(out), soft_wrap=True)
    if not args.no_browser:
        open_file(out)
    return 0
