"""`mbkf live`: tracks a person through a stream and shows and writes motion, torques and reactions as they come."""

from __future__ import annotations

import argparse
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from mbkf.cli.live_output import add_output_options, say, sinks, told

if TYPE_CHECKING:
    from mbkf.io.subject import Subject
    from mbkf.stream.run.standing import KnownPerson, ScaledPerson, StandingStart
    from mbkf.stream.source import FrameSource
    from mbkf.viz.live.standing_page import StandingPage

LEAST_PATIENCE_S = 30.0
"""With a time limit, a stream that never appears is waited for at least so long."""

FILE_PREFIX = "file:"

NO_STREAM = "stopped before a stream appeared; nothing was written"

_EPILOG = """\
examples:
  mbkf live --from lsl --subject subject.toml --out result
  mbkf live --from lsl --mass 63.6 --out result                     (stand still for a second, then move)
  mbkf live --from natnet --server 192.168.1.10 --local 192.168.1.20 --subject subject.toml --view --out result
  mbkf live --from file:walk.c3d --subject subject.toml --seconds 5 --out result
  mbkf live --from lsl --subject subject.toml --lag 60 --out result       (each frame 60 ms later, and more exact)
  mbkf live --recover result

Ctrl-C or --seconds ends it. Then DIR holds what 'mbkf reconstruct' writes, and live.json: frames received and lost,
latencies from arrival to result (a lag not counted), and what happened. Marker positions are those of the subject file.
A stream that breaks off is waited for and taken up again.

Without --subject a person who stands still for a second is scaled from those frames, as 'mbkf scale' would from a
static trial, and tracked from then on; DIR/subject.toml keeps the person. Points without names need --protocol. Without
--mass the plates weigh the person, if both feet stand on them; their amplifiers must have been set to zero. With --view
the page shows these prompts to the person, and then the measurement.
"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Adds the command to the command line."""
    from mbkf.cli.options import add_lag_option, add_spreads_option

    parser = subparsers.add_parser(
        "live",
        help="tracks a person through a stream of markers and plates",
        description="Track a scaled subject through a live stream, frame by frame.",
        epilog=_EPILOG,
    )
    parser.add_argument(
        "--from", dest="source", metavar="lsl|natnet|file:TRIAL", help="where frames come from"
    )
    parser.add_argument(
        "--subject",
        metavar="SUBJECT.toml",
        help="written by 'mbkf scale'; without it a person who stands still is scaled",
    )
    parser.add_argument(
        "--mass", type=float, metavar="KG", help="without --subject: body mass; by default what plates carry"
    )
    parser.add_argument(
        "--protocol",
        metavar="NAME|FILE",
        help="without --subject: markers worn; by default found from the stream's names",
    )
    parser.add_argument("--filter", choices=("kinematic", "torque", "dynamic"), help="by default dynamic")
    parser.add_argument("--preset", metavar="NAME|FILE", help="settings, as for 'mbkf reconstruct'")
    add_lag_option(parser)
    add_spreads_option(parser)
    parser.add_argument("--view", action="store_true", help="show it in the browser")
    parser.add_argument(
        "--seconds", type=float, metavar="S", help="end after this time, from the first frame"
    )
    parser.add_argument("--out", metavar="DIR", help="folder to write")
    parser.add_argument(
        "--recover", metavar="DIR", help="make the results of a run that broke off, from its log in DIR"
    )
    stream = parser.add_argument_group("the stream")
    stream.add_argument(
        "--stream", metavar="NAME", help="LSL: name of the marker stream (default: the first)"
    )
    stream.add_argument("--plates-stream", metavar="NAME", help="LSL: name of the plate stream")
    stream.add_argument(
        "--server", default="127.0.0.1", metavar="ADDRESS", help="NatNet: the camera computer"
    )
    stream.add_argument("--local", default="127.0.0.1", metavar="ADDRESS", help="NatNet: this computer")
    stream.add_argument("--port", type=int, default=1510, metavar="N", help="NatNet: command port")
    stream.add_argument("--multicast", metavar="ADDRESS", help="NatNet: multicast group (default: unicast)")
    stream.add_argument("--up", metavar="AXIS", help="NatNet and files: axis that points up (NatNet: y)")
    stream.add_argument(
        "--forces", metavar="FILE", help="file: ground reactions beside it, as for reconstruct"
    )
    stream.add_argument("--unit", metavar="UNIT", help="file: length unit of the markers")
    stream.add_argument("--unlabelled", action="store_true", help="file: ignore its names")
    stream.add_argument(
        "--speed",
        type=float,
        default=1.0,
        metavar="X",
        help="file: times real time; 0 for as fast as it goes",
    )
    add_output_options(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Follows the stream, writes the folder and prints the key numbers.

    Raises:
        MbkfError: An input is unusable.
    """
    from mbkf.cli.options import asked_spreads, lag_seconds
    from mbkf.cli.stopping import stop_with_input, stopped_by_signal
    from mbkf.errors import InvalidInput
    from mbkf.io.atomic import check_folder
    from mbkf.io.subject import Subject
    from mbkf.stream.run.session import LiveSession
    from mbkf.stream.run.standing import StandingStart
    from mbkf.trial.preparation.presets import with_preset
    from mbkf.trial.preparation.settings import ReconstructSettings

    if args.recover is not None:
        return _recover(Path(args.recover))
    for option, given in (("--from", args.source), ("--out", args.out)):
        if given is None:
            raise InvalidInput(f"{option} is missing; see mbkf live --help")
    _check_numbers(args)
    person = _person(args)
    folder = check_folder(args.out)
    settings = ReconstructSettings(
        filter=args.filter or "dynamic",
        lag_s=lag_seconds(args),
        correct_markers=False,
        spreads=asked_spreads(args),
    )
    if args.preset is not None:
        settings = with_preset(settings, args.preset, args.filter)
    source, name = _source(args), args.source.partition(":")[0]
    with stopped_by_signal() as stop, _waiting_page(args) as waiting:
        if args.end_with_input:
            stop_with_input(stop)
        say(f"waiting for {args.source} …")
        patience = None if args.seconds is None else max(args.seconds, LEAST_PATIENCE_S)
        try:
            if isinstance(person, Subject):
                session = LiveSession(source, person, settings, folder, name)
            else:
                shown = None if waiting is None else waiting.progress
                start = StandingStart(source, name, person, folder, _say_on_both(waiting), shown)
                found = _standing(start, waiting, stop, patience)
                session = LiveSession(found.source, found.subject, settings, folder, name, found.report)
            if not session.connect(stop, patience):
                raise InvalidInput(NO_STREAM)
            listeners = sinks(args, session, waiting)
        except BaseException:
            source.close()
            raise
        stream, markers = session.setup.stream, len(session.setup.names)
        say(f"following {stream.trial}: {markers} markers at {stream.rate_hz:g} Hz")
        outcome = session.run(stop, listeners, args.seconds, keep_log=args.keep_log)
    return told(outcome, folder)


def _check_numbers(args: argparse.Namespace) -> None:
    from mbkf.cli.options import check_positive

    if args.seconds is not None:
        check_positive("--seconds", args.seconds)
    check_positive("--speed", args.speed, or_zero=True)
    if args.view:
        from mbkf.viz.server import checked_port

        checked_port(args.view_port)


def _person(args: argparse.Namespace) -> Subject | KnownPerson:
    """The subject of the file, or what is known of a person to be scaled."""
    from mbkf.cli.options import check_positive
    from mbkf.errors import InvalidInput
    from mbkf.io.subject import read_subject
    from mbkf.model.protocol import load_protocol
    from mbkf.stream.run.standing import KnownPerson

    if args.subject is None:
        if args.mass is not None:
            check_positive("--mass", args.mass)
        return KnownPerson(args.mass, None if args.protocol is None else load_protocol(args.protocol))
    for name in ("mass", "protocol"):
        if getattr(args, name) is not None:
            raise InvalidInput(f"--{name} is for a person to be scaled; leave it away beside --subject")
    return read_subject(args.subject)


@contextmanager
def _waiting_page(args: argparse.Namespace) -> Iterator[StandingPage | None]:
    """The page for the person to be scaled, not yet opened; closed at the end."""
    if not args.view or args.subject is not None:
        yield None
        return
    from mbkf.viz.live.standing_page import StandingPage

    page = StandingPage(address=args.view_address, port=args.view_port, token=args.token)
    try:
        yield page
    finally:
        page.close()


def _say_on_both(waiting: StandingPage | None) -> Callable[[str], None]:
    """Says a sentence in the terminal, and on the page if there is one."""

    def show(text: str) -> None:
        say(text)
        if waiting is not None:
            waiting.say(text)

    return show


def _standing(
    start: StandingStart, waiting: StandingPage | None, stop: threading.Event, patience_s: float | None
) -> ScaledPerson:
    """A person who stood still and was scaled.

    Raises:
        InvalidInput: There is no stream, no person was scaled, or the page cannot be served.
    """
    from mbkf.errors import InvalidInput

    if not start.connect(stop, patience_s):
        raise InvalidInput(NO_STREAM)
    if waiting is not None:
        say(f"page: {waiting.open(start.stream.trial)}")
    found = start.find(stop, patience_s)
    if found is None:
        raise InvalidInput("stopped before a person was scaled; live.json lists what was seen")
    return found


def _source(args: argparse.Namespace) -> FrameSource:
    from mbkf.errors import InvalidInput, UnknownName

    kind: str = args.source
    if kind == "lsl":
        from mbkf.stream.lsl.source import LslSource

        return LslSource(args.stream, args.plates_stream)
    if kind == "natnet":
        from mbkf.stream.natnet.source import NatNetSource

        return NatNetSource(args.server, args.local, args.port, args.multicast, args.up or "y")
    if not kind.startswith(FILE_PREFIX):
        raise UnknownName("source", kind, ("lsl", "natnet", "file:TRIAL"), "--from")
    path = kind.removeprefix(FILE_PREFIX)
    if not path:
        raise InvalidInput("--from file: lacks the file; write file:TRIAL.c3d")
    from mbkf.io.capture import read_capture
    from mbkf.stream.file_source import FileSource
    from mbkf.stream.played import played

    capture = read_capture(path, forces=args.forces, up=args.up, unit=args.unit)
    return FileSource(played(capture, args.unlabelled), args.speed)


def _recover(folder: Path) -> int:
    from mbkf.errors import InvalidInput
    from mbkf.stream.run.folder import write_results

    written = write_results(folder, ("live: made from the log of a run that broke off",))
    for sentence in written.left_out:
        say(f"mbkf: {sentence}")
    if written.summary is None:
        raise InvalidInput(f"nothing can be recovered: {written.problem}")
    print(f"{folder}: {written.summary['frames']} frames recovered")
    return 0
