"""Track a person through a live stream of markers and plates.

Shows and writes motion, torques and reactions frame by frame.

Examples:
  mbkf live --from lsl --subject subject.toml --out result
  mbkf live --from lsl --mass 63.6 --out result                     (stand still for a second, then move)
  mbkf live --from natnet --server 192.168.1.10 --local 192.168.1.20 --subject subject.toml --view --out result
  mbkf live --from qualisys:192.168.1.10 --subject subject.toml --view --out result
  mbkf live --from vicon:192.168.1.10 --subject subject.toml --view --out result
  mbkf live --from xsens --subject subject.toml --view --out result       (Xsens MVN's network streamer)
  mbkf live --from file:walk.c3d --subject subject.toml --seconds 5 --out result
  mbkf live --from lsl --subject subject.toml --lag 60 --out result       (each frame 60 ms later, and more exact)
  mbkf live --from qualisys --subject subject.toml --record walk.c3d --out result
  mbkf live --recover result
  mbkf live --list

Ctrl-C or --seconds ends it. Then DIR holds the files of 'mbkf reconstruct', and live.json: frames received and lost,
latencies from arrival to result (a lag not counted), and events. Marker positions are those of the subject file. If the
stream breaks off, the command waits for it and continues.

Without --subject a person who stands still for a second is scaled from those frames, as 'mbkf scale' would from a
static trial, and tracked from then on; DIR/subject.toml keeps the person. Points without names need --protocol.
Without --mass the plates weigh the person if both feet stand on them; set their amplifiers to zero first. With --view
the page shows these prompts to the person, and then the measurement.

--list asks the network for two seconds which streams there are, and prints each with the words that follow it. Vicon's
program is looked for on this computer, or with --from vicon:HOST on that one.
"""

from __future__ import annotations

import argparse
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from mbkf.cli.following import (
    add_following_options,
    follow,
    report_outcome,
    say,
)
from mbkf.cli.live_source import SOURCES, add_source_options, source_of
from mbkf.cli.options import (
    add_out,
    add_preset_options,
    add_strict,
    asked_spreads,
    body_mass,
    lag_seconds,
    strict_exit,
    with_chosen,
)

if TYPE_CHECKING:
    from mbkf.io.subject import Subject
    from mbkf.stream.run.session import LiveSession
    from mbkf.stream.run.standing import KnownPerson, ScaledPerson, StandingStart
    from mbkf.viz.live.standing_page import StandingPage

NO_STREAM = "stopped before a stream appeared; nothing was written"


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    parser.add_argument("--from", dest="source", metavar=SOURCES, help="source of the frames")
    parser.add_argument(
        "--subject",
        metavar="SUBJECT.toml",
        help="written by 'mbkf scale'; without it a person who stands still is scaled",
    )
    parser.add_argument(
        "--mass",
        type=body_mass,
        metavar="KG",
        help="without --subject: body mass (default: as plates weigh it)",
    )
    parser.add_argument(
        "--protocol",
        metavar="NAME|FILE",
        help="without --subject: the marker set (default: found from the stream's names)",
    )
    parser.add_argument("--filter", choices=("kinematic", "torque", "dynamic"), help="default: dynamic")
    add_preset_options(parser)
    add_strict(parser)
    add_out(parser, "DIR", "folder to write")
    add_out(
        parser,
        "FILE.c3d",
        "record the stream: all markers or points, and the plates at their own rate",
        option="--record",
    )
    parser.add_argument(
        "--recover", metavar="DIR", help="make the results of a run that broke off, from its log in DIR"
    )
    parser.add_argument(
        "--list",
        action="store_true",
        help="print the streams of the network (with --from KIND[:PLACE] those of one kind; see --local)",
    )
    add_source_options(parser)
    add_following_options(parser)


def run(args: argparse.Namespace) -> int:
    """Follows the stream, writes the folder and prints the key numbers.

    Raises:
        InvalidInput: An option is missing, or no stream appeared.
    """
    from mbkf.errors import InvalidInput
    from mbkf.io.subject import Subject
    from mbkf.trial.preparation.settings import ReconstructSettings

    if args.recover is not None:
        return _recover(Path(args.recover))
    if args.list:
        from mbkf.cli.stream_list import list_streams

        return list_streams(args.source, args.local)
    for option, given in (("--from", args.source), ("--out", args.out)):
        if given is None:
            raise InvalidInput(f"{option} is missing; see mbkf live --help")
    if args.source.partition(":")[0] == "xsens":
        return _follow_sensors(args)
    person, folder = _person(args), _folder(args)
    settings = ReconstructSettings(
        filter=args.filter or "dynamic",
        lag_s=lag_seconds(args),
        correct_markers=False,
        spreads=asked_spreads(args),
    )
    settings = with_chosen(settings, args)
    source, name = source_of(args), args.source.partition(":")[0]
    record = _recording(args.record)

    def begin(stop: threading.Event, patience_s: float | None) -> LiveSession:
        from mbkf.stream.run.session import LiveSession  # loads slowly; by now the source is listened to

        if isinstance(person, Subject):
            session = LiveSession(source, person, settings, folder, name, record=record)
        else:
            from mbkf.stream.run.standing import StandingStart

            shown = None if waiting is None else waiting.progress
            start = StandingStart(source, name, person, folder, _say_on_both(waiting), shown)
            found = _standing(start, waiting, stop, patience_s)
            session = LiveSession(
                found.source, found.subject, settings, folder, name, found.report, record=record
            )
        if not session.connect(stop, patience_s):
            raise InvalidInput(NO_STREAM)
        return session

    with _waiting_page(args) as waiting:
        outcome = follow(args, source, begin, waiting)
    told = None if outcome.summary is None else outcome.summary["verdict"]
    return report_outcome(outcome, folder) or strict_exit(args, told)


