"""Change a marker set on a capture, in the browser.

Opens a page with the capture's markers on the body. There a marker can be moved to another segment or landmark, or left
out. The command ends with "Done" on the page, or with Ctrl-C; only "Save" writes the file. The page is served to this
computer alone.

Examples:
  mbkf protocol edit static.c3d --out my_markers.toml
  mbkf protocol edit static.c3d --protocol my_markers.toml --out my_markers.toml
"""

from __future__ import annotations

import argparse
import sys

from mbkf.cli.options import CAPTURE_FILES, add_axes_options, add_out, add_page_options, axes_options


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("capture", metavar="CAPTURE", help=f"standing trial ({CAPTURE_FILES})")
    parser.add_argument(
        "--protocol",
        metavar="NAME|FILE",
        help="marker set to begin with (default: found from the names, or inferred)",
    )
    add_out(parser, "FILE.toml", "file that saving writes", required=True, edits="protocol")
    add_axes_options(parser)
    add_page_options(parser)


def run(args: argparse.Namespace) -> int:
    """Serves the page until it is done, and prints the counts of the saved set."""
    from mbkf.cli.inputs import edits_own_file, outputs_of
    from mbkf.cli.opening import open_page, printed_address
    from mbkf.cli.progress import stages
    from mbkf.cli.stopping import stopped_by_signal
    from mbkf.io.atomic import check_folder
    from mbkf.io.capture import read_capture
    from mbkf.model.protocol_file import checked_name
    from mbkf.trial.protocol.editing import starting_set
    from mbkf.trial.protocol.standing import stand_beside
    from mbkf.viz.protocol.edit import EditPage

    out = checked_name(args.out)
    check_folder(out.parent)
    capture = read_capture(args.capture, **axes_options(args))
    with stages() as report:
        protocol, capture = starting_set(capture, args.protocol)
        standing = stand_beside(capture, protocol, report)
    if standing.trouble:
        print(f"warning: the set does not fit this capture yet: {standing.trouble}", file=sys.stderr)
    page = EditPage(protocol, standing, out, port=args.port, edits=edits_own_file(args, outputs_of(args)[0]))
    print(f'{printed_address(page, not args.no_browser)}\n"Done" on the page or Ctrl-C ends', flush=True)
    try:
        with stopped_by_signal() as stop:
            if not args.no_browser:
                open_page(page)
            while not (stop.is_set() or page.done.wait(0.2)):
                pass
    finally:
        page.close()
    if page.saved is None:
        print("nothing was saved")
    else:
        print(f"{out}: {len(page.saved.markers)} markers, {len(page.saved.ignored)} left out")
    return 0
