"""Tables over trials: all of every summary, whatever it holds, and the same as CSV and Parquet."""

import json

import pyarrow as pa
import pyarrow.csv as pa_csv
import pyarrow.parquet as pq
import pytest

from mbkf.study.batch import tables
from mbkf.study.batch.curves import SCHEMA
from mbkf.study.batch.outcome import Outcome, Status
from mbkf.study.batch.plan import Person, Plan, Trial
from mbkf.study.batch.tables import OWN, write_tables

SUMMARIES = (
    {
        "mass_kg": 70,
        "smoothed": True,
        "nis": {"markers": 1.0, "law": None},
        "warnings": ["one", "ä"],
        "x": None,
    },
    {"mass_kg": 71.5, "smoothed": False, "nis": {"markers": 2}, "lag": "none", "truth": None, "mixed": 3},
    {"mixed": "three", "nis": {}, "seconds": 9.0},
)


@pytest.fixture
def made(tmp_path):
    """Three trials done and one that failed, each with two rows of curves."""
    trials = [Trial(Person(f"P{k}"), tmp_path / f"walk{k}.c3d", condition="aid" * k) for k in range(4)]
    for trial, summary in zip(trials, SUMMARIES, strict=False):
        folder = tmp_path / trial.place
        folder.mkdir(parents=True)
        (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
        rows = {name: [None, None] for name in SCHEMA.names} | {"name": ["knee", "hip"], "percent": [0, 1]}
        pq.write_table(pa.table(rows, schema=SCHEMA), folder / "curves.parquet")
    outcomes = [Outcome(Status.DONE, seconds=1.5, peak_memory_mb=300.0)] * 3
    return Plan(tuple(trials)), [*outcomes, Outcome(Status.FAILED, "cut short")], tmp_path


@pytest.mark.parametrize("rows", [1, 2, 500])
def test_a_row_has_all_of_its_summary(made, rows, monkeypatch):
    """However many rows are held at a time."""
    monkeypatch.setattr(tables, "ROWS", rows)
    found = pq.read_table(write_tables(*made)).to_pylist()
    assert [row["status"] for row in found] == ["done", "done", "done", "failed"]
    first, second, third, last = found
    assert (first["mass_kg"], first["smoothed"], first["nis.markers"]) == (70.0, True, 1.0)
    assert json.loads(first["warnings"]) == ["one", "ä"]
    assert (second["lag"], second["mixed"], third["mixed"]) == ("none", "3", "three")
    assert third["seconds"] == 1.5, "a summary does not change what is told of the worker"
    assert (last["reason"], last["mass_kg"], last["folder"]) == ("cut short", None, "P3/walk3")
    assert [row["condition"] for row in found[:2]] == ["", "aid"]
    assert "x" not in first and "truth" not in first and "nis.law" not in first


def test_text_and_columns_say_the_same(made):
    file = write_tables(*made)
    columns, text = pq.read_table(file), pa_csv.read_csv(file.with_suffix(".csv"))
    assert text.column_names == columns.column_names
    assert text["mass_kg"].to_pylist() == columns["mass_kg"].to_pylist()
    assert columns.column_names[: len(OWN)] == OWN.names


def test_curves_stand_below_each_other_with_their_trials_names(made):
    write_tables(*made)
    folder = made[2]
    found, text = pq.read_table(folder / "curves.parquet"), pa_csv.read_csv(folder / "curves.csv")
    assert found["subject"].to_pylist() == text["subject"].to_pylist() == ["P0", "P0", "P1", "P1", "P2", "P2"]
    assert found["name"].to_pylist() == text["name"].to_pylist() == ["knee", "hip"] * 3
    assert found["trial"].to_pylist()[:2] == ["walk0"] * 2


def test_a_shard_s_tables_have_its_name(made):
    assert write_tables(*made, "-1-of-2").name == "summary-1-of-2.parquet"
    assert (made[2] / "curves-1-of-2.csv").is_file()


def test_a_summary_that_cannot_be_read_leaves_its_row(made):
    (made[2] / "P1" / "walk1" / "summary.json").write_text("{", encoding="utf-8")
    found = pq.read_table(write_tables(*made)).to_pylist()
    assert (found[1]["status"], found[1]["mass_kg"]) == ("done", None)


def test_where_the_curves_cannot_be_written_the_earlier_summary_stays(made, monkeypatch):
    write_tables(*made)
    before = {name: (made[2] / name).read_bytes() for name in tables.TABLES}
    plan, _, out = made
    monkeypatch.setattr(tables, "_curves", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        write_tables(plan, [Outcome(Status.FAILED, "another")] * 4, out)
    assert {name: (out / name).read_bytes() for name in tables.TABLES} == before
    assert not list(out.glob(".*"))
