"""Session files: what is written comes back, and what is not possible is refused."""

import json
from datetime import date

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mbkf.errors import FileFormatError
from mbkf.io.session import (
    FROM_SESSION,
    FROM_STATIC,
    SESSION_FILE,
    SEXES,
    SIDES,
    EventKind,
    FootEvent,
    SessionNotes,
    TrialKind,
    TrialNotes,
    plain_session,
    read_session,
    session_of,
    write_session,
)
from mbkf.io.trial_video import TrialVideo
from mbkf.io.visit import AFFECTED, VISIT, Visit

TEXTS = st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=12)
EVENTS = st.builds(
    FootEvent,
    st.sampled_from(SIDES),
    st.sampled_from(EventKind),
    st.floats(allow_nan=False, allow_infinity=False),
)
VIDEOS = st.builds(
    TrialVideo,
    TEXTS.filter(bool),
    st.floats(-1e4, 1e4).map(lambda found: round(found, 2)),
)
TRIALS = st.builds(
    TrialNotes,
    st.none() | st.sampled_from(TrialKind),
    TEXTS,
    st.none() | st.lists(EVENTS, max_size=4).map(lambda found: tuple(sorted(found, key=lambda e: e.time_s))),
    TEXTS,
    st.lists(VIDEOS, max_size=2).map(tuple),
).filter(lambda trial: trial != TrialNotes())
DAYS = st.just("") | st.dates(date(1850, 1, 1)).map(date.isoformat)
OWN = st.dictionaries(
    TEXTS.filter(lambda name: name not in VISIT.keys),
    TEXTS | st.booleans() | st.integers(-(2**53), 2**53) | st.floats(allow_nan=False, allow_infinity=False),
    max_size=3,
)
VISITS = st.builds(
    Visit, DAYS, DAYS, TEXTS, st.sampled_from(("", *AFFECTED)), TEXTS, TEXTS, TEXTS, OWN
).filter(lambda visit: not visit.date or visit.birth_date <= visit.date)
SESSIONS = st.builds(
    SessionNotes,
    TEXTS,
    st.none() | st.floats(0.5, 500.0),
    st.none() | st.floats(0.3, 2.8),
    st.none() | st.floats(0.0, 130.0),
    st.sampled_from(("", *SEXES)),
    st.none() | TEXTS.filter(bool),
    st.dictionaries(TEXTS, TRIALS, max_size=3),
    st.sampled_from(("", FROM_SESSION, FROM_STATIC)),
    VISITS,
)


@given(notes=SESSIONS)
@settings(deadline=None)
def test_what_is_written_comes_back(tmp_path_factory, notes):
    path = tmp_path_factory.mktemp("session") / SESSION_FILE
    write_session(notes, path)
    assert read_session(path) == notes
    assert session_of(json.loads(json.dumps(plain_session(notes)))) == notes


def test_the_example_of_the_docs_is_read(tmp_path):
    path = tmp_path / SESSION_FILE
    path.write_text(
        'name = "P01"\nmass_kg = 71.2\nage = 34\n[trial.walk3]\nexcluded = "stumbled"\n'
        '[[trial.walk4.event]]\nside = "right"\nkind = "off"\ntime_s = 1\n'
        '[[trial.walk4.event]]\nside = "left"\nkind = "strike"\ntime_s = 0.5\n'
    )
    notes = read_session(path)
    assert (notes.name, notes.mass_kg, notes.age, notes.height_m) == ("P01", 71.2, 34.0, None)
    assert notes.trial("walk3").excluded == "stumbled" and notes.trial("walk9") == TrialNotes()
    assert [event.side for event in notes.trial("walk4").events] == ["left", "right"]


@pytest.mark.parametrize(
    ("text", "fragment"),
    [
        ("mass_kg = 0.1", "mass_kg must be a number between 0.5 and 500"),
        ("mass_kg = true", "mass_kg must be"),
        ("mass_kg = nan", "mass_kg must be"),
        ("mass_kg = 1" + "0" * 400, "more than 64 bits"),
        ("height_m = 178", "height_m must be a number between 0.3 and 2.8"),
        ("age = -1", "age must be"),
        ('sex = "f"', "sex must be one of female, male, other"),
        ("sex = [1]", "sex must be one of"),
        ("name = 3", "name must be a text"),
        ("trial = 3", "trial must hold tables"),
        ("trial.a = 3", "trial must hold tables"),
        ('trial.a.kind = "stroll"', "trial a: kind must be one of static, walk"),
        ("trial.a.event = 1", "trial a: event must be a list of tables"),
        ("trial.a.event = [1]", "trial a: event must be a list of tables"),
        (
            'trial.a.event = [{side = "right", kind = "off"}]',
            "trial a: time_s is missing; it must be a number in s",
        ),
        ('trial.a.event = [{side = "right", kind = "off", time_s = inf}]', "time_s must be a number"),
        ("mass = 90", "line 1: unknown session entry 'mass'; did you mean mass_kg"),
        ("name = 'a'\nMass_KG = 90", "line 2: unknown session entry 'Mass_KG'; did you mean mass_kg"),
        ("[trials.w2]\nexcluded = 'fell'", "line 1: unknown session entry 'trials'; did you mean trial"),
        ("[trial.w3]\nexclude = 'fell'", "line 2: unknown trial entry 'exclude'; did you mean excluded"),
        (
            "mass_kg = 71,9",
            "line 1: not a session file: 'mass_kg = 71,9': decimals have a point, write mass_kg = 71.9",
        ),
        ("mass_kg = '71,9 kg'", "got 71,9 kg; write mass_kg = 71.9"),
        ("mass_kg = '158 lb'", "got 158 lb; write mass_kg = 71.67"),
        ("height_m = 178", "got 178; write height_m = 1.78 if it is in cm"),
        ("height_m = 1780", "got 1780; write height_m = 1.78 if it is in mm"),
        ("visit = 3", "visit must be a table, [visit]"),
        (
            "[visit]\ndate = '31.3.2025'",
            "line 2: visit: date must be a day written as 2025-03-31, got 31.3.2025",
        ),
        ("[visit]\ndate = 2025-03-31T10:00:00", "visit: date must be a day written as 2025-03-31"),
        ("[visit]\ndate = '2025-02-29'", "visit: date must be a day"),
        ("[visit]\nbirth_date = '0198-02-12'", "visit: birth_date must be a day"),
        ("[visit]\nside = 'links'", "visit: side must be one of right, left, both"),
        (
            "[visit]\ndate = 2025-03-31\nbirth_date = 2026-01-01",
            "birth_date 2026-01-01 lies after date 2025-03-31",
        ),
        ("[visit]\nward = [1]", "visit: ward must be a text, a number, or true or false"),
        ("[visit]\nward = inf", "visit: ward must be a text"),
        ("trial.a.condition = 3", "trial a: condition must be a text"),
        ("name = ", "not a session file"),
        ("a = " + "[" * 5000, "not a session file"),
    ],
)
def test_what_is_not_possible_is_refused(tmp_path, text, fragment):
    path = tmp_path / SESSION_FILE
    path.write_text(text)
    with pytest.raises(FileFormatError) as told:
        read_session(path)
    assert fragment in str(told.value) and len(str(told.value)) < 400


def test_a_missing_file_and_bytes_are_refused(tmp_path):
    with pytest.raises(FileFormatError, match="no such file"):
        read_session(tmp_path / SESSION_FILE)
    (tmp_path / SESSION_FILE).write_bytes(b"\xff\xfe\0")
    with pytest.raises(FileFormatError, match="cannot be read"):
        read_session(tmp_path / SESSION_FILE)
