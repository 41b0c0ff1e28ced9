"""Pages are whole texts, and say no word that a language lacks."""

import re

from mbkf.app.pages import LOOKS, SCRIPTS, SECTIONS, page_words, start_page
from mbkf.study.survey.problems import TEXTS
from mbkf.viz.language import words
from mbkf.viz.page import asset
from tests.io.reconstructions import made_up

SAID_BY_THE_SERVER = {
    *("done", "unchanged", "failed", "static", "walk", "squat", "jump", "unknown"),
    *(f"{say}_{key}" for say in ("problem", "todo") for key in TEXTS),
}
"""Words that the server's answers choose."""


def test_the_page_is_one_text():
    page = start_page()
    assert page.startswith("<!DOCTYPE html>") and "{{" not in page
    assert "innerHTML" not in page and "insertAdjacentHTML" not in page


def test_every_word_is_used_and_every_used_one_known():
    known = set(page_words("en"))
    text = "\n".join(asset(name) for name in SCRIPTS)
    asked = set(re.findall(r"word\(\s*\"(\w+)\"", text))
    assert asked <= known
    assert known <= set(re.findall(r"\"(\w+)\"", text)) | SAID_BY_THE_SERVER


def test_no_two_sections_have_a_word_of_one_name():
    assert len(page_words("en")) == sum(len(words("en", section)) for section in SECTIONS)


def test_pages_of_a_trial_are_known():
    assert set(LOOKS) == {"report"} and made_up().frames
