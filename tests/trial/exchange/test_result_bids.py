"""A data set of Motion-BIDS: what describes the columns fits them, and the numbers are the result's."""

import json
from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.written import overwriting
from mbkf.trial.exchange.result_bids import write_results_bids
from tests.recordings import LOST, broken_walk, walk

STEM = "sub-07_task-walk1"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("bids") / "set"
    write_results_bids([broken_walk()], place, "07")
    return place / "sub-07" / "motion"


def rows(path):
    return [line.split("\t") for line in path.read_text("utf-8").splitlines()]


@pytest.mark.parametrize(("system", "kind"), [("optical", "POS"), ("mbkf", "JNTANG")])
def test_the_columns_are_those_that_stand_beside_them(folder, system, kind):
    r = broken_walk()
    head, *channels = rows(folder / f"{STEM}_tracksys-{system}_channels.tsv")
    values = rows(folder / f"{STEM}_tracksys-{system}_motion.tsv")
    about = json.loads((folder / f"{STEM}_tracksys-{system}_motion.json").read_text())
    assert head[:5] == ["name", "component", "type", "tracked_point", "units"]
    assert {one[2] for one in channels} == {kind}
    assert about["MotionChannelCount"] == about[f"{kind}ChannelCount"] == len(channels)
    assert about["TrackedPointsCount"] == len({one[3] for one in channels})
    assert len(values) == r.frames and {len(row) for row in values} == {len(channels)}
    assert about["SamplingFrequency"] == r.rate_hz and about["MissingValues"] == "n/a"
    name, wanted = (r.marker_names[0] + "_y", r.measured_m[:, 0, 1])
    if system == "mbkf":
        name, wanted = "knee_angle_r", np.where(r.tracked, np.degrees(r.angle("knee_angle_r")), np.nan)
    at = [one[0] for one in channels].index(name)
    found = np.array([np.nan if row[at] == "n/a" else float(row[at]) for row in values])
    np.testing.assert_allclose(found, wanted, rtol=1e-7)
    assert np.isnan(found[LOST if system == "mbkf" else slice(20, 50)]).all()


def test_foot_events_count_from_the_first_frame(folder, tmp_path):
    later = replace(broken_walk(), times_s=broken_walk().times_s + 5.0)
    write_results_bids([later], tmp_path, "07")
    assert rows(tmp_path / "sub-07" / "motion" / f"{STEM}_events.tsv") == rows(folder / f"{STEM}_events.tsv")
    head, *events = rows(folder / f"{STEM}_events.tsv")
    assert head == ["onset", "duration", "trial_type"]
    assert {one[2] for one in events} <= {
        f"Foot {a}, {b}" for a in ("Strike", "Off") for b in ("Right", "Left")
    }
    assert len(events) > 2 and sorted(float(one[0]) for one in events) == [float(one[0]) for one in events]


def test_trials_of_one_name_are_numbered_and_the_set_keeps_what_it_has(tmp_path):
    (tmp_path / "README").write_text("my study")
    write_results_bids([walk(), replace(walk(), trial="walk 1")], tmp_path)
    names = {path.name for path in (tmp_path / "sub-01" / "motion").glob("*optical_*motion.tsv")}
    assert names == {f"sub-01_task-walk1_tracksys-optical_run-{k}_motion.tsv" for k in (1, 2)}
    assert (tmp_path / "README").read_text() == "my study"
    assert rows(tmp_path / "participants.tsv")[1][0] == "sub-01"


def test_a_further_person_gets_a_row_in_the_columns_of_the_table(tmp_path):
    table = tmp_path / "participants.tsv"
    write_results_bids([walk()], tmp_path, "07")
    table.write_text("participant_id\tage\tbody_mass\nsub-07\t31\t70\n")
    for _ in range(2):
        with overwriting():
            write_results_bids([walk()], tmp_path, "08")
    mass = f"{walk().subject.mass_kg:.6g}"
    assert rows(table) == [
        ["participant_id", "age", "body_mass"],
        ["sub-07", "31", "70"],
        ["sub-08", "n/a", mass],
    ]


def test_labels_and_empty_sets_are_refused(tmp_path):
    with pytest.raises(InvalidInput, match="letters and digits"):
        write_results_bids([walk()], tmp_path / "set", "P 1")
    with pytest.raises(InvalidInput, match="no result"):
        write_results_bids([], tmp_path / "set")
    assert list(tmp_path.iterdir()) == []
