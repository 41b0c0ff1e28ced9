"""A batch from end to end: bad files cost only themselves, what is done is not done again, workers change nothing."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from mbkf.errors import FileFormatError, InvalidInput
from mbkf.io.c3d_write import write_c3d
from mbkf.io.capture import read_capture
from mbkf.io.subject import read_subject
from mbkf.study.batch import run as module
from mbkf.study.batch.outcome import Outcome, Status
from mbkf.study.batch.plan import Person, Plan, Sorted, Trial
from mbkf.study.batch.run import batch, outcomes_of, plan_of, with_others
from mbkf.study.batch.tasks import ScalePerson, SortCaptures
from tests.captures import snapshot
from tests.studies import QUICK, ThisProcess, batch_here, study, walk_folder

pytestmark = pytest.mark.slow

TIMES = ("seconds", "peak_memory_mb", "step_seconds_median", "step_seconds_p99", "realtime_factor")


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """Two persons, one with a damaged trial and one without markers in another: folder, results, table, progress."""
    place = tmp_path_factory.mktemp("batch")
    source = study(place / "study", persons=2, trials=1)
    (source / "P1" / "cut.c3d").write_bytes((walk_folder() / "trial.c3d").read_bytes()[:9000])
    (source / "P3").mkdir()
    (source / "P3" / "walk.c3d").write_bytes(b"nothing")
    told = []
    table = batch(
        source,
        place / "out",
        workers=2,
        settings=QUICK,
        static_only=True,
        progress=lambda *one: told.append(one),
    )
    return source, place / "out", table, told


@pytest.fixture
def here(monkeypatch):
    """Tasks are done in this process: the test asks nothing of workers."""
    monkeypatch.setattr(module, "LocalWorkers", ThisProcess)


def rows(table):
    return {row["folder"]: row for row in table.to_pylist()}


def test_a_bad_file_costs_only_itself(done):
    found = rows(done[2])
    assert {name: row["status"] for name, row in found.items()} == {
        "P1/cut": "failed", "P1/walk1": "done", "P2/walk1": "done", "P3/walk": "failed",
    }  # fmt: skip
    assert "cut short" in found["P1/cut"]["reason"]
    assert "could not be scaled" in found["P3/walk"]["reason"]
    assert found["P2/walk1"]["marker_rms_mm"] > 0.0 and found["P1/cut"]["marker_rms_mm"] is None


def test_progress_is_told(done):
    told = done[3]
    assert [one for one in told if one[0] == "Trials"] == [("Trials", k, 3) for k in (1, 2, 3)]
    assert ("Scaling", 3, 3) in told
    inside = [one for one in told if one[0] == "P1/walk1: Filtering"]
    assert inside and inside[-1][1] == inside[-1][2] > 100


@pytest.mark.usefixtures("here")
def test_a_second_run_does_nothing_again(done):
    source, out, table, _ = done
    before = {name: data for name, data in snapshot(out).items() if "/" in name}
    again = rows(batch(source, out, workers=1, settings=QUICK, static_only=True))
    assert {row["status"] for row in again.values()} == {"unchanged", "failed"}
    assert {name: data for name, data in snapshot(out).items() if "/" in name} == before
    for name, row in rows(table).items():
        for key, value in row.items():
            if key not in (*TIMES, "status"):
                assert again[name][key] == value, (name, key)


@pytest.mark.usefixtures("here")
def test_shards_make_the_whole_and_numbers_do_not_depend_on_the_workers(done, tmp_path):
    source, _, table, _ = done
    parts = [
        batch(source, tmp_path, workers=1, shard=(k, 2), settings=QUICK, static_only=True) for k in (1, 2)
    ]
    assert sum(len(part) for part in parts) == len(table)
    assert {path.name for path in tmp_path.glob("summary*.csv")} == {
        "summary-1-of-2.csv",
        "summary-2-of-2.csv",
    }
    whole = rows(batch(source, tmp_path, workers=1, settings=QUICK, static_only=True))
    for name, row in rows(table).items():
        for key, value in row.items():
            if key in (*TIMES, "status", "reason"):
                continue
            if isinstance(value, float):
                np.testing.assert_allclose(whole[name][key], value, rtol=1e-9)
            else:
                assert whole[name][key] == value, (name, key)
    assert {row["status"] for row in whole.values()} == {"unchanged", "failed"}


@pytest.mark.usefixtures("here")
def test_what_was_interrupted_is_gone_on_with(tmp_path):
    source = study(tmp_path / "study", trials=2)

    def stop(stage, count, total):
        if (stage, count) == ("Trials", 1):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        batch(source, tmp_path / "out", workers=1, settings=QUICK, static_only=True, progress=stop)
    assert not [path for path in (tmp_path / "out").rglob("*") if path.name.startswith(".")]
    statuses = batch(source, tmp_path / "out", workers=1, settings=QUICK, static_only=True)[
        "status"
    ].to_pylist()
    assert set(statuses) <= {"done", "unchanged"} and "unchanged" in statuses


@pytest.mark.parametrize(
    "changes, why",
    [({"workers": 0}, "workers can do nothing"), ({"shard": (3, 2)}, "shard 3/2 does not exist")],
)
def test_what_cannot_be_asked_is_refused(tmp_path, changes, why):
    with pytest.raises(InvalidInput, match=why):
        batch(study(tmp_path / "study"), tmp_path / "out", **changes)
    assert not (tmp_path / "out").exists()


def test_a_source_is_a_folder_or_a_list(tmp_path):
    (tmp_path / "walk.c3d").touch()
    with pytest.raises(FileFormatError, match="neither a folder nor a list"):
        plan_of(tmp_path / "walk.c3d")
    assert len(plan_of(tmp_path).trials) == 1
    assert set(module.LISTS) == {".toml", ".csv"}


def test_two_persons_in_one_folder_get_bodies_and_masses_of_their_own(tmp_path):
    source = tmp_path / "mixed"
    source.mkdir()
    for name, size, mass_kg in (("A01", 1.0, 70.0), ("B02", 0.8, 39.4)):
        for kind, file in (("static", "static.c3d"), ("walk", "trial.c3d")):
            made = read_capture(walk_folder() / file)
            markers = replace(made.markers, positions_m=size * made.markers.positions_m)
            capture = replace(made, markers=markers, plates=(), subject_mass_kg=mass_kg)
            write_c3d(capture, source / f"{kind}_{name}.c3d")
    table = batch_here(source, tmp_path / "out", static_only=True)
    assert table["status"].to_pylist() == ["done", "done"]
    bodies = {
        key: read_subject(tmp_path / "out" / key / "subject.toml") for key in table["subject"].to_pylist()
    }
    assert {key: body.mass_kg for key, body in bodies.items()} == pytest.approx({"A01": 70, "B02": 39.4})
    ratios = [bodies["B02"].scale_factors[k] / f for k, f in bodies["A01"].scale_factors.items()]
    assert np.median(ratios) == pytest.approx(0.8, abs=0.02)
    assert max(table["marker_rms_mm"].to_pylist()) < 12.0


class Strange:
    """An executor in whose trials ``walk2`` and ``walk1`` are another's, of whom ``walk1`` cannot be scaled."""

    def run(self, tasks, watch=None):
        for number, task in enumerate(tasks):
            if isinstance(task, SortCaptures):
                owners = {
                    files.path: replace(
                        task.person, name=f"{task.person.name}-{files.path.stem}", unsorted=()
                    )
                    for files in task.person.unsorted
                }
                yield number, Outcome(Status.DONE, captures=Sorted(owners, {}))
            elif isinstance(task, ScalePerson):
                failed = task.person.name == "P-other-walk1"
                yield (
                    number,
                    Outcome(Status.FAILED, "no mass") if failed else Outcome(Status.DONE, subject=Path("s")),
                )
            elif task.trial.person.name == "P" and task.trial.path.stem != "walk3":
                yield number, Outcome(Status.FAILED, "longer", another_person=True)
            else:
                yield number, Outcome(Status.DONE)


