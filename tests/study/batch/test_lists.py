"""Lists of persons and trials: TOML and CSV say the same, and what they cannot mean is refused with its line."""

import re
from pathlib import Path

import pytest

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.study.batch.lists import plan_of_csv, plan_of_toml
from mbkf.study.batch.plan import Files

TOML = """\
[[subject]]
name = "P1"
mass_kg = 71.2
static = "P1/static.c3d"
trials = ["P1/walk1.c3d", { path = "P1/walk2.trc", forces = "P1/walk2_grf.mot", name = "second" }]

[[subject]]
name = "P2"
session = "monday"
protocol = "plug_in_gait"
subject = "P2/subject.toml"
trials = ["P2/walk.c3d"]
"""
CSV = """\
subject,session,trial,static,forces,name,mass_kg,protocol,subject_file
P1,,P1/walk1.c3d,P1/static.c3d,,,71.2,,
P1,,P1/walk2.trc,,P1/walk2_grf.mot,second,,,
P2,monday,P2/walk.c3d,,,,,plug_in_gait,P2/subject.toml
"""


def written(folder, text, name):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_both_kinds_of_list_say_the_same(tmp_path):
    by_toml = plan_of_toml(written(tmp_path, TOML, "list.toml"))
    assert by_toml == plan_of_csv(written(tmp_path, CSV, "list.csv"))
    first, second, third = by_toml.trials
    assert first.path == tmp_path / "P1" / "walk1.c3d" and first.forces is None
    assert (second.name, second.forces) == ("second", tmp_path / "P1" / "walk2_grf.mot")
    assert first.person is not None and first.person == second.person
    assert first.person.moving == (Files(first.path), Files(second.path, second.forces))
    assert first.person.statics == (tmp_path / "P1" / "static.c3d",)
    assert (third.person.session, third.person.protocol) == ("monday", "plug_in_gait")
    assert third.person.subject == tmp_path / "P2" / "subject.toml"


def test_paths_are_those_of_the_list_wherever_it_is_read_from(tmp_path, monkeypatch):
    written(tmp_path, CSV, "list.csv")
    monkeypatch.chdir(tmp_path)
    assert plan_of_csv(Path("list.csv")).trials[0].path == tmp_path / "P1" / "walk1.c3d"


def test_a_later_row_may_state_the_mass(tmp_path):
    plan = plan_of_csv(written(tmp_path, "subject,trial,mass_kg\nP,a.c3d,\nP,b.c3d,80\n", "list.csv"))
    assert {trial.person.mass_kg for trial in plan.trials} == {80.0}


@pytest.mark.parametrize(
    "text, why",
    [
        ("subject,name\nP,a.c3d\n", "line 1: has no column 'trial'; its columns are subject, name"),
        ("subject,path\nP,a.c3d\n", "line 1: unknown list column 'path'"),
        ("subject,trial,Mass\nP,a.c3d,3\n", "line 1: unknown list column 'Mass'; did you mean mass_kg"),
        ("subject,trial,Height (cm)\nP,a.c3d,178\n", "'Height \\(cm\\)'; did you mean height_m"),
        ("subject,trial,mass_kg,Mass_kg\nP,a.c3d,3,3\n", "column mass_kg stands twice"),
        ("P,a.c3d\n", "unknown list column 'P'"),
    ],
)
def test_columns_that_cannot_be_are_refused(tmp_path, text, why):
    with pytest.raises(FileFormatError, match=why):
        plan_of_csv(written(tmp_path, text, "list.csv"))


@pytest.mark.parametrize(
    "row, why",
    [
        ("Q,b.c3d,heavy", "line 3: mass_kg must be a number between 0.5 and 500 kg, got heavy"),
        ("Q,b.c3d,5000", "line 3: mass_kg must be .* got 5000.0; write mass_kg = 5 if it is in g"),
        ("Q,b.c3d,158 lb", "line 3: mass_kg must be .* got 158 lb; write mass_kg = 71.67"),
        ("Q,b.c3d,#REF!", "line 3: mass_kg must be .* got #REF!"),
        ("Q,b.c3d,71,9", "line 3: 4 cells for 3 columns"),
        (",b.c3d,", "line 3: subject is missing"),
        ("Q,,", "line 3: trial is missing; name its capture"),
        ("#Q,b.c3d,", "line 3: begins with #"),
        ("Q,b\0.c3d,", "line 3: a file's name cannot hold a zero byte|NUL"),
        ("Q/R,b.c3d,", "'Q/R' cannot be a folder's name"),
        ("P,b.c3d,72", "line 3: mass_kg of P is 72.0 here and 71.0 in line 2; keep one of both"),
    ],
)
def test_a_bad_row_costs_its_own_person_and_is_named(tmp_path, row, why):
    """One person's trials fail; the next person's are planned as without the row."""
    text = f"subject,trial,mass_kg\nP,a.c3d,71\n{row}\nR,c.c3d,80\n"
    plan = plan_of_csv(written(tmp_path, text, "list.csv"))
    *_, last = plan.trials
    assert (last.person.name, last.person.mass_kg, last.fault) == ("R", 80.0, "")
    lost = [trial for trial in plan.trials if trial.fault]
    assert lost and all(re.search(why, trial.fault) for trial in lost)
    assert {trial.person.name for trial in lost} <= {"P"} or not plan.trials[0].fault


