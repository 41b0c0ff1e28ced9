"""Pages are whole texts, and speak every language completely."""

import json
import re
import shutil
import subprocess

import pytest

from mbkf.app.pages import LOOKS, SCRIPTS, start_page
from mbkf.viz.page import asset
from tests.io.reconstructions import made_up

SAID_BY_THE_SERVER = {"done", "unchanged", "failed", "static", "walk", "squat", "jump", "unknown"}
"""Words that the server's answers choose."""


def words():
    """The page's words by language, as its script has them."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("needs node to read the script")
    script = asset("app_words.js").partition("let language")[0] + "console.log(JSON.stringify(WORDS));"
    return json.loads(subprocess.run([node, "-e", script], capture_output=True, check=True, text=True).stdout)


def test_the_page_is_one_text():
    page = start_page()
    assert page.startswith("<!DOCTYPE html>") and "{{" not in page
    assert "innerHTML" not in page and "insertAdjacentHTML" not in page


def test_every_language_has_every_word():
    known = words()
    assert set(known) == {"en", "es"}
    assert set(known["en"]) == set(known["es"])
    for name, text in known["en"].items():
        assert sorted(re.findall(r"\{\d\}", text)) == sorted(re.findall(r"\{\d\}", known["es"][name])), name


def test_every_word_is_used_and_every_used_one_known():
    known = set(re.findall(r"(\w+): \"", asset("app_words.js").partition("es: {")[0]))
    words_after = asset("app_words.js").partition("let language")[2]
    text = "\n".join([words_after, *(asset(name) for name in SCRIPTS if name != "app_words.js")])
    asked = set(re.findall(r"word\(\s*\"(\w+)\"", text))
    assert asked <= known
    assert known <= set(re.findall(r"\"(\w+)\"", text)) | SAID_BY_THE_SERVER


def test_pages_of_a_trial_are_known():
    assert set(LOOKS) == {"look", "report"} and made_up().frames
