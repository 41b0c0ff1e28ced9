"""`mbkf app`: the laboratory's page, where a session's folder becomes a checked report."""

from __future__ import annotations

import argparse

_EPILOG = """\
examples:
  mbkf app                       sessions in the folder mbkf of your home
  mbkf app study --port 8123

The page opens in the browser; nothing leaves this computer. A folder with captures is a session: drop one on the page,
or name a folder that holds some. Results lie in FOLDER/results, as 'mbkf batch FOLDER --out FOLDER/results' puts them
there, and what you state of a session in its session.toml. Ctrl-C ends; the next start goes on.
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    parser = subparsers.add_parser(
        "app",
        help="the laboratory's page: drop a session, get the report",
        description="Open the laboratory's page on this computer.",
        epilog=_EPILOG,
    )
    parser.add_argument("folder", metavar="FOLDER", nargs="?", help="folder with the sessions (~/mbkf)")
    parser.add_argument("--port", type=int, default=0, metavar="N", help="port (any that is free)")
    parser.add_argument("--workers", type=int, metavar="N", help="processes (one for each processor)")
    parser.add_argument("--no-browser", action="store_true", help="print the page's address only")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Serves the page until interrupted.

    Raises:
        MbkfError: The port cannot be listened on, or the folder is a file.
        OSError: The folder cannot be written to.
    """
    import webbrowser
    from pathlib import Path

    from mbkf.app.server import AppServer
    from mbkf.cli.stopping import stopped_by_signal
    from mbkf.errors import InvalidInput
    from mbkf.io.atomic import check_folder
    from mbkf.viz.server import checked_port

    if args.workers is not None and args.workers < 1:
        raise InvalidInput(f"{args.workers} workers can do nothing; give one or more")
    folder = check_folder(Path.home() / "mbkf" if args.folder is None else args.folder)
    server = AppServer(folder, checked_port(args.port), args.workers)
    try:
        print(f"{server.url}\nCtrl-C ends", flush=True)
        if not args.no_browser:
            webbrowser.open(server.url)
        with stopped_by_signal() as stop:
            stop.wait()
    finally:
        server.close()
    return 0
