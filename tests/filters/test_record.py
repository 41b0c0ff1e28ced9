"""The record of a frame: declared once, filled from a posterior, read back as a trial."""

from dataclasses import fields

import numpy as np
import pytest

from mbkf.filters.record import FIELDS, UNASKED, FrameRecorder, blank, record_dtype
from mbkf.filters.tracking import Track, track_of
from tests.followed import estimates, made_filter, recording, tracked

SIZES = {"M": 3, "nq": 8, "nv": 7, "A": 7, "B": 2, "N": 4}


def test_every_field_has_its_type_and_shape():
    dtype = record_dtype(SIZES)
    assert dtype.names == tuple(field.name for field in FIELDS)
    assert dtype["measured_m"].shape == (3, 3)
    assert dtype["q"].shape == (8,) and dtype["wrench"].shape == (2, 6) and dtype["nis"].shape == ()


def test_arrays_of_a_trial_are_fields_of_the_record():
    own = {field.name for field in FIELDS}
    made_of_it = {field.name for field in fields(Track)} - {"contact", "starts", "smoothed", "covariance"}
    assert made_of_it <= own


def test_a_blank_record_says_nothing():
    row = blank(record_dtype(SIZES), 2)
    assert np.isnan(row["q"]).all() and np.isnan(row["nis"]).all()
    assert not row["known"].any() and not row["refused"].any()
    assert (row["footing"] == UNASKED).all()


@pytest.mark.parametrize("name", ["kinematic", "dynamic"])
def test_rows_one_by_one_are_the_whole_trial(name):
    tracking, found = estimates(name)
    recorder = FrameRecorder(tracking, recording().markers_m.shape[1])
    rows = blank(recorder.dtype, len(found))
    for t, one in enumerate(found):
        row, spread = recorder.row(t, recording().markers_m[t], one, 0.001)
        recorder.spread(row, spread)
        recorder.innovation(row, one)
        rows[t] = row[0]
    track, whole = track_of(rows), tracked(name)
    for field in fields(Track):
        if field.name not in ("step_seconds", "covariance"):
            np.testing.assert_array_equal(getattr(track, field.name), getattr(whole, field.name), field.name)


def test_a_frame_without_an_estimate_stays_blank():
    recorder = FrameRecorder(made_filter("kinematic"), recording().markers_m.shape[1])
    row, spread = recorder.row(7, recording().markers_m[0], None, 0.0)
    assert spread is None and not row["known"][0] and row["number"][0] == 7
    np.testing.assert_array_equal(row["measured_m"][0], recording().markers_m[0])
