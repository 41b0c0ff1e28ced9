"""The record of a frame: declared once, filled from a posterior, read back as a trial."""

from dataclasses import fields

import numpy as np
import pytest

from mbkf.filters.body_errors import BodyErrors
from mbkf.filters.offset_change import CHANGES
from mbkf.filters.record import (
    FIELDS,
    OFFSETS_HELD_S,
    UNASKED,
    FrameRecorder,
    HeldErrors,
    Stretches,
    Track,
    blank,
    record_dtype,
    roots_again,
)
from mbkf.filters.spread import ASKED
from mbkf.filters.tracking import track, track_of
from mbkf.model.joint_centres import centre_names
from tests.dynamics import DT
from tests.followed import estimates, inputs, made_filter, recording, tracked

SIZES = {"marker": 3, "configuration": 8, "dof": 7, "coordinate": 7, "part": 2, "ball": 4, "level": 2}


def test_every_field_has_its_type_and_shape():
    dtype = record_dtype(SIZES)
    assert set(dtype.names) == {field.name for field in FIELDS} and len(dtype.names) == len(FIELDS)
    assert dtype["measured_m"].shape == (3, 3)
    assert dtype["q"].shape == (8,) and dtype["wrench"].shape == (2, 6) and dtype["nis"].shape == ()


def test_numbers_of_a_row_are_aligned():
    """The kernel takes no others."""
    row = blank(record_dtype(SIZES), 1)[0]
    assert all(row[field.name].flags.aligned for field in FIELDS if field.kind != "?")


def test_arrays_of_a_trial_are_fields_of_the_record():
    own = {field.name for field in FIELDS}
    made_of_it = {field.name for field in fields(Track)} - {
        "foot_contact",
        "starts",
        "smoothed",
        "covariance",
        "limb_doubts",
        *CHANGES,
    }
    assert made_of_it <= own


def test_a_blank_record_says_nothing():
    row = blank(record_dtype(SIZES), 2)
    assert np.isnan(row["q"]).all() and np.isnan(row["nis"]).all()
    assert not row["known"].any() and not row["rejected"].any()
    assert (row["footing"] == UNASKED).all()


@pytest.mark.parametrize("name", ["kinematic", "dynamic"])
def test_rows_one_by_one_are_the_whole_trial(name):
    tracking, found = estimates(name)
    recorder = FrameRecorder(tracking, recording().markers_m.shape[1], levels=True)
    rows = blank(recorder.dtype, len(found))
    for t, one in enumerate(found):
        row, spread = recorder.row(t, recording().markers_m[t], one, 0.001)
        recorder.spread(row, spread)
        recorder.innovation(row, one)
        rows[t] = row[0]
    made, whole = track_of(rows), tracked(name)
    for field in fields(Track):
        if field.name not in ("step_seconds", "covariance"):
            np.testing.assert_array_equal(getattr(made, field.name), getattr(whole, field.name), field.name)


def test_a_frame_without_an_estimate_stays_blank():
    recorder = FrameRecorder(made_filter("kinematic"), recording().markers_m.shape[1])
    row, spread = recorder.row(7, recording().markers_m[0], None, 0.0)
    assert spread is None and not row["known"][0] and row["number"][0] == 7
    np.testing.assert_array_equal(row["measured_m"][0], recording().markers_m[0])


@pytest.fixture(scope="module")
def body():
    """Errors by 2 % of every factor, 5 mm of every joint centre and of every marker's place."""
    sensor = inputs().sensor
    places = len(centre_names(sensor.model.description)) + 3 * len(sensor.segments)
    sd = np.concatenate([np.full(18, 0.02), np.full(places, 0.005)])
    return BodyErrors(sensor, inputs().noise_m, np.diag(sd))


@pytest.mark.parametrize("name", ["kinematic", "dynamic"])
def test_spreads_are_totals_with_the_offset_beside_them(name, body):
    """The offset is the body's alone; what varies is the filter's, as without it."""
    tracking, found = estimates(name)
    told, plain = (FrameRecorder(tracking, recording().markers_m.shape[1], one) for one in (body, None))
    rows = []
    for recorder in (told, plain):
        row, spread = recorder.row(20, recording().markers_m[20], found[20], 0.001)
        recorder.spread(row, spread)
        rows.append(row)
    roots = body.at(found[20].q, found[20].v, found[20].a, found[20].wrench, found[20].contact)
    np.testing.assert_allclose(rows[0]["sd_q_offset"][0] ** 2, (roots.position**2).sum(axis=1), rtol=1e-12)
    of_name = {sd: f"{sd}_offset" for sd in ("sd_q", "sd_v")}
    of_name |= {f"{part}_sd": f"{part}_offset" for part in ("torque", "angle", "rate", "wrench")}
    for spread, beside in of_name.items():
        total, offset, alone = (np.square(row) for row in (rows[0][spread], rows[0][beside], rows[1][spread]))
        np.testing.assert_allclose(
            total, alone + offset, rtol=1e-9, atol=1e-12 * np.nanmax(total, initial=0.0)
        )
        assert not rows[1][beside].any()