def test_trials_of_another_person_beside_one_standing_trial_are_done_with_a_body_of_their_own(tmp_path):
    person = Person("P", statics=(Path("static"),))
    plan = Plan(tuple(Trial(person, Path(f"walk{k}")) for k in (1, 2, 3)))
    asked = (plan, outcomes_of(plan, tmp_path, QUICK, Strange()), tmp_path, QUICK, Strange())
    after, outcomes = with_others(*asked)
    assert [trial.place.as_posix() for trial in after.trials] == ["P/walk1", "P-other-walk2/walk2", "P/walk3"]
    assert [(one.status.value, one.reason) for one in outcomes] == [
        ("failed", "longer"),
        ("done", ""),
        ("done", ""),
    ]


def test_a_trial_of_another_person_is_not_written_into_the_folder_of_a_third(tmp_path):
    person, third = Person("P", statics=(Path("static"),)), Person("P-other-walk2")
    plan = Plan((Trial(person, Path("walk2")), Trial(third, Path("walk3"))))
    after, outcomes = with_others(
        plan, outcomes_of(plan, tmp_path, QUICK, Strange()), tmp_path, QUICK, Strange()
    )
    assert after == plan and [one.reason for one in outcomes] == ["longer", ""]


def test_a_shard_leaves_trials_of_another_person_to_the_whole(monkeypatch, tmp_path):
    """It may hold some of that person's trials only, and bodies would depend on the shards."""
    asked, table = [], tmp_path / "t.parquet"
    pq.write_table(pa.table({"trial": ["a"]}), table)
    monkeypatch.setattr(module, "outcomes_of", lambda *_: [])
    monkeypatch.setattr(
        module, "with_others", lambda plan, outcomes, *_: asked.append(plan) or (plan, outcomes)
    )
    monkeypatch.setattr(module, "write_tables", lambda *_: table)
    plan = Plan(())
    module.follow(plan, tmp_path, QUICK, Strange(), suffix="-1-of-2")
    assert not asked
    module.follow(plan, tmp_path, QUICK, Strange())
    assert asked == [plan]
