"""Random requests of every route: each reply is a page, a file, or one sentence; none is an unforeseen failure."""

import json
import random
from urllib.parse import quote, urlencode

import pytest

from mbkf.app.routes import routes
from tests.app.asking import asked, plain

SEEDS, REQUESTS = 8, 60
NAMES = (
    "P1",
    "walk1",
    "static",
    "P9",
    "",
    ".",
    "..",
    "\0",
    "é 😀",
    "x" * 300,
    "😀" * 60,
    "P1/walk1.c3d",
    "results",
)
VALUES = (
    None, True, 0, -1, 1e308, 10**400, "", "\0", "\ud800", "x" * 3000, [], {}, [[]], {"a": {}}, "walk", "../x.toml",
    "a\0b", "/etc/passwd", [None] * 3, {"side": "left", "kind": "off", "time_s": 1.0}, {"\ud800": 1},
)  # fmt: skip
KEYS = (
    "name", "mass_kg", "age", "trial", "walk1", "event", "events", "base", "notes", "kind", "excluded", "protocol",
    "source", "body", "stream", "do", "choices", "before", "over", "side", "time_s", "sex", "height_m",
)  # fmt: skip
LEFT_OUT = {"/run", "/live/streams", "/arrange"}
"""Slow ones, and the one that deletes and renames files which the others ask for."""
WORDS = ("session", "trial", "do", "to", "before", "norms", "language", "as", "file", "page")


def value(dice, depth=3):
    if depth and dice.random() < 0.5:
        return {dice.choice(KEYS): value(dice, depth - 1) for _ in range(dice.randrange(5))}
    return dice.choice(VALUES)


def body(dice):
    kind = dice.random()
    if kind < 0.15:
        return dice.randbytes(dice.randrange(200))
    if kind < 0.3:
        return b"[" * dice.randrange(1, 5000)
    return json.dumps(value(dice)).encode()


def address(dice, path):
    words = {word: dice.choice(NAMES) for word in WORDS if dice.random() < 0.6}
    if dice.random() < 0.6:
        words |= {"session": "P1", "trial": "walk1"}
    return f"{path}?{urlencode(words)}" + dice.choice(
        ("", "&trial=%ED%A0%80", "&session=%FF", "&do=start;x", "&=&")
    )


@pytest.mark.parametrize("seed", range(SEEDS))
def test_no_request_ends_unforeseen(server, cookie, seed):
    dice = random.Random(seed)
    paths = [
        one.path for one in routes(server.workspace, server.runs, server.live) if one.path not in LEFT_OUT
    ]
    for _ in range(REQUESTS):
        method, path = dice.choice(("GET", "POST", "POST", "PUT", "HEAD")), dice.choice([*paths, "/none"])
        version = plain(server, cookie, "/session?session=P1")[1].get("version", "x")
        headers = {"Cookie": cookie, "If-Match": dice.choice(('"x"', version, f'"{version}"', "*"))}
        target, sent = address(dice, path), body(dice) if method in {"POST", "PUT"} else None
        answer, text = asked(server, target, method, sent, **headers)
        assert answer.status < 500, (method, target, sent, text)
        if answer.status >= 400 and method != "HEAD":
            said = json.loads(text)["trouble"] if text.startswith(b"{") else text.decode()
            assert said.strip() and "\n" not in said.strip()
    assert plain(server, cookie, "/session?session=P1")[0] == 200


@pytest.mark.parametrize(
    ("name", "status", "said"),
    [
        ("P1/" + "😀" * 60 + ".c3d", 400, "244 bytes is too long"),
        ("P1/walk1.c3d/inner.c3d", 409, "a file stands where a folder is needed"),
        ("P1", 409, "a folder stands where a file is needed"),
        ("P1/walk1.c3d", 409, "another content"),
        ("P1/a\0b.c3d", 400, "rename the file"),
        ("results/runs.json", 400, "among the results"),
    ],
)
def test_dropped_files_that_cannot_be_kept(server, cookie, name, status, said):
    found, told = plain(server, cookie, f"/put?file={quote(name)}", "POST", b"x")
    assert found == status and said in told["trouble"]


def test_a_body_beyond_its_bound_is_refused_before_it_is_read(server, cookie):
    for path in (
        "/session?session=P1",
        "/put?file=P1%2Fbig.c3d",
        "/trial/events?session=P1&trial=walk1",
        "/live",
    ):
        headers = {"Cookie": cookie, "If-Match": "x", "Content-Length": str(10**13)}
        answer, text = asked(server, path, "POST", None, **headers)
        assert answer.status == 413 and "at most" in json.loads(text)["trouble"]
