"""Pages are whole texts, and say no word that a language lacks."""

import json
import re
from dataclasses import fields
from pathlib import Path

from mbkf.app import bin
from mbkf.app.charts import Charts
from mbkf.app.pages import SCRIPTS, SECTIONS, help_page, start_page
from mbkf.study.survey.problems import TEXTS
from mbkf.trial.gait.convention import CONVENTIONS, MOMENTS
from mbkf.viz.language import languages, words
from mbkf.viz.page import COLOURS, asset

SERVER = "".join(
    (Path(bin.__file__).parent / f"{name}.py").read_text("utf-8")
    for name in ("bin", "arranging", "norm_files")
)

SAID_BY_THE_SERVER = {
    *("done", "unchanged", "failed", "static", "walk", "squat", "jump", "unknown"),
    *(f"{say}_{key}" for say in ("problem", "todo") for key in TEXTS),
    *(one.name for one in fields(Charts)),
    *(one.replace("-", "_") for one in (*CONVENTIONS, *MOMENTS, *COLOURS)),
    *(f"refused_{key}" for key in re.findall(r'Refused\([^"]*f?".*?"[^"]*"(\w+)"', SERVER, re.S)),
    *(f"help_{key}" for key in words("en", "help_texts")),
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


def test_help_has_every_step_in_every_language():
    for language in sorted(languages()):
        page, titles = help_page(language), words(language, "help_titles")
        for step in words("en", "help_texts"):
            assert f'<section id="{step}"><h2>{titles[f"help_{step}"]}</h2><p>' in page
    asked = set(re.findall(r'(?:helpButton\(|titled\("\w+", )"(\w+)"', "".join(map(asset, SCRIPTS))))
    assert asked and asked <= set(words("en", "help_texts"))