def _folder(args: argparse.Namespace) -> Path:
    """The folder of the run, in which it may write its files.

    Raises:
        ProtectedFile: It holds such a file that mbkf did not write.
    """
    from mbkf.io.atomic import check_folder
    from mbkf.io.results_folder import RESULT_FILES
    from mbkf.stream.run.report import LIVE_FILE

    if args.subject is not None:
        return check_folder(args.out, (LIVE_FILE, *RESULT_FILES))
    from mbkf.stream.run.standing import SUBJECT_FILE

    return check_folder(args.out, (LIVE_FILE, SUBJECT_FILE, *RESULT_FILES))


def _recording(name: str | None) -> Path | None:
    """The file to record to.

    Raises:
        InvalidInput: Its name does not end in ``.c3d``.
        ProtectedFile: It exists.
    """
    from mbkf.errors import InvalidInput
    from mbkf.io.written import check_absent

    if name is None:
        return None
    if Path(name).suffix.lower() != ".c3d":
        raise InvalidInput(f"--record {name}: a C3D file is named .c3d; change the name")
    check_absent(name)
    return Path(name)


def _follow_sensors(args: argparse.Namespace) -> int:
    """Follows a suit of inertial sensors as ``mbkf imu live`` does.

    Raises:
        InvalidInput: An option is for markers, or ``--subject`` is missing.
    """
    from mbkf.cli.imu_live import follow_sensors
    from mbkf.errors import InvalidInput
    from mbkf.io.subject import read_subject

    for name in ("mass", "protocol", "filter", "preset", "record", "plates"):
        if getattr(args, name) is not None:
            raise InvalidInput(
                f"--{name} is for markers, and xsens brings orientations; see mbkf imu live --help"
            )
    if args.subject is None:
        raise InvalidInput(
            "--subject is missing; a person who is not scaled: mbkf imu live --from xsens --mass KG --height M"
        )
    return follow_sensors(args, source_of(args), read_subject(args.subject))


def _person(args: argparse.Namespace) -> Subject | KnownPerson:
    """The subject of the file, or the known facts of a person to scale."""
    from mbkf.errors import InvalidInput
    from mbkf.io.subject import read_subject

    if args.subject is None:
        from mbkf.model.protocol import load_protocol
        from mbkf.stream.run.standing import KnownPerson

        return KnownPerson(args.mass, None if args.protocol is None else load_protocol(args.protocol))
    for name in ("mass", "protocol"):
        if getattr(args, name) is not None:
            raise InvalidInput(
                f"--{name} is for a person to scale, and --subject names a scaled one; give one"
            )
    return read_subject(args.subject)


@contextmanager
def _waiting_page(args: argparse.Namespace) -> Iterator[StandingPage | None]:
    """The page for the person to scale, not yet opened; closed at the end."""
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
    """Prints a sentence in the terminal, and on the page if there is one."""

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
        InvalidInput: No stream appeared, no person was scaled, or the page cannot be served.
    """
    from mbkf.errors import InvalidInput

    if not start.connect(stop, patience_s):
        raise InvalidInput(NO_STREAM)
    if waiting is not None:
        say(f"page: {waiting.open(start.stream.trial)}")
    found = start.find(stop, patience_s)
    if found is None:
        raise InvalidInput("stopped before a person was scaled; live.json lists the attempts")
    return found


def _recover(folder: Path) -> int:
    """Makes recording and results of a log; returns 1 where the recording alone could not be written.

    Raises:
        InvalidInput: There are no results.
    """
    from mbkf.errors import InvalidInput
    from mbkf.stream.run.folder import write_results
    from mbkf.stream.run.recording import write_recording

    recording = write_recording(folder)
    for sentence in recording.sentences:
        say(f"mbkf: {sentence}")
    if recording.frames:
        print(f"{recording.file}: {recording.frames} frames recorded")
    written = write_results(folder, ("live: made from the log of a run that broke off",))
    for sentence in written.left_out:
        say(f"mbkf: {sentence}")
    if written.summary is None:
        raise InvalidInput(f"no frame can be recovered: {written.problem}")
    print(f"{folder}: {written.summary['frames']} frames recovered")
    return 0 if recording.problem is None else 1
