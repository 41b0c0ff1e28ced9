"""An OpenSim model's poses: derivatives, constraints, a chain by hand, and OpenSim itself where it is installed."""

import numpy as np
import pytest

from mbkf.errors import InvalidInput
from mbkf.io.osim import read_osim
from mbkf.model.osim_kinematics import OsimKinematics
from tests.osim_mechanisms import COUPLER, JOINTS, LINE, joint, mechanism, spatial_transform

POSTURES = 6


def kinematics(folder, text):
    path = folder / "model.osim"
    path.write_text(text, encoding="utf-8")
    return OsimKinematics(read_osim(path))


@pytest.fixture(scope="module")
def every_joint(tmp_path_factory):
    return kinematics(tmp_path_factory.mktemp("osim"), mechanism())


@pytest.fixture
def postures(every_joint):
    free = np.random.default_rng(1).uniform(-1.2, 1.2, (POSTURES, len(every_joint.free)))
    return every_joint.expanded(free)[0]


def markers(body, q):
    found = body.model.markers
    numbers = np.array([body.body(one.body) for one in found])
    return body.poses(q).points(numbers, np.array([one.position_m for one in found]))


def test_derivatives_are_those_of_the_places_and_turns(every_joint, postures):
    step = 1e-6
    places, by = markers(every_joint, postures)
    now = every_joint.poses(postures)
    for c in range(len(every_joint.names)):
        moved = np.zeros_like(postures)
        moved[:, c] = step
        after, before = (markers(every_joint, postures + sign * moved)[0] for sign in (1.0, -1.0))
        assert by[..., c] == pytest.approx((after - before) / (2.0 * step), abs=1e-8)
        turned = every_joint.poses(postures + moved).rotations @ np.swapaxes(now.rotations, 2, 3)
        spin = np.stack([turned[..., 2, 1], turned[..., 0, 2], turned[..., 1, 0]], axis=-1) / step
        assert now.turning[..., c] == pytest.approx(spin, abs=1e-5)
    assert places.shape == (POSTURES, len(every_joint.model.markers), 3)


def test_followers_obey_their_constraint_and_locked_coordinates_stay(every_joint):
    free = np.random.default_rng(2).uniform(-1.0, 1.0, (POSTURES, len(every_joint.free)))
    q, by = every_joint.expanded(free)
    names = every_joint.names
    (coupler,) = every_joint.model.couplers
    assert q[:, names.index("patella")] == pytest.approx(coupler.value.value(q[:, names.index("knee")]))
    assert (q[:, names.index("held")] == 0.1).all()
    knee = list(every_joint.free).index(names.index("knee"))
    step = np.zeros_like(free)
    step[:, knee] = 1e-6
    numeric = (every_joint.expanded(free + step)[0] - every_joint.expanded(free - step)[0]) / 2e-6
    assert by[..., knee] == pytest.approx(numeric, abs=1e-8)


def test_a_hinge_by_hand(tmp_path):
    """A body whose joint turns it about z by 90°: its x axis shows along the ground's y."""
    hinge = joint("PinJoint", "ground", "root", ("angle",))
    for turn in ("0.3 -0.5 0.8", "-0.2 0.4 1.1"):
        hinge = hinge.replace(turn, "0 0 0")
    found = kinematics(tmp_path, mechanism((hinge,), "")).poses(np.array([[np.pi / 2]]))
    assert found.rotations[0, 0] == pytest.approx(np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]), abs=1e-12)
    # joint at (0.1, 0.2, -0.3); the child's origin lies at (-0.02, 0.1, -0.05) from it, turned
    assert found.origins_m[0, 0] == pytest.approx([0.1 - 0.1, 0.2 - 0.02, -0.35])
    assert found.turning[0, 0, :, 0] == pytest.approx([0.0, 0.0, 1.0])


def test_angles_are_those_that_a_turn_follows(every_joint):
    angles = {one.name for one in every_joint.model.coordinates if one.rotational}
    assert angles == set(every_joint.names) - {"tx", "ty", "tz", "p2", "p3", "held"}


@pytest.mark.parametrize(
    ("joints", "constraints", "reason"),
    [
        ((JOINTS[0].replace("FreeJoint", "EllipsoidJoint"),), "", "'to_root' cannot be followed: .*EllipsoidJoint"),
        ((*JOINTS[:1], JOINTS[3]), "", "'to_universal'"),
        ((JOINTS[0], JOINTS[0].replace("rx", "qx")), "", "stands twice|two joints"),
        (JOINTS, COUPLER.replace("CoordinateCoupler", "ConstantDistance"), r"follows \(ConstantDistanceConstraint\)"),
        (JOINTS, COUPLER.replace(">knee<", ">hip<"), "no joint has a coordinate 'hip'"),
        (JOINTS, COUPLER + COUPLER.replace(">knee<", ">x<").replace(">patella<", ">knee<").replace(">x<", ">patella<"),
         "in a circle"),
        (
            (joint("CustomJoint", "ground", "root", ("a", "b"), spatial_transform((("a b", LINE),), ())),),
            "",
            "its rotation1 depends on 2 coordinates",
        ),
        (
            (joint("CustomJoint", "ground", "root", ("a",), spatial_transform((("a", "<Sine/>"),), ())),),
            "",
            "not supported .Sine",
        ),
        ((JOINTS[0].replace("<clamped>", "<prescribed>true</prescribed><clamped>"),), "", "is prescribed"),
    ],
)  # fmt: skip
def test_mechanisms_that_cannot_be_followed_are_refused_by_name(joints, constraints, reason, tmp_path):
    with pytest.raises(InvalidInput, match=reason):
        kinematics(tmp_path, mechanism(joints, constraints))


def test_markers_are_where_opensim_has_them(every_joint, postures, tmp_path):
    opensim = pytest.importorskip("opensim", reason="OpenSim comes with the extra 'peers'")
    path = tmp_path / "model.osim"
    path.write_text(mechanism(), encoding="utf-8")
    model = opensim.Model(str(path))
    state = model.initSystem()
    places = markers(every_joint, postures)[0]
    for row, expected in zip(postures, places, strict=True):
        for name, value in zip(every_joint.names, row, strict=True):
            coordinate = model.getCoordinateSet().get(name)
            coordinate.setLocked(state, False)
            coordinate.setValue(state, float(value), False)
        model.realizePosition(state)
        for marker, place in zip(every_joint.model.markers, expected, strict=True):
            found = model.getMarkerSet().get(marker.name).getLocationInGround(state)
            assert [found.get(k) for k in range(3)] == pytest.approx(place, abs=1e-9)
