"""`mbkf protocol show`: a marker set on the body, as a page and as a table."""

from __future__ import annotations

import argparse

_EPILOG = """\
Prints the markers and opens a page that shows them on the body, each in the colour of its segment. The page is one file
that needs nothing else and can be mailed; without --out it is a temporary one.

examples:
  mbkf protocol show plug_in_gait
  mbkf protocol show my_markers.toml --out my_markers.html --no-browser
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the group."""
    parser = subparsers.add_parser(
        "show",
        help="a marker set on the body",
        description="Show a marker set on the body.",
        epilog=_EPILOG,
    )
    parser.add_argument("protocol", metavar="NAME|FILE", help="marker set: its name, or its TOML file")
    parser.add_argument("--out", metavar="FILE.html", help="where to write the page")
    parser.add_argument("--no-browser", action="store_true", help="do not open the page")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Prints the set, and writes and opens its page.

    Raises:
        MbkfError: There is no such marker set.
        OSError: The page cannot be written.
    """
    import tempfile
    import webbrowser
    from pathlib import Path

    from mbkf.cli.protocol import print_set, wide_console
    from mbkf.model.protocol import load_protocol
    from mbkf.viz.protocol.page import write_show_page

    protocol = load_protocol(args.protocol)
    console = wide_console()
    print_set(protocol, console)
    if args.out is None and args.no_browser:
        return 0
    folder = Path(tempfile.mkdtemp(prefix="mbkf-")) if args.out is None else Path()
    out = folder / "marker_set.html" if args.out is None else Path(args.out)
    write_show_page(protocol, out)
    console.print(str(out), soft_wrap=True)
    if not args.no_browser:
        webbrowser.open(out.resolve().as_uri())
    return 0
