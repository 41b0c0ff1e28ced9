"""Sources of live frames by name, as ``--from`` names them, and their options."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from mbkf.cli.following import add_speed_option, file_named
from mbkf.cli.options import natural, port

if TYPE_CHECKING:
    from mbkf.stream.source import FrameSource

SOURCES = "lsl|natnet|qualisys[:HOST]|udp[:PORT]|vicon[:HOST]|xsens[:PORT]|file:TRIAL"
"""Values of ``--from``, for help."""


def add_source_options(parser: argparse.ArgumentParser) -> None:
    """Adds the options of streams."""
    stream = parser.add_argument_group("the stream")
    stream.add_argument(
        "--stream", metavar="NAME", help="LSL: name of the marker stream (default: the first)"
    )
    stream.add_argument("--plates-stream", metavar="NAME", help="LSL: name of the plate stream")
    stream.add_argument("--server", default="127.0.0.1", metavar="ADDRESS", help="NatNet: camera computer")
    stream.add_argument(
        "--local",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="NatNet, udp, Xsens, --list: address of this computer",
    )
    stream.add_argument("--port", type=port, default=1510, metavar="N", help="NatNet: command port")
    stream.add_argument("--multicast", metavar="ADDRESS", help="NatNet: multicast group (default: unicast)")
    stream.add_argument(
        "--up",
        metavar="AXIS",
        help="NatNet, Qualisys, Vicon, Xsens and files: vertical axis (NatNet: y; Qualisys, Vicon: as stated; Xsens: "
        "as the posture shows)",
    )
    add_character_option(stream)
    stream.add_argument("--over-udp", action="store_true", help="Qualisys: frames over UDP in place of TCP")
    stream.add_argument(
        "--control",
        metavar="PASSWORD",
        nargs="?",
        const="",
        help="Qualisys: start a measurement in QTM with the run, and stop it at the end",
    )
    stream.add_argument(
        "--pull", action="store_true", help="Vicon: ask for each frame in place of being sent all"
    )
    stream.add_argument(
        "--plates",
        metavar="FILE",
        help="capture of this laboratory (C3D) whose plates' corners count where the stream states none",
    )
    stream.add_argument("--forces", metavar="FILE", help="file: its ground reactions, as for reconstruct")
    stream.add_argument("--unit", metavar="UNIT", help="file: length unit of the markers")
    stream.add_argument(
        "--person",
        metavar="NAME",
        help="file: of several persons in it the one to follow: name or number; Vicon: name of the subject",
    )
    stream.add_argument("--unlabelled", action="store_true", help="file: ignore its names")
    add_speed_option(stream)


def add_character_option(parser: argparse._ActionsContainer) -> None:
    """Adds ``--character``."""
    parser.add_argument(
        "--character",
        type=natural,
        metavar="ID",
        help="Xsens: MVN's ID of the person to follow (default: the first)",
    )


def source_of(args: argparse.Namespace) -> FrameSource:
    """The source that ``--from`` names, not connected yet, with the plates' corners of ``--plates``.

    Raises:
        UnknownName: There is no such source.
        InvalidInput: An option is wrong, or the source cannot be listened to.
    """
    if args.plates is None:
        return _source(args)
    from mbkf.io.capture import read_capture
    from mbkf.stream.placed_plates import PlacedPlates, PlateGeometry

    geometry = PlateGeometry(args.plates, read_capture(args.plates).plates)
    return PlacedPlates(_source(args), geometry, in_plate_axes=args.source == "natnet")


def _source(args: argparse.Namespace) -> FrameSource:
    """The source that ``--from`` names, as it is."""
    name, colon, detail = args.source.partition(":")
    if name in _STREAMS and (not colon or name in _WITH_PLACE):
        return _STREAMS[name](args, detail)
    path = file_named(args.source, "file:TRIAL.c3d", *_STREAMS)
    from mbkf.io.capture import read_capture
    from mbkf.stream.file_source import FileSource
    from mbkf.stream.played import played

    capture = read_capture(path, forces=args.forces, up=args.up, unit=args.unit, person=args.person)
    return FileSource(played(capture, args.unlabelled), args.speed)


def _lsl(args: argparse.Namespace, _: str) -> FrameSource:
    from mbkf.stream.lsl.source import LslSource

    return LslSource(args.stream, args.plates_stream)


def _natnet(args: argparse.Namespace, _: str) -> FrameSource:
    from mbkf.stream.natnet.source import NatNetSource

    return NatNetSource(args.server, args.local, args.port, args.multicast, args.up or "y")


def _udp(args: argparse.Namespace, detail: str) -> FrameSource:
    from mbkf.stream.udp.messages import DEFAULT_PORT
    from mbkf.stream.udp.source import UdpSource

    return UdpSource(_port(detail, DEFAULT_PORT, "udp"), args.local)


def _qualisys(args: argparse.Namespace, detail: str) -> FrameSource:
    from mbkf.stream.qualisys.client import BASE_PORT
    from mbkf.stream.qualisys.source import QualisysSource

    host, _, base = detail.partition(":")
    number = _port(base, BASE_PORT, f"qualisys:{host}")
    return QualisysSource(
        host or "127.0.0.1", number, up=args.up, over_udp=args.over_udp, control=args.control
    )


def _vicon(args: argparse.Namespace, detail: str) -> FrameSource:
    from mbkf.stream.vicon.client import PORT
    from mbkf.stream.vicon.source import ViconSource

    host, _, place = detail.partition(":")
    number = _port(place, PORT, f"vicon:{host}")
    return ViconSource(host or "127.0.0.1", number, up=args.up, person=args.person, pull=args.pull)


def xsens_source(args: argparse.Namespace, detail: str) -> FrameSource:
    """MVN's network streamer.

    Args:
        args: Options ``--local``, ``--up`` and ``--character``.
        detail: Port, "" for the usual one.

    Raises:
        InvalidInput: The port is not one, or cannot be listened at.
    """
    from mbkf.stream.xsens.packets import DEFAULT_PORT
    from mbkf.stream.xsens.source import XsensSource

    number = _port(detail, DEFAULT_PORT, "xsens")
    return XsensSource(number, args.local, up=args.up, character=args.character)


def _port(detail: str, default: int, source: str) -> int:
    """The port behind a source's name.

    Raises:
        InvalidInput: It is not one.
    """
    from mbkf.errors import InvalidInput

    if not detail:
        return default
    try:
        return port(detail)
    except argparse.ArgumentTypeError as error:
        raise InvalidInput(f"--from {source}:{detail}: {error}; write {source}:{default}") from error


_STREAMS: Mapping[str, Callable[[argparse.Namespace, str], FrameSource]] = {
    "lsl": _lsl,
    "natnet": _natnet,
    "qualisys": _qualisys,
    "udp": _udp,
    "vicon": _vicon,
    "xsens": xsens_source,
}
_WITH_PLACE = ("qualisys", "udp", "vicon", "xsens")
"""Sources whose name may be followed by a colon and a port or an address."""
