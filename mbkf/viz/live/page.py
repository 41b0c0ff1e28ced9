"""The live page: a receiver of frames that shows the newest one in every open browser."""

from __future__ import annotations

import json

import numpy as np

from mbkf.conventions import Array
from mbkf.model.body import Body
from mbkf.stream.loopback import LOOPBACK
from mbkf.stream.results.frame import LiveFrame
from mbkf.stream.results.judgement import Judgement
from mbkf.viz.live.rows import DisplayRows
from mbkf.viz.page import page
from mbkf.viz.scene.description import scene_description
from mbkf.viz.sentences import in_languages
from mbkf.viz.server import PageServer


class LivePage:
    """A web page that follows a live reconstruction (a ``FrameSink``).

    :meth:`take` only keeps a frame. The server's own thread makes a row of the newest one, at most 30 times a second,
    just after a frame has come and only while a page is open, so the filter never waits. The page may be closed and
    opened again at any time.

    Args:
        model: The body.
        marker_names: (M,) markers of the frames, in their order.
        plate_corners_m: (K, 4, 3) corners of the force plates, NaN where not known; None without plates.
        title: Heading of the page.
        address: Address to listen at; this computer only by default.
        port: 0 for any free one.
        token: Secret in the page's address; a random one by default where the address is not this computer's own.

    Attributes:
        url: Address to open in a browser, token included.

    Raises:
        InvalidInput: The address or port cannot be used.
    """

    def __init__(
        self,
        model: Body,
        marker_names: tuple[str, ...],
        plate_corners_m: Array | None = None,
        *,
        title: str = "live",
        address: str = LOOPBACK,
        port: int = 0,
        token: str | None = None,
    ) -> None:
        corners = np.empty((0, 4, 3)) if plate_corners_m is None else np.asarray(plate_corners_m)
        heights = corners[..., 2][np.isfinite(corners[..., 2])]
        self._rows = DisplayRows(model, len(marker_names), float(heights.mean()) if heights.size else 0.0)
        self._newest: LiveFrame | None = None
        self._sent: tuple[LiveFrame, int, bytes] | None = None
        self._judged: tuple[Judgement, int, str] | None = None
        greeting = scene_description(
            title, model, marker_names, self._rows.clinical.names, corners, self._rows.layout, streamed=True
        )
        self._server = PageServer(
            page(),
            greeting=json.dumps(greeting),
            newest=self._packed,
            news=self._judgement,
            address=address,
            port=port,
            token=token,
        )
        self.url = self._server.url

    def take(self, frame: LiveFrame) -> None:
        """Keeps the frame as the newest one; returns at once."""
        self._newest = frame
        self._server.wake()

    def close(self) -> None:
        """Ends the server; open pages show that they are not connected."""
        self._server.close()

    def _judgement(self) -> tuple[int, str] | None:
        """The newest judgement of the run as JSON, for all open pages; None before there is one."""
        frame = self._newest
        if frame is None or frame.judgement is None:
            return None
        if self._judged is None or self._judged[0] is not frame.judgement:
            count = 0 if self._judged is None else self._judged[1] + 1
            text = json.dumps(_spoken(frame.judgement), ensure_ascii=False)
            self._judged = (frame.judgement, count, text)
        return self._judged[1:]

    def _packed(self) -> tuple[int, bytes] | None:
        """The newest frame's row as 32-bit numbers; made once for all open pages."""
        frame = self._newest
        if frame is None:
            return None
        if self._sent is None or self._sent[0] is not frame:
            count = 0 if self._sent is None else self._sent[1] + 1
            self._sent = (frame, count, self._rows.row(frame).astype("<f4").tobytes())
        return self._sent[1:]


def _spoken(judgement: Judgement) -> dict[str, object]:
    """A judgement as plain data, with its sentences in other languages."""
    limbs = [one.sentence for one in judgement.limb_doubts]
    texts = [judgement.verdict.line, *judgement.verdict.sentences, *judgement.notices, *limbs]
    return {"judgement": judgement.plain(), "said": in_languages(texts)}
