"""A result as BVH, read by a reader that knows the format only: every joint where the body has it."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.trial.exchange.result_bvh import write_result_bvh
from tests.motions import assert_near
from tests.recordings import LOST, broken_walk, performer, walker
from tests.synthesis.conftest import SECONDS
from tests.trial.exchange.bvh_reading import places, read

LEFT_UP_FORWARD = [1, 2, 0]
"""World axes that are x, y and z of the file."""


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    path = tmp_path_factory.mktemp("bvh") / "walk.bvh"
    write_result_bvh(broken_walk(), path)
    return read(path.read_text(encoding="ascii"))


def assert_on_the_body(nodes, row, model, q, at_most_m=5e-6):
    R, origins = model.placements(q)
    found = places(nodes, row)
    for name, joint in model.joints.items():
        rotation, centre_cm = found[name]
        assert_near(centre_cm / 100.0, origins[joint.joint_id][LEFT_UP_FORWARD], at_most_m)
        own = R[joint.joint_id][np.ix_(LEFT_UP_FORWARD, LEFT_UP_FORWARD)]
        assert_near(rotation, own, 1e-6)


def test_all_joints_are_where_the_body_has_them_in_every_followed_frame(walked):
    nodes, rows, step_s = walked
    r, model = broken_walk(), walker()[1]
    assert step_s == pytest.approx(1.0 / r.rate_hz) and len(rows) == r.frames
    for t in np.flatnonzero(r.tracked):
        assert_on_the_body(nodes, rows[t], model, r.q[t])


def test_frames_without_the_body_hold_the_last_pose(walked):
    _, rows, _ = walked
    np.testing.assert_array_equal(rows[LOST], np.tile(rows[LOST.start - 1], (LOST.stop - LOST.start, 1)))
    assert (rows[LOST.stop] != rows[LOST.start - 1]).any()


def test_before_the_first_followed_frame_that_pose_stands_and_lost_frames_hold(tmp_path):
    r = broken_walk()
    tracked = np.arange(r.frames) > 4
    times = r.times_s + np.where(np.arange(r.frames) >= 50, 3.0 / r.rate_hz, 0.0)
    write_result_bvh(replace(r, tracked=tracked, times_s=times), tmp_path / "x.bvh")
    nodes, rows, _ = read((tmp_path / "x.bvh").read_text())
    assert len(rows) == r.frames + 3
    for frame, row in [(0, 5), (5, 5), (49, 49), (50, 49), (52, 49), (53, 50), (len(rows) - 1, r.frames - 1)]:
        assert_on_the_body(nodes, rows[frame], walker()[1], r.q[row])


def test_the_tree_is_the_body_s_with_ends_and_the_usual_channels(walked):
    nodes, _, _ = walked
    model = walker()[1]
    assert [node.name for node in nodes if not node.name.endswith("/end")] == list(model.joints)
    turns = ["Zrotation", "Xrotation", "Yrotation"]
    for node in nodes:
        if node.name.endswith("/end"):
            assert node.channels == [] and 1.0 < np.linalg.norm(node.offset) < 60.0
        elif node.parent < 0:
            assert node.channels == ["Xposition", "Yposition", "Zposition", *turns]
        else:
            assert node.channels == turns
            assert nodes[node.parent].name == model.description.segment(node.name).parent
    leaves = {node.name for node in nodes} - {nodes[node.parent].name for node in nodes if node.parent >= 0}
    assert all(name.endswith("/end") for name in leaves)


def test_without_angles_the_body_stands_upright_facing_z(walked):
    nodes, rows, _ = walked
    found = places(nodes, np.zeros(rows.shape[1]))
    model = walker()[1]
    height = found["head"][1][1] - found["right_foot"][1][1]
    assert height > 120.0
    assert found["right_toes/end"][1][2] > found["right_foot"][1][2] + 5.0
    assert found["left_thigh"][1][0] > 5.0 > -5.0 > found["right_thigh"][1][0]
    assert_on_the_body(nodes, np.zeros(rows.shape[1]), model, model.neutral())


def moved(name):
    return performer(name, SECONDS[name], 5)[2]


@pytest.mark.parametrize("name", ["squat", "kneel", "reach"])
def test_deep_bends_stay_exact_and_continuous(tmp_path, name):
    """Past 90° of flexion, where the middle angle is singular."""
    motion, model = moved(name), walker()[1]
    rows = np.arange(0, len(motion.q), 2)
    T, blank = len(rows), broken_walk()
    arrays = {
        key: np.resize(value, (T, *value.shape[1:]))
        for key, value in vars(blank).items()
        if isinstance(value, np.ndarray) and len(value) == blank.frames
    }
    r = replace(
        blank,
        **{
            **arrays,
            "q": motion.q[rows],
            "times_s": np.arange(T) / blank.rate_hz,
            "tracked": np.ones(T, bool),
        },
    )
    write_result_bvh(r, tmp_path / "x.bvh")
    nodes, found, _ = read((tmp_path / "x.bvh").read_text())
    for t in range(0, T, 5):
        assert_on_the_body(nodes, found[t], model, r.q[t])


def test_the_joints_stay_where_they_are_on_their_segments():
    """What BVH takes for granted: a joint's place in its parent's frame is the same at all times."""
    model, rng = walker()[1], np.random.default_rng(0)
    for _ in range(20):
        q = model.integrate(model.neutral(), rng.normal(size=model.nv))
        R, origins = model.placements(q)
        for segment in model.description.segments[1:]:
            parent, own = model.joints[segment.parent].joint_id, model.joints[segment.name].joint_id
            offset = R[parent].T @ (origins[own] - origins[parent])
            wanted = model.axis_scale(model.description.segment(segment.parent)) * segment.origin_m
            assert_near(offset, wanted, 1e-12)


def test_a_result_that_follows_nothing_is_refused(tmp_path):
    r = broken_walk()
    with pytest.raises(InvalidInput, match="no frame"):
        write_result_bvh(replace(r, tracked=np.zeros(r.frames, bool)), tmp_path / "x.bvh")
    assert list(tmp_path.iterdir()) == []
