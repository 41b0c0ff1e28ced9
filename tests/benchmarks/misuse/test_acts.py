"""Acts name an input by other paths that lead to the same file, and say which files may not change."""

import pytest

from benchmarks.misuse.acts import IN, NEW, OTHER, WAYS, acts_of
from benchmarks.misuse.cases import Case
from benchmarks.misuse.world import INPUTS

SCALE = Case("scale", "{static} --out {OUT}", "new.toml", sides=(".json",))
BATCH = Case("batch", "{list} --out {OUT}", "new")


@pytest.fixture
def world(tmp_path):
    made = tmp_path / "world"
    made.mkdir()
    for name in ("static", "trial", "list"):
        (made / INPUTS[name]).write_text(name)
    return made


@pytest.mark.parametrize("way", WAYS)
def test_every_way_leads_to_the_same_file(tmp_path, monkeypatch, way):
    (tmp_path / IN).mkdir()
    (tmp_path / OTHER).mkdir()
    file = tmp_path / IN / "a.c3d"
    file.write_text("a")
    monkeypatch.chdir(tmp_path)
    assert WAYS[way](tmp_path, file, ".toml").samefile(file)


def test_an_output_file_gets_acts_of_every_way_and_side(tmp_path, world):
    acts = list(acts_of(SCALE, world, ()))
    over = [act for act in acts if act.kind == "output over an input"]
    assert len(over) == len(WAYS) + 1  # and a link of the side's name
    for k, act in enumerate(over[:-1]):
        place = tmp_path / f"{k}"
        place.mkdir()
        words = act.prepare(world, place)
        assert words[:2] == ["scale", str(place / IN / "static.c3d")]
        assert (place / words[-1]).samefile(place / IN / "static.c3d")
    assert {act.must for act in acts if "foreign" in act.kind} == {"refused", "done"}


def test_a_file_that_the_command_wrote_itself_is_no_input(world):
    (world / INPUTS["session"]).mkdir()
    for name in ("report.html", "curves.parquet"):
        (world / INPUTS["session"] / name).write_text(name)
    own = Case("report", "{session} --out {OUT}", "new.html", rewrites=("report.html",))
    over = [act.title for act in acts_of(own, world, ()) if act.kind == "output over an input"]
    assert len(over) == len(WAYS) and all("curves.parquet" in title for title in over)


def test_an_input_takes_the_name_of_an_output(tmp_path, world):
    acts = acts_of(BATCH, world, ("summary.csv", "P/motion.h5"))
    act = next(act for act in acts if "list is summary.csv" in act.title)
    place = tmp_path / "act"
    place.mkdir()
    words = act.prepare(world, place)
    assert words == ["batch", str(place / NEW / "summary.csv"), "--out", str(place / NEW)]
    assert (place / NEW / "summary.csv").read_text() == "list"


def test_where_a_command_has_leave_inputs_still_stay(tmp_path, world):
    leave = next(act for act in acts_of(SCALE, world, ()) if act.must == "done")
    assert leave.must_stay(tmp_path, f"{IN}/static.c3d")
    assert not leave.must_stay(tmp_path, f"{NEW}/new.toml")
