"""Infer a marker set from captures.

Infers the segment and the place of each marker. A marker's place on the body and its movement tell the segment; its
name helps where it can be read. Markers that may be on another segment are marked as doubts; points that are no part
of the body are left out.

Examples:
  mbkf protocol guess static.c3d --trial walk.c3d --out my_markers.toml
  mbkf protocol guess --trial walk.c3d --out my_markers.toml
"""

from __future__ import annotations

import argparse

from mbkf.cli.options import CAPTURE_FILES, add_axes_options, add_out, axes_options


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("static", metavar="STATIC", nargs="?", help=f"standing trial ({CAPTURE_FILES})")
    parser.add_argument(
        "--trial", metavar="TRIAL", action="append", default=[], help="moving trial; may be repeated"
    )
    add_out(parser, "FILE.toml", "file to write", required=True)
    add_axes_options(parser)


def run(args: argparse.Namespace) -> int:
    """Prints the inferred set, and writes it."""
    from dataclasses import replace

    from mbkf.cli.protocol import print_set
    from mbkf.cli.tables import terminal
    from mbkf.io.atomic import check_folder
    from mbkf.io.capture import read_capture
    from mbkf.model.protocol_file import checked_name, write_protocol
    from mbkf.trial.protocol.inferred import infer_marker_set

    out = checked_name(args.out)
    check_folder(out.parent)
    static = None if args.static is None else read_capture(args.static, **axes_options(args))
    found = infer_marker_set(static, [read_capture(path, **axes_options(args)) for path in args.trial])
    protocol = replace(found.protocol, name=out.stem)
    console = terminal()
    print_set(protocol, console)
    console.print(found.line, soft_wrap=True)
    write_protocol(protocol, out)
    console.print(f"{out}: look at it with 'mbkf protocol edit' on the standing trial", soft_wrap=True)
    return 0
