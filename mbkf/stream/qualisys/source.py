"""Frames from Qualisys Track Manager over its real-time protocol: connection, its renewal, parameters that change."""

from __future__ import annotations

import time
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from mbkf.conventions import Array, read_only
from mbkf.errors import InvalidInput, InvalidPacket, MbkfError
from mbkf.stream.known import KnownStream
from mbkf.stream.qualisys import packets
from mbkf.stream.qualisys.client import PARAMETERS, Packet, QtmClient
from mbkf.stream.qualisys.parameters import MM, QtmDescription, read_parameters
from mbkf.stream.qualisys.plates import PlateForceReader
from mbkf.stream.qualisys.waiting import WaitingFrames
from mbkf.stream.reconnecting import ReconnectingSource
from mbkf.stream.source import PlateSamples, SourceFrame, StreamDescription

ASK_AGAIN_S = 0.25
"""Interval of questions for parameters while frames do not fit them."""

NEW_PARAMETERS = {1, 3, 7, 11}
"""Events after which parameters may be others: connected, capture started, file started, cameras' settings changed."""

NO_POINTS, NO_RESIDUALS = read_only(np.zeros((0, 3))), read_only(np.zeros(0))


class QualisysSource(ReconnectingSource[QtmClient, Packet]):
    """A :class:`mbkf.stream.source.FrameSource`."""

    def __init__(
        self,
        host: str,
        port: int,
        *,
        up: str | None = None,
        over_udp: bool = False,
        control: str | None = None,
    ) -> None:
        """A source that is not connected yet.

        Args:
            host: QTM's computer.
            port: Its base port.
            up: Axis that points up in QTM; None for the one that it states.
            over_udp: Whether frames come over UDP.
            control: Password with which a measurement is started at the first frame asked for and stopped at the end,
                "" without one; None to leave QTM alone.
        """
        super().__init__("QTM")
        self._place, self._up, self._control = (host, port, over_udp), up, control
        self._described: QtmDescription | None = None
        self._plates: PlateForceReader | None = None
        self._waiting: WaitingFrames | None = None
        self._asked_s = 0.0

    def connect(self, timeout_s: float) -> StreamDescription | None:
        """QTM's description of the stream, None while QTM is not there; frames are asked for by the first read.

        Raises:
            InvalidInput: Another server answers, or the parameters cannot be used.
        """
        begin = time.perf_counter()
        try:
            self._client = self._open()
        except OSError:
            time.sleep(max(0.0, min(timeout_s, 0.1 - (time.perf_counter() - begin))))
            return None
        self._described = read_parameters(self._client.parameters, self._up)
        self._known, self._plates = KnownStream(self._described.stream), PlateForceReader(self._described)
        self._waiting = WaitingFrames(self._described.stream, self._report)
        self._news += [("plates", sentence) for sentence in self._described.left_out]
        return self._described.stream

    def read(self, timeout_s: float) -> SourceFrame | None:
        """The next frame, with the forces until its end where they come in time."""
        assert self._waiting is not None, "connect first"
        until = time.perf_counter() + timeout_s
        if not self.receiving:
            self.receiving = True
            self._heard_s = time.perf_counter()
            self._ask_for_frames()
        while True:
            ready = self._waiting.due()
            if ready is not None:
                return ready
            now = time.perf_counter()
            wait_s = min(until - now, self._waiting.wait_s(now))
            found = self._take(max(0.0, wait_s))
            if found is not None:
                self._put(found)
            elif now >= until:
                return None

    def close(self) -> None:
        """Ends a measurement that this source started, and the connection."""
        if self._client is None:
            return
        with suppress(OSError):
            self._client.send("StreamFrames Stop")
            if self._control is not None and self.receiving:
                self._client.send("Stop")
                self._client.send("ReleaseControl")
        super().close()

    def _open(self) -> QtmClient:
        return QtmClient(*self._place)

    def _resume(self, client: QtmClient) -> None:
        self._describe(client.parameters)
        self._ask_for_frames()

    def _ask_for_frames(self) -> None:
        assert self._client is not None and self._known is not None
        try:
            if self._control is not None:
                self._client.command(f"TakeControl {self._control}".strip())
                self._client.command("Start")
            components = "3DRes 3DNoLabelsRes" if self._known.stream.marker_names else "3DNoLabelsRes"
            self._client.stream(f"{components} Force" if self._known.stream.plates else components)
        except (OSError, InvalidPacket) as error:
            self._lose(str(error))
        except InvalidInput as error:
            self._control = None
            self._news.append(("control", f"no measurement was started: {error}"))
            self._ask_for_frames()

    def _put(self, one: Packet) -> None:
        """Takes a packet."""
        if one.kind == packets.DATA:
            try:
                self._put_frame(packets.read_frame(one.payload), one.arrival_s)
            except (InvalidPacket, ValueError, ArithmeticError) as error:
                self._report("packets", f"packets that cannot be read are left out ({error})")
        elif one.kind == packets.XML:
            self._describe(packets.text_of(one.payload))
        elif one.kind == packets.EVENT and one.payload[:1] and one.payload[0] in NEW_PARAMETERS:
            self._ask_for_parameters()
        elif one.kind == packets.ERROR:
            self._report("connection", f"QTM answers: {packets.text_of(one.payload)[:200]}")

    def _put_frame(self, frame: packets.DataFrame, arrival_s: float) -> None:
        assert self._described is not None and self._known is not None
        assert self._plates is not None and self._waiting is not None
        if self._known.refused:
            return
        known = self._known
        if frame.forces is not None and known.stream.plates:
            before = self._plates.axes
            samples = known.plate_samples(self._plates.samples(frame.forces))
            if self._plates.axes != before:
                self._news.append(("plates axes", f"QTM states forces in axes of the {self._plates.axes}"))
            self._waiting.put_samples(samples, arrival_s)
        labelled, its_residuals = _component(frame, packets.MARKERS_RESIDUAL, packets.MARKERS)
        bare, bare_residuals = _component(frame, packets.POINTS_RESIDUAL, packets.POINTS)
        if labelled is None and (bare is None or known.stream.marker_names):
            return  # forces alone
        markers, residuals = NO_POINTS, NO_RESIDUALS
        if known.stream.marker_names:
            markers, residuals = self._markers(labelled, its_residuals)
        points = NO_POINTS
        if bare is not None and len(bare):
            points = self._world(bare)
            residuals = np.concatenate([residuals, MM * bare_residuals.astype(float)])
        none = PlateSamples.none(len(known.stream.plates))
        made = SourceFrame(frame.number, arrival_s, markers, points, none, residuals_m=residuals)
        self._waiting.put(made)

    def _markers(
        self, found: NDArray[np.float32] | None, residuals: NDArray[np.float32]
    ) -> tuple[Array, Array]:
        """(M, 3) known markers and (M,) residuals; NaN where their number is not the parameters', which it asks for."""
        assert self._known is not None and self._described is not None
        if found is None or len(found) != len(self._described.stream.marker_names):
            self._ask_for_parameters()
            unseen = np.full((len(self._known.stream.marker_names), 4), np.nan)
            return unseen[:, :3], unseen[:, 3]
        in_order = self._known.in_order
        return in_order(self._world(found)), in_order(MM * residuals.astype(float))

    def _world(self, points_mm: NDArray[np.float32]) -> Array:
        assert self._described is not None
        return np.asarray(points_mm.astype(float) @ self._described.to_world)

    def _ask_for_parameters(self) -> None:
        now = time.perf_counter()
        if self._client is None or now - self._asked_s < ASK_AGAIN_S:
            return
        self._asked_s = now
        try:
            self._client.send(PARAMETERS)
        except OSError as error:
            self._lose(str(error))

    def _describe(self, text: str) -> None:
        """Takes parameters that came again."""
        assert self._known is not None
        try:
            found = read_parameters(text, self._up)
        except MbkfError as error:
            self._report("refused", f"QTM's new parameters cannot be used ({error})")
            return
        if self._described is not None and _same(found, self._described) and not self._known.refused:
            return
        axes = None if self._plates is None else self._plates.axes
        self._described, self._plates = found, PlateForceReader(found)
        self._plates.axes = axes
        self._news += self._known.describe(found.stream)


def _component(
    frame: packets.DataFrame, with_residuals: int, plain: int
) -> tuple[NDArray[np.float32] | None, NDArray[np.float32]]:
    """Points (N, 3) and residuals (N,), mm, of one of two components; NaN for the one without residuals."""
    if with_residuals in frame.points:
        return frame.points[with_residuals], frame.residuals[with_residuals]
    found = frame.points.get(plain)
    return found, np.full(0 if found is None else len(found), np.nan, dtype=np.float32)


def _same(one: QtmDescription, other: QtmDescription) -> bool:
    """True for equal rates, names and plates."""
    first, second = one.stream, other.stream
    return (
        (first.marker_names, first.rate_hz, one.plate_ids)
        == (second.marker_names, second.rate_hz, other.plate_ids)
        and np.array_equal(one.rotation, other.rotation)
        and all(
            plate.rate_hz == known.rate_hz and _alike(plate.corners_m, known.corners_m)
            for plate, known in zip(first.plates, second.plates, strict=True)
        )
    )


def _alike(one: Array | None, other: Array | None) -> bool:
    return one is None or other is None or np.array_equal(one, other)
