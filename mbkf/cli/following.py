"""Follow a live stream: options, page and streams of results, and the run's outcome in the terminal."""

from __future__ import annotations

import argparse
import os
import threading
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mbkf.cli.options import add_lag_option, add_spreads_option, not_negative, port, positive
from mbkf.cli.terminal import console

if TYPE_CHECKING:
    from mbkf.stream.results.frame import FrameSink, LiveFrame
    from mbkf.stream.run.session import LiveOutcome, LiveSession
    from mbkf.stream.source import FrameSource
    from mbkf.viz.live.standing_page import StandingPage

LEAST_PATIENCE_S = 30.0
"""With a time limit, a stream that never appears is waited for at least so long."""

FILE_PREFIX = "file:"

Begin = Callable[[threading.Event, float | None], "LiveSession"]
"""Connects a run: (event that stops, longest wait in s or None) -> the connected run."""


def add_following_options(parser: argparse.ArgumentParser) -> None:
    """Adds the options of commands that follow a stream, but for ``--from``, ``--out`` and ``--speed``."""
    add_lag_option(parser)
    add_spreads_option(parser)
    parser.add_argument("--view", action="store_true", help="show it in the browser")
    parser.add_argument("--seconds", type=positive, metavar="S", help="end S seconds after the first frame")
    out = parser.add_argument_group("results while it runs")
    out.add_argument("--publish", metavar="NAME", help="send results as an LSL stream of this name")
    out.add_argument("--websocket", metavar="[ADDRESS:]PORT", help="serve results as JSON over WebSocket")
    out.add_argument("--send-json", metavar="[ADDRESS:]PORT", help="send results as JSON over UDP")
    out.add_argument(
        "--send-osc", metavar="[ADDRESS:]PORT", help="send results as Open Sound Control over UDP"
    )
    out.add_argument(
        "--view-address", default="127.0.0.1", metavar="ADDRESS", help="address of the page (this computer)"
    )
    out.add_argument("--view-port", type=port, default=0, metavar="N", help="port of the page (any free one)")
    out.add_argument(
        "--token",
        metavar="TEXT",
        default=os.environ.get("MBKF_TOKEN"),
        help="password of page and WebSocket on another address (default: MBKF_TOKEN in the environment, which other "
        "users cannot read, or a random one)",
    )
    out.add_argument(
        "--end-with-input",
        action="store_true",
        help="end when the standard input closes, for programs that start this command",
    )
    out.add_argument("--keep-log", action="store_true", help="keep the log beside the results")


def add_speed_option(parser: argparse._ActionsContainer) -> None:
    """Adds ``--speed`` of a file that is played."""
    parser.add_argument(
        "--speed",
        type=not_negative,
        default=1.0,
        metavar="X",
        help="file: times real time; 0 for as fast as possible",
    )


def file_named(source: str, example: str, *streams: str) -> str:
    """The path of a source ``file:PATH``.

    Args:
        source: Value of ``--from``.
        example: Such a value, for the message.
        streams: Other values that the command takes.

    Raises:
        UnknownName: The source is neither.
        InvalidInput: The path is missing.
    """
    from mbkf.errors import InvalidInput, UnknownName

    if not source.startswith(FILE_PREFIX):
        raise UnknownName("source", source, (*streams, example), "--from")
    if source == FILE_PREFIX:
        raise InvalidInput(f"--from file: names no file; write {example}")
    return source.removeprefix(FILE_PREFIX)


def follow(
    args: argparse.Namespace, source: FrameSource, begin: Begin, waiting: StandingPage | None = None
) -> LiveOutcome:
    """Follows a stream until it ends, --seconds have passed or a signal comes.

    Args:
        args: Options of the command.
        source: The stream, closed if the run cannot begin.
        begin: Connects the run.
        waiting: The page that waits for the person, if there is one.
    """
    from mbkf.cli.stopping import stop_with_input, stopped_by_signal

    patience = None if args.seconds is None else max(args.seconds, LEAST_PATIENCE_S)
    with stopped_by_signal() as stop:
        if args.end_with_input:
            stop_with_input(stop)
        say(f"waiting for {args.source} …")
        try:
            session = begin(stop, patience)
            listeners = sinks(args, session, waiting)
        except BaseException:
            source.close()
            raise
        stream = session.setup.stream
        of = f"{len(stream.sensors)} sensors" if stream.sensors else f"{len(session.setup.names)} markers"
        say(f"following {stream.trial}: {of} at {stream.rate_hz:g} Hz")
        return session.run(stop, listeners, args.seconds, keep_log=args.keep_log)


