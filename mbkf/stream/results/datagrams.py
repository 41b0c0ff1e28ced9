"""Results as datagrams to one receiver: JSON, or Open Sound Control. Nobody has to receive them."""

from __future__ import annotations

import errno
import json
import socket
import time
from collections.abc import Callable

from mbkf.errors import InvalidInput
from mbkf.stream.results.frame import LiveFrame
from mbkf.stream.results.message import frame_message
from mbkf.stream.results.osc import OscBundles
from mbkf.stream.results.sending import SendingThread
from mbkf.stream.results.values import ResultValues

NAMES_S = 1.0
"""Interval at which JSON states names and units of the values."""

JSON, OSC = "json", "osc"


class DatagramResults:
    """A :class:`mbkf.stream.results.frame.FrameSink`."""

    def __init__(
        self,
        values: ResultValues,
        kind: str,
        address: str,
        port: int,
        report: Callable[[str], None] | None = None,
    ) -> None:
        """Opens the socket.

        Args:
            values: Makes the numbers; receivers of one run share it.
            kind: :data:`JSON` or :data:`OSC`.
            address: Address of the receiver.
            port: Its port.
            report: Takes a sentence on messages that are too large, once.

        Raises:
            InvalidInput: It cannot be sent to.
        """
        self._values = values
        self._bundles = OscBundles(self._values.names) if kind == OSC else None
        self._names_due_s = 0.0
        self._kind, self._report = kind, report
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.connect((address, port))
        except (OSError, OverflowError, UnicodeError) as error:
            self._socket.close()
            raise InvalidInput(f"results cannot be sent to {address}, port {port} ({error})") from error
        self._thread = SendingThread(self._send, f"mbkf-{kind}-results")

    def take(self, frame: LiveFrame) -> None:
        """Hands the frame over."""
        self._thread.take(frame)

    def close(self) -> None:
        """Sends the waiting frames and ends."""
        self._thread.close()
        self._socket.close()

    def _send(self, frame: LiveFrame) -> None:
        values = self._values.row(frame)
        if self._bundles is not None:
            self._put(self._bundles.bundle(frame, values))
            return
        now = time.monotonic()
        if now >= self._names_due_s:
            self._names_due_s = now + NAMES_S
            self._put(json.dumps({"names": self._values.names, "units": self._values.units}).encode())
        self._put(json.dumps(frame_message(frame, values)).encode())

    def _put(self, data: bytes) -> None:
        try:
            self._socket.send(data)
        except OSError as error:  # nobody listens, or the message is too large
            if error.errno == errno.EMSGSIZE and self._report is not None:
                report, self._report = self._report, None
                report(
                    f"results: messages of {self._kind} are too large for a datagram and are left out (the first had "
                    f"{len(data)} bytes); take --websocket, or --spreads none"
                )
