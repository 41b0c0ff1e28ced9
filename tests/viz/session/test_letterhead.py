"""The head of the sheet: facts that are stated, in the report's language, own entries under their names."""

import re
from dataclasses import replace

import pytest

from mbkf.io.laboratory import Laboratory
from mbkf.io.visit import CONDITIONS, Visit
from mbkf.viz.language import words
from mbkf.viz.session.letterhead import MOST_TEXT, condition_name, letterhead, long_texts, shortened
from mbkf.viz.session.terms import Terms
from mbkf.viz.translation import translated
from tests.study.session.sessions import session

VISIT = Visit("2025-03-31", "1988-11-02", "barefoot", "left", "Hemi<b>", "n" * 400, "Dr. A", {"ward": "B 2"})


@pytest.mark.parametrize("language", ["en", "es"])
def test_facts_are_shown_in_the_language(language):
    gaits = tuple(replace(one, condition="orthosis") for one in session().gaits)
    one = replace(session(), patient="P01", visit=VISIT, age=36, sex="female", gaits=gaits)
    laboratory = Laboratory("Ours", "Road\nTown", b"\x89PNG\r\n\x1a\n", "image/png")
    page, own = letterhead(one, laboratory, Terms(language)), words(language, "visit")
    for text in (
        "P01",
        "2025-03-31",
        "1988-11-02, 36",
        own["orthosis"],
        own["side_left"],
        "Dr. A",
        "B 2",
        "Ours",
    ):
        assert text in page, text
    assert '<dt translate="no">ward</dt>' in page and "Hemi&lt;b&gt;" in page and "Road<br>Town" in page
    assert 'src="data:image/png;base64,iVBORw0KGgo="' in page and "n" * 400 not in page


def test_words_of_people_stay_and_numbers_have_the_sign_of_the_language():
    visit = Visit(diagnosis="scale again, 2.5 cm", others={"unit": "left"})
    one = replace(session(), patient="right", visit=visit)
    page = translated(letterhead(one, Laboratory("left", "1.5 Road"), Terms("es")), "es")
    for text in (">right<", ">scale again, 2.5 cm<", ">left<", "<b>left</b><br>1.5 Road"):
        assert text in page, text
    assert re.search(r">[\d, m]*\d,\d kg<", page)


def test_facts_that_are_not_stated_have_no_heading():
    page = letterhead(session(), Laboratory(), Terms("en"))
    assert "Diagnosis" not in page and "Born" not in page and "<img" not in page and "kg" in page


def test_long_texts_are_shortened_between_words():
    assert shortened("a b") == "a b"
    text = "word " * 100
    assert len(shortened(text)) <= MOST_TEXT + 2 and shortened(text).endswith("word …")
    assert long_texts(replace(session(), visit=VISIT)) == [("visit_notes", "n" * 400)]


def test_conditions_have_names_and_other_texts_stay():
    assert all(condition_name(one, "es") for one in CONDITIONS)
    assert condition_name("AFO", "es") == "AFO" and condition_name("aid", "en") == "walking aid"
