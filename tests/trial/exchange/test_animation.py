"""The body in animation's axes: a right-handed turn of the world, and the frames that are shown."""

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.trial.exchange.animation import TO_ANIMATION, animated_body, held_rows
from tests.motions import assert_near
from tests.recordings import walk, walker


def test_left_up_and_forward_are_x_y_and_z():
    forward, left, up = np.eye(3)
    np.testing.assert_array_equal(np.array([left, up, forward]) @ TO_ANIMATION.T, np.eye(3))
    assert np.linalg.det(TO_ANIMATION) == 1.0


def test_chaining_the_segments_gives_their_places():
    r, model = walk(), walker()[1]
    rows = np.array([0, 120, 7])
    body = animated_body(r, rows)
    for f, row in enumerate(rows):
        R, origins = model.placements(r.q[row])
        turns, places = [], []
        for k, parent in enumerate(body.parents):
            if parent < 0:
                turns.append(body.rotations[f, k])
                places.append(body.root_m[f])
            else:
                turns.append(turns[parent] @ body.rotations[f, k])
                places.append(places[parent] + turns[parent] @ body.offsets_m[k])
            joint = model.joints[body.names[k]].joint_id
            assert_near(places[k], TO_ANIMATION @ origins[joint], 1e-12)
            assert_near(turns[k], TO_ANIMATION @ R[joint] @ TO_ANIMATION.T, 1e-12)


@pytest.mark.parametrize(
    ("rows", "tracked", "shown"),
    [
        ([0, 1, 2], [1, 1, 1], [0, 1, 2]),
        ([0, -1, 1, 2], [1, 0, 1], [0, 0, 0, 2]),
        ([0, 1, -1, 2], [0, 1, 1], [1, 1, 1, 2]),
        ([-1, 0, 1], [1, 0], [0, 0, 0]),
    ],
)
def test_what_is_not_known_is_held(rows, tracked, shown):
    assert held_rows(np.array(rows), np.array(tracked, dtype=bool)).tolist() == shown


@pytest.mark.parametrize("frames", [0, 3])
def test_without_any_followed_frame_there_is_nothing_to_show(frames):
    with pytest.raises(InvalidInput, match="no frame"):
        held_rows(np.arange(frames), np.zeros(frames, dtype=bool))
