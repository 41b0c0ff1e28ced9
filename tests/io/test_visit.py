"""Visits: entries of a laboratory's own stay, TOML's days are days, and age counts completed years."""

from mbkf.io.session import SESSION_FILE, SessionNotes, TrialNotes, plain_session, read_session, session_of
from mbkf.io.session_change import change_session
from mbkf.io.visit import Visit

TEXT = """# by hand
name = "P01"
[visit]
date = 2025-03-31 # Monday
diagnosis = "Hemiparesis"
ward = "B 2" # ours
bed = 7
seen_at = 10:30:00
"""


def test_own_entries_and_comments_stay_when_another_one_changes(tmp_path):
    path = tmp_path / SESSION_FILE
    path.write_text(TEXT)
    before = read_session(path)
    assert before.visit == Visit(
        "2025-03-31", diagnosis="Hemiparesis", others={"ward": "B 2", "bed": 7, "seen_at": "10:30:00"}
    )
    plain = plain_session(before)
    plain["visit"] = {**plain["visit"], "condition": "barefoot"}
    change_session(path, before, session_of(plain))
    found = read_session(path)
    assert found.visit.condition == "barefoot" and found.visit.others == before.visit.others
    assert "# ours" in path.read_text() and "# by hand" in path.read_text()


def test_age_counts_completed_years():
    born = "1988-11-02"
    ages = [Visit(day, born).age for day in ("1988-11-02", "2025-11-01", "2025-11-02")]
    assert ages == [0, 36, 37] and Visit("2025-11-02").age is None and Visit(birth_date=born).age is None
    assert SessionNotes(age=40.0, visit=Visit("2025-11-02", born)).age_at_visit == 40.0
    assert SessionNotes(visit=Visit("2025-11-02", born)).age_at_visit == 37


def test_a_visit_takes_from_the_folder_above_where_it_states_nothing():
    above = Visit(birth_date="1988-11-02", diagnosis="above", others={"ward": "A", "bed": 1})
    found = Visit("2025-03-31", diagnosis="own", others={"bed": 2}).within(above)
    assert found == Visit("2025-03-31", "1988-11-02", diagnosis="own", others={"ward": "A", "bed": 2})


def test_the_condition_of_a_trial_goes_before_that_of_the_visit():
    notes = SessionNotes(trials={"w1": TrialNotes(condition="orthosis")}, visit=Visit(condition="barefoot"))
    assert [notes.condition(name) for name in ("w1", "w2")] == ["orthosis", "barefoot"]
