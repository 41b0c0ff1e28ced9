"""Fits of an OpenSim model to points: exact postures, limits, missing points, and a root turned any way."""

import numpy as np
import pytest

from mbkf.io.osim import read_osim
from mbkf.model.osim_fit import Targets, fit
from mbkf.model.osim_kinematics import OsimKinematics
from tests.osim_mechanisms import joint, mechanism

FRAMES, RATE_HZ = 12, 50.0
PLACES = np.array([[0.1, -0.3, 0.2], [0.3, 0.0, -0.1], [-0.2, 0.2, 0.1]])


def kinematics(folder, text=None):
    (folder / "model.osim").write_text(text or mechanism(), encoding="utf-8")
    return OsimKinematics(read_osim(folder / "model.osim"))


def targets(body, q):
    bodies = np.repeat(np.arange(len(body.bodies)), len(PLACES))
    places = np.tile(PLACES, (len(body.bodies), 1))
    return Targets(bodies, places, body.poses(q).points(bodies, places)[0], np.ones(len(bodies)))


@pytest.fixture(scope="module")
def body(tmp_path_factory):
    return kinematics(tmp_path_factory.mktemp("osim"))


@pytest.fixture(scope="module")
def motion(body):
    """Angles of every frame, far from the default in the root's turn."""
    rng = np.random.default_rng(4)
    start, end = rng.uniform(-0.8, 0.8, (2, len(body.free)))
    start[body.names.index("ry")] = end[body.names.index("ry")] + 0.3
    free = start + (end - start) * np.linspace(0.0, 1.0, FRAMES)[:, None]
    free[:, body.names.index("rx")] += 1.1
    return body.expanded(free)[0]


def test_a_motion_is_found_again(body, motion):
    found = fit(body, targets(body, motion), RATE_HZ)
    assert found == pytest.approx(motion, abs=1e-7)


def test_points_that_are_not_known_do_not_count(body, motion):
    wanted = targets(body, motion)
    at = wanted.at_m.copy()
    at[3:7, 0] = np.nan
    at[5, 8] = np.nan
    found = fit(body, Targets(wanted.bodies, wanted.places_m, at, wanted.weights), RATE_HZ, motion[0])
    assert found == pytest.approx(motion, abs=1e-7)


def test_a_heavier_point_is_nearer(tmp_path):
    hinge = kinematics(tmp_path, mechanism((joint("PinJoint", "ground", "root", ("angle",)),), ""))
    bodies, places = np.zeros(2, int), np.array([[0.3, 0.1, 0.0], [0.3, 0.1, 0.0]])
    poses = [hinge.poses(np.array([[angle]])).points(bodies[:1], places[:1])[0][0, 0] for angle in (0.2, 0.4)]
    at = np.array([poses])
    even, uneven = (
        fit(hinge, Targets(bodies, places, at, np.array(weights)), RATE_HZ)[0, 0]
        for weights in ([1.0, 1.0], [3.0, 1.0])
    )
    assert even == pytest.approx(0.3)
    assert 0.2 < uneven < 0.23


@pytest.mark.parametrize(("angle", "found"), [(1.9, 1.9), (2.6, 2.0), (-2.4, -2.0)])
def test_a_coordinate_stops_at_its_limit(angle, found, tmp_path):
    hinge = kinematics(tmp_path, mechanism((joint("PinJoint", "ground", "root", ("angle",)),), ""))
    wanted = targets(hinge, np.array([[angle]]))
    assert fit(hinge, wanted, RATE_HZ)[0, 0] == pytest.approx(found, abs=1e-9)


def test_others_give_way_where_one_is_at_its_limit(tmp_path):
    """Two hinges about one axis: where the first may turn no further, the second takes the rest."""
    first = joint("PinJoint", "ground", "root", ("first",))
    second = joint("PinJoint", "root", "ball", ("second",))
    for turn in ("0.3 -0.5 0.8", "-0.2 0.4 1.1"):
        first, second = first.replace(turn, "0 0 0"), second.replace(turn, "0 0 0")
    for place in ("0.1 0.2 -0.3", "0.02 -0.1 0.05"):
        second = second.replace(place, "0 0 0")
    pair = kinematics(tmp_path, mechanism((first.replace("-2 2", "-0.5 0.5"), second), ""))
    bodies = np.full(3, pair.body("ball"))
    # both joints at one place, so that only the sum of the angles shows
    at = pair.poses(np.array([[0.5, 0.7]])).points(bodies, PLACES)[0]
    found = fit(pair, Targets(bodies, PLACES, at, np.ones(3)), RATE_HZ)[0]
    assert found.sum() == pytest.approx(1.2, abs=1e-6) and abs(found[0]) <= 0.5
