"""Sides are found wherever a name may tell them, and what is left of the name then is kept whole."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.marker_sets.sides import WEIGHTS, side_guesses, side_words, tokens_of


@pytest.mark.parametrize(
    ("name", "tokens"),
    [
        ("RKnee", ["r", "knee"]),
        ("R.Knee.Lat", ["r", "knee", "lat"]),
        ("WaistLFront", ["waist", "l", "front"]),
        ("L5S1JointCenter", ["l5", "s1", "joint", "center"]),
        ("r_shank(antsup)", ["r", "shank", "antsup"]),
        ("Knöchel_re", ["knochel", "re"]),
        ("Fuß", ["fuss"]),
        ("RASI", ["rasi"]),
        ("*5", ["5"]),
    ],
)
def test_names_are_cut_into_words(name, tokens):
    assert tokens_of(name) == tokens


@pytest.mark.parametrize(
    ("name", "side", "rest", "style"),
    [
        ("Right_Knee", "right", "knee", "word"),
        ("leftknee", "left", "knee", "word"),
        ("L.Knee", "left", "knee", "token"),
        ("AcromionR", "right", "acromion", "token"),
        ("WaistLFront", "left", "waistfront", "inner token"),
        ("LKNE", "left", "kne", "first letter"),
        ("KNER", "right", "kne", "last letter"),
        ("FRTHI", "right", "fthi", "inner letter"),
        ("genou_G", "left", "genou", "initial"),
        ("KNE", "", "kne", "none"),
    ],
)
def test_a_side_is_found_where_it_stands(name, side, rest, style):
    assert any((g.side, g.rest, g.style) == (side, rest, style) for g in side_guesses(name))


@given(st.text(alphabet="RLrlKNEasi_.5", min_size=1, max_size=12))
def test_a_partner_differs_in_its_side_only(name):
    text = "".join(tokens_of(name))
    guesses = side_guesses(name)
    assert sum(guess.style == "none" for guess in guesses) <= 1
    for guess in guesses:
        assert guess.style in WEIGHTS
        assert bool(guess.side) == bool(guess.partner)
        if guess.style.endswith("letter"):
            assert sum(a != b for a, b in zip(guess.partner, text, strict=True)) == 1


def test_side_words_come_in_pairs():
    assert {"right", "left", "r", "l", "dx", "sx", "droite", "gauche", "li"} <= side_words()
