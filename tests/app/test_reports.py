"""Reports in the page's folder: of what is done and not left out, compared, with norms of all sessions."""

import shutil

import pytest

from mbkf.app import reports
from mbkf.app.charts import Charts
from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.io.norms import read_norms
from mbkf.io.results_folder import write_reconstruction
from mbkf.io.session import SessionNotes, TrialNotes
from mbkf.io.visit import Visit
from mbkf.study.session.norm_selection import REASONS
from mbkf.trial.gait.convention import BY_CLINIC, BY_MODEL
from mbkf.trial.results.summary import summarise
from mbkf.viz.language import words
from tests.studies import study
from tests.study.session.sessions import walks


@pytest.fixture
def workspace(tmp_path):
    """Three persons with two walks each, as if they had been run; the sex and age of the third one are not stated."""
    study(tmp_path / "lab", persons=3, trials=2)
    made = Workspace(tmp_path / "lab")
    for person, first in (("P1", 5), ("P2", 6), ("P3", 5)):
        for k, r in enumerate(walks(2, first), start=1):
            write_reconstruction(r, summarise(r), made.out / person / f"walk{k}")
    for person in ("P1", "P2"):
        made.change(person, SessionNotes(), SessionNotes(sex="female", age=30.0))
    return made


def test_a_report_alone_compared_and_with_norms(workspace):
    shown = reports.choices(workspace, "P1")
    assert (shown["sessions"], shown["norms"]) == (["P2", "P3"], [])
    assert shown["charts"]["convention"] == "clinical", "the page's default"
    chosen = reports.norms_selection(workspace, "P3", "en")
    assert [one.split(",")[0] for one in chosen["persons"]] == ["P1: female", "P2: female"] and chosen[
        "cycles"
    ] > 4
    assert chosen["left_out"] == ["P3: the person in view is compared with others alone"]
    assert reports.norms_selection(workspace, "P3", "es")["left_out"] == [
        "P3: la persona en vista solo se compara con otras"
    ]
    assert words("en", "left_out_of_norms") == REASONS, "the command line and the page say alike"
    assert reports.build(workspace, "P3", BY_CLINIC) == {"norms": "norms.toml", "persons": 2}
    assert reports.choices(workspace, "P2")["norms"] == ["norms.toml"]
    assert read_norms(workspace.root / "norms.toml").name == "lab"
    page = reports.report_of(workspace, "P3", "P2", "norms.toml", "es")
    assert 'id="change"' in page and 'class="band n"' in page and '<html lang="es">' in page
    assert 'id="change"' not in reports.report_of(workspace, "P3", "", "", "en")
    other = reports.report_of(workspace, "P3", "", "norms.toml", "en", Charts("model"))
    assert (
        "2 persons" in other
        and "clinical, Plug-in Gait axes" in other
        and "Angles of the norms are in other" in other
    )
    own = reports.report_of(workspace, "P3", "", "norms.toml", "en")
    assert 0 < other.count('class="band n"') < own.count('class="band n"'), "moments, powers and reactions"


def test_nobody_is_compared_with_norms_of_themselves(workspace):
    reports.build(workspace, "", BY_CLINIC)
    with pytest.raises(InvalidInput, match="holds walks of P1"):
        reports.report_of(workspace, "P1", "", "norms.toml", "en")
    with pytest.raises(InvalidInput, match="P1: the person in view"):
        reports.build(workspace, "P1", BY_CLINIC)


def test_trials_that_are_left_out_do_not_count(workspace):
    assert len(reports.read_whole(workspace, "P1", BY_MODEL).trials) == 2
    notes = SessionNotes(name="Ana", sex="female", trials={"walk2": TrialNotes(excluded="fell")})
    workspace.change("P3", SessionNotes(), notes)
    left = reports.read_whole(workspace, "P3", BY_MODEL)
    assert len(left.trials) == 1 and left.name == "Ana, P3" and left.sex == "female"


def test_what_is_not_there_is_told(workspace, tmp_path):
    with pytest.raises(InvalidInput, match="no file of norms 'x'"):
        reports.report_of(workspace, "P1", "", "x", "en")
    with pytest.raises(InvalidInput, match="no session 'P9'"):
        reports.report_of(workspace, "P9", "", "", "en")
    with pytest.raises(InvalidInput, match=r"no session '\.\./P1'"):
        reports.report_of(workspace, "P1", "../P1", "", "en")
    study(tmp_path / "new", persons=1)
    with pytest.raises(InvalidInput, match="session 'P1' has no result yet"):
        reports.report_of(Workspace(tmp_path / "new"), "P1", "", "", "en")


def test_dated_visits_of_the_person_make_a_trend(tmp_path):
    study(tmp_path / "lab", persons=1, trials=2)
    made = Workspace(tmp_path / "lab")
    for day in ("monday", "tuesday", "friday"):
        shutil.copytree(made.root / "P1", made.root / "P2" / day)
        for k, r in enumerate(walks(2), start=1):
            write_reconstruction(r, summarise(r), made.out / "P2" / day / f"walk{k}")
    for day, date in (("monday", "2025-03-31"), ("tuesday", "2025-04-01")):
        made.change(f"P2/{day}", SessionNotes(), SessionNotes(visit=Visit(date)))
    assert reports.choices(made, "P2/friday")["visits"] == 2
    made.change("P2/friday", SessionNotes(), SessionNotes(visit=Visit("2025-04-04")))
    page = reports.report_of(made, "P2/friday", "", "", "en", trend=True)
    assert 'id="trend"' in page and "<th>2025-03-31</th>" in page
    assert 'id="trend"' not in reports.report_of(made, "P2/friday", "", "", "en")
