"""The dictionary of spellings is well formed, and its grammar covers a name wholly or not at all."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.errors import FileFormatError
from mbkf.marker_sets.spelling import Group, Spellings, load_dictionary
from mbkf.model.body_file import load_body

EMPTY = '[modifiers]\n[objects]\nalways = []\nalone = []\n[computed]\nwords = []\n[[place]]\nspellings = ["knee"]\n'


@pytest.fixture(scope="module")
def spellings():
    return load_dictionary().spellings


def places_of(group: Group):
    for odds in (group.places, group.sided or {}, *group.modified.values()):
        yield from odds
    for one in group.beside:
        yield from (one.places or {})
        yield from (one.sided or {})


def test_every_place_of_the_dictionary_is_on_the_body(spellings):
    body = load_body("human18")
    known = {segment.name for segment in body.segments} | set(body.landmarks)
    for group in spellings.places.values():
        for place in places_of(group):
            assert place in known or {f"right_{place}", f"left_{place}"} <= known, place


def test_every_spelling_reads_as_itself_and_in_small_letters(spellings):
    for spelling, group in spellings.places.items():
        assert spelling == "".join(c for c in spelling.lower() if c.isascii() and c.isalnum())
        parse = spellings.parse(spelling)
        assert parse is not None
        assert (parse.group, parse.quality) == (group, 1.0)


@pytest.mark.parametrize(
    ("text", "spelling", "modifiers"),
    [
        ("kneelat", "knee", {"lateral"}),
        ("latknee", "knee", {"lateral"}),
        ("knem", "kne", {"medial"}),
        ("thighfront", "thigh", {"front"}),
        ("thap", "th", {"letter"}),
        ("tib2", "tib", {"number"}),
        ("kneejointcenter", "knee", {"centre"}),
        ("lateralfemoralepicondyle", "epicondyle", {"lateral", "thigh"}),
        ("thighwand", "thigh", {"filler"}),
    ],
)
def test_a_name_is_a_place_with_modifiers(spellings, text, spelling, modifiers):
    parse = spellings.parse(text)
    assert parse is not None
    assert (parse.spelling, parse.modifiers) == (spelling, modifiers)


@pytest.mark.parametrize("text", ["", "lat", "12", "kneex", "xknee", "kneeelbow", "marker5", "latmedknee"])
def test_what_is_not_covered_is_not_read(spellings, text):
    assert spellings.parse(text) is None


@given(st.text(alphabet="abdefhiklmnoprstu0123456789", max_size=24))
@settings(max_examples=200, deadline=None)
def test_any_text_is_read_or_left(text):
    parse = load_dictionary().spellings.parse(text)
    if parse is not None:
        assert parse.spelling in text
        for sided in (True, False):
            odds, _ = parse.places(sided, frozenset())
            assert sum(odds.values()) <= 1 + 1e-9


def test_company_decides():
    dictionary = load_dictionary().spellings
    toe = dictionary.parse("toe")
    assert toe is not None
    with_heel, _ = toe.places(True, frozenset(("hee",)))
    with_calcaneus, _ = toe.places(True, frozenset(("cal", "lfc")))
    assert max(with_heel, key=lambda place: with_heel[place]) == "metatarsal_2"
    assert max(with_calcaneus, key=lambda place: with_calcaneus[place]) == "hallux"


def test_a_dictionary_of_ones_own():
    own = Spellings([Group(("kneecap",), {"knee_lateral": 0.5})], {"lateral": ["out"]})
    assert own.parse("kneecapout") is not None
    assert own.parse("knee") is None
    assert own.knows("out")


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("nothing", "not a valid dictionary"),
        (EMPTY, "not a valid dictionary"),
        (EMPTY + "places = { thigh = 1.5 }", "between 0 and 1"),
        (EMPTY + "places = { thigh = 0.7, shank = 0.7 }", "add up to 1 at most"),
        (
            EMPTY + 'places = { thigh = 0.7 }\n[[place]]\nspellings = ["knee"]\nplaces = {}',
            "'knee' is in two groups",
        ),
    ],
)
def test_a_faulty_dictionary_says_what_is_wrong(tmp_path, text, reason):
    path = tmp_path / "spellings.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(FileFormatError, match=reason):
        load_dictionary(path)


def test_a_missing_dictionary_is_named(tmp_path):
    with pytest.raises(FileFormatError, match="cannot be read"):
        load_dictionary(tmp_path / "none.toml")
