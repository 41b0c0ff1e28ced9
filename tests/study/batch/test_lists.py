"""Lists of persons and trials: TOML and CSV say the same, and what they cannot mean is refused with its line."""

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
        ("subject,path\nP,a.c3d\n", "no column 'trial'"),
        ("subject,trial,weight\nP,a.c3d,3\n", "not known: weight"),
        ("subject,trial,mass_kg\nP,a.c3d,\nP,b.c3d,heavy\n", "line 3: 'heavy' should be a number"),
        ("subject,trial,mass_kg\nP,a.c3d,5000\n", "line 2: mass_kg must be"),
        ("subject,trial\n,a.c3d\n", "line 2: names no subject"),
        ("subject,trial\nP,a\0.c3d\n", "zero byte|NUL"),
    ],
)
def test_a_csv_list_that_cannot_be_is_refused(tmp_path, text, why):
    with pytest.raises(FileFormatError, match=why):
        plan_of_csv(written(tmp_path, text, "list.csv"))


@pytest.mark.parametrize(
    "text, why",
    [
        ("[[subject]\n", "list in TOML"),
        ("title = 'x'\n", r"no \[\[subject\]\]"),
        ("subject = 3\n", r"no \[\[subject\]\]"),
        ("[[subject]]\ntrials = ['a.c3d']\n", "needs a name"),
        ("[[subject]]\nname = 'P'\ntrials = 'a.c3d'\n", "must be a list"),
        ("[[subject]]\nname = 'P'\ntrials = [{forces = 'a.mot'}]\n", "with path"),
        ("[[subject]]\nname = 'P'\ntrials = [3]\n", "with path"),
        ("[[subject]]\nname = 'P'\nmass_kg = -3\ntrials = ['a.c3d']\n", "mass_kg must be"),
    ],
)
def test_a_toml_list_that_cannot_be_is_refused(tmp_path, text, why):
    with pytest.raises(FileFormatError, match=why):
        plan_of_toml(written(tmp_path, text, "list.toml"))


@pytest.mark.parametrize("text", ["", "subject,trial\n"])
def test_an_empty_list_is_refused(tmp_path, text):
    with pytest.raises(InvalidInput, match="no trial"):
        plan_of_csv(written(tmp_path, text, "list.csv"))