@pytest.mark.parametrize("row", ['Q,b.c3d,"71,9"', "Q,b.c3d,71.9 kg", "Q , b.c3d , 71.9kg"])
def test_a_number_that_can_mean_one_thing_is_read_with_a_note(tmp_path, row):
    plan = plan_of_csv(written(tmp_path, f"subject,trial,mass_kg\n{row}\n", "list.csv"))
    (trial,) = plan.trials
    assert (trial.person.mass_kg, trial.fault, trial.path.name) == (71.9, "", "b.c3d")
    (note,) = plan.notes
    assert "list.csv, line 2: mass_kg '71" in note and "is read as 71.9 kg" in note


@pytest.mark.parametrize(
    "text",
    [
        "subject;trial;mass_kg\nP;a.c3d;71,9\n",
        "subject\ttrial\tmass_kg\nP\ta.c3d\t71,9\n",
        "sep=;\nsubject;trial;mass_kg\nP;a.c3d;71.9\n",
        "\ufeffSubject;Trial;Mass (kg)\r\nP;a.c3d;71,9\r\n;;\r\n",
        'Subject,TRIAL,"Mass [kg]",\nP,a.c3d,71.9,\n,,,\n',
        "\nsubject,trial,mass kg\n\nP,a.c3d,71.9\n\n",
    ],
)
def test_lists_of_spreadsheets_are_read(tmp_path, text):
    (trial,) = plan_of_csv(written(tmp_path, text, "list.csv")).trials
    assert (trial.person.name, trial.path.name, trial.person.mass_kg, trial.fault) == ("P", "a.c3d", 71.9, "")


@pytest.mark.parametrize("content", ["sübject,trial\n".encode("cp1252"), "subject,trial\n".encode("utf-16")])
def test_other_encodings_are_named(tmp_path, content):
    (tmp_path / "list.csv").write_bytes(content)
    with pytest.raises(FileFormatError, match=r"save .* in UTF-8"):
        plan_of_csv(tmp_path / "list.csv")


@pytest.mark.parametrize(
    "text, why",
    [
        ("[[subject]\n", "not a list in TOML"),
        ("title = 'x'\n", "unknown list entry 'title'"),
        ("subject = 3\n", r"no \[\[subject\]\]"),
        ("", "subject is missing"),
        ("[[subjects]]\nname = 'P'\n", "line 1: unknown list entry 'subjects'; did you mean subject"),
    ],
)
def test_a_toml_list_that_cannot_be_is_refused(tmp_path, text, why):
    with pytest.raises(FileFormatError, match=why):
        plan_of_toml(written(tmp_path, text, "list.toml"))


@pytest.mark.parametrize(
    "entry, why, lost",
    [
        ("trials = ['a.c3d']", "line 5: name is missing", 1),
        ("name = 'P'\ntrials = 'a.c3d'", "line 7: P: trials must be a list of files", 1),
        ("name = 'P'\ntrials = [{forces = 'a.mot'}, 'b.c3d']", "P, trial 1: path is missing", 1),
        (
            "name = 'P'\ntrials = [{path = 'a.c3d', force = 'a.mot'}, 'b.c3d']",
            "trial entry 'force'; .* forces",
            1,
        ),
        ("name = 'P'\ntrials = [3, 'b.c3d']", "with path", 1),
        ("name = 'P'\nmass_kg = -3\ntrials = ['a.c3d', 'b.c3d']", "line 7: P: mass_kg must be", 2),
        (
            "name = 'P'\nmass = 70\ntrials = ['a.c3d', 'b.c3d']",
            "line 7: unknown subject entry 'mass'; .* mass_kg",
            1,
        ),
        ("name = 'O'\nmass_kg = 72\ntrials = ['b.c3d']", "mass_kg of O is 72.0 here and 71.0 in line 1", 2),
    ],
)
def test_a_bad_person_or_trial_costs_its_own_trials(tmp_path, entry, why, lost):
    before = "[[subject]]\nname = 'O'\nmass_kg = 71\ntrials = ['o.c3d']\n"
    after = "[[subject]]\nname = 'R'\ntrials = ['r.c3d']\n"
    plan = plan_of_toml(written(tmp_path, f"{before}[[subject]]\n{entry}\n{after}", "list.toml"))
    faults = [trial.fault for trial in plan.trials if trial.fault]
    assert len(faults) == lost and all(re.search(why, fault) for fault in faults)
    assert (plan.trials[-1].person.name, plan.trials[-1].fault) == ("R", "")


@pytest.mark.parametrize("text", ["", "subject,trial\n", ",,\n;;\n"])
def test_an_empty_list_is_refused(tmp_path, text):
    with pytest.raises(InvalidInput, match="no trial"):
        plan_of_csv(written(tmp_path, text, "list.csv"))
