"""Open the laboratory's page: drop a session, get its report.

The page opens in the browser; nothing leaves this computer. A folder with captures is a session: drop one on the page,
or name a folder that holds sessions. Results lie in FOLDER/results, where 'mbkf batch FOLDER --out FOLDER/results'
writes them, and your statements about a session in its session.toml. Ctrl-C ends; the next start continues.

Examples:
  mbkf app                       sessions in the folder mbkf of your home
  mbkf app study --port 8123
  mbkf app study --shortcut      writes a shortcut that opens this page by a click
"""

from __future__ import annotations

import argparse
from pathlib import Path

from mbkf.cli.options import add_chart_options, add_page_options, count

END_S = 0.5
"""Longest time that an answer to the page may take after the server has closed."""


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("folder", metavar="FOLDER", nargs="?", help="folder with the sessions (~/mbkf)")
    add_page_options(parser)
    add_chart_options(parser, "clinical")
    parser.add_argument("--workers", type=count, metavar="N", help="processes (one for each processor)")
    parser.add_argument(
        "--shortcut",
        action="store_true",
        help="write a shortcut that opens the page with these options (menu of Linux, desktop of macOS and Windows)",
    )


def run(args: argparse.Namespace) -> int:
    """Serves the page until interrupted."""
    from mbkf.app.charts import Charts
    from mbkf.app.server import AppServer
    from mbkf.cli.opening import open_page, printed_address
    from mbkf.cli.shortcut import write_shortcut
    from mbkf.cli.stopping import end_within, stopped_by_signal
    from mbkf.io.atomic import check_folder

    folder = check_folder(Path.home() / "mbkf" if args.folder is None else args.folder)
    if args.shortcut:
        print(write_shortcut(_words(args, folder)))
        return 0
    charts = Charts(args.convention, args.moments, args.colours)
    server = AppServer(folder, args.port, args.workers, charts)
    try:
        print(f"{printed_address(server, not args.no_browser)}\nCtrl-C ends", flush=True)
        with stopped_by_signal() as stop:
            if not args.no_browser:
                open_page(server)
            stop.wait()
    finally:
        server.close()
        end_within(END_S)
    return 0


def _words(args: argparse.Namespace, folder: Path) -> list[str]:
    """Words of a call of this command with the given options."""
    given = {"port": args.port or None, "convention": args.convention, "moments": args.moments}
    given |= {"colours": args.colours, "workers": args.workers}
    options = [
        word for name, value in given.items() if value is not None for word in (f"--{name}", str(value))
    ]
    return ["app", str(folder.absolute()), *options]
