"""A result in MeshCat: keys of the animation are the result's poses, markers and forces."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import mbkf
from mbkf.conventions import GRAVITY_M_S2
from mbkf.errors import InvalidInput
from mbkf.viz.meshcat.playing import WEIGHTS_PER_M, play
from tests.recordings import broken_walk, leaning_walk, walk, walker
from tests.viz.browsing import until
from tests.viz.meshcat.recorded import keys, path, viewer


@pytest.fixture(scope="module")
def model():
    return walker()[1]


def clips(result, **options):
    shown = mbkf.play(result, open=False, viewer=viewer(), **options)
    (found,) = shown.viewer.window.animations
    return shown.viewer.window, found


def test_segments_follow_forward_kinematics(model):
    r = walk()
    _, found = clips(r)
    stride = round(r.rate_hz / 50.0)
    for name, joint in model.joints.items():
        clip = found[path("human18", "visuals", name)]
        times, places = keys(clip, "position")
        quaternions = keys(clip, "quaternion")[1]
        np.testing.assert_allclose(times, r.times_s[::stride] - r.times_s[0], atol=1e-12)
        for k in (0, 17, len(times) - 1):
            R, p = model.placements(r.q[k * stride])
            np.testing.assert_allclose(places[k], p[joint.joint_id], atol=1e-12)
            turned = Rotation.from_quat(quaternions[k]).as_matrix()
            np.testing.assert_allclose(turned, R[joint.joint_id], atol=1e-9)


def test_arrows_stand_on_the_centre_of_pressure_and_point_along_the_force():
    r = leaning_walk()
    window, found = clips(r)
    loads, stride = r.loads, round(r.rate_hz / 50.0)
    drawn = [name for name in loads.names if path("human18", "loads", name) in found]
    assert drawn == ["right_foot", "left_foot", "pelvis", "right_hand"]
    for name in drawn:
        part = loads.names.index(name)
        clip, parts = found[path("human18", "loads", name)], path("human18", "loads", name)
        times, points = keys(clip, "position")
        turns, tips = keys(clip, "quaternion")[1], keys(found[f"{parts}/head"], "position")[1]
        sizes = keys(found[f"{parts}/head"], "scale")[1]
        frames = np.round((np.array(times)) * r.rate_hz).astype(int)
        assert (frames % stride == 0).all()
        for k, frame in enumerate(frames):
            force = loads.wrench[frame, part, :3]
            length = np.linalg.norm(force) / (WEIGHTS_PER_M * r.subject.mass_kg * GRAVITY_M_S2)
            np.testing.assert_allclose(points[k], loads.point_m[frame, part], atol=1e-12)
            direction = Rotation.from_quat(turns[k]).apply([0.0, 1.0, 0.0])
            np.testing.assert_allclose(direction * np.linalg.norm(force), force, atol=1e-6)
            assert tips[k][1] + 0.09 * sizes[k][1] == pytest.approx(length)
        assert f"{parts}/shaft/bar" in window.objects and f"{parts}/head/cone" in window.objects


def test_an_arrow_points_along_the_opposite_of_its_own_axis():
    r = leaning_walk()
    wrench = np.zeros_like(r.foot_wrench)
    wrench[..., 1] = -0.5 * r.subject.mass_kg * GRAVITY_M_S2
    _, found = clips(replace(r, foot_wrench=wrench))
    turns = keys(found[path("human18", "loads", "right_foot")], "quaternion")[1]
    assert len(turns)
    np.testing.assert_allclose(
        Rotation.from_quat(turns).apply([0.0, 1.0, 0.0]), [[0, -1, 0]] * len(turns), atol=1e-12
    )


def test_the_unknown_is_hidden():
    """The body where it is lost, markers where they are unseen or taken away; the rest stays."""
    r = broken_walk()
    _, found = clips(r)
    visible = {
        name: keys(found[path("human18", *where)], "visible")
        for name, where in {
            "pelvis": ("visuals", "pelvis"),
            "unseen": ("markers", f"marker_{r.marker_names[0]}"),
            "hidden": ("markers", f"marker_{r.marker_names[1]}"),
        }.items()
    }
    assert visible["pelvis"] == ([0.0, 1.0, 1.1], [True, False, True])
    assert visible["unseen"] == ([0.0, 0.2, 0.5], [True, False, True])
    assert visible["hidden"] == ([0.0, 0.3, 0.4], [True, False, True])
    tracks = found[path("human18", "markers", f"marker_{r.marker_names[2]}")]["tracks"]
    assert [track["name"] for track in tracks] == [".position"]


def test_the_speed_is_that_of_the_clips():
    assert {clip["fps"] for clip in clips(walk(), speed=0.25)[1].values()} == {0.25}


@pytest.mark.parametrize("speed", [0.0, -1.0, np.nan])
def test_a_speed_that_is_not_positive_is_refused(speed):
    with pytest.raises(InvalidInput, match="speed"):
        play(walk(), speed, open=False, viewer=viewer())


def test_a_result_without_the_body_is_refused():
    r = walk()
    with pytest.raises(InvalidInput, match="0 of 251 frames"):
        play(replace(r, tracked=np.zeros(r.frames, bool)), open=False, viewer=viewer())


@pytest.mark.slow
def test_a_browser_plays_it(browser, model):
    r = walk()
    shown = play(r, open=False)
    try:
        page = browser.new_page(device_scale_factor=0.25)
        page.goto(shown.viewer.url())
        until(page, "window.viewer !== undefined && viewer.animator.duration > 2.4")
        page.evaluate("viewer.animator.pause(); viewer.animator.seek(1.2)")
        place = 'viewer.scene_tree.find(["meshcat", "human18", "visuals", "head"]).object.position.toArray()'
        head = model.placements(r.q[120])[1][model.joint("head").joint_id]
        np.testing.assert_allclose(page.evaluate(place), head, atol=1e-5)
        page.close()
    finally:
        shown.close()
