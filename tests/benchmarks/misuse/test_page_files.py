"""Requests of the page's part reach the server, and answers without words are told."""

import json

import pytest

from benchmarks.misuse.page_files import DROPPED, NOT_OURS, _says_so, dropped


class Answering:
    def __init__(self, status, content):
        self.answer, self.asked = (status, content), []

    def ask(self, path, body=None):
        self.asked.append((path, body))
        return self.answer


@pytest.mark.parametrize(
    ("status", "content", "right"),
    [
        (200, b'{"put": "a"}', True),
        (400, b'{"trouble": "a.c3d is there already; rename it"}', True),
        (507, b"The disk is full: make room", True),
        (500, b"Internal Server Error, sorry for that", False),
        (400, b"no", False),
    ],
)
def test_a_drop_is_taken_or_refused_in_a_sentence(status, content, right):
    page = Answering(status, content)
    assert (dropped(page, "P1/a b.c3d") == "") is right
    assert page.asked == [("/put?file=P1/a%20b.c3d", b"another capture")]


def test_names_lead_to_files_that_are_there():
    assert {"P1/trial.c3d", "results/P1/trial/motion.h5", "door/static.c3d"} <= set(DROPPED)


@pytest.mark.parametrize(("words", "right"), [(f"subject.json exists and was {NOT_OURS}", True), ("", False)])
def test_a_run_over_a_file_of_others_has_to_say_so(words, right):
    reply = {"run": {"state": "finished"}, "trials": [{"reason": words}]}
    page = Answering(200, json.dumps(reply).encode())
    assert _says_so(page, "P1") is right
    assert page.asked[0] == ("/run?session=P1&do=start", b"")
