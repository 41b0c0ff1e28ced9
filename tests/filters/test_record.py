"""The record of a frame: declared once, filled from a posterior, read back as a trial."""

from dataclasses import fields

import numpy as np
import pytest

from mbkf.filters import offset_change
from mbkf.filters.body_errors import BodyErrors
from mbkf.filters.record import (
    FIELDS,
    OFFSETS_HELD_S,
    UNASKED,
    FrameRecorder,
    HeldErrors,
    Track,
    blank,
    record_dtype,
)
from mbkf.filters.spread import ASKED
from mbkf.filters.tracking import track_of
from mbkf.model.joint_centres import centre_names
from tests.dynamics import DT
from tests.followed import estimates, inputs, made_filter, recording, tracked

SIZES = {"marker": 3, "configuration": 8, "dof": 7, "coordinate": 7, "part": 2, "ball": 4}


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


def test_a_trial_holds_changes_of_offsets_about_its_own_mean_and_totals_as_they_were(body, monkeypatch):
    """Roots that were not kept are worked out from the records; frames without an estimate stay unknown."""
    tracking, found = estimates("dynamic")
    held = round(OFFSETS_HELD_S / DT)
    recorder = FrameRecorder(tracking, recording().markers_m.shape[1], body, whole_trial=True)
    rows = blank(recorder.dtype, len(found) + 1)
    rows["number"] = np.arange(len(rows))

    def filled():
        for t, one in enumerate(found):
            recorder.step(rows[t : t + 1], one, 0.001)
            recorder.spread(rows[t : t + 1], recorder.motion(rows[t : t + 1], one))

    monkeypatch.setattr(offset_change, "KEPT_BYTES", 0)
    recorder = FrameRecorder(tracking, recording().markers_m.shape[1], body, whole_trial=True)
    filled()
    so_far = rows.copy()
    recorder.finish(rows)
    instants = [found[t] for t in range(0, len(found), held)]
    roots = [body.at(one.q, one.v, one.a, one.wrench, one.contact) for one in instants]
    torque = np.array([one.torque for one in roots])
    expected = np.linalg.norm(torque - torque.mean(axis=0), axis=2)
    for t in range(len(found)):
        np.testing.assert_allclose(rows["torque_change"][t], expected[t // held], rtol=1e-4, atol=1e-4)
    np.testing.assert_array_equal(rows["torque_change"][-2], so_far["torque_change"][-2])
    assert (so_far["torque_change"][0] == 0.0).all() and (rows["angle_change"][0] > 0.0).any()
    for name in rows.dtype.names:
        if not name.endswith("_change"):
            np.testing.assert_array_equal(rows[name], so_far[name])
        elif rows[name].ndim > 1:
            assert np.isnan(rows[name][-1]).all()


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
