"""Joints that slide as they turn, and the fixed hinges that stand for them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.errors import InvalidInput
from mbkf.io.osim import read_osim
from mbkf.model.osim_hinges import with_fixed_hinges
from mbkf.model.osim_kinematics import OsimKinematics
from mbkf.model.osim_tree import osim_tree
from tests.osim_mechanisms import COUPLER, LINE, joint, mechanism, spatial_transform

ROOT = joint("FreeJoint", "ground", "root", ("rx", "ry", "rz", "tx", "ty", "tz"))
CENTRE = np.array([0.03, -0.02, 0.0])


def spline(x, y):
    numbers = (" ".join(repr(float(one)) for one in values) for values in (x, y))
    return "<SimmSpline><x>{}</x><y>{}</y></SimmSpline>".format(*numbers)


def squared(coefficient):
    return f"<PolynomialFunction><coefficients>{coefficient} 0 0</coefficients></PolynomialFunction>"


def sliding(*shifts, turns=(("knee", LINE),)):
    transform = spatial_transform(turns, [("knee", one) for one in shifts])
    return joint("CustomJoint", "root", "shin", ("knee",), transform)


def model(folder, *joints, constraints="", kneecap_kg=1.0):
    text = mechanism((ROOT, *joints), constraints)
    light = f'<Body name="kneecap"><mass>{kneecap_kg}</mass>'
    path = folder / "model.osim"
    path.write_text(text.replace('<Body name="kneecap"><mass>1</mass>', light), encoding="utf-8")
    return read_osim(path)


def placed(osim, angles):
    """(T, 3, 3) and (T, 3) pose of the shin for values of the knee, all other coordinates at their default."""
    kinematics = OsimKinematics(osim)
    q = np.tile(kinematics.defaults, (len(angles), 1))
    q[:, kinematics.names.index("knee")] = angles
    poses, shin = kinematics.poses(q), kinematics.body("shin")
    return poses.rotations[:, shin], poses.origins_m[:, shin]


def rms_m(osim, other, angles):
    """Distance of seven points about the shin's centre of mass between two models."""
    points = 0.2 * np.vstack([np.zeros(3), np.eye(3), -np.eye(3)])
    found = [
        np.einsum("tij,pj->tpi", R, points) + at[:, None]
        for R, at in (placed(osim, angles), placed(other, angles))
    ]
    return np.sqrt(np.mean(np.sum((found[0] - found[1]) ** 2, axis=2)))


def test_a_slide_that_is_a_turn_about_another_point_is_found(tmp_path):
    """Shifts c − R(θ) c make a joint turn about c: x is OpenSim's own axis of the turn, y and z are along AXES."""
    x = np.linspace(-2.0, 2.0, 81)
    away = CENTRE[1] - Rotation.from_rotvec(x[:, None] * [1.0, 0.0, 0.0]).apply([0.0, CENTRE[1], 0.0])[:, 1]
    up = -Rotation.from_rotvec(x[:, None] * [1.0, 0.0, 0.0]).apply([0.0, CENTRE[1], 0.0])[:, 2]
    along = away / 0.6, up - away * 0.8 / 0.6  # parts along (0, 0.6, 0.8) and (0, 0, 1)
    osim = model(tmp_path, sliding(spline(x, 0.0 * x), *(spline(x, one) for one in along)))
    found, (note,) = with_fixed_hinges(osim, {})
    angles = np.linspace(-1.2, 1.2, 9)
    for one, other in zip(placed(found, angles), placed(osim, angles), strict=True):
        assert one == pytest.approx(other, abs=1e-6)
    assert note.segment == "shin" and note.rms_m < 1e-6


