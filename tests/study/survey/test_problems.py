"""Problems say what is the matter in every language, and what to do."""

import pytest

from mbkf.study.survey.problems import GRAVE, OF_MARKER_SET, TEXTS, Problem, plain_problem
from mbkf.viz.language import words


@pytest.mark.parametrize("key", TEXTS)
def test_pages_say_in_english_what_python_says(key):
    english = words("en", "problems")
    assert (english[f"problem_{key}"], english[f"todo_{key}"]) == TEXTS[key]


def test_a_problem_is_told_with_its_values():
    mass = Problem("mass", ("120.0", "71.8"))
    assert mass.what == "the stated mass is 120.0 kg, by the plates it is 71.8 kg"
    assert plain_problem(mass)["values"] == ["120.0", "71.8"] and not mass.grave and not mass.marker_set
    assert Problem("unreadable", ("why",)).grave and Problem("unknown_set").marker_set
    assert set(TEXTS) >= GRAVE | OF_MARKER_SET
