"""The waiting page: shows the prompts to the person who is scaled, until the live page takes its place."""

from __future__ import annotations

import json

from mbkf.stream.loopback import LOOPBACK
from mbkf.viz.page import asset, embedded_words, fill, scripts
from mbkf.viz.sentences import in_languages
from mbkf.viz.server import PageServer


class StandingPage:
    """A web page that shows the newest sentence, large, and the progress of the standing.

    A sentence from before the page is opened is shown then. An open page that loses its server asks at the same address
    until another page replies, and becomes that one.

    Args:
        address: Address to listen at; this computer only by default.
        port: 0 for any free one.
        token: Secret in the page's address, as for :class:`mbkf.viz.live.page.LivePage`.
    """

    def __init__(self, *, address: str = LOOPBACK, port: int = 0, token: str | None = None) -> None:
        self._address, self._port, self._token = address, port, token
        self._newest: tuple[int, str, float | None] = (0, "", None)
        self._server: PageServer | None = None

    def open(self, title: str) -> str:
        """Serves the page; returns its address, token included.

        Args:
            title: Heading of the page.

        Raises:
            InvalidInput: The address or port cannot be used.
        """
        self._server = PageServer(
            standing_page(),
            greeting=json.dumps({"title": title}),
            newest=self._packed,
            address=self._address,
            port=self._port,
            token=self._token,
        )
        return self._server.url

    def say(self, text: str) -> None:
        """Shows a sentence instead of the last one; returns at once."""
        self._show(text, self._newest[2])

    def progress(self, share: float | None) -> None:
        """Shows the progress of the standing, 0 to 1; None hides it while no frames come. Returns at once."""
        self._show(self._newest[1], share)

    def hand_over(self) -> tuple[int, str]:
        """Frees the port at once; returns it and the token, for the page that follows at the same address."""
        assert self._server is not None
        self._server.free()
        return self._server.port, self._server.token

    def close(self) -> None:
        """Ends the server if there is one; open pages show that."""
        if self._server is not None:
            self._server.close()

    def _show(self, text: str, share: float | None) -> None:
        number, *shown = self._newest
        if shown != [text, share]:
            self._newest = (number + 1, text, share)
            if self._server is not None:
                self._server.wake()

    def _packed(self) -> tuple[int, bytes]:
        """The newest sentence and share as a numbered row of JSON."""
        number, text, share = self._newest
        return number, json.dumps(
            {"text": text, "share": share, "said": in_languages([text])}, ensure_ascii=False
        ).encode("utf-8")


def standing_page() -> str:
    """The page, in the style of the live page."""
    style = asset("page.css") + asset("standing.css")
    return fill(
        "standing.html",
        style=style,
        words=embedded_words("live_page"),
        scripts=scripts(["app_words.js", "standing.js"]),
    )