def test_the_hinge_is_the_nearest_one_and_its_distance_is_stated(tmp_path):
    osim = model(
        tmp_path, sliding(squared(0.004), squared(-0.006), turns=(("knee", LINE), ("knee", squared(0.02))))
    )
    found, (note,) = with_fixed_hinges(osim, {})
    angles = np.deg2rad(np.linspace(-70.0, 70.0, 41))
    assert note.rms_m == pytest.approx(rms_m(found, osim, angles), rel=1e-9)
    assert 5e-4 < note.rms_m < 5e-3
    assert f"{1e3 * note.rms_m:.1f} mm RMS" in note.text and "from -70 to 70°" in note.text
    at = next(k for k, one in enumerate(found.joints) if one.name == "to_shin")
    hinge = found.joints[at]
    for frame in ("parent_frame", "child_frame"):
        for moved in (*np.eye(3), *-np.eye(3)):
            other = getattr(hinge, frame).copy()
            other[:3, 3] += 1e-3 * moved
            changed = replace(hinge, **{frame: other})
            joints = (*found.joints[:at], changed, *found.joints[at + 1 :])
            assert rms_m(replace(found, joints=joints), osim, angles) > note.rms_m
    links = osim_tree(found).joints["root"]
    assert [one.kind for one in links if one.name == "knee"] == ["revolute"]


def test_the_range_may_be_stated(tmp_path):
    osim = model(tmp_path, sliding(squared(0.004)))
    narrow, wide = (with_fixed_hinges(osim, one)[1][0] for one in ({"knee": [0.0, 30.0]}, {}))
    assert narrow.rms_m < 0.2 * wide.rms_m and "from 0 to 30°" in narrow.text
    for wrong in ([30.0, 0.0], [10.0], [0.0, np.inf]):
        with pytest.raises(InvalidInput, match="fitted_deg of knee needs two angles"):
            with_fixed_hinges(osim, {"knee": wrong})
    with pytest.raises(InvalidInput, match=r"fitted_deg names hip; only .* are: knee"):
        with_fixed_hinges(osim, {"hip": [0.0, 30.0]})


def test_a_joint_far_from_every_hinge_is_refused(tmp_path):
    with pytest.raises(
        InvalidInput, match=r"'to_shin' slides or turns along curves of 'knee'.* mm RMS away; 5 mm"
    ):
        with_fixed_hinges(model(tmp_path, sliding(squared(0.1))), {})
    with pytest.raises(InvalidInput, match="'to_shin' slides or turns"):  # twice as fast as its coordinate
        with_fixed_hinges(
            model(tmp_path, sliding(turns=(("knee", LINE.replace("1 0", "2 0")), ("knee", LINE)))), {}
        )


def test_plain_joints_stay(tmp_path):
    osim = model(tmp_path, sliding(), joint("BallJoint", "root", "ball", ("b1", "b2", "b3")))
    assert with_fixed_hinges(osim, {}) == (osim, ())


def test_a_light_body_that_follows_a_coordinate_is_fixed(tmp_path):
    knee, kneecap = sliding(), joint("PinJoint", "root", "kneecap", ("patella",))
    osim = model(tmp_path, knee, kneecap, constraints=COUPLER, kneecap_kg=0.05)
    found, (note,) = with_fixed_hinges(osim, {})
    assert note.segment == "root" and note.text.startswith("kneecap (0.05 kg) is fixed to root")
    assert found.couplers == ()
    poses = [
        one.poses(one.expanded(one.defaults[one.free][None])[0]) for one in map(OsimKinematics, (osim, found))
    ]
    places = [one.origins_m[0, OsimKinematics(osim).body("kneecap")] for one in poses]
    assert places[0] == pytest.approx(places[1], abs=1e-12)
    with pytest.raises(
        InvalidInput, match="'patella' follows 'knee', and its body 'kneecap' bears others or has 11"
    ):
        with_fixed_hinges(model(tmp_path, knee, kneecap, constraints=COUPLER), {})
    foot = joint("PinJoint", "kneecap", "ball", ("b1",))
    with pytest.raises(InvalidInput, match="'kneecap' bears others"):
        with_fixed_hinges(model(tmp_path, knee, kneecap, foot, constraints=COUPLER, kneecap_kg=0.05), {})