@pytest.mark.parametrize("name", ["kinematic", "dynamic"])
def test_groups_of_fields_that_are_written_at_once_hold_each_its_own(name, body):
    """One by one as the spread states them."""
    tracking, found = estimates(name)
    recorder = FrameRecorder(tracking, recording().markers_m.shape[1], body, levels=True)
    row, spread = recorder.row(20, recording().markers_m[20], found[20], 0.0)
    recorder.spread(row, spread)
    for field, part in (("sd_q", "position"), ("sd_v", "velocity"), ("torque_sd", "torque")):
        np.testing.assert_allclose(row[field][0], getattr(spread, part), rtol=1e-12)
    for part in ("angle", "rate"):
        np.testing.assert_array_equal(row[f"{part}_sd"][0], getattr(spread, part))
        np.testing.assert_array_equal(row[f"{part}_offset"][0], getattr(spread, f"{part}_offset"))
    wrench = np.hypot(tracking.wrench_sd(found[20]), spread.wrench_offset)
    np.testing.assert_allclose(row["wrench_sd"][0], wrench, rtol=1e-12)
    if name == "kinematic":
        assert np.isnan(row["level_sd"]).all() and np.isnan(row["level_offset"]).all()
    else:
        offset = row["level_offset"][0] ** 2
        np.testing.assert_allclose(offset, spread.body.level_variance, rtol=1e-12)
        np.testing.assert_allclose(row["level_sd"][0] ** 2 - offset, spread.level_variance, rtol=1e-9)


def test_offsets_are_those_of_the_frames_own_stretch(body):
    tracking, found = estimates("dynamic")
    recorder = FrameRecorder(tracking, recording().markers_m.shape[1], body)
    for t in (0, round(OFFSETS_HELD_S / DT), round(OFFSETS_HELD_S / DT) + 1):
        row, spread = recorder.row(t, recording().markers_m[t], found[t], 0.0)
        np.testing.assert_array_equal(row["torque_offset"][0], spread.torque_offset)
        np.testing.assert_allclose(row["torque_sd"][0], spread.torque, rtol=1e-12)


def test_stretches_begin_with_starts_and_after_the_time_that_offsets_are_held():
    stretches, frames = Stretches(DT), round(OFFSETS_HELD_S / DT)
    starts = {0, frames + 3}
    begins = [t for t in range(3 * frames) if stretches.begins(t, t in starts)]
    assert begins == [0, frames, frames + 3, 2 * frames + 3]


def test_roots_are_found_again_from_a_record(body):
    tracking, found = estimates("dynamic")
    recorder = FrameRecorder(tracking, recording().markers_m.shape[1])
    row, _ = recorder.row(20, recording().markers_m[20], found[20], 0.001)
    one = found[20]
    roots, again = body.at(one.q, one.v, one.a, one.wrench, one.contact), roots_again(body, row[0])
    for name in ("position", "velocity", "torque", "wrench"):
        np.testing.assert_array_equal(getattr(again, name), getattr(roots, name))


def test_a_whole_trial_has_the_changes_of_its_offsets(body):
    _, found = estimates("kinematic")
    plain, told = (track(made_filter("kinematic"), recording(), body=one) for one in (None, body))
    begins = range(0, len(found), round(OFFSETS_HELD_S / DT))
    torque = np.array([body.at(*found[t][:4], found[t].contact).torque for t in begins])
    expected = np.linalg.norm(torque - torque.mean(axis=0), axis=2)
    np.testing.assert_allclose(told.torque_change[begins], expected, rtol=1e-3, atol=1e-4)
    np.testing.assert_array_equal(plain.torque_change, np.where(np.isnan(plain.torque_sd), np.nan, 0.0))
    assert (told.angle_change[:, 6:] > 0.0).any()


def test_errors_by_the_body_are_held_for_a_while_and_found_when_asked(body, monkeypatch):
    _, found = estimates("dynamic")
    asked = []
    monkeypatch.setattr(body, "at", lambda q, *others: asked.append(q) or q)
    held, frames = HeldErrors(body, DT), round(OFFSETS_HELD_S / DT)
    later = [held.of(t, found[t]) for t in range(2 * frames)]
    assert not asked
    for t, one in enumerate(later):
        assert one() is found[t // frames * frames].q
    assert len(asked) == 2
    anew = found[frames + 1]._replace(started=True)
    assert held.of(frames + 1, anew)() is anew.q
    assert HeldErrors(None, DT).of(0, found[0])() is None


@pytest.mark.parametrize("name", ["dynamic", "kinematic"])
@pytest.mark.parametrize("asked", [(), ("torques",), ("angles",)])
def test_spreads_that_are_not_asked_for_stay_unknown_and_the_others_as_they_are(name, asked):
    """Those of configuration, velocity and wrenches are told in any case."""
    tracking, found = estimates(name)
    whole, part = (
        FrameRecorder(tracking, recording().markers_m.shape[1], asked=one) for one in (ASKED, asked)
    )
    left_out = {"torques": ("torque_",), "angles": ("angle_", "rate_", "ball_")}
    unknown = tuple(prefix for one in ASKED if one not in asked for prefix in left_out[one])
    rows = []
    for recorder in (whole, part):
        row, spread = recorder.row(20, recording().markers_m[20], found[20], 0.0)
        recorder.spread(row, spread)
        rows.append(row)
    for field in whole.dtype.names:
        if field.startswith(unknown):
            assert np.isfinite(rows[0][field]).all() and np.isnan(rows[1][field]).all()
        else:
            np.testing.assert_array_equal(rows[0][field], rows[1][field])
