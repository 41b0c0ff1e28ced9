"""Two pages of one session and a person at its file: 50 random interleavings of 6 edits, and no edit is lost."""

from __future__ import annotations

import http.client
import json
import random
import tomllib
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlsplit

from benchmarks.app.visit import Server, served
from benchmarks.checks import Check, Context
from benchmarks.misuse.world import made_world
from mbkf.app.workspace import Workspace
from mbkf.io.toml import toml_text

INTERLEAVINGS, EDITS = 50, 6
BY_HAND, LOADED_AGAIN, OWN = 0.2, 0.2, 0.5
"""Shares of edits in the file itself, of pages that were loaded again, and of people who keep their own value."""

VALUES: dict[str, tuple[object, ...]] = {
    "name": ("Ana", "Bo"), "mass_kg": (60.0, 61.5), "height_m": (1.7, 1.8), "age": (30.0, 31.0),
    "sex": ("female", "male"),
}  # fmt: skip
TIMEOUT_S = 60.0


@dataclass
class Tab:
    """A page as the browser holds it.

    Attributes:
        server: The page's server.
        session: The session that it shows.
        cookie: The browser's cookie.
        notes: The notes that it shows.
        version: Their version.
    """

    server: Server
    session: str
    cookie: str = ""
    notes: dict[str, object] = field(default_factory=dict)
    version: str = ""

    def load(self) -> None:
        """Loads the page."""
        address = urlsplit(self.server.url)
        if not self.cookie:
            _, _, header = self._asked("GET", f"/?{address.query}")
            self.cookie = header.partition(";")[0]
        self._see(self._asked("GET", f"/session?session={self.session}")[1])

    def save(self, changed: dict[str, object]) -> list[dict[str, object]]:
        """Saves notes; returns the fields that somebody else changed."""
        sent = json.dumps({"base": self.notes, "notes": changed})
        status, told, _ = self._asked("POST", f"/session?session={self.session}", sent)
        if status not in (200, 409):
            raise AssertionError(f"status {status}: {told}")
        self._see(told)
        found = told.get("differences", [])
        assert isinstance(found, list)
        return found

    def _see(self, told: dict[str, object]) -> None:
        notes = told["notes"]
        assert isinstance(notes, dict)
        self.notes, self.version = notes, str(told["version"])

    def _asked(self, method: str, path: str, body: str | None = None) -> tuple[int, dict[str, object], str]:
        port = urlsplit(self.server.url).port
        headers = {"Cookie": self.cookie, "If-Match": f'"{self.version}"'}
        with closing(http.client.HTTPConnection("127.0.0.1", port, timeout=TIMEOUT_S)) as connection:
            connection.request(method, path, body, headers)
            answer = connection.getresponse()
            text = answer.read()
            told = json.loads(text) if text.startswith(b"{") else {}
            return answer.status, told, answer.headers.get("Set-Cookie", "")


def rows(context: Context) -> list[Check]:
    """The row of two pages."""
    root = made_world(context.out / "laboratory") / "lab"
    session = Workspace(root).sessions()[0]
    with served(root) as server:
        tabs = [Tab(server, session) for _ in range(2)]
        lost = [_lost(tabs, root / session / "session.toml", random.Random(k)) for k in range(INTERLEAVINGS)]
    return [
        Check("interleavings of two pages", len(lost), INTERLEAVINGS, ">="),
        Check("edits lost in them", sum(lost), 0, "<="),
    ]


def _lost(tabs: list[Tab], file: Path, dice: random.Random) -> int:
    """Number of fields that do not hold the last value that a person meant."""
    file.unlink(missing_ok=True)
    for tab in tabs:
        tab.load()
    meant: dict[str, object] = {}
    for _ in range(EDITS):
        key = dice.choice(list(VALUES))
        value = dice.choice(VALUES[key])
        if dice.random() < BY_HAND:
            file.write_text(toml_text("by hand", {**_held(file), key: value}), encoding="utf-8")
            meant[key] = value
            continue
        tab = dice.choice(tabs)
        if dice.random() < LOADED_AGAIN:
            tab.load()
        if value == tab.notes.get(key):
            continue
        if tab.save({**tab.notes, key: value}):
            if dice.random() >= OWN:
                continue
            tab.save({**tab.notes, key: value})
        meant[key] = value
    held = _held(file)
    return sum(held.get(key) != meant.get(key) for key in VALUES)


def _held(file: Path) -> dict[str, object]:
    return tomllib.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
