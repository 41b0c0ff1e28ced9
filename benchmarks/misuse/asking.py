"""Asks a page that a command serves for its sessions, as a browser does, and says where it fails to answer."""

from __future__ import annotations

import http.cookiejar
import json
import urllib.error
import urllib.request
from urllib.parse import quote, urlsplit

ANSWERS_S = 10.0
"""After so long a page that does not answer hangs."""

REFUSED, BROKEN = 400, 500
"""From these on a status is a refusal, and a fault of the server."""


def unanswered(address: str) -> str:
    """The first question that a page answers wrongly or not at all; "" where it answers all.

    Args:
        address: The page with its token.
    """
    cookies = urllib.request.HTTPCookieProcessor(http.cookiejar.CookieJar())
    opener = urllib.request.build_opener(cookies, urllib.request.ProxyHandler({}))
    root = f"http://{urlsplit(address).netloc}"
    question = address
    try:
        opener.open(address, timeout=ANSWERS_S).read()
        question = f"{root}/sessions"
        with opener.open(question, timeout=ANSWERS_S) as reply:
            sessions = [str(one["id"]) for one in json.load(reply)["sessions"]]
        for name in sessions:
            question = f"{root}/session?session={quote(name, safe='')}"
            try:
                opener.open(question, timeout=ANSWERS_S).read()
            except urllib.error.HTTPError as error:
                if not REFUSED <= error.code < BROKEN:
                    raise
    except (OSError, ValueError, KeyError) as error:
        return f"{urlsplit(question).path}: {type(error).__name__}: {error}"
    return ""