def sinks(
    args: argparse.Namespace, session: LiveSession, waiting: StandingPage | None = None
) -> list[FrameSink]:
    """The receivers of results that the options name.

    Args:
        args: Options of the command.
        session: The connected run.
        waiting: The page that waited for the person; the live page takes its place.

    Raises:
        MbkfError: An address cannot be served, or a library is missing.
    """
    from mbkf.stream.results.values import ResultValues

    found: list[FrameSink] = [SaidVerdict(say)]
    setup = session.setup
    values = ResultValues(setup.model)
    if args.publish is not None:
        from mbkf.stream.lsl.results import LslResults

        found.append(LslResults(values, args.publish, setup.stream.rate_hz))
    if args.websocket is not None:
        from mbkf.stream.results.websocket import WebSocketResults, parse_address

        served = WebSocketResults(values, *parse_address(args.websocket), args.token)
        say(f"results: {served.url}")
        found.append(served)
    for kind, option, to in (("json", "--send-json", args.send_json), ("osc", "--send-osc", args.send_osc)):
        if to is not None:
            from mbkf.stream.results.datagrams import DatagramResults
            from mbkf.stream.results.websocket import parse_address

            place = parse_address(to, option)
            found.append(DatagramResults(values, kind, *place, partial(session.note, "results")))
    if args.view:
        from mbkf.viz.live.page import LivePage

        view_port, token = (args.view_port, args.token) if waiting is None else waiting.hand_over()
        page = LivePage(
            setup.model,
            setup.names,
            setup.plate_corners_m,
            title=setup.stream.trial,
            address=args.view_address,
            port=view_port,
            token=token,
        )
        if waiting is None:
            say(f"page: {page.url}")
        found.append(page)
    return found


class SaidVerdict:
    """A receiver of results that says the running verdict in the terminal, and again whenever a part's word changes.

    Args:
        say: Takes a sentence.
    """

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._said: Mapping[str, str] | None = None
        self._judgement: object = None

    def take(self, frame: LiveFrame) -> None:
        """Says the verdict of the frame if it is a new one."""
        judgement = frame.judgement
        if judgement is None or judgement is self._judgement:
            return
        self._judgement, parts = judgement, judgement.verdict.parts
        if parts != self._said:
            self._said = parts
            self._say(f"{judgement.time_s:.1f} s: {judgement.verdict.line}")

    def close(self) -> None:
        """The run's own outcome follows."""


def report_outcome(outcome: LiveOutcome, folder: Path) -> int:
    """Prints the run's numbers; returns 1 if it failed and yet left results.

    Raises:
        InvalidInput: Its results could not be written.
    """
    from mbkf.cli.reconstruct import print_summary
    from mbkf.errors import InvalidInput

    if outcome.summary is not None:
        print_summary(outcome.summary, folder)
    report = outcome.report
    lag = f", beside a lag of {_ms(report['lag_ms'])} ms" if report["lag_ms"] else ""
    print(
        f"frames: {report['frames_in']} received, {report['frames_lost']} lost; latency: median "
        f"{_ms(report['latency_ms_median'])}, 99 % {_ms(report['latency_ms_p99'])} ms{lag}; {report['ended_by']}"
    )
    if report.get("frames_recorded"):
        print(f"{report['recording']}: {report['frames_recorded']} frames recorded")
    failed = [] if outcome.failure is None else [f"the run ended early: {outcome.failure}"]
    logged, unlogged = report["frames_written"], report["frames_not_written"]
    if unlogged:
        failed.append(f"{unlogged} frames were never logged and cannot be recovered")
    if outcome.unreported is not None:
        failed.append(outcome.unreported)
    if report.get("recording_problem"):
        failed.append(f"the recording could not be written: {report['recording_problem']}")
        failed.append(f"'mbkf live --recover {folder}' tries again")
    if outcome.problem is not None:
        failed.insert(0, f"the results could not be written: {outcome.problem}")
        if report["log"] and logged:
            failed.append(f"'mbkf live --recover {folder}' makes results of the {logged} frames in its log")
        raise InvalidInput("; ".join(failed))
    if failed:
        say(f"mbkf: error: {'; '.join(failed)}; the results of {logged} frames are in {folder}")
    return 1 if failed else 0


def _ms(value: Any) -> str:
    return "–" if value is None else f"{value:.1f}"


def say(text: str) -> None:
    """Prints a sentence on the standard error."""
    console(stderr=True).print(text, soft_wrap=True)
