"""Results of a live run while it goes on, and how it went: page, Lab Streaming Layer, WebSocket, terminal."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mbkf.stream.results.frame import FrameSink
    from mbkf.stream.run.session import LiveOutcome, LiveSession
    from mbkf.viz.live.standing_page import StandingPage


def add_output_options(parser: argparse.ArgumentParser) -> None:
    """Options of commands that follow a stream."""
    out = parser.add_argument_group("results while it runs")
    out.add_argument("--publish", metavar="NAME", help="send results as an LSL stream of this name")
    out.add_argument("--websocket", metavar="[ADDRESS:]PORT", help="serve results as JSON over WebSocket")
    out.add_argument(
        "--view-address", default="127.0.0.1", metavar="ADDRESS", help="where the page is served"
    )
    out.add_argument("--view-port", type=int, default=0, metavar="N", help="port of the page (default: any)")
    out.add_argument("--token", metavar="TEXT", help="what page and WebSocket ask for on another address")
    out.add_argument(
        "--end-with-input",
        action="store_true",
        help="end when the standard input closes, for programs that start it",
    )
    out.add_argument("--keep-log", action="store_true", help="keep the log beside the results")


def sinks(
    args: argparse.Namespace, session: LiveSession, waiting: StandingPage | None = None
) -> list[FrameSink]:
    """The listeners that were asked for.

    Args:
        args: Options of the command.
        session: The connected run.
        waiting: The page that waited for the person, if there was one.

    Raises:
        MbkfError: An address cannot be served, or a library is missing.
    """
    found: list[FrameSink] = []
    if args.publish is not None:
        from mbkf.stream.lsl.results import LslResults

        found.append(LslResults(session.setup.model, args.publish, session.setup.stream.rate_hz))
    if args.websocket is not None:
        from mbkf.stream.results.websocket import WebSocketResults, parse_address

        address, port = parse_address(args.websocket)
        served = WebSocketResults(session.setup.model, address, port, args.token)
        say(f"results: {served.url}")
        found.append(served)
    if args.view:
        found.append(_live_page(args, session, waiting))
    return found


def _live_page(args: argparse.Namespace, session: LiveSession, waiting: StandingPage | None) -> FrameSink:
    """The live page, where the waiting page was if there was one."""
    from mbkf.viz.live.page import LivePage

    port, token = (args.view_port, args.token) if waiting is None else waiting.hand_over()
    page = LivePage(
        session.setup.model,
        session.setup.names,
        session.setup.plate_corners_m,
        title=session.setup.stream.trial,
        address=args.view_address,
        port=port,
        token=token,
    )
    if waiting is None:
        say(f"page: {page.url}")
    return page


def told(outcome: LiveOutcome, folder: Path) -> int:
    """Prints how the run went; 1 where it failed and yet left results.

    Raises:
        InvalidInput: Its results could not be written.
    """
    from mbkf.cli.reconstruct import print_summary
    from mbkf.errors import InvalidInput

    if outcome.summary is not None:
        print_summary(outcome.summary, folder)
    report = outcome.report
    lag = f" besides a lag of {_ms(report['lag_ms'])} ms" if report["lag_ms"] else ""
    print(
        f"{report['frames_in']} frames came, {report['frames_lost']} were lost; latency median "
        f"{_ms(report['latency_ms_median'])}, 99 % {_ms(report['latency_ms_p99'])} ms{lag}; {report['ended_by']}"
    )
    failed = [] if outcome.failure is None else [f"it ended early: {outcome.failure}"]
    logged, unlogged = report["frames_written"], report["frames_not_written"]
    if unlogged:
        failed.append(f"{unlogged} frames were never logged and cannot be recovered")
    if outcome.problem is not None:
        failed.insert(0, f"the results could not be written: {outcome.problem}")
        if report["log"] and logged:
            failed.append(
                f"{logged} frames are in its log, of which 'mbkf live --recover {folder}' makes results"
            )
        raise InvalidInput("; ".join(failed))
    if failed:
        say(f"mbkf: error: {'; '.join(failed)}; {folder} holds the results of {logged} frames")
    return 1 if failed else 0


def _ms(value: Any) -> str:
    return "–" if value is None else f"{value:.1f}"


def say(text: str) -> None:
    """A sentence on the standard error."""
    from rich.console import Console

    Console(stderr=True, highlight=False, markup=False).print(text, soft_wrap=True)
