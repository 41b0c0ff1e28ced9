"""Requests that no page sends: bodies at random, names that no disk holds, bodies too long; each ends in a sentence."""

from __future__ import annotations

import http.client
import json
import random
from contextlib import closing, suppress
from pathlib import Path
from urllib.parse import quote, urlencode, urlsplit

from benchmarks.app.visit import Server, served
from benchmarks.checks import Check, Context, information
from benchmarks.misuse.world import made_world
from mbkf.app.workspace import Workspace

REQUESTS = 1000
LARGE_MB = 299
MEMORY_MB = 60.0
"""Most memory that a body of LARGE_MB may take."""

PATHS = (
    "/session", "/trial/events", "/trial/look", "/trial/report", "/trial/recording", "/trial/export", "/report",
    "/report/choices", "/report/curves", "/marker_set", "/marker_set/say", "/live", "/put", "/sessions", "/", "/none",
)  # fmt: skip
NAMES = ("walk1", "static", "", ".", "..", "\0", "é 😀", "x" * 300, "😀" * 60, "results/a.c3d", "\udcff")
VALUES: tuple[object, ...] = (
    None,
    True,
    -1,
    10**400,
    "",
    "\0",
    "\ud800",
    "x" * 3000,
    [],
    {},
    [[]],
    "walk",
    [None] * 3,
)
KEYS = (
    "name",
    "mass_kg",
    "trial",
    "event",
    "events",
    "base",
    "notes",
    "protocol",
    "source",
    "do",
    "choices",
    "over",
)
WORDS = ("session", "trial", "do", "to", "before", "norms", "language", "file", "page")
TIMEOUT_S = 120.0


def rows(context: Context) -> list[Check]:
    """All rows of requests."""
    root = made_world(context.out / "laboratory") / "lab"
    session = Workspace(root).sessions()[0]
    with served(root) as server:
        browser = _Browser(server)
        ends = [_random_end(browser, session, random.Random(k)) for k in range(REQUESTS)]
        refused, notes_mb = _large(browser, f"/session?session={session}")
        kept, file_mb = _large(browser, "/put?file=new%2Flarge.c3d")
    bad = [end for end in ends if end]
    return [
        Check("random requests", len(ends), REQUESTS, ">="),
        Check("of them without a sentence, or with an unforeseen failure", len(bad), 0, "<="),
        Check(f"memory of a body of {LARGE_MB} MB, as notes", notes_mb, MEMORY_MB, "<=", "MB"),
        Check(f"memory of a body of {LARGE_MB} MB, as a file", file_mb, MEMORY_MB, "<=", "MB"),
        Check(
            "large bodies refused as notes and kept as a file", (refused in (0, 413)) + (kept == 200), 2, ">="
        ),
        *(information(one, 1.0) for one in bad[:10]),
    ]


class _Browser:
    def __init__(self, server: Server) -> None:
        address = urlsplit(server.url)
        self.port, self.pid, self.cookie = address.port, server.pid, ""
        self.cookie = self.asked("GET", f"/?{address.query}")[2].partition(";")[0]

    def asked(self, method: str, path: str, body: object = None) -> tuple[int, bytes, str]:
        headers = {"Cookie": self.cookie, "If-Match": '"x"'}
        with closing(http.client.HTTPConnection("127.0.0.1", self.port, timeout=TIMEOUT_S)) as connection:
            connection.request(method, path, body, headers)  # type: ignore[arg-type]
            answer = connection.getresponse()
            return answer.status, answer.read(), answer.headers.get("Set-Cookie", "")


def _random_end(browser: _Browser, session: str, dice: random.Random) -> str:
    """The fault of a random request's reply; empty where it is well."""
    words = {word: dice.choice(NAMES) for word in WORDS if dice.random() < 0.5}
    if dice.random() < 0.7:
        words["session"] = session
    query = urlencode(words, quote_via=quote, errors="surrogateescape")
    method = dice.choice(("GET", "POST"))
    path = f"{dice.choice(PATHS)}?{query}"
    status, text, _ = browser.asked(method, path, _body(dice) if method == "POST" else None)
    said = json.loads(text).get("trouble", "") if text.startswith(b"{") and status >= 400 else text.decode()
    return (
        ""
        if status < 500 and (status < 400 or said.strip())
        else f"{method} {path[:80]}: {status} {said[:80]}"
    )


def _body(dice: random.Random) -> bytes:
    if dice.random() < 0.3:
        return dice.randbytes(dice.randrange(300))
    return json.dumps(_value(dice, 3)).encode()


def _value(dice: random.Random, depth: int) -> object:
    if depth and dice.random() < 0.6:
        return {dice.choice(KEYS): _value(dice, depth - 1) for _ in range(dice.randrange(5))}
    return dice.choice(VALUES)


def _large(browser: _Browser, path: str) -> tuple[int, float]:
    """Status of the reply to a large body, 0 where the server hung up, and the memory that it adds, MB."""
    before, status = _largest_mb(browser.pid), 0
    with suppress(OSError):  # refused while it was sent
        status = browser.asked("POST", path, (b"x" * 10**6 for _ in range(LARGE_MB)))[0]
    return status, _largest_mb(browser.pid) - before


def _largest_mb(pid: int) -> float:
    status = Path(f"/proc/{pid}/status")
    lines = status.read_text("ascii").splitlines() if status.exists() else []
    return next((int(line.split()[1]) / 1024.0 for line in lines if line.startswith("VmHWM:")), 0.0)
