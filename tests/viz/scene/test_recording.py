"""A recording: rows that show what the result holds, packed without visible loss."""

import base64
import json
import re
import zlib
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from mbkf.errors import InvalidInput
from mbkf.viz.scene.channels import REFUSED, SEEN, UNSEEN
from mbkf.viz.scene.recording import MISSING, pack, playback_page, recorded_scene, recording
from tests.recordings import LOST, RAIL, SEAT, broken_walk, leaning_walk, walk

VALUES = st.one_of(st.just(np.nan), st.floats(-1e3, 1e3))


def unpack(packed):
    """(T, W) rows as the page's script gets them from what was packed."""
    low, step = np.array(packed["low"]), np.array(packed["step"])
    raw = zlib.decompress(base64.b64decode(packed["data"]))
    differences = np.frombuffer(raw, dtype="<u2").reshape(len(low), packed["frames"])
    counts = np.cumsum(differences, axis=1, dtype=np.uint16)
    return np.where(counts == MISSING, np.nan, low[:, None] + step[:, None] * counts).T


def part(scene, rows, name):
    first, width = scene["parts"][name]
    return rows[:, first : first + width]


@given(arrays(float, array_shapes(min_dims=2, max_dims=2, max_side=12), elements=VALUES))
def test_packing_keeps_values_to_a_65000th_of_their_range(rows):
    back = unpack(pack(rows))
    np.testing.assert_array_equal(np.isnan(back), np.isnan(rows))
    for mine, theirs in zip(rows.T, back.T, strict=True):
        known = ~np.isnan(mine)
        if known.any():
            step = np.ptp(mine[known]) / 65534
            assert np.abs(mine[known] - theirs[known]).max() <= 0.51 * step + 1e-6 * np.abs(mine[known]).max()


@given(arrays(float, (9, 3), elements=st.floats(-5.0, 5.0)))
def test_a_resolution_bounds_the_error(rows):
    back = unpack(pack(rows, np.array([0.01, 0.1, 1.0])))
    assert (np.abs(back - rows).max(axis=0) <= [0.0051, 0.051, 0.51]).all()


def test_what_travels_looks_the_same():
    r = walk()
    scene, rows, _ = recorded_scene(r)
    back = unpack(recording(r)["rows"])
    for name, tolerance in (("segments", 2e-4), ("predicted", 2e-4), ("force", 0.2), ("angles", 3e-4)):
        assert np.nanmax(np.abs(part(scene, back, name) - part(scene, rows, name))) <= tolerance
    assert scene["start_s"] == r.times_s[0]


def test_the_status_tells_times_and_the_durations_of_steps_in_milliseconds():
    r = walk()
    scene, rows, _ = recorded_scene(r)
    status = part(scene, rows, "status")
    shown = status[:, 1].astype(int)
    np.testing.assert_allclose(status[:, 0], r.times_s[shown])
    np.testing.assert_allclose(status[:, 2], 1e3 * r.step_seconds[shown])


def test_it_opens_where_the_body_is_first_seen():
    r = walk()
    late = replace(r, tracked=np.arange(r.frames) >= 37)
    assert recorded_scene(r)[0]["first_tracked"] == 0
    assert recorded_scene(late)[0]["first_tracked"] == 37
    quick = replace(late, rate_hz=4 * r.rate_hz, times_s=r.times_s / 4)
    scene, rows, _ = recorded_scene(quick)
    assert part(scene, rows, "status")[scene["first_tracked"], 1] == 40, "every fourth frame is shown"
    assert recorded_scene(replace(r, tracked=np.zeros(r.frames, bool)))[0]["first_tracked"] == 0


def test_infinite_numbers_are_missing():
    assert np.isnan(unpack(pack(np.array([[np.inf, 1.0], [2.0, -np.inf]])))).tolist() == [
        [True, False],
        [False, True],
    ]


