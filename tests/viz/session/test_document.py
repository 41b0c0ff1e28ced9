"""The session's page: whole, self-contained, in every language, with nothing active."""

import re
from dataclasses import replace

import pytest

from mbkf.errors import InvalidInput
from mbkf.io.session import SessionNotes, TrialNotes
from mbkf.io.visit import Visit
from mbkf.study.session.gather import session_of
from mbkf.study.session.norms import norms_of
from mbkf.viz.language import languages
from mbkf.viz.session.document import session_page
from tests.recordings import recorded
from tests.study.session.sessions import estimated, person, session, walks


def everything(language):
    notes = SessionNotes(trials={"walk 1": TrialNotes(condition="orthosis")}, visit=Visit("2025-03-31"))
    whole = session_of([*walks(), recorded("jump", 3.0, 2), recorded("squat", 4.0, 2)], "Ana", notes)
    visits = [replace(whole, visit=Visit(day)) for day in ("2025-01-01", "2025-02-01")]
    norms = norms_of([person(), person(1, 6)], "ours")
    return session_page(whole, whole, norms, language, visits=visits)


@pytest.mark.parametrize("language", sorted(languages()))
def test_the_page_has_every_section_in_every_language(language):
    page = everything(language)
    sections = re.findall(r'<section id="([\w-]+)"', page)
    assert sections == [
        "summary", "trials", "gait-walk", "gait-walk-2", "jumps", "squats", "conditions", "trend", "change", "numbers",
    ]  # fmt: skip
    assert f'<html lang="{language}">' in page and re.findall(r'href="#([\w-]+)"', page) == sections
    assert "{0}" not in page and "{1}" not in page and "default-src 'none'" in page and "<script" not in page
    assert "http" not in page.replace("http-equiv", "")


def test_languages_differ():
    assert "Joint powers" in everything("en") and "Potencias articulares" in everything("es")
    with pytest.raises(InvalidInput, match="no language"):
        session_page(session(), language="xx")


def test_the_trials_of_the_body_are_named():
    one = session()
    subject = replace(
        one.subject, report={"scaled_from": [{"trial": name, "part": "", "why": ""} for name in "ab"]}
    )
    assert "The body is scaled from a, b." in session_page(replace(one, subject=subject))
    assert "The body is scaled from" not in session_page(replace(one, subject=replace(subject, report={})))


def test_names_are_text():
    evil = '"><img src=x onerror=alert(1)>'
    found = session_of([replace(walks()[0], trial=evil)], evil)
    page = session_page(found, replace(found, name="<script>"), None)
    assert "<img" not in page and "<script" not in page and "&lt;img" in page


def test_what_is_not_known_is_said():
    standing = recorded("squat", 4.0, 2)
    page = session_page(replace(session_of([standing], "x"), squats=()))
    assert "No gait cycle was found" in page
    mixed = session_page(session_of([walks()[0], estimated(walks()[1])], "x"))
    assert "not in the mean" in mixed and "not in the mean" not in session_page(session())
    alone = session_page(session_of([estimated(r) for r in walks()], "x"))
    assert "only estimated cycles" in alone
