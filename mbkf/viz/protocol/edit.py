"""The editor's page of a marker set, and the server behind it that saves the set."""

from __future__ import annotations

import json
import secrets
import threading
from pathlib import Path

from mbkf.errors import InvalidInput, MbkfError
from mbkf.io.plain_data import parse_json
from mbkf.model.protocol import Protocol
from mbkf.model.protocol_file import checked_name, write_protocol
from mbkf.trial.protocol.editing import Choice, edited
from mbkf.trial.protocol.standing import Standing
from mbkf.viz.protocol.page import EDIT_SCRIPTS, page_text, set_data
from mbkf.viz.server import PageServer


class MarkerSetEdit:
    """A marker set in an editor: the page sends a person's choices by marker, and this class carries them out.

    Args:
        protocol: The set to begin with.
        standing: The capture, with the body beside it.
        out: The file that saving writes.

    Attributes:
        done: Set when the page reports that the person is done.
        saved: The newest saved set; None before.

    Raises:
        InvalidInput: The file's name is not possible for a marker set.
    """

    def __init__(self, protocol: Protocol, standing: Standing, out: str | Path) -> None:
        self._protocol, self._standing, self._out = protocol, standing, checked_name(out)
        self.done = threading.Event()
        self.saved: Protocol | None = None

    def text(self, say: str = "") -> str:
        """The page.

        Args:
            say: Address for the page's requests; its own server's WebSocket if empty.
        """
        data = {
            **set_data(self._protocol, self._standing),
            "out": self._out.name,
            "trouble": self._standing.trouble,
            "say": say,
        }
        return page_text(data, EDIT_SCRIPTS, "'self'")

    def hear(self, word: str) -> str:
        """Carries out a request of the page, in JSON, and returns the reply, in JSON.

        Args:
            word: ``{"do": "done"}``, or ``{"do": "save", "choices": {NAME: {WHAT: TEXT}}}`` with a field of
                :class:`~mbkf.trial.protocol.editing.Choice` for WHAT.
        """
        try:
            asked = parse_json(word)
            if asked.get("do") == "save":
                return json.dumps(self._save(asked.get("choices")))
            if asked.get("do") == "done":
                self.done.set()
                return json.dumps({"done": True})
            raise InvalidInput(f"the page sent the unknown request {asked.get('do')!r}")
        except (MbkfError, OSError) as error:
            return json.dumps({"trouble": str(error)})
        except ValueError:
            return json.dumps({"trouble": "the page sent a request that is no JSON"})

    def _save(self, choices: object) -> dict[str, object]:
        known = (
            {str(name): _choice(one) for name, one in choices.items()} if isinstance(choices, dict) else {}
        )
        made = edited(self._protocol, self._standing, known, self._out.stem)
        write_protocol(made, self._out)
        self.saved = made
        return {"saved": self._out.name, "markers": len(made.markers), "ignored": len(made.ignored)}


class EditPage(MarkerSetEdit):
    """Serves an editor to this computer until its page is done; only with the token, since it writes a file.

    Args:
        protocol: The set to begin with.
        standing: The capture, with the body beside it.
        out: The file that saving writes.
        port: 0 for any free one.

    Attributes:
        url: Address to open in a browser, token included.

    Raises:
        InvalidInput: The port is not free, or the file's name is not possible for a marker set.
    """

    def __init__(self, protocol: Protocol, standing: Standing, out: str | Path, *, port: int = 0) -> None:
        super().__init__(protocol, standing, out)
        self._server = PageServer(self.text(), hear=self.hear, port=port, token=secrets.token_urlsafe(16))
        self.url = self._server.url

    def close(self) -> None:
        """Ends the server."""
        self._server.close()


def _choice(said: object) -> Choice:
    if not isinstance(said, dict) or not set(said) <= {"segment", "landmark", "ignored"}:
        raise InvalidInput("the page sent an unknown choice")
    return Choice(**{key: str(value) for key, value in said.items()})
