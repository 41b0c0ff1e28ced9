"""A program of Vicon that answers at a given computer: DataStream has no public question to all servers of a network.

Source: client functions of Vicon's DataStream SDK 1.11, which connect to a computer by its name.
"""

from __future__ import annotations

from contextlib import closing, suppress

from mbkf.errors import MbkfError
from mbkf.stream.found import FoundStream
from mbkf.stream.loopback import LOOPBACK
from mbkf.stream.vicon.client import PORT
from mbkf.stream.vicon.source import ViconSource


def vicon_streams(timeout_s: float, host: str = LOOPBACK, port: int = PORT) -> list[FoundStream]:
    """The program that answers at a computer, and its stream; nothing where another one answers or none does.

    Args:
        timeout_s: Longest wait for its answer, and for frames that describe the stream.
        host: The computer.
        port: The port.
    """
    stream = None
    with closing(ViconSource(host, port, answer_s=timeout_s)) as source:
        with suppress(MbkfError):  # another server, or no cameras
            stream = source.connect(timeout_s)
        if not source.connected:
            return []
    name = "Vicon" if stream is None else stream.trial
    place = "" if (host, port) == (LOOPBACK, PORT) else host if port == PORT else f"{host}:{port}"
    return [FoundStream("vicon", name, host, place).described(stream)]
