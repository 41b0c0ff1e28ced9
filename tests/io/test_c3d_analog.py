"""Plates of a file become readings on the body in the world; events and channels are kept."""

import numpy as np
import pytest

from mbkf.io.axes import rotation_to_world
from mbkf.io.c3d import read_c3d
from mbkf.io.capture_options import CaptureOptions
from tests.io.c3d_builder import CENTRE_M, CORNERS_MM, PLATE_AXES, Plate, build_c3d, standing_points

FRAMES, PER_FRAME = 100, 10
PLACE_M = np.array([0.3, -0.05, 0.0])
FORCE_N = np.array([40.0, -25.0, 700.0])


def channels(force_n=FORCE_N, offset=(0.0,) * 6, loaded=slice(400, 700)) -> np.ndarray:
    """(S, 6) type 2 channels in N and N mm: a force at PLACE_M for a while."""
    force = np.zeros((FRAMES * PER_FRAME, 3))
    force[loaded] = force_n
    moment = np.cross(PLACE_M - CENTRE_M, force)
    wrench = np.hstack([force, moment]) + np.array(offset)
    return np.hstack([wrench[:, :3] @ PLATE_AXES, wrench[:, 3:] @ PLATE_AXES * 1e3])


def made(path, *plates, **options):
    return build_c3d(path, standing_points(FRAMES), plates=plates, **options)


def test_force_on_the_body_at_its_place_with_its_times(tmp_path):
    capture = read_c3d(made(tmp_path / "a.c3d", Plate(2, channels()), first_frame=250), CaptureOptions())
    (plate,) = capture.plates
    assert (plate.name, plate.rate_hz, plate.start_time_s) == ("1", 1000.0, 2.5)
    np.testing.assert_allclose(plate.origin_m, CENTRE_M, atol=1e-9)
    np.testing.assert_allclose(plate.corners_m, CORNERS_MM.T / 1e3, atol=1e-9)
    np.testing.assert_allclose(plate.force_n[500], FORCE_N, rtol=1e-6)
    np.testing.assert_allclose(plate.moment_nm[500], np.cross(PLACE_M - CENTRE_M, FORCE_N), rtol=1e-5)
    np.testing.assert_allclose(plate.centre_of_pressure_m[400:700], np.tile(PLACE_M, (300, 1)), atol=1e-6)
    assert np.isnan(plate.centre_of_pressure_m[:400]).all()
    assert capture.up_axis == "z"
    assert [channel.name for channel in capture.analog] == [f"C{i}" for i in range(6)]
    assert {channel.rate_hz for channel in capture.analog} == {1000.0}


BROKEN = channels()
BROKEN[420, 2] = np.nan
OFFSET = (2.0, -3.0, -32.0, 4.0, -2.0, 1.0)


@pytest.mark.parametrize("tare", [True, False])
def test_offset_is_removed_on_request_and_told(tmp_path, tare):
    capture = read_c3d(made(tmp_path / "a.c3d", Plate(2, channels(offset=OFFSET))), CaptureOptions(tare=tare))
    (plate,) = capture.plates
    np.testing.assert_allclose(plate.offset, OFFSET if tare else np.zeros(6), atol=1e-4)
    np.testing.assert_allclose(plate.force_n[500] + plate.offset[:3], FORCE_N + OFFSET[:3], atol=1e-3)
    assert any("offset of -32.0 N" in note for note in capture.notes) == tare
    if tare:
        np.testing.assert_allclose(plate.centre_of_pressure_m[500], PLACE_M, atol=1e-5)


def test_a_standing_trial_keeps_its_load_and_says_so(tmp_path):
    capture = read_c3d(made(tmp_path / "a.c3d", Plate(2, channels(loaded=slice(None)))), CaptureOptions())
    np.testing.assert_allclose(capture.plates[0].force_n, np.tile(FORCE_N, (1000, 1)), rtol=1e-6)
    assert any("loaded all the time" in note for note in capture.notes)


@pytest.mark.parametrize("up", ["x", "-x", "y", "-y", "z", "-z"])
def test_plates_tell_which_axis_points_up(tmp_path, up):
    R = rotation_to_world(up)  # file -> world
    points = standing_points(FRAMES) @ R
    plate = Plate(2, channels(), corners=R.T @ CORNERS_MM)
    capture = read_c3d(build_c3d(tmp_path / "a.c3d", points, plates=(plate,)), CaptureOptions())
    assert capture.up_axis == up
    np.testing.assert_allclose(capture.markers.positions_m, standing_points(FRAMES) / 1e3, atol=1e-6)
    np.testing.assert_allclose(capture.plates[0].force_n[500], FORCE_N, rtol=1e-5)
    np.testing.assert_allclose(capture.plates[0].centre_of_pressure_m[500], PLACE_M, atol=1e-6)


