"""`mbkf view`: a result in 3-D, in the browser or as one page that can be mailed."""

from __future__ import annotations

import argparse

_EPILOG = """\
examples:
  mbkf view result                           opens the browser; Ctrl-C ends
  mbkf view result --html walk.html          writes one self-contained page instead

The page is served to this computer alone. --address lets others see it; the printed address then carries a token that
each of them needs.
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    parser = subparsers.add_parser(
        "view",
        help="3-D playback of a result in the browser",
        description="Play a result: person, markers, reactions and chosen curves; play, pause, speed, slider.",
        epilog=_EPILOG,
    )
    parser.add_argument("folder", metavar="DIR", help="written by 'mbkf reconstruct' or 'mbkf live'")
    parser.add_argument("--html", metavar="FILE", help="write one self-contained page and end")
    parser.add_argument(
        "--address", default="127.0.0.1", metavar="IP", help="where to serve the page (127.0.0.1)"
    )
    parser.add_argument("--port", type=int, default=0, metavar="N", help="port (any that is free)")
    parser.add_argument("--no-browser", action="store_true", help="print the page's address only")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Writes the page, or serves it until interrupted.

    Raises:
        MbkfError: There is no result, or the page cannot be served there.
        OSError: The page cannot be written.
    """
    import webbrowser

    from mbkf.io.results_folder import read_reconstruction
    from mbkf.viz.scene.playback import playback_page, write_playback
    from mbkf.viz.server import PageServer, checked_port

    port = checked_port(args.port)
    result = read_reconstruction(args.folder)
    if args.html is not None:
        write_playback(result, args.html)
        print(args.html)
        return 0
    server = PageServer(playback_page(result), address=args.address, port=port)
    try:
        print(f"{server.url}\nCtrl-C ends", flush=True)
        if not args.no_browser:
            webbrowser.open(server.url)
        server.wait()
    except KeyboardInterrupt:
        pass
    finally:
        server.close()
    return 0
