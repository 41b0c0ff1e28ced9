"""`mbkf protocol guess`: a marker set inferred from captures whose markers no shipped set explains."""

from __future__ import annotations

import argparse

_EPILOG = """\
Where a marker is on the body and how it moves tells the segment; its name helps where it can be read. Markers that may
be on another segment are marked as doubts; points that are no part of the body are left out.

examples:
  mbkf protocol guess static.c3d --trial walk.c3d --out my_markers.toml
  mbkf protocol guess --trial walk.c3d --out my_markers.toml
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the group."""
    from mbkf.cli.options import CAPTURE_FILES, add_axes_options

    parser = subparsers.add_parser(
        "guess",
        help="a marker set inferred from captures",
        description="Infer which segment each marker of a person's captures is on, and where.",
        epilog=_EPILOG,
    )
    parser.add_argument("static", metavar="STATIC", nargs="?", help=f"standing trial ({CAPTURE_FILES})")
    parser.add_argument(
        "--trial", metavar="TRIAL", action="append", default=[], help="moving trial; may be repeated"
    )
    parser.add_argument("--out", required=True, metavar="FILE.toml", help="file to write")
    add_axes_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Prints the inferred set, and writes it.

    Raises:
        MbkfError: A capture cannot be read, or no person is found in the captures.
    """
    from dataclasses import replace

    from mbkf.cli.options import axes_options
    from mbkf.cli.protocol import print_set, wide_console
    from mbkf.io.atomic import check_folder
    from mbkf.io.capture import read_capture
    from mbkf.model.protocol_file import checked_name, write_protocol
    from mbkf.trial.protocol.inferred import infer_marker_set

    out = checked_name(args.out)
    check_folder(out.parent)
    static = None if args.static is None else read_capture(args.static, **axes_options(args))
    found = infer_marker_set(static, [read_capture(path, **axes_options(args)) for path in args.trial])
    protocol = replace(found.protocol, name=out.stem)
    console = wide_console()
    print_set(protocol, console)
    console.print(found.line, soft_wrap=True)
    write_protocol(protocol, out)
    console.print(f"{out}: look at it with 'mbkf protocol edit' on the standing trial", soft_wrap=True)
    return 0