def test_several_plates_of_different_kinds(tmp_path):
    calibration = np.diag([100.0, 100.0, 200.0, 5e4, 5e4, 3e4]) + 1.0
    volts = np.linalg.solve(calibration, channels().T).T
    plates = (
        Plate(2, channels()),
        Plate(4, volts, units=("V",) * 6, calibration=calibration),
        Plate(3, np.zeros((1000, 8)), origin=(120.0, 200.0, -50.0), units=("N",) * 8),
    )
    capture = read_c3d(made(tmp_path / "a.c3d", *plates), CaptureOptions())
    assert [plate.name for plate in capture.plates] == ["1", "2", "3"]
    np.testing.assert_allclose(capture.plates[1].force_n, capture.plates[0].force_n, atol=2e-3)
    np.testing.assert_allclose(capture.plates[1].moment_nm, capture.plates[0].moment_nm, atol=2e-3)
    np.testing.assert_array_equal(capture.plates[2].force_n, 0.0)


@pytest.mark.parametrize(
    ("plate", "reason"),
    [
        (Plate(2, channels(), corners=np.zeros((3, 4))), "CORNERS"),
        (Plate(2, channels(), corners=CORNERS_MM[:, [0, 0, 2, 3]]), "CORNERS"),
        (Plate(2, channels(), corners=CORNERS_MM[:, [0, 2, 1, 3]]), "CORNERS"),
        (Plate(3, channels()), "needs 8 channels, it has 6"),
        (Plate(3, np.zeros((1000, 8)), units=("N",) * 8), "places of its sensors"),
        (Plate(2, BROKEN), "1 of 1000 samples of force or moment are not numbers, the first at 0.420 s"),
        (Plate(4, channels(), units=("V",) * 6), "CAL_MATRIX"),
        (Plate(7, channels()), "type 7"),
    ],
)
def test_unusable_plates_are_left_out_with_the_reason_and_the_others_are_used(tmp_path, plate, reason):
    path = made(tmp_path / "a.c3d", plate, Plate(2, channels()))
    options = CaptureOptions()
    (read,) = read_c3d(path, options).plates
    assert read.name == "2" and list(options.left_out) == ["1"] and reason in options.left_out["1"]
    np.testing.assert_allclose(read.force_n[500], FORCE_N, rtol=1e-6)
    none = CaptureOptions(plates=False)
    assert read_c3d(path, none).plates == () and none.left_out == {}


def test_plates_without_channels_or_with_absent_ones_are_left_out(tmp_path):
    path = made(
        tmp_path / "a.c3d", Plate(2, channels()), extra={("FORCE_PLATFORM", "CHANNEL"): np.zeros((6, 1))}
    )
    capture = read_c3d(path, CaptureOptions())
    assert capture.plates == ()
    far = {("FORCE_PLATFORM", "CHANNEL"): np.arange(3.0, 9.0)[:, None]}
    beyond = CaptureOptions()
    assert read_c3d(made(tmp_path / "b.c3d", Plate(2, channels()), extra=far), beyond).plates == ()
    assert "names channel 8, the file has 6" in beyond.left_out["1"]


@pytest.mark.parametrize("channel", [7.0, np.arange(1.0, 3.0), np.zeros((6, 0))])
def test_fewer_channels_than_plates_belong_to_nobody(tmp_path, channel):
    extra = {("FORCE_PLATFORM", "CHANNEL"): channel, ("FORCE_PLATFORM", "USED"): 3}
    options = CaptureOptions()
    assert read_c3d(made(tmp_path / "a.c3d", Plate(2, channels()), extra=extra), options).plates == ()
    assert list(options.left_out) == ["1", "2", "3"]


def renamed(path, name):
    """The file without a parameter of FORCE_PLATFORM, whose name becomes another."""
    content = path.read_bytes()
    at = content.index(name, content.index(b"FORCE_PLATFORM"))
    path.write_bytes(content[:at] + b"Q" + content[at + 1 :])
    return path


