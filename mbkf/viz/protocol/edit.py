"""The editor's page of a marker set, and the server behind it that saves the set."""

from __future__ import annotations

import json
import secrets
import threading
from collections.abc import Callable, Mapping
from pathlib import Path

from mbkf.errors import InvalidInput, MbkfError
from mbkf.io.files_read import read_state_bytes
from mbkf.io.plain_data import parse_json
from mbkf.io.written import check_replaceable
from mbkf.model.protocol import Protocol, load_protocol
from mbkf.model.protocol_file import checked_name, write_protocol
from mbkf.trial.protocol.editing import Choice, edited
from mbkf.trial.protocol.merging import merged_sets
from mbkf.trial.protocol.standing import Standing
from mbkf.viz.protocol.page import EDIT_SCRIPTS, page_text, set_data
from mbkf.viz.server import PageServer


class MarkerSetEdit:
    """A marker set in an editor: the page sends a person's choices by marker, and this class carries them out.

    Args:
        protocol: The set to begin with.
        standing: The capture, with the body beside it.
        out: The file that saving writes.
        edits: It is the marker set to begin with, and may be a user's own.

    Attributes:
        done: Set when the page reports that the person is done.
        saved: The newest saved set; None before.
        file: Name of the file that saving writes.

    Raises:
        InvalidInput: The file's name is not possible for a marker set.
        ProtectedFile: The file is an input, or mbkf did not write it; with ``edits`` it may be either.
    """

    def __init__(
        self, protocol: Protocol, standing: Standing, out: str | Path, *, edits: bool = False
    ) -> None:
        self._protocol, self._standing, self._out = protocol, standing, checked_name(out)
        check_replaceable(self._out, edits=edits)
        self._lock, self._before = threading.Lock(), self._content()
        self.done, self.file = threading.Event(), self._out.name
        self.saved: Protocol | None = None

    def text(self, say: str = "") -> str:
        """The page.

        Args:
            say: Address for the page's requests; its own server's WebSocket if empty.
        """
        data = {
            **set_data(self._protocol, self._standing),
            "out": self.file,
            "trouble": self._standing.trouble,
            "say": say,
        }
        return page_text(data, EDIT_SCRIPTS, "'self'")

    def hear(self, word: str) -> str:
        """Carries out a request of the page, in JSON, and returns the reply, in JSON.

        Args:
            word: ``{"do": "done"}``, or ``{"do": "save", "choices": {NAME: {WHAT: TEXT}}}`` with a field of
                :class:`~mbkf.trial.protocol.editing.Choice` for WHAT; ``before``: the choices of the page's last save;
                ``over``: true to keep the page's choices where somebody else changed the same marker.
        """
        try:
            asked = parse_json(word)
            if asked.get("do") == "save":
                with self._lock:
                    return json.dumps(self._save(asked))
            if asked.get("do") == "done":
                self.done.set()
                return json.dumps({"done": True})
            raise InvalidInput(f"the page sent the unknown request {asked.get('do')!r}")
        except (MbkfError, OSError) as error:
            return json.dumps({"trouble": str(error)})
        except ValueError:
            return json.dumps({"trouble": "the page sent a request that is no JSON"})

    def _save(self, asked: Mapping[str, object]) -> dict[str, object]:
        """Saves the page's choices, over those that another page or program has written into the file meanwhile.

        Raises:
            MbkfError: A choice is not possible, or the file has become damaged.
            OSError: The file cannot be written.
        """
        made, over = self._chosen(asked.get("choices")), asked.get("over") is True
        differing: tuple[str, ...] = ()
        if self._content() not in (None, self._before):
            base = self._chosen(asked.get("before"))
            made, differing = merged_sets(base, made, load_protocol(self._out), over)
        write_protocol(made, self._out, edits=True)
        self.saved = made
        answer = {"saved": self.file, "markers": len(made.markers), "ignored": len(made.ignored)}
        if not differing or over:
            return answer
        text = f"somebody else has changed {', '.join(differing)} meanwhile; choose which change is right"
        return {**answer, "trouble": text, "differences": list(differing)}

    def _chosen(self, choices: object) -> Protocol:
        """The set that the editor began with, with choices."""
        known = choices.items() if isinstance(choices, dict) else ()
        chosen = {str(name): _choice(one) for name, one in known}
        return edited(self._protocol, self._standing, chosen, self._out.stem)

    def _content(self) -> bytes | None:
        """The content of the file; None before it is there."""
        try:
            return read_state_bytes(self._out)
        except FileNotFoundError:
            return None


class EditPage(MarkerSetEdit):
    """Serves an editor to this computer until its page is done; only with the token, since it writes a file.

    Args:
        protocol: The set to begin with.
        standing: The capture, with the body beside it.
        out: The file that saving writes.
        edits: As for :class:`MarkerSetEdit`.
        port: 0 for any free one.

    Attributes:
        url: Address to open in a browser, token included.

    Raises:
        InvalidInput: The port is not free, or the file's name is not possible for a marker set.
    """

    def __init__(
        self, protocol: Protocol, standing: Standing, out: str | Path, *, port: int = 0, edits: bool = False
    ) -> None:
        super().__init__(protocol, standing, out, edits=edits)
        self._server = PageServer(self.text(), hear=self.hear, port=port, token=secrets.token_urlsafe(16))
        self.url = self._server.url

    def entrance(self, used: Callable[[], None]) -> str:
        """An address that admits a browser once; ``used`` is called then."""
        return self._server.entrance(used)

    def close(self) -> None:
        """Ends the server."""
        self._server.close()


def _choice(said: object) -> Choice:
    if not isinstance(said, dict) or not set(said) <= {"segment", "landmark", "ignored"}:
        raise InvalidInput("the page sent an unknown choice")
    return Choice(**{key: str(value) for key, value in said.items()})
