"""The direction a person faces: forward along the walk, left and up square to it."""

import numpy as np

from mbkf.trial.gait.facing import facing
from tests.recordings import broken_walk, walk


def test_a_walker_faces_where_it_goes():
    r = walk()
    axes = facing(r)
    np.testing.assert_allclose(
        axes @ axes.transpose(0, 2, 1), np.broadcast_to(np.eye(3), axes.shape), atol=1e-12
    )
    way = r.q[-1, :2] - r.q[0, :2]
    assert (axes[:, 0, :2] @ (way / np.linalg.norm(way)) > 0.95).all()
    np.testing.assert_allclose(np.cross(axes[:, 2], axes[:, 0]), axes[:, 1], atol=1e-12)


def test_where_the_body_is_lost_the_direction_goes_on():
    assert np.isfinite(facing(broken_walk())).all()
