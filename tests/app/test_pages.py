"""Pages are whole texts, and say no word that a language lacks."""

import json
import re
from dataclasses import fields

from mbkf.app.charts import Charts
from mbkf.app.pages import SCRIPTS, SECTIONS, start_page
from mbkf.study.survey.problems import TEXTS
from mbkf.trial.gait.convention import CONVENTIONS, MOMENTS
from mbkf.viz.language import words
from mbkf.viz.page import COLOURS, asset

SAID_BY_THE_SERVER = {
    *("done", "unchanged", "failed", "static", "walk", "squat", "jump", "unknown"),
    *(f"{say}_{key}" for say in ("problem", "todo") for key in TEXTS),
    *(one.name for one in fields(Charts)),
    *(one.replace("-", "_") for one in (*CONVENTIONS, *MOMENTS, *COLOURS)),
}
"""Words that the server's answers choose."""


def page_words():
    """The texts that the page brings, in English."""
    (found,) = re.findall(r'id="words">(.*?)</script>', start_page())
    return json.loads(found)["en"]["words"]


def test_the_page_is_one_text():
    page = start_page()
    assert page.startswith("<!DOCTYPE html>") and "{{" not in page
    assert "innerHTML" not in page and "insertAdjacentHTML" not in page


def test_every_word_is_used_and_every_used_one_known():
    known = set(page_words())
    text = "\n".join(asset(name) for name in SCRIPTS)
    asked = set(re.findall(r"word\(\s*\"(\w+)\"", text))
    assert asked <= known
    assert known <= set(re.findall(r"\"(\w+)\"", text)) | SAID_BY_THE_SERVER


def test_no_two_sections_have_a_word_of_one_name():
    assert len(page_words()) == sum(len(words("en", section)) for section in SECTIONS)