def test_a_missing_origin_is_reported(tmp_path):
    sound = made(tmp_path / "a.c3d", Plate(2, channels()))
    assert not any("ORIGIN" in note for note in read_c3d(sound, CaptureOptions()).notes)
    capture = read_c3d(renamed(sound, b"ORIGIN"), CaptureOptions())
    assert len(capture.plates) == 1 and any("lacks FORCE_PLATFORM:ORIGIN" in note for note in capture.notes)


@pytest.mark.parametrize("used", [None, -1, np.inf])
def test_plates_that_are_not_counted_are_those_of_their_types(tmp_path, used):
    extra = {} if used is None else {("FORCE_PLATFORM", "USED"): used}
    path = made(tmp_path / "a.c3d", Plate(2, channels()), Plate(2, channels()), extra=extra)
    path = renamed(path, b"USED") if used is None else path
    capture = read_c3d(path, CaptureOptions())
    assert len(capture.plates) == 2 and any("plates is that of TYPE, 2" in note for note in capture.notes)


def test_channels_in_one_row_are_shared_out_among_the_plates(tmp_path):
    extra = {("FORCE_PLATFORM", "CHANNEL"): np.arange(1.0, 13.0)}
    path = made(tmp_path / "a.c3d", Plate(2, 0.5 * channels()), Plate(2, channels()), extra=extra)
    first, second = read_c3d(path, CaptureOptions()).plates
    np.testing.assert_allclose(first.force_n[500], 0.5 * FORCE_N, rtol=1e-6)
    np.testing.assert_allclose(second.force_n[500], FORCE_N, rtol=1e-6)


def test_doubtful_plates_are_remarked(tmp_path):
    pulling = read_c3d(made(tmp_path / "a.c3d", Plate(2, -channels())), CaptureOptions())
    assert any("pulls the body down" in note for note in pulling.notes)
    in_metres = channels()
    in_metres[:, 3:] *= 10.0
    off = read_c3d(made(tmp_path / "b.c3d", Plate(2, in_metres)), CaptureOptions())
    assert any("off the plate" in note for note in off.notes)


@pytest.mark.parametrize("group", ["EVENT", "EVENTS"])
def test_events_are_in_order_with_minutes_added(tmp_path, group):
    extra = {
        (group, "USED"): 2,
        (group, "CONTEXTS"): ["Left", "Right"],
        (group, "LABELS"): ["Foot Off", "Foot Strike"],
        (group, "TIMES"): np.array([[1.0, 0.0], [2.5, 3.25]]),
    }
    events = read_c3d(build_c3d(tmp_path / "a.c3d", extra=extra), CaptureOptions()).events
    found = [(event.time_s, event.context, event.label) for event in events]
    assert found == [(3.25, "Right", "Foot Strike"), (62.5, "Left", "Foot Off")]


def test_fewer_labels_than_events_are_reported(tmp_path):
    extra = {
        ("EVENT", "USED"): 2,
        ("EVENT", "LABELS"): ["A"],
        ("EVENT", "TIMES"): np.array([[0.0, 0.0], [1.0, 2.0]]),
    }
    capture = read_c3d(build_c3d(tmp_path / "a.c3d", extra=extra), CaptureOptions())
    assert [event.label for event in capture.events] == ["A", ""]
    assert "EVENT:LABELS lacks 1 of 2 events" in capture.notes


@pytest.mark.parametrize(
    ("times", "used", "found", "remark"),
    [
        (np.array([0.0, 3.25, 1.0, 2.5]), 2, [3.25, 62.5], ""),
        (np.array([3.25, 2.5, 1.0]), 2, [], "no minutes and seconds"),
        (np.zeros((2, 0)), 2, [], "EVENT:TIMES is missing"),
        (np.array([[0.0, 1.0], [3.25, np.nan]]), 2, [3.25], "1 of 2 events have no time"),
    ],
)
def test_events_without_a_time_are_left_out_and_reported(tmp_path, times, used, found, remark):
    extra = {("EVENT", "USED"): used, ("EVENT", "LABELS"): ["A", "B"], ("EVENT", "TIMES"): times}
    extra["EVENT", "CONTEXTS"] = ["Left", "Right"]
    capture = read_c3d(build_c3d(tmp_path / "a.c3d", extra=extra), CaptureOptions())
    assert [event.time_s for event in capture.events] == found
    assert (
        any(remark in note for note in capture.notes)
        if remark
        else not any("event" in n for n in capture.notes)
    )
