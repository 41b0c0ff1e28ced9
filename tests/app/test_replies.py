"""Answers are JSON or a page; foreseen failures are one sentence, others come through."""

import asyncio
import json

import pytest

from mbkf.app.replies import page, told
from mbkf.errors import InvalidInput


def failing(error):
    def answer():
        raise error

    return answer


@pytest.mark.parametrize(
    ("error", "status", "trouble"),
    [
        (InvalidInput("two\n lines"), 400, "two lines"),
        (OSError(28, "No space left"), 500, "No space left"),
        (OSError("odd"), 500, "odd"),
    ],
)
def test_failures_are_one_sentence(error, status, trouble):
    reply = asyncio.run(told(failing(error)))
    assert reply.status_code == status and json.loads(reply.body) == {"trouble": trouble}


def test_what_was_not_foreseen_comes_through():
    with pytest.raises(ZeroDivisionError):
        asyncio.run(told(failing(ZeroDivisionError())))


def test_pages():
    good, bad = asyncio.run(page(lambda: "<p>")), asyncio.run(page(failing(InvalidInput("no such trial"))))
    assert (good.status_code, good.body, bad.status_code, bad.body) == (200, b"<p>", 404, b"no such trial")
