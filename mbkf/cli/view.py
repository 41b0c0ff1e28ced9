"""Play a result in 3-D in the browser.

Shows person, markers, reactions and chosen curves, with play, pause, speed and slider. The page is served to this
computer alone. --address lets others see it; the printed address then carries a token that each of them needs.

Examples:
  mbkf view result                           opens the browser; Ctrl-C ends
  mbkf view result --html walk.html          writes one self-contained page instead
"""

from __future__ import annotations

import argparse

from mbkf.cli.options import add_out, add_page_options


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("folder", metavar="DIR", help="written by 'mbkf reconstruct' or 'mbkf live'")
    add_out(parser, "FILE", "write one self-contained page and end", option="--html")
    parser.add_argument(
        "--address", default="127.0.0.1", metavar="IP", help="address of the page (127.0.0.1)"
    )
    add_page_options(parser)


def run(args: argparse.Namespace) -> int:
    """Writes the page, or serves it until interrupted."""
    from mbkf.cli.opening import open_page, printed_address
    from mbkf.io.atomic import write_text
    from mbkf.io.results_folder import read_reconstruction
    from mbkf.viz.scene.recording import playback_page
    from mbkf.viz.server import PageServer

    text = playback_page(read_reconstruction(args.folder))
    if args.html is not None:
        write_text(args.html, text)
        print(args.html)
        return 0
    server = PageServer(text, address=args.address, port=args.port)
    try:
        print(f"{printed_address(server, not args.no_browser)}\nCtrl-C ends", flush=True)
        if not args.no_browser:
            open_page(server)
        server.wait()
    except KeyboardInterrupt:
        pass
    finally:
        server.close()
    return 0