def test_rows_show_the_result():
    r = walk()
    scene, rows, _ = recorded_scene(r)
    assert rows.shape == (r.frames, scene["width"])
    assert scene["rate_hz"] == r.rate_hz
    np.testing.assert_array_equal(part(scene, rows, "measured").reshape(r.measured_m.shape), r.measured_m)
    np.testing.assert_array_equal(part(scene, rows, "angles"), r.angles)
    np.testing.assert_array_equal(part(scene, rows, "force").reshape(-1, 2, 3), r.foot_wrench[..., :3])
    np.testing.assert_array_equal(part(scene, rows, "pressure").reshape(-1, 2, 3), r.foot_cop_m)
    np.testing.assert_array_equal(part(scene, rows, "step_seconds")[:, 0], r.step_seconds)
    assert (part(scene, rows, "state") == SEEN).all()


def test_parts_that_ever_bear_have_arrows_of_their_own():
    r = leaning_walk()
    scene, rows, _ = recorded_scene(r)
    assert scene["loads"] == [
        {"name": "right_foot", "side": "r"},
        {"name": "left_foot", "side": "l"},
        {"name": "pelvis", "side": ""},
        {"name": "right_hand", "side": "r"},
    ]
    hand = r.support_names.index("right_hand")
    force, point = (part(scene, rows, name).reshape(-1, 4, 3) for name in ("force", "pressure"))
    np.testing.assert_array_equal(force[:, 3], r.support_wrench[:, hand, :3])
    np.testing.assert_array_equal(point[:, 3], r.support_point_m[:, hand])
    source = part(scene, rows, "source")
    assert (source[SEAT, 2] == 3).all() and (source[RAIL, 3] == 3).all()
    assert source[:, 2:].sum() == 3 * (len(source[SEAT]) + len(source[RAIL]))
    np.testing.assert_array_equal(source[:, :2], r.foot_source)
    titles = {q["id"]: q["title"] for q in scene["quantities"]}
    assert titles["load:vertical_right_hand"] == "Vertical force, right hand"
    assert titles["load:x_pelvis"] == "Force along x, pelvis"
    assert titles["reaction:vertical_r"] == "Vertical reaction, right"
    back = unpack(recording(r)["rows"])
    np.testing.assert_array_equal(part(scene, back, "source"), source)


def test_hidden_markers_are_marked_and_a_lost_body_is_not_drawn():
    scene, rows, _ = recorded_scene(broken_walk())
    state = part(scene, rows, "state")
    assert (state[20:50, 0] == UNSEEN).all() and (state[30:40, 1] == UNSEEN).all()
    assert (state[60:65, 2] == REFUSED).all()
    measured = part(scene, rows, "measured").reshape(len(rows), -1, 3)
    assert np.isnan(measured[30:40, 1]).all() and np.isfinite(measured[60:65, 2]).all()
    assert np.isnan(part(scene, rows, "segments")[LOST]).all()
    assert np.isnan(part(scene, rows, "predicted")[LOST]).all()


def test_fast_recordings_are_thinned():
    fast = replace(walk(), rate_hz=250.0)
    scene, rows, _ = recorded_scene(fast)
    assert len(rows) == -(-fast.frames // 3)
    assert scene["rate_hz"] == pytest.approx(250.0 / 3)


def test_nothing_to_play_is_said():
    r = walk()
    none = {
        name: value[:0]
        for name in r.__dataclass_fields__
        if isinstance(value := getattr(r, name), np.ndarray) and name != "plate_corners_m"
    }
    with pytest.raises(InvalidInput, match="no frames"):
        recorded_scene(replace(r, **none))


def test_the_page_holds_the_rows_and_is_small():
    text = playback_page(walk())
    (held,) = re.findall(r'id="recording">(.*?)</script>', text)
    data = json.loads(held)
    assert data["scene"]["title"] == "walk <1>"
    assert data == recording(walk())
    assert len(text) < 2_000_000
