"""Key numbers for spreadsheets: at most 60 columns to chart, and every other number of summary.json in the list."""

import csv

import pytest

from mbkf.io.written import TABLE, form_of
from mbkf.trial.exchange.result_csv import leaves
from mbkf.trial.exchange.summary_table import CHARTED, more_path, write_summary_csv
from mbkf.trial.results.summary import summarise
from tests.recordings import walk


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    path = tmp_path_factory.mktemp("summary") / "walk.csv"
    write_summary_csv(walk(), path)
    return path, [list(csv.reader(one.read_text("utf-8").splitlines())) for one in (path, more_path(path))]


def test_both_tables_are_mbkf_s(written):
    path, _ = written
    assert [form_of(one) for one in (path, more_path(path))] == [TABLE, TABLE]


def test_the_row_holds_key_numbers_under_few_names(written):
    _, (row, _) = written
    found = dict(leaves(summarise(walk())))
    assert row[0] == list(CHARTED) and len(row) == 2 and len(row[0]) <= 60
    texts = dict(zip(*row, strict=True))
    assert float(texts["marker_rms_mm"]) == found["marker_rms_mm"]
    assert float(texts["knee_r_peak_nm_per_kg"]) == found["torque_peak_nm_per_kg.knee_r"]
    assert texts["hidden_marker_rms_mm"] == "" and texts["frames"] == str(walk().frames)


def test_no_number_is_lost_or_stands_twice(written):
    _, (_, more) = written
    found = dict(leaves(summarise(walk())))
    listed = {key: value for trial, key, value in more[1:]}
    assert len(listed) == len(more) - 1
    assert set(listed) | set(CHARTED.values()) >= set(found)
    assert not set(listed) & set(CHARTED.values())
    assert float(listed["step_seconds_median"]) == found["step_seconds_median"]
